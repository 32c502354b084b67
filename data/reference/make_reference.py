"""Regenerates every trace in this folder: Modelica models, compiled and simulated by rumoca.

    python -m venv venv && venv/bin/pip install -r requirements.txt
    venv/bin/python make_reference.py          # some minutes, nearly all of them for UDDS

The tool finds the instants at which a model's mode ends (rolling, standing; controller free, at a
limit); this script chooses the next mode from the equations and restarts there, as it does at
every kink of an input. A stretch of UDDS is computed a second time with SciPy's Radau from
equations written by hand; the script fails where the two differ.
"""

import csv
import math
import sys
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np
import rumoca
from scipy.integrate import solve_ivp

HERE = Path(__file__).resolve().parent
G = 9.80665


class Simulator:
    """One model with its current state; advances piece by piece."""

    def __init__(self, file, model, rtol, solver, start):
        self.model = rumoca.Session().load(str(HERE / file), model=model)
        self.rtol, self.solver, self.retries = rtol, solver, 0
        self.state = dict(start)

    def advance(self, duration, dt, **params):
        """Until the mode ends or `duration` is over; the result and the time that it took."""
        for factor in (1.0, 0.5, 2.0, 0.2, 5.0, 0.1, 10.0, 30.0):
            config = rumoca.SimConfig(solver=self.solver, rtol=factor * self.rtol,
                                      atol=factor * self.rtol, max_wall_seconds=60)
            try:
                r = self.model.simulate(t=(0.0, duration), dt=dt, config=config, params=params,
                                        start=self.state)
                break
            except rumoca.SimulationError as e:  # its own check on interpolation, now and then
                self.retries += 1
                if "disagreement" not in str(e) or factor == 30.0:
                    raise
        self.state = {name: float(r[name][-1]) for name in self.state}
        return r, float(r.time[-1]) if r.termination else duration


def write(name, header, rows):
    with open(HERE / f"{name}.csv", "w", newline="") as f:
        out = csv.writer(f, lineterminator="\n")
        out.writerow(header)
        for row in rows:
            out.writerow([f"{x:.10g}" for x in row])
    print(f"{name}: {len(rows)} rows", flush=True)


def dc_motor():
    for name, L, J in (("pasek", 0.438, 0.0036), ("moments", 0.803, 0.0031)):
        for suffix, Tc in (("", 0.0), ("_static", 0.128)):
            R, K, b = 30.9, 1.323, 0.0005
            w = (60.0 - R * Tc / K) / (K + R * b / K)  # steady state at 60 V
            sim = Simulator("dc_motor.mo", "DcMotor", 1e-12, "rk-like",
                            {"i": (b * w + Tc) / K, "w": w})
            rows = [(-0.02, 60.0, sim.state["i"], w)]
            for n in range(-19, 301):
                volts = 60.0 if n <= 0 else 248.0
                sim.advance(1e-3, 1e-3, R=R, L=L, K=K, J=J, b=b, Tc=Tc, V=volts)
                assert sim.state["w"] > 0.0
                rows.append((n * 1e-3, volts, sim.state["i"], sim.state["w"]))
            write(f"motor_{name}{suffix}",
                  ("time_s", "voltage_v", "current_a", "speed_rad_s"), rows)


def battery():
    pulses = ((10, 0.0), (60, 60.0), (60, 0.0), (30, -40.0), (60, 0.0), (180, 20.0))
    for name, Rp, C in (("table", 1.7834e-4, 9532.9), ("slow", 0.02, 1500.0)):
        sim = Simulator("battery.mo", "Battery", 1e-12, "rk-like", {"soc": 0.869, "vrc": 0.0})
        rows = [(0, 0.0, 0.869, 0.0, 343.22 + (399.8 - 343.22) * 0.869)]
        for seconds, amps in pulses:
            for _ in range(seconds):
                r, _t = sim.advance(1.0, 1.0, Rp=Rp, C=C, I=amps)
                rows.append((len(rows), amps, sim.state["soc"], sim.state["vrc"], r["V"][-1]))
        write(f"battery_{name}", ("time_s", "current_a", "soc", "rc_v", "terminal_v"), rows)


