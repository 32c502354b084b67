"""Types; the docstrings of the functions say what they do."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from os import PathLike
from typing import Any, Literal, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

__version__: str
DEFAULT_VEHICLE: str

Path: TypeAlias = str | PathLike[str]
Drive: TypeAlias = Path | tuple[ArrayLike, ArrayLike] | tuple[ArrayLike, ArrayLike, ArrayLike]
Mode: TypeAlias = Literal["vehicle", "battery"]
Counted: TypeAlias = Callable[[int, int], object]

class Vehicle:
    """A vehicle with its driver; its parameters are sound."""

    @property
    def name(self) -> str: ...
    @property
    def parameters(self) -> dict[str, Any]:
        """A copy of the parameters, laid out and named as in a TOML file."""
    def replace(self, changes: Mapping[str, Any]) -> Vehicle:
        """A changed copy; keys are paths such as ``body.mass_kg`` or ``drive.0.gearbox.ratio``."""
    def variants(self, changes: Mapping[str, ArrayLike]) -> list[Vehicle]:
        """A changed copy for each row of the arrays, which are of one length."""
    def to_toml(self) -> str:
        """The text of its file."""

class Battery:
    """A battery with parameters over state of charge and temperature; they are sound."""

    @property
    def name(self) -> str: ...
    @property
    def parameters(self) -> dict[str, Any]:
        """A copy of the parameters, laid out and named as in a TOML file."""
    def replace(self, changes: Mapping[str, Any]) -> Battery:
        """A changed copy; keys are paths such as ``battery.capacity_ah``."""
    def to_toml(self) -> str:
        """The text of its file."""

class Result:
    """A finished replay."""

    @property
    def columns(self) -> dict[str, NDArray[Any]]:
        """The trace, as in trace.csv: ``pandas.DataFrame(result.columns)``."""
    @property
    def summary(self) -> dict[str, Any]:
        """The figures, as in summary.json."""
    @property
    def notes(self) -> list[str]: ...

class Sweep:
    """Many finished replays, in the order of the vehicles."""

    @property
    def columns(self) -> dict[str, NDArray[np.float64]]:
        """The figures of the summaries, a value per vehicle; NaN where there is none."""
    @property
    def errors(self) -> list[str | None]:
        """Why a vehicle could not be run."""
    @property
    def notes(self) -> list[str]: ...
    def __len__(self) -> int: ...

class Identified(NamedTuple):
    found: Any
    notes: list[str]

def cycles() -> list[str]: ...
def vehicles() -> list[str]: ...
def batteries() -> list[str]: ...
def vehicle(source: Path | Mapping[str, Any]) -> Vehicle: ...
def battery(source: Path | Mapping[str, Any]) -> Battery: ...
def simulate(
    drive: Drive,
    vehicle: Vehicle | Path | Mapping[str, Any] = ...,
    dt_s: float = 1e-3,
    *,
    mode: Mode = "vehicle",
    ledger: bool = True,
    progress: Counted | None = None,
) -> Result: ...
def simulate_many(
    drive: Drive,
    vehicles: Iterable[Vehicle | Path | Mapping[str, Any]],
    dt_s: float = 1e-2,
    *,
    mode: Mode = "vehicle",
    ledger: bool = False,
    errors: Literal["raise", "keep"] = "raise",
    progress: Counted | None = None,
) -> Sweep: ...
def estimate_soc(
    time_s: ArrayLike,
    current_a: ArrayLike,
    voltage_v: ArrayLike,
    temperature_c: ArrayLike = 25.0,
    *,
    battery: Battery | Path | Mapping[str, Any],
    initial_soc: float,
    initial_soc_sd: float = 0.01,
    estimator: Literal["ekf", "coulomb"] = "ekf",
    rested: bool = False,
    rate_hz: float = 10.0,
    current_delay_s: float = 0.0,
) -> dict[str, NDArray[Any]]: ...
def identify_battery(
    files: Path | Sequence[Path],
    *,
    name: str = "battery",
    description: str = ...,
    source: str = ...,
    capacity_ah: float | None = None,
    discharge_limit_a: float = ...,
    charge_limit_a: float = ...,
    folds: int = 5,
    seed: int = 1,
    progress: Callable[[str], object] | None = None,
) -> Identified: ...
def identify_vehicle(
    files: Path | Sequence[Path],
    *,
    vehicle: Path = ...,
    name: str = "identified",
    progress: Callable[[str], object] | None = None,
) -> Identified: ...
