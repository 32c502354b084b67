"""Mass and drag of 10,000 vehicles on the UDDS, spread over a Dask cluster.

    python many_vehicles.py [VEHICLES [SCHEDULER]]

Without a scheduler's address the cluster is local: a process per core, with one thread. Each task
takes a block of vehicles; what travels are two arrays there and one data frame back.
"""

import sys

import numpy as np
import pandas as pd
import voltstep
from dask.distributed import Client, LocalCluster

BLOCK = 50


def block(changes):
    vehicles = voltstep.vehicle("bmw-i3-60ah").variants(changes)
    return pd.DataFrame(changes | voltstep.simulate_many("udds", vehicles, 0.01).columns)


def sweep(client, count):
    random = np.random.default_rng(1)
    mass_kg = random.uniform(1200, 1800, count)
    drag = random.uniform(0.2, 0.35, count)
    tasks = [client.submit(block, {"body.mass_kg": mass_kg[i:i + BLOCK],
                                   "body.resistance.physical.drag_coefficient": drag[i:i + BLOCK]})
             for i in range(0, count, BLOCK)]
    return pd.concat(client.gather(tasks), ignore_index=True)


if __name__ == "__main__":
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 10_000
    address = sys.argv[2] if len(sys.argv) > 2 else LocalCluster(
        threads_per_worker=1, dashboard_address=None)
    with Client(address) as client:
        frame = sweep(client, count)
    print(frame[["body.mass_kg", "consumption_wh_per_km"]].describe().to_string())
