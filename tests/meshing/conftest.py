"""Two meshes whose files are read back: a quarter of a crossover, and a piece of weave with end shells."""

import pytest

from fabrics import catalogue
from meshing import crossover, patch


@pytest.fixture(scope="session", params=["quarter", "weave_with_end_shells"])
def mesh(request):
    if request.param == "quarter":
        return crossover.build(catalogue.load("S-720"), size=(3, 2, 1))
    return patch.build(catalogue.load("S-731"), (2, 3), size=(3, 2, 1), end_shells=2e-5)
