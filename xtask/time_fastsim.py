"""Times `voltstep replay udds` against FASTSim's walk() over the same cycle, interleaved.

    python -m venv venv && venv/bin/pip install fastsim==3.1.0
    VOLTSTEP_PYTHON=venv/bin/python cargo xtask fastsim

Ours: the BMW i3 in steps of 1 ms without the ledger, 1.369 million steps, the time that the command
says it spent stepping. Theirs: a battery electric car of FASTSim's own in its 1,369 steps of 1 s,
with the history that it keeps by default. The ratio is that of the medians of five runs; the target
is at most 2.2.

Other work on the machine stretches either time. Beside the wall clock stands therefore the time of
the processor: of walk() itself, and of a command that takes twice the steps less that of the one
compared, as both write the same files.
"""

import json
import resource
import statistics
import subprocess
import sys
import tempfile
import time
import warnings

PACKAGE, VERSION = "fastsim", "3.1.0"
VEHICLE = "2022_Renault_Zoe_ZE50_R135.yaml"
CYCLE = "udds.csv"
RUNS = 5
TARGET = 2.2

try:
    from importlib.metadata import version

    import fastsim
except ImportError:
    sys.exit(f"time_fastsim.py: {sys.executable} has no {PACKAGE}: "
             f"`pip install {PACKAGE}=={VERSION}` in a virtual environment, and name its Python "
             "in VOLTSTEP_PYTHON")
if version(PACKAGE) != VERSION:
    sys.exit(f"time_fastsim.py: {PACKAGE} {version(PACKAGE)}, but the comparison is with {VERSION}")


# Later versions call it run().
warnings.filterwarnings("ignore", category=DeprecationWarning)


def theirs():
    """Wall clock and processor time of one walk [s], and its steps."""
    drive = fastsim.SimDrive(fastsim.Vehicle.from_resource(VEHICLE),
                             fastsim.Cycle.from_resource(CYCLE))
    wall, processor = time.perf_counter(), time.process_time()
    drive.walk()
    return time.perf_counter() - wall, time.process_time() - processor


def command(voltstep, folder, *more):
    """What the command says, and its processor time [s]."""
    def spent():
        used = resource.getrusage(resource.RUSAGE_CHILDREN)
        return used.ru_utime + used.ru_stime
    before = spent()
    said = subprocess.run([voltstep, "replay", "udds", "--no-ledger", "--json", "--out", folder, *more],
                          check=True, capture_output=True, text=True).stdout
    return json.loads(said), spent() - before


def ours(voltstep, folder):
    said, processor = command(voltstep, folder)
    _, twice = command(voltstep, folder, "--dt-ms", "0.5")
    return said["run_wall_s"], twice - processor


def main(voltstep):
    with tempfile.TemporaryDirectory() as folder:
        # Either once before it counts: files and code are in memory from then on.
        ours(voltstep, folder), theirs()
        pairs = [(ours(voltstep, folder), theirs()) for _ in range(RUNS)]
    for which, name in enumerate(["wall clock", "processor"]):
        mine = statistics.median(pair[0][which] for pair in pairs)
        other = statistics.median(pair[1][which] for pair in pairs)
        print(f"{name:10}  voltstep {1e3 * mine:7.1f} ms  {PACKAGE} {VERSION} {1e3 * other:7.1f} ms"
              f"  ratio {mine / other:.2f} (target {TARGET} at most)")


main(sys.argv[1])
