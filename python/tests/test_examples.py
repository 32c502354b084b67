"""What the book shows runs."""

import os
import subprocess
import sys
from pathlib import Path

import nbformat
import numpy as np
import voltstep
from nbclient import NotebookClient

EXAMPLES = Path(__file__).parents[1] / "examples"


def test_the_notebook_runs_and_is_kept_without_outputs():
    notebook = nbformat.read(EXAMPLES / "first_use.ipynb", as_version=4)
    code = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert code and all(not cell.outputs and cell.execution_count is None for cell in code)
    NotebookClient(notebook, timeout=300, kernel_name="python3").execute()
    assert all(cell.execution_count for cell in code)


def test_a_local_cluster_sweeps_200_vehicles():
    environment = os.environ | {"RAYON_NUM_THREADS": "1"}
    shown = subprocess.run([sys.executable, EXAMPLES / "many_vehicles.py", "200"], check=True,
                           capture_output=True, text=True, env=environment, timeout=300).stdout
    table = dict(line.split(maxsplit=1) for line in shown.splitlines()[1:])
    assert float(table["count"].split()[1]) == 200
    random = np.random.default_rng(1)
    changes = {"body.mass_kg": random.uniform(1200, 1800, 200),
               "body.resistance.physical.drag_coefficient": random.uniform(0.2, 0.35, 200)}
    vehicles = voltstep.vehicle("bmw-i3-60ah").variants(changes)
    here = voltstep.simulate_many("udds", vehicles, 0.01).columns["consumption_wh_per_km"]
    assert abs(float(table["max"].split()[1]) - here.max()) < 1e-5
