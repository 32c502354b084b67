/* What the example needs of the machine it runs on. */
#ifndef PLATFORM_H
#define PLATFORM_H

/* Writes a text. */
void say(const char *text);

#endif
