#!/usr/bin/env python3
"""Extract the driving cycles in this folder from the packages in SOURCE.toml.

Usage: extract.py FASTSIM_DIR CARCULATOR_UTILS_DIR [OUTPUT_DIR]

The two folders hold the unpacked wheels. The output is the same for every run.
Speeds given in m/s are kept digit for digit; km/h are divided by 3.6 and mph
multiplied by 0.44704 in decimal arithmetic, both rounded to 1e-9 m/s.
"""

import csv
import sys
import tomllib
from decimal import Decimal
from pathlib import Path

HERE = Path(__file__).resolve().parent
TO_M_S = {
    "m/s": lambda v: v,
    "km/h": lambda v: (v / Decimal("3.6")).quantize(Decimal("1e-9")),
    "mph": lambda v: (v * Decimal("0.44704")).quantize(Decimal("1e-9")),
}


def plain(value: Decimal) -> str:
    """Decimal notation without trailing zeros."""
    text = f"{value:f}"
    return text.rstrip("0").rstrip(".") if "." in text else text


def read_cycle(package_dir: Path, entry: dict) -> list[tuple[Decimal, Decimal]]:
    """The samples of one cycle, up to the duration that SOURCE.toml gives."""
    dist_info = package_dir / f"{entry['package']}-{entry['version']}.dist-info"
    if not dist_info.is_dir():
        sys.exit(f"{package_dir} does not hold {entry['package']} {entry['version']}")
    to_m_s = TO_M_S[entry["source_speed_unit"]]
    time, speed = entry["columns"]["time"], entry["columns"]["speed"]
    # utf-8-sig: one of the files starts with a byte order mark
    with open(package_dir / entry["file"], encoding="utf-8-sig", newline="") as file:
        delimiter = ";" if ";" in file.readline() else ","
        file.seek(0)
        rows = csv.DictReader(file, delimiter=delimiter)
        samples = [(Decimal(r[time]), to_m_s(Decimal(r[speed]))) for r in rows if r[speed]]
    return [(t, v) for t, v in samples if t <= entry["duration_s"]]


def check(name: str, entry: dict, samples: list[tuple[Decimal, Decimal]]) -> None:
    """Times ascend from 0 to the duration, no speed is negative, the distance fits."""
    times = [t for t, _ in samples]
    if times[0] != 0 or any(b <= a for a, b in zip(times, times[1:])):
        sys.exit(f"{name}: times do not ascend from 0")
    if any(v < 0 for _, v in samples):
        sys.exit(f"{name}: negative speed")
    if times[-1] != entry["duration_s"]:
        sys.exit(f"{name}: ends at {times[-1]} s, SOURCE.toml says {entry['duration_s']} s")
    pairs = zip(samples, samples[1:])
    distance_km = sum((v0 + v1) / 2 * (t1 - t0) for (t0, v0), (t1, v1) in pairs) / 1000
    print(f"{name}: {len(samples)} samples, {times[-1]} s, {distance_km:.6f} km")
    if abs(float(distance_km) - entry["distance_km"]) > 1e-6:
        sys.exit(f"{name}: SOURCE.toml says {entry['distance_km']} km")


def main() -> None:
    if len(sys.argv) not in (3, 4):
        sys.exit(__doc__)
    packages = {"fastsim": Path(sys.argv[1]), "carculator_utils": Path(sys.argv[2])}
    output = Path(sys.argv[3]) if len(sys.argv) == 4 else HERE
    with open(HERE / "SOURCE.toml", "rb") as file:
        cycles = tomllib.load(file)
    for name, entry in cycles.items():
        samples = read_cycle(packages[entry["package"]], entry)
        check(name, entry, samples)
        lines = ["time_s,speed_m_s"] + [f"{plain(t)},{plain(v)}" for t, v in samples]
        (output / f"{name}.csv").write_text("\n".join(lines) + "\n", newline="\n")


if __name__ == "__main__":
    main()
