"""What models and cases of the crossover refuse: one line. What the command line says of it: tests/refusals."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from fabrics import catalogue
from fabrics.base.errors import InputError
from fabrics.base.record import Record
from fabrics.surface import ResponseSurface
from meshing import crossover as mesher
from unitcell3d.cases import biaxial_and_platens, periodic_cell, pull_out, single_yarn, stack
from unitcell3d.identify import interpolant, shear_fit
from unitcell3d.identify.calibrate import calibrate
from unitcell3d.model.crossover import CrossoverModel, Numerics
from unitcell3d.model.pull_out import PullOutModel

S720 = catalogue.load("S-720")
TINY, WHOLE = (mesher.build(S720, size=(3, 2, 2), domain=domain) for domain in ("quarter", "whole"))
GAMMA = np.linspace(0, 0.9, 30)


def surface(n1, n2):
    axes = (np.arange(n) * 1e-6 for n in (n1, n2))
    return ResponseSurface(*axes, *(np.zeros((n1, n2)) for _ in interpolant.QUANTITIES))


biaxial = biaxial_and_platens.biaxial
REFUSED = [
    (partial(CrossoverModel, TINY, replace(S720, solid_laws=None)), "solid"),
    (partial(CrossoverModel, TINY, replace(S720, name="S-999")), "S-999"),
    (partial(Numerics, penalty=-1.0), "penalty"),
    (partial(Numerics, toe=0.0), "toe"),
    (partial(biaxial, TINY, S720, (0, -1)), "ratio"),
    (partial(biaxial, TINY, S720, "both"), "ratio"),
    (partial(biaxial, TINY, S720, max_displacement=-1.0), "max_displacement"),
    (partial(Record.read, "none.h5"), "none.h5"),
    (partial(single_yarn.pull, TINY, S720, family=2), "yarn = 2: must be 0"),
    (partial(single_yarn.pull, TINY, S720, strain=-0.1), "strain = -0.1: must be positive"),
    (partial(stack.stack_compression, TINY, S720, min_plate_gap=2.0), "min_plate_gap = 2.0"),
    (
        partial(periodic_cell.shear, TINY, S720, 0.2),
        "whole crossover or a patch of the weave's repeat",
    ),
    (partial(shear_fit.fit, GAMMA, 1e6 * GAMMA), "does not stiffen"),
    (partial(shear_fit.fit, GAMMA[:3], GAMMA[:3]), "shear angles = 3"),
    (partial(pull_out.pull_out, WHOLE, S720), "displacements"),
    (partial(pull_out.pull_out, WHOLE, S720, (np.inf,)), "displacements"),
    (partial(pull_out.pull_out, WHOLE, S720, (1e-6,), pull=0.0), "pull"),
    (partial(PullOutModel, TINY, S720), "whole"),
    (partial(calibrate, S720, size="coarse", paths={}), "paths"),
    (partial(calibrate, S720, size="coarse", jobs=0), "jobs"),
    (partial(interpolant.Interpolant(surface(5, 5)), "T1", 1e-6, 1.0), "d2"),
    (partial(interpolant.errors, surface(4, 5)), "d1"),
]


@pytest.mark.parametrize("make, line", REFUSED, ids=[line for _, line in REFUSED])
def test_one_line_says_what_is_wrong(make, line):
    with pytest.raises(InputError, match=f"^.*{line}.*$"):
        make()