def pid():
    omega = 2.0 * math.pi * 0.5
    step = [(1.0, 0.5, 0.0), (3.0, 1.8, 0.0), (4.0, -0.5, 0.0)]
    for name, D, pieces in (("step", 0.0, step), ("sine", 0.05, [(8.0, 0.0, 1.6)])):
        sim = Simulator("pid.mo", "PidLag", 1e-11, "rk-like", {"z": 0.0, "u": 0.0, "y": 0.0})
        rows, begin, switches = [(0.0, pieces[0][1], 0.0, 0.0)], 0.0, 0
        for duration, r0, r1 in pieces:
            def reference(t):
                return r0 + r1 * math.sin(omega * t)

            def mode_now(t):
                s = sim.state
                raw = 4.0 * (reference(t) - s["y"]) + 6.0 * s["z"] + D * (
                    r1 * omega * math.cos(omega * t) - (2.0 * s["u"] - s["y"]) / 0.5)
                return raw, (1.0 if raw >= 1.0 else -1.0 if raw <= -1.0 else 0.0)

            mode = mode_now(begin)[1]
            for n in range(round(duration / 0.02)):
                t, end = begin + n * 0.02, begin + (n + 1) * 0.02
                while end - t > 1e-12:
                    left = round(end - t, 12)
                    _, took = sim.advance(left, left, D=D, r0=r0, r1=r1, omega=omega,
                                          t0=t, mode=mode)
                    t += took
                    if end - t > 1e-12:  # the mode ended: leave it across the limit
                        raw = mode_now(t)[0]
                        mode = 0.0 if mode else math.copysign(1.0, raw)
                        switches += 1
                        assert switches < 40, "the controller chatters"
                rows.append((end, reference(end), sim.state["u"], sim.state["y"]))
            begin += duration
        print(f"pid_{name}: {switches} changes of mode")
        write(f"pid_{name}", ("time_s", "reference", "output", "measurement"), rows)


def standing_or_rolling(force, friction):
    return 0.0 if abs(force) <= friction else math.copysign(1.0, force)


def body():
    for name, v0, sina, seconds in (("flat", 30.0, 0.0, 240), ("uphill", 25.0, 0.02, 240),
                                    ("downhill", 15.0, -0.005, 320)):
        sim = Simulator("body.mo", "Body", 1e-12, "rk-like", {"v": v0, "x": 0.0})
        rows, mode = [(0.0, v0, 0.0)], 1.0
        for n in range(seconds):
            left = 1.0
            while left > 1e-12:
                _, took = sim.advance(left, left, sina=sina, mode=mode)
                left -= took
                if left > 1e-12:
                    sim.state["v"] = 0.0
                    friction = 0.009 * 1500.0 * G * math.sqrt(1.0 - sina**2)
                    mode = standing_or_rolling(-1500.0 * G * sina, friction)
            rows.append((n + 1, sim.state["v"], sim.state["x"]))
        write(f"body_{name}", ("time_s", "speed_m_s", "distance_m"), rows)


def bench():
    header = ("time_s", "duty", "motor_a", "speed_rad_s", "supply_a", "energy_j")
    start = {"i": 0.0, "w": 0.0, "z": 0.0, "u": 0.0, "E": 0.0}
    sim = Simulator("bench.mo", "Bench", 1e-11, "rk-like", start)
    rows, duty = [(0.0,) * 6], 0.0
    for seconds, end in ((4, 0.6), (2, 0.6), (1, -0.2), (3, -0.2), (2, 0.0)):
        slope = (end - duty) / seconds
        for n in range(seconds * 20):
            sim.advance(0.05, 0.05, d0=duty + slope * n * 0.05, d1=slope)
            s, d = sim.state, duty + slope * (n + 1) * 0.05
            rows.append((len(rows) * 0.05, d, s["i"], s["w"], d * s["i"], s["E"]))
        duty = end
    write("bench_open", header, rows)
    sim = Simulator("bench.mo", "Bench", 1e-11, "rk-like", start)
    r, _ = sim.advance(20.0, 0.05, closed=1.0)
    rows = zip(r.time, r["u"], r["i"], r["w"], r["u"] * r["i"], r["E"])
    write("bench_closed", header, list(rows))


STATES = ("v", "x", "z", "D", "soc", "vrc", "i", "E")


