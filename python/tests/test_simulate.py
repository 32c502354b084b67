"""The same bits as the command, and arrays that own them."""

import csv
import pickle
import signal
import threading
import time

import numpy as np
import pandas as pd
import pytest
import voltstep

TIMED = ("run_wall_s", "realtime_factor")


def same_summary(ours, theirs):
    for timed in TIMED:
        ours, theirs = dict(ours), dict(theirs)
        ours.pop(timed), theirs.pop(timed)
    assert ours == theirs


def same_trace(columns, path):
    """The command writes single precision as short as it reads back the same."""
    with open(path) as file:
        rows = list(csv.reader(file))
    assert list(columns) == rows[0]
    for name, written in zip(rows[0], zip(*rows[1:])):
        theirs = np.array([np.float32(text) if text else np.float32("nan") for text in written])
        np.testing.assert_array_equal(columns[name].astype(np.float32), theirs, err_msg=name)


@pytest.mark.parametrize("arguments, options", [
    (["udds"], {}),
    (["udds", "--vehicle", "bmw-i3-60ah-thermal"], {"vehicle": "bmw-i3-60ah-thermal"}),
    (["us06", "--vehicle", "two-axles", "--no-ledger"], {"vehicle": "two-axles", "ledger": False}),
    (["nedc", "--dt-ms", "10"], {"dt_s": 0.01}),
])
def test_a_cycle_has_the_bits_of_the_command(replay, arguments, options):
    summary, folder = replay(*arguments)
    result = voltstep.simulate(arguments[0], **options)
    same_summary(result.summary, summary)
    assert result.notes == summary["notes"]
    same_trace(result.columns, folder / "trace.csv")


@pytest.mark.parametrize("mode", ["vehicle", "battery"])
def test_a_trip_has_the_bits_of_the_command(replay, trip, mode):
    summary, folder = replay(trip, "--mode", mode)
    result = voltstep.simulate(trip, mode=mode)
    same_summary(result.summary, summary)
    same_trace(result.columns, folder / "trace.csv")


def test_columns_are_arrays_that_own_what_rust_made():
    columns = voltstep.simulate("nedc", dt_s=0.001, ledger=False).columns
    frame = pd.DataFrame(columns)
    assert len(frame) == len(columns["soc"]) > 1000
    for name, column in columns.items():
        assert column.dtype == (np.float64 if name == "time_s" else np.float32), name
        assert type(column.base).__name__ == "PySliceContainer", "copied"


def test_arrays_are_as_their_file(tmp_path):
    time_s, speed_m_s, grade = [0.0, 10, 60], [0.0, 12.5, 0], [0, 0.02, 0]
    path = tmp_path / "arrays.csv"
    pd.DataFrame({"time_s": time_s, "speed_m_s": speed_m_s, "grade": grade}).to_csv(path, index=False)
    of_file = voltstep.simulate(path)
    of_arrays = voltstep.simulate((np.array(time_s), speed_m_s, pd.Series(grade)))
    same_summary(of_arrays.summary, of_file.summary)
    assert of_arrays.summary["battery_energy_kwh"] > voltstep.simulate(
        (time_s, speed_m_s)).summary["battery_energy_kwh"]


@pytest.mark.parametrize("arrays, words", [
    (([0, 1, 2], [0, 1]), "speed_m_s has 2 values, time_s has 3; expected the same"),
    (([0, 1], [0, 200]), "arrays: in sample 1 speed_m_s of 200 m/s; expected -150 to 150 m/s"),
    (([0, 1], [0, float("nan")]), "arrays: in sample 1 `NaN` for speed_m_s; expected a number"),
    (([0], [0]), "arrays: 1 samples; expected two at least"),
])
def test_arrays_that_are_no_cycle(arrays, words):
    with pytest.raises(ValueError) as refused:
        voltstep.simulate(arrays)
    assert str(refused.value) == words


