"""A crimped yarn of solids with 0 to 44 fibre bars, with one-point and full integration (thesis Figure 3-4)."""

from __future__ import annotations

from functools import cache

from fabrics import catalogue
from fabrics.errors import UnstableError
from meshing import crossover
from shellfabric.panel import quality
from unitcell3d.cases import single_yarn as cases_single_yarn
from unitcell3d.material import solid_law
from validation.verification.stability.core import STABLE, WRONG, Axis, Map, Outcome, guarded

FABRIC, SIZE = "S-720", (8, 10, 3)
BARS = (0, 10, 22, 34, 44)
POINTS = {"one point": solid_law.ONE_POINT, "2 x 2 x 2 points": solid_law.FULL}
ALLOWED = 0.01  # of the thickness


@cache
def mesh() -> crossover.Crossover:
    """A quarter crossover with 44 fibre lines in each half of a yarn."""
    return crossover.build(catalogue.load(FABRIC), size=SIZE)


def point(bars: int, points: str) -> Outcome:
    """STABLE where the yarn is pulled straight and no node strays from its neighbours along the yarn."""

    def run():
        made = mesh()
        bars_given = None if bars == 44 else bars
        record = cases_single_yarn.pull(
            made, catalogue.load(FABRIC), 0, bars=bars_given, integration=POINTS[points], rows=12
        )
        if record.failed:
            raise UnstableError(record.failed)
        thickness = 2 * catalogue.load(FABRIC).weave.h01
        off = float(max(record["astray"])) / thickness
        found = quality.of_yarn(record["astray"], thickness)
        return Outcome(STABLE if off <= ALLOWED else WRONG, 100 * off, checks=found)

    return guarded(run)


def chart(quick: bool = False) -> Map:
    """The map."""
    return Map(
        "bars", "A crimped yarn of solids with and without fibre bars",
        f"The warp of {FABRIC} alone, {SIZE[0]} x {SIZE[1]} x {SIZE[2]} hexahedra in half its width and length, 44 "
        "fibre lines of which some carry bars, is pulled straight and on to its failure strain. The thesis's Figure "
        "3-4 shows nodes thrown about without bars: the modes without energy of its one-point elements.",
        Axis("fibre lines with bars", (0, 44) if quick else BARS), Axis("integration", tuple(POINTS)), point,
        "amplitude from node to node [% of the thickness]", f"amplitude above {100 * ALLOWED:g} %",
        "no convergence, a singular tangent, an inverted element", (44, "2 x 2 x 2 points"), (),
    )  # fmt: skip
