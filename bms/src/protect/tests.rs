mod debounce;
mod judge;
mod latch;
mod scene;
mod table;
mod time;
