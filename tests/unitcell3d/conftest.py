"""The meshes of S-720 that most tests share, and its calibration on a small one, made once for all processes.

pytest loads this file in the process that starts the others too. There dolfinx is not imported: it would set up MPI,
whose variables of the environment (OMPI_*, PMIX_*) they would inherit, and `mpiexec` ends at once where it finds them.
"""

from functools import partial
from importlib.util import find_spec
from types import SimpleNamespace

import pytest

from fabrics import catalogue

SIZE = (4, 3, 2)  # the smallest with a middle row

if find_spec("dolfinx") is None:
    collect_ignore_glob = ["*.py", "*/*.py"]


@pytest.fixture(scope="session")
def s720():
    return catalogue.load("S-720")


@pytest.fixture(scope="session")
def meshed(s720):
    """A function that meshes S-720."""
    from meshing import crossover

    return partial(crossover.build, s720)


@pytest.fixture(scope="session")
def coarse(meshed):
    return meshed(size="coarse")


@pytest.fixture(scope="session")
def few(meshed):
    """A whole crossover of few elements: for tests of equations, where the next finer mesh differs by a tenth."""
    return meshed(domain="whole", size=(3, 2, 2))


@pytest.fixture(scope="session")
def tiny(meshed):
    """The smallest mesh with a middle row: for tests of equations, not of answers."""
    return meshed(size=SIZE)


@pytest.fixture(scope="session")
def whole(meshed):
    """A whole crossover of elements as those of `tiny`."""
    return meshed(domain="whole", size=SIZE)


@pytest.fixture(scope="session")
def calibrated(s720, shared):
    """Calibration of S-720 on the mesh of `tiny`: found, folder, and what was told of its progress.

    The first process solves the paths, and all take them from their files.
    """
    from unitcell3d.identify.calibrate import calibrate

    folder = shared("calibration", lambda folder: calibrate(s720, size=SIZE, out=folder))
    progress = {}

    def watch(fabric, path, share):
        progress[path] = share

    found = calibrate(s720, size=SIZE, out=folder, resume=True, on_progress=watch)
    return SimpleNamespace(found=found, folder=folder, progress=progress)
