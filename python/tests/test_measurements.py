"""Estimators over arrays and identification, as the command does."""

import json
import os
import shutil
import subprocess

import numpy as np
import pandas as pd
import pytest
import voltstep


def command(*arguments):
    return subprocess.run([os.environ["VOLTSTEP_COMMAND"], *map(str, arguments)], check=True,
                          capture_output=True, text=True).stdout


@pytest.fixture(scope="module")
def cell(tmp_path_factory):
    """A rested cell on pulses, as its own model says it is measured."""
    battery = voltstep.battery("panasonic-ncr18650pf")
    time_s = np.arange(0, 3000, 0.5)
    current_a = np.where((time_s // 60) % 2 == 1, 2.0, 0.0)
    discharged_ah = np.concatenate([[0], np.cumsum(
        0.25 * (current_a[1:] + current_a[:-1]))]) / 3600
    table = pd.DataFrame({
        "time_s": time_s, "current_a": current_a,
        "voltage_v": 4.15 - 0.25 * discharged_ah - 0.03 * current_a,
        "discharged_ah": discharged_ah, "cell_temperature_c": 25.0})
    path = tmp_path_factory.mktemp("cell") / "cell.csv"
    table.to_csv(path, index=False)
    return battery, pd.read_csv(path), path


@pytest.mark.parametrize("estimator", ["ekf", "coulomb"])
def test_an_estimator_is_that_of_the_command(cell, estimator):
    battery, table, path = cell
    figures = json.loads(command("soc", path, "--estimator", estimator, "--json"))["runs"][0]
    delay_s = battery.parameters["fit"]["current_delay_s"]
    found = voltstep.estimate_soc(
        table.time_s, table.current_a, table.voltage_v, table.cell_temperature_c, battery=battery,
        initial_soc=1.0, estimator=estimator, rested=True, current_delay_s=delay_s)
    truth = np.interp(found["time_s"], table.time_s, table.discharged_ah)
    truth = 1 - truth / np.float64(np.float32(battery.parameters["battery"]["capacity_ah"]))
    rmse = np.sqrt(np.mean((found["soc"] - truth) ** 2))
    said = figures["figures"] if "figures" in figures else figures
    assert rmse == pytest.approx(said["soc_rmse"], rel=1e-9)
    assert (found["soc_sd"] > 0).all() and found["contradicted"].dtype == bool


def test_a_wrong_start_is_corrected_by_the_voltage(cell):
    battery, table, _ = cell
    columns = (table.time_s, table.current_a, table.voltage_v)
    filtered, counted = (voltstep.estimate_soc(*columns, battery=battery, initial_soc=0.7,
                                               initial_soc_sd=0.3, estimator=estimator)["soc"][-1]
                         for estimator in ("ekf", "coulomb"))
    right = voltstep.estimate_soc(*columns, battery=battery, initial_soc=1.0)["soc"][-1]
    assert abs(filtered - right) < 0.25 * abs(counted - right)


@pytest.mark.parametrize("change, words", [
    ({"initial_soc": 1.5}, "initial_soc must lie in 0..1, found 1.5"),
    ({"rate_hz": 0}, "rate_hz must lie in 0.01..1000, found 0"),
    ({"estimator": "ukf"}, "estimator must be `ekf` or `coulomb`, found `ukf`"),
    ({"time_s": [0, 2, 1]}, "time_s does not rise at sample 2"),
    ({"current_a": [0]}, "current_a has 1 values, time_s has 3; expected the same"),
])
def test_what_an_estimator_refuses(change, words):
    arguments = {"time_s": [0, 1, 2], "current_a": [0, 0, 0], "voltage_v": [4, 4, 4],
                 "battery": "panasonic-ncr18650pf", "initial_soc": 0.9} | change
    with pytest.raises(ValueError) as refused:
        voltstep.estimate_soc(**arguments)
    assert str(refused.value) == words


@pytest.fixture(scope="module")
def trips(tmp_path_factory):
    """Three drives of one car, well over half an hour each."""
    folder = tmp_path_factory.mktemp("trips")
    for number, names in enumerate([["wltc3b"] * 3, ["us06"] * 5, ["hwfet", "udds"] * 2]):
        speed_m_s = np.concatenate([np.interp(
            np.arange(0, column["time_s"][-1]), column["time_s"], column["reference_m_s"])
            for column in (voltstep.simulate(name, ledger=False).columns for name in names)])
        time_s = np.arange(len(speed_m_s), dtype=float)
        trace = pd.DataFrame(voltstep.simulate((time_s, speed_m_s), ledger=False).columns)[::10]
        pd.DataFrame({
            "Time [s]": trace.time_s, "Velocity [km/h]": 3.6 * trace.speed_m_s, "Elevation [m]": 500,
            "Motor Torque [Nm]": trace.motor_torque_nm, "Battery Voltage [V]": trace.battery_voltage_v,
            "Battery Current [A]": -trace.battery_current_a, "Battery Temperature [°C]": 25,
            "SoC [%]": 100 * trace.soc,
        }).to_csv(folder / f"trip{number}.csv", sep=";", index=False)
    return folder


def test_a_vehicle_is_identified_as_by_the_command(trip, tmp_path):
    trips, out = tmp_path / "trips", tmp_path / "identified.toml"
    trips.mkdir()
    for name in "abc":
        shutil.copy(trip, trips / f"{name}.csv")
    command("identify", "vehicle", trips, "--out", out)
    stages = []
    found, notes = voltstep.identify_vehicle(trips, progress=stages.append)
    assert same_but_for_the_command(out.read_text(), found.to_toml())
    assert "reading" in stages and notes


def test_a_battery_is_identified_as_by_the_command(trips, tmp_path):
    out = tmp_path / "battery.toml"
    command("identify", "battery", trips, "--capacity-ah", 60, "--folds", 3, "--out", out)
    found, _ = voltstep.identify_battery([trips], capacity_ah=60, folds=3)
    assert same_but_for_the_command(out.read_text(), found.to_toml())
    assert found.parameters["battery"]["capacity_ah"] == 60


def same_but_for_the_command(theirs, ours):
    """The files are the same in every line that does not say how they came about."""
    kept = [[line for line in text.splitlines() if "voltstep" not in line] for text in (theirs, ours)]
    return kept[0] == kept[1] and len(kept[0]) > 20


def test_what_tells_no_battery(trip, refusal):
    with pytest.raises(ValueError) as refused:
        voltstep.identify_battery(trip, capacity_ah=60)
    assert str(refused.value) == refusal("identify", "battery", trip, "--capacity-ah", 60)