def test_refuses_in_the_words_of_the_command(refusal, tmp_path):
    path = tmp_path / "bad.toml"
    path.write_text(voltstep.vehicle("bmw-i3-60ah").to_toml().replace("mass_kg = 1486.5", "mass_kg = -1"))
    for arguments, call in [
        (["replay", "udss"], lambda: voltstep.simulate("udss")),
        (["replay", "udds", "--vehicle", path], lambda: voltstep.vehicle(path)),
        (["replay", "udds", "--vehicle", "bmw"], lambda: voltstep.simulate("udds", "bmw")),
        (["replay", "udds", "--dt-ms", "1000"], lambda: voltstep.simulate("udds", dt_s=1.0)),
    ]:
        with pytest.raises(ValueError) as refused:
            call()
        assert str(refused.value) == refusal(*arguments)
    with pytest.raises(ValueError, match="dt_s must lie in 1e-7..1, not NaN"):
        voltstep.simulate("udds", dt_s=float("nan"))
    assert str(path) + ":" in refusal("replay", "udds", "--vehicle", path)


def test_many_are_as_one_at_a_time():
    base = voltstep.vehicle("bmw-i3-60ah")
    mass_kg = np.linspace(1200, 1800, 5)
    vehicles = base.variants({"body.mass_kg": mass_kg})
    told = []
    sweep = voltstep.simulate_many("nedc", vehicles, progress=lambda *at: told.append(at))
    assert sorted(told) == [(n, 5) for n in range(1, 6)] and len(sweep) == 5
    assert sweep.errors == [None] * 5
    for i, vehicle in enumerate(vehicles):
        one = voltstep.simulate("nedc", vehicle, 0.01, ledger=False).summary
        for name, column in sweep.columns.items():
            assert column[i] == one[name], name
    assert (np.diff(sweep.columns["consumption_wh_per_km"]) > 0).all()
    assert not any("run_wall_s" in name for name in sweep.columns)


def test_what_cannot_run_is_named_or_kept():
    base = voltstep.vehicle("bmw-i3-60ah")
    vehicles = [base, base.replace(
        {"gearbox.ratio": 1e12, "motor.inertia_kg_m2": 1e12, "wheel.radius_m": 1e-12})]
    kept = voltstep.simulate_many("udds", vehicles, errors="keep")
    assert kept.errors[0] is None and kept.errors[1].startswith("the plant refused its input")
    assert np.isnan(kept.columns["soc_final"]).tolist() == [False, True]
    with pytest.raises(ValueError, match="^vehicle 1: the plant refused"):
        voltstep.simulate_many("udds", vehicles)


def test_the_lock_is_free_meanwhile():
    seen, stop = [], threading.Event()

    def count():
        while not stop.is_set():
            seen.append(None)
            time.sleep(0.001)

    counter = threading.Thread(target=count)
    counter.start()
    before = len(seen)
    voltstep.simulate("wltc3b", dt_s=2e-4)
    counted = len(seen) - before
    stop.set()
    counter.join()
    assert counted > 20


@pytest.mark.parametrize("call", [
    lambda: voltstep.simulate(([0, 5e5], [0, 10])),
    lambda: voltstep.simulate_many("udds", ["bmw-i3-60ah"] * 2000, 0.001),
])
def test_ctrl_c_ends_it(call):
    timer = threading.Timer(0.5, signal.raise_signal, [signal.SIGINT])
    timer.start()
    started = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        call()
    timer.join()
    assert time.monotonic() - started < 10


def test_an_error_of_the_callback_ends_it():
    def refuse(done, total):
        raise KeyError(total)

    with pytest.raises(KeyError):
        voltstep.simulate("udds", progress=refuse)


def test_vehicles_are_dicts_and_travel():
    base = voltstep.vehicle("bmw-i3-60ah")
    parameters = base.parameters
    assert voltstep.vehicle(parameters) == base == pickle.loads(pickle.dumps(base))
    parameters["body"]["mass_kg"] = np.float32(1300)
    lighter = voltstep.vehicle(parameters)
    assert lighter == base.replace({"body.mass_kg": 1300}) != base
    assert base.parameters["body"]["mass_kg"] == 1486.5
    for changes, words in [
        ({"body.mas_kg": 1}, "unknown key `mas_kg`"),
        ({"body.mass_kg": -1}, "mass_kg"),
        ({"name.x": 1}, "`name` is no table"),
    ]:
        with pytest.raises(ValueError, match=words):
            base.replace(changes)
    with pytest.raises(ValueError, match="variant 1: .*mass_kg"):
        base.variants({"body.mass_kg": [1300, -1]})


def test_every_name_is_there():
    assert "udds" in voltstep.cycles()
    for name in voltstep.vehicles():
        assert voltstep.vehicle(name).name == name
    for name in voltstep.batteries():
        assert voltstep.battery(name).name == name
