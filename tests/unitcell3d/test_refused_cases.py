"""What models and cases of the crossover refuse: one line. What the command line says of it: tests/refusals."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from fabrics import catalogue
from fabrics.errors import InputError
from fabrics.record import Record
from fabrics.surface import ResponseSurface
from meshing import crossover as mesher
from unitcell3d.cases import biaxial_and_platens, periodic_cell, pull_out, single_yarn, stack
from unitcell3d.identify import interpolant, shear_fit
from unitcell3d.identify.calibrate import calibrate
from unitcell3d.identify.response_surface import sample
from unitcell3d.model.crossover import CrossoverModel, Numerics
from unitcell3d.model.pull_out import PullOutModel

S720 = catalogue.load("S-720")
TINY, WHOLE = (mesher.build(S720, size=(3, 2, 2), domain=domain) for domain in ("quarter", "whole"))
GAMMA = np.linspace(0, 0.9, 30)
SMALL = {"d1": (0.0, 12e-6), "d2": (0.0, 12e-6), "points": (5, 5), "size": (4, 3, 2)}


def surface(n1, n2):
    axes = (np.arange(n) * 1e-6 for n in (n1, n2))
    return ResponseSurface(*axes, *(np.zeros((n1, n2)) for _ in interpolant.QUANTITIES))


biaxial, plates = biaxial_and_platens.biaxial, biaxial_and_platens.plate_compression
REFUSED = [
    (partial(CrossoverModel, TINY, replace(S720, solid_laws=None)), "solid"),
    (partial(CrossoverModel, TINY, replace(S720, name="S-999")), "S-999"),
    (partial(Numerics, penalty=-1.0), "penalty"),
    (partial(Numerics, toe=0.0), "toe"),
    (partial(Numerics, friction=-0.1), "friction"),
    (partial(biaxial, TINY, S720, (0, -1)), "ratio"),
    (partial(biaxial, TINY, S720, "both"), "ratio"),
    (partial(biaxial, TINY, S720, (1, 1), max_displacement=-1.0), "max_displacement"),
    (partial(plates, TINY, S720, pressure=0.0), "pressure"),
    (partial(Record.read, "none.h5"), "none.h5"),
    (partial(single_yarn.pull, TINY, S720, family=2), "yarn = 2: must be 0"),
    (
        partial(single_yarn.pull, TINY, S720, bars=22),
        "bars = 22: must be 0 to 3, or 3 and an even number more, up to the mesh's 9",
    ),
    (partial(single_yarn.pull, TINY, S720, strain=-0.1), "strain = -0.1: must be positive"),
    (
        partial(stack.stack_compression, TINY, S720, plies=0),
        "plies = 0: must be a whole number from 1",
    ),
    (
        partial(stack.stack_compression, TINY, S720, pressure=-1.0),
        "pressure = -1.0: must be positive",
    ),
    (
        partial(stack.stack_compression, TINY, S720, min_plate_gap=2.0),
        "min_plate_gap = 2.0: must be between 0 and 1",
    ),
    (
        partial(periodic_cell.shear, WHOLE, S720, 2.0),
        "gamma = 2.0: must be above 0 and at most 1.2 rad",
    ),
    (partial(periodic_cell.shear, TINY, S720, 0.2), "whole crossover or a patch of 2 x 2"),
    (partial(shear_fit.fit, GAMMA, 1e6 * GAMMA), "does not stiffen"),
    (partial(shear_fit.fit, GAMMA[:3], GAMMA[:3]), "shear angles = 3"),
    *(
        (partial(pull_out.pull_out, WHOLE, S720, loads), "displacements")
        for loads in ((), (0.0,), (-1e-6,), (np.inf,))
    ),
    (partial(pull_out.pull_out, WHOLE, S720, pressures=(-1e6,)), "at least one positive pressure"),
    (
        partial(pull_out.pull_out, WHOLE, S720, (1e-6,), pressures=(1e6,)),
        "left out where displacements",
    ),
    (partial(pull_out.pull_out, WHOLE, S720, (1e-6,), pull=0.0), "pull"),
    (partial(PullOutModel, TINY, S720), "whole"),
    (partial(calibrate, S720, size="huge"), "size"),
    (partial(calibrate, S720, paths={}), "paths"),
    (partial(calibrate, S720, jobs=0), "jobs"),
    (partial(calibrate, S720, friction=-0.1), "friction"),
    (partial(sample, S720, **SMALL | {"d1": (1e-6, 1e-6)}), "d1"),
    (partial(sample, S720, **SMALL | {"points": (3, 5)}), "points"),
    (partial(sample, S720, **SMALL | {"points": (5, 500)}), "points"),
    (partial(sample, S720, **SMALL | {"tolerance": 0.0}), "tolerance"),
    (partial(sample, S720, **SMALL | {"jobs": 0}), "jobs"),
    (partial(sample, S720, **SMALL | {"friction": 0.3, "tolerance": 1e-2}), "friction"),
    (partial(interpolant.Interpolant(surface(5, 5)), "T1", 1e-6, 1.0), "d2"),
    (partial(interpolant.errors, surface(4, 5)), "d1"),
]


@pytest.mark.parametrize(("make", "line"), REFUSED, ids=range(len(REFUSED)))
def test_one_line_says_what_is_wrong(make, line):
    with pytest.raises(InputError, match=line) as caught:
        make()
    assert "\n" not in str(caught.value)
    assert caught.value.exit_code == 2
