"""Reads the messages that the example `can_messages` writes, with cantools and the DBC files alone.

    cargo run -p voltstep-bms --example can_messages | python check_dbc.py data/*.dbc

Every value must be what the line says, to a step of its signal; what is read, written again, must give
the same bytes; no message of the files may be missing.
"""

import sys

import cantools

databases = [cantools.database.load_file(path, strict=True) for path in sys.argv[1:]]
messages = {message.frame_id: message for database in databases for message in database.messages}
seen, values, faults = set(), 0, []
for line in sys.stdin:
    frame, *expected = line.split()
    number, data = frame.split("#")
    message, data = messages[int(number, 16)], bytes.fromhex(data)
    seen.add(message.frame_id)
    if len(data) != message.length:
        faults.append(f"{message.name}: {len(data)} bytes, not {message.length}")
        continue
    read = message.decode(data, decode_choices=False)
    for name, value in (pair.split("=") for pair in expected):
        values += 1
        step = abs(message.get_signal_by_name(name).scale)
        if name not in read or abs(read[name] - float(value)) > step * 1.001:
            faults.append(f"{message.name}.{name}: {read.get(name)}, not {value}")
    if message.encode(read, strict=False) != data:
        faults.append(f"{message.name}: written again, {data.hex()} is other bytes")
for number in messages.keys() - seen:
    faults.append(f"{messages[number].name} was not shown")
print("\n".join(faults) or f"{len(seen)} messages, {values} values: as cantools reads them")
sys.exit(bool(faults))
