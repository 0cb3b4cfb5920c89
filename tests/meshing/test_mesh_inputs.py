"""What is refused of a mesh that no command asks for. What the command line refuses: tests/refusals/meshes.toml."""

from dataclasses import replace
from functools import partial

import pytest

from fabrics import catalogue
from fabrics.base.errors import InputError
from meshing import crossover, patch
from meshing.conforming import conform
from meshing.section import Section

S720 = catalogue.load("S-720")
NEGATIVE = S720.micrograph | {"weft": S720.micrograph["weft"] | {"crimp": -0.01}}
WITH_NEGATIVE = replace(S720, micrograph=NEGATIVE)
REFUSED = [
    (partial(crossover.build, S720, size=(8, 6.5, 2)), r"size = \(8, 6.5, 2\): must be coarse"),
    (
        partial(patch.build, S720, size=(float("inf"), 6, 2)),
        r"size = \(inf, 6, 2\): must be coarse",
    ),
    (partial(patch.build, S720, gap=float("nan")), "gap = nan: must be from 0 to below half"),
    (partial(crossover.build, S720, gap="wide"), "gap = 'wide': must be from 0 to below half"),
    (partial(crossover.build, S720, width=1.2e-3), "width = 0.0012: must be two lengths"),
    (partial(patch.build, S720, crimp="guessed"), "crimp = 'guessed': must be hand or micrograph"),
    (partial(patch.build, WITH_NEGATIVE, crimp="micrograph"), "crimp = -0.01: must be a fraction"),
    (partial(patch.build, replace(S720, solid_laws=None)), "fabric S-720 has no solid laws: a 3D"),
    (partial(patch.build, S720, (2, 1.5)), r"count = \(2, 1.5\): must be two whole numbers from 1"),
    (partial(patch.build, S720, 3), "count = 3: must be two whole numbers from 1"),
    (partial(Section, "sine", 1e-3, -1e-4, 0.1), "thickness = -0.0001: must be a positive number"),
    (
        partial(conform, [1.27e-3] * 2, [1e-7, 1e-12], S720.weave, 0.075),
        "no conforming sections have the fibre fractions",
    ),
]


@pytest.mark.parametrize("make, line", REFUSED, ids=[line[:30] for _, line in REFUSED])
def test_one_line_says_what_is_wrong(make, line):
    with pytest.raises(InputError, match=f"^{line}.*$"):
        make()
