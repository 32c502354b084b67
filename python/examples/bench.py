"""Times the package against the command, FASTSim and thevenin, in one run.

    pip install fastsim==3.1.0 thevenin==0.2.1
    python python/examples/bench.py target/release/voltstep [VEHICLES]

Other work on the machine stretches any of the times: of five interleaved runs the fastest counts.
"""

import json
import os
import subprocess
import sys
import tempfile
import time
import warnings

import fastsim
import numpy as np
import thevenin
import voltstep

RUNS = 5
warnings.filterwarnings("ignore")


def timed(work):
    started = time.perf_counter()
    result = work()
    return time.perf_counter() - started, result


def of_command(command):
    with tempfile.TemporaryDirectory() as folder:
        said = subprocess.run([command, "replay", "udds", "--no-ledger", "--json", "--out", folder],
                              check=True, capture_output=True, text=True).stdout
    return json.loads(said)["run_wall_s"]


def of_fastsim():
    drive = fastsim.SimDrive(fastsim.Vehicle.from_resource("2022_Renault_Zoe_ZE50_R135.yaml"),
                             fastsim.Cycle.from_resource("udds.csv"))
    return timed(drive.walk)[0]


def thevenin_hour():
    """A cell at 1 C for half an hour and at rest for another, a value every second."""
    experiment = thevenin.Experiment()
    experiment.add_step("current_C", 1.0, (1800.0, 1.0))
    experiment.add_step("current_A", 0.0, (1800.0, 1.0))
    simulation = thevenin.Simulation()
    return timed(lambda: simulation.run(experiment))[0]


def voltstep_hour(folder):
    """The same hour of a cell's trip file in steps of 10 ms."""
    path = os.path.join(folder, "hour.csv")
    with open(path, "w") as file:
        file.write("Time [s];Velocity [km/h];Elevation [m];Motor Torque [Nm];Battery Voltage [V];"
                   "Battery Current [A];Battery Temperature [°C];SoC [%]\n")
        for second in range(3601):
            drawn_a = 60 if second < 1800 else 0
            file.write(f"{second};{30 + second % 2};0;0;360;{-drawn_a};25;{90 - min(second, 1800) / 36}\n")
    return timed(lambda: voltstep.simulate(path, dt_s=0.01, mode="battery"))[0]


def main(command, count):
    columns = {name: [] for name in ("package", "whole call", "command", "FASTSim", "thevenin", "battery")}
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(RUNS):
            call, result = timed(lambda: voltstep.simulate("udds", ledger=False))
            columns["package"].append(result.summary["run_wall_s"])
            columns["whole call"].append(call)
            columns["command"].append(of_command(command))
            columns["FASTSim"].append(of_fastsim())
            columns["thevenin"].append(thevenin_hour())
            columns["battery"].append(voltstep_hour(folder))
    best = {name: min(values) for name, values in columns.items()}
    ms = {name: f"{1e3 * value:.1f} ms" for name, value in best.items()}
    print(f"UDDS, 1 ms steps, stepping: package {ms['package']}, command {ms['command']}, "
          f"ratio {best['package'] / best['command']:.2f} (target 1.2 at most)")
    print(f"UDDS, 1 ms steps, whole call with arrays: {ms['whole call']}")
    print(f"UDDS, FASTSim {fastsim.__version__ if hasattr(fastsim, '__version__') else ''}"
          f" in steps of 1 s: {ms['FASTSim']}")
    print(f"an hour of a battery: thevenin {thevenin.__version__} {ms['thevenin']}, "
          f"voltstep in steps of 10 ms, with reading its file, {ms['battery']}")
    mass_kg = np.random.default_rng(1).uniform(1200, 1800, count)
    vehicle = voltstep.vehicle("bmw-i3-60ah")
    wall, _ = timed(lambda: voltstep.simulate_many("udds", vehicle.variants({"body.mass_kg": mass_kg}), 0.01))
    print(f"UDDS, 10 ms steps, {count} vehicles on {os.cpu_count()} cores: {wall:.1f} s "
          f"({1e3 * wall / count:.2f} ms each; target 60 s for 10,000 on two)")


main(sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 10_000)
