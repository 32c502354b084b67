import json
import os
import subprocess

import pytest


@pytest.fixture(scope="session")
def replay(tmp_path_factory):
    """What the command says and writes: (summary, folder)."""
    command = os.environ["VOLTSTEP_COMMAND"]

    def run(*arguments):
        folder = tmp_path_factory.mktemp("out")
        said = subprocess.run([command, "replay", *map(str, arguments), "--json", "--out", folder],
                              check=True, capture_output=True, text=True).stdout
        return json.loads(said), folder

    return run


@pytest.fixture(scope="session")
def refusal():
    """The words with which the command refuses."""
    command = os.environ["VOLTSTEP_COMMAND"]

    def run(*arguments):
        done = subprocess.run([command, *map(str, arguments)], capture_output=True, text=True)
        assert done.returncode == 2, done
        return done.stderr.strip().removeprefix("voltstep: ")

    return run


@pytest.fixture(scope="session")
def trip():
    """The synthetic trip, whose true parameters are known."""
    return os.path.join(os.path.dirname(__file__), "../../data/trips/synthetic.csv")
