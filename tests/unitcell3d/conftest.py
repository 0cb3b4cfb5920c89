"""The meshes of S-720 that most tests share, and its calibration on the coarse one, made once for all processes."""

import fcntl
import os
from types import SimpleNamespace

import pytest

pytest.importorskip("dolfinx")

from fabrics import catalogue
from meshing import crossover as mesher
from unitcell3d.identify.calibrate import calibrate


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


@pytest.fixture(scope="session")
def whole(s720):
    """A whole crossover of elements as those of `tiny`."""
    return mesher.build(s720, domain="whole", size=(4, 3, 2))


@pytest.fixture(scope="session")
def calibrated(s720, tmp_path_factory):
    """Calibration of S-720 on the coarse mesh: found, folder, and what was told of its progress.

    The folder is that of the run of the tests: where several processes share it, the first one solves the paths, and
    the others, which wait for it, take them from their files.
    """
    base = tmp_path_factory.getbasetemp()
    shared = base.parent if "PYTEST_XDIST_WORKER" in os.environ else base
    folder, progress = shared / "calibration-of-S-720", {}
    with open(shared / "calibration.lock", "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        found = calibrate(
            s720,
            size="coarse",
            out=folder,
            resume=True,
            on_progress=lambda fabric, path, share: progress.update({path: share}),
        )
    return SimpleNamespace(found=found, folder=folder, progress=progress)
