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