def udds(name, K):
    cycle = np.loadtxt(HERE.parent / "cycles" / "udds.csv", delimiter=",", skiprows=1)[:, 1]
    start = dict.fromkeys(STATES, 0.0) | {"soc": 0.8}
    sim = Simulator("udds.mo", "Udds", 1e-10, "bdf", start)
    friction, mode, modes = 0.009 * 1500.0 * G, 0.0, 0
    rows = [(0.0, 0.0, 0.0, 0.8, 0.0, 0.0)]
    low, high, saved = [0.0, 0.0], [0.0, 0.0], []
    error = 0.0
    for n in range(len(cycle) - 1):
        r0, r1, t = cycle[n], cycle[n + 1] - cycle[n], 0.0
        saved.append((mode, dict(sim.state)))
        if n % 100 == 0:
            print(f"{name}: {n} s, {sim.retries} tried again", flush=True)
        while 1.0 - t > 1e-9:
            r, took = sim.advance(1.0 - t, 2.5e-4, K=K, r0=r0 + r1 * t, r1=r1, mode=mode)
            seen = (K * r["i"], r["D"] * r["i"])
            low = [min(a, float(x.min())) for a, x in zip(low, seen)]
            high = [max(a, float(x.max())) for a, x in zip(high, seen)]
            error = max(error, float(np.abs(r0 + r1 * (t + r.time) - r["v"]).max()))
            t += took
            if 1.0 - t > 1e-9:
                force = K * sim.state["i"] / 0.25
                mode = (math.copysign(1.0, force) if mode == 0.0
                        else standing_or_rolling(force, friction))
                sim.state["v"] = 0.0
                modes += 1
        s = sim.state
        rows.append((n + 1, s["v"], s["x"], s["soc"], s["i"], s["D"] * s["i"]))
    write(name, ("time_s", "speed_m_s", "distance_m", "soc", "motor_a", "battery_a"), rows)
    print(f"{name}: {modes} changes of mode, {sim.retries} pieces tried again, "
          f"largest speed error {error:.5f} m/s")
    check_by_hand(cycle, K, saved)
    return (name, s["soc"], s["E"] / 3.6e6, low[0], high[0], low[1], high[1])


def check_by_hand(cycle, K, saved):
    """A few seconds of UDDS again, by another method from equations written by hand."""
    def slope_of(t, y, r0, r1):
        v, _, z, D, soc, vrc, i, _ = y
        e, Ib, Voc = r0 + r1 * t - v, D * i, 500.0 + 100.0 * soc
        road = K * i / 0.25 - 4.21e-6 * v / 0.0625 - 0.5 * 1.2 * 0.29 * 2.2 * v * abs(v)
        return [(road - 0.009 * 1500.0 * G) / (1500.0 + 3.87e-7 / 0.0625), v, e,
                1e6 * (20.0 * e + 0.1 * z - D), -Ib / 108000.0, (Ib - vrc / 1e-3) / 1e-6,
                (D * (Voc - vrc - 0.06 * Ib) - 0.025 * i - K * v / 0.25) / 1e-3, Voc * Ib]

    for n in (100, 196, 420):
        (mode, a), (_, b) = saved[n], saved[n + 1]
        assert mode == 1.0
        r = solve_ivp(slope_of, (0.0, 1.0), [a[k] for k in STATES], "Radau", rtol=1e-9,
                      atol=1e-9, args=(cycle[n], cycle[n + 1] - cycle[n]))
        ours = dict(zip(STATES, r.y[:, -1]))
        worst = {k: abs(ours[k] - b[k]) for k in ("v", "soc", "i", "E")}
        print(f"K {K}, second {n}, rumoca against Radau: {worst}", flush=True)
        assert worst["v"] < 1e-8 and worst["soc"] < 1e-11 and worst["i"] < 1e-3, worst


def main():
    with ProcessPoolExecutor() as pool:
        runs = [pool.submit(udds, "udds", 1.4), pool.submit(udds, "udds_table", 0.65)]
        others = [pool.submit(f) for f in (dc_motor, battery, pid, body, bench)]
        for job in others:
            job.result()
        with open(HERE / "udds_end_values.csv", "w", newline="") as f:
            out = csv.writer(f, lineterminator="\n")
            out.writerow(("trace", "soc", "energy_kwh", "torque_min_nm", "torque_max_nm",
                          "battery_min_a", "battery_max_a"))
            for run in runs:
                name, *values = run.result()
                out.writerow([name, *(f"{x:.10g}" for x in values)])


if __name__ == "__main__":
    sys.exit(main())
