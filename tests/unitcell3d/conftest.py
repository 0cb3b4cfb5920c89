import os
import subprocess
import sys

import pytest

pytest.importorskip("dolfinx")

from fabrics import catalogue
from meshing import crossover as mesher


@pytest.fixture(scope="session")
def s720():
    return catalogue.load("S-720")


@pytest.fixture(scope="session")
def coarse(s720):
    return mesher.build(s720, size="coarse")


@pytest.fixture(scope="session")
def tiny(s720):
    """The smallest mesh with a middle row: for tests of equations, not of answers."""
    return mesher.build(s720, size=(4, 3, 2))


@pytest.fixture
def two_processes():
    """Run a program under mpirun on two ranks, each of which writes a line "forces 2 ..." of hexadecimal numbers.

    Returns run(program) -> the numbers, which are the same on both ranks.
    """

    def run(program):
        launch = ["mpirun", "--allow-run-as-root", "--oversubscribe", "-n", "2", sys.executable, "-c", program]
        # this process may be an MPI process already, whose children are not to take its place
        alone = {key: value for key, value in os.environ.items() if not key.startswith(("OMPI", "PMIX"))}
        try:
            done = subprocess.run(launch, capture_output=True, text=True, timeout=300, env=alone)
        except FileNotFoundError:
            pytest.skip("no mpirun")
        assert done.returncode == 0, done.stderr
        lines = [line.split()[1:] for line in done.stdout.splitlines() if line.startswith("forces")]
        assert len(lines) == 2
        assert lines[0] == lines[1]
        assert lines[0][0] == "2"
        return [float.fromhex(word) for word in lines[0][1:]]

    return run
