"""An electric car's powertrain and battery, step by step.

The models are those of the command ``voltstep`` and of a microcontroller: single precision, the
same bits. Names carry their units: ``_s`` seconds, ``_m_s`` metres per second, ``_a`` amperes (of a
battery positive when discharging), ``_v`` volts, ``_c`` degrees Celsius, ``_kwh`` kilowatt-hours;
without a unit it is a ratio. What is refused raises ValueError with the words of the command.
"""

from os import PathLike
from typing import NamedTuple

from . import _voltstep
from ._voltstep import Battery, Result, Sweep, Vehicle, __version__, battery, vehicle

__all__ = [
    "Battery", "Identified", "Result", "Sweep", "Vehicle", "__version__", "battery", "batteries",
    "cycles", "estimate_soc", "identify_battery", "identify_vehicle", "simulate", "simulate_many",
    "vehicle", "vehicles",
]

DEFAULT_VEHICLE = "bmw-i3-60ah"


class Identified(NamedTuple):
    """What was identified, and what to know about it."""

    found: "Battery | Vehicle"
    notes: list


def cycles():
    """The names of the built-in driving cycles."""
    return _voltstep.names()[0]


def vehicles():
    """The names of the built-in vehicles."""
    return _voltstep.names()[1]


def batteries():
    """The names of the built-in batteries."""
    return _voltstep.names()[2]


def simulate(drive, vehicle=DEFAULT_VEHICLE, dt_s=1e-3, *, mode="vehicle", ledger=True,
             progress=None):
    """Replay one vehicle on a cycle or a trip, as ``voltstep replay`` does.

    drive: name of a cycle, path of a cycle or trip file, or ``(time_s, speed_m_s[, grade])``
        with time in seconds, speed in m/s and grade as a ratio.
    vehicle: a Vehicle, a name, the path of a TOML file, or a dict of parameters.
    dt_s: length of a step [s]; one above 1 ms is compared with 1 ms, which takes longer.
    mode: of a trip the whole ``"vehicle"``, or the ``"battery"`` alone on measured current.
    ledger: whether to keep the energy ledger.
    progress: called with (done, total), of rows of the trace.
    """
    return _voltstep.simulate(drive, vehicle, dt_s, mode=mode, ledger=ledger, progress=progress)


def simulate_many(drive, vehicles, dt_s=1e-2, *, mode="vehicle", ledger=False, errors="raise",
                  progress=None):
    """Replay many vehicles on all cores; Python's lock is free meanwhile.

    drive, mode, ledger: as simulate().
    vehicles: Vehicles, names, paths or dicts; see Vehicle.variants().
    dt_s: length of a step [s]; what one above 1 ms costs is told in notes, of the first vehicle.
    errors: ``"raise"`` for the first vehicle that cannot be run, or ``"keep"`` for its words in
        errors and NaN in the columns.
    progress: called with (done, total), of vehicles.
    """
    if errors not in ("raise", "keep"):
        raise ValueError(f"errors must be `raise` or `keep`, found `{errors}`")
    return _voltstep.simulate_many(drive, vehicles, dt_s, mode=mode, ledger=ledger,
                                   keep_errors=errors == "keep", progress=progress)


def estimate_soc(time_s, current_a, voltage_v, temperature_c=25.0, *, battery, initial_soc,
                 initial_soc_sd=0.01, estimator="ekf", rested=False, rate_hz=10.0,
                 current_delay_s=0.0):
    """Follow a battery's state of charge from what was measured, as ``voltstep soc`` does.

    time_s, current_a, voltage_v, temperature_c: arrays [s], [A] (positive when discharging), [V],
        [°C]; a single temperature holds for all. Time rises; it need not be even.
    battery: a Battery, a name, the path of a TOML file, or a dict of parameters.
    initial_soc, initial_soc_sd: the state of charge at the start, 0..1, and how well it is known.
    estimator: ``"ekf"``, a Kalman filter on current and voltage, or ``"coulomb"``, a counter.
    rested: whether the battery had rested for an hour before the first sample.
    rate_hz: samples per second that the estimator is given.
    current_delay_s: by how much the measured current leads the measured voltage [s].

    Returns a dict of arrays: time_s [s], soc and its standard deviation soc_sd (0..1), and
    contradicted, where measurement and model do not go together.
    """
    if isinstance(temperature_c, (int, float)):
        temperature_c = [temperature_c] * len(time_s)
    return _voltstep.estimate_soc(
        time_s, current_a, voltage_v, temperature_c, battery, estimator=estimator,
        initial_soc=initial_soc, initial_soc_sd=initial_soc_sd, rested=rested, rate_hz=rate_hz,
        current_delay_s=current_delay_s)


def identify_battery(files, *, name="battery", description="identified from measurements",
                     source="own measurements", capacity_ah=None, discharge_limit_a=float("inf"),
                     charge_limit_a=float("inf"), folds=5, seed=1, progress=None):
    """Identify a battery from trips or from tests of one cell, as ``voltstep identify battery``.

    files: paths; a folder stands for the .csv files in it.
    capacity_ah: capacity [A·h], where the measurements do not tell it.
    discharge_limit_a, charge_limit_a: largest currents [A], which measurements do not tell.
    folds, seed: of the cross-validation.
    progress: called with the name of each stage.
    """
    return Identified(*_voltstep.identify_battery(
        _paths(files), name=name, description=description, source=source, capacity_ah=capacity_ah,
        discharge_limit_a=discharge_limit_a, charge_limit_a=charge_limit_a, folds=folds, seed=seed,
        progress=progress))


def identify_vehicle(files, *, vehicle=DEFAULT_VEHICLE, name="identified", progress=None):
    """Identify a vehicle from trips, as ``voltstep identify vehicle`` does.

    files: paths; a folder stands for the .csv files in it.
    vehicle: name or path of the one that gives what trips do not tell.
    progress: called with the name of each stage.
    """
    return Identified(*_voltstep.identify_vehicle(_paths(files), vehicle=vehicle, name=name,
                                                  progress=progress))


def _paths(files):
    return [files] if isinstance(files, (str, PathLike)) else list(files)
