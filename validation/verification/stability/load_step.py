"""Load step of the 3D crossover: equilibria from step to step, without the halving that the code falls back on."""

from __future__ import annotations

from functools import cache

from fabrics.errors import UnstableError
from unitcell3d.solver.load_stepping import Steps
from validation.verification.crossover_convergence import cases, study
from validation.verification.stability.core import ABOVE, STABLE, WRONG, Axis, Map, Outcome, guarded

SIZE = (8, 6, 2)  # on 4 x 3 x 1 one step over the whole path converges, with a thousand times the penalty even
STEPS = (0.05, 0.1, 0.2, 0.4, 0.7, 1.0)
PATHS = ("equibiaxial", "warp only", "weft only")
ALLOWED = 1e-3


def solve(step: float, path: str) -> tuple[dict[str, float], int]:
    """Forces at the end of a path."""
    fabric, paths = study.scene()
    only = (("first", step), ("largest", step), ("least", step))
    found = cases.solve(fabric, {path: paths[path]}, cases.Case(size=SIZE, steps=only))
    if found["failed"]:
        raise UnstableError(found["failed"][path])
    return found["values"], found["tangents"]


usual = cache(lambda path: solve(STEPS[0], path)[0])


def point(step: float, path: str) -> Outcome:
    """STABLE where the path reaches its end, with the forces that small steps give."""

    def run():
        values, tangents = solve(step, path)
        off = max(abs(value / usual(path)[name] - 1) for name, value in values.items())
        message = f"forces off by {100 * off:.1g} %" if off > ALLOWED else ""
        return Outcome(STABLE if off <= ALLOWED else WRONG, tangents, message)

    return guarded(run)


def chart(quick: bool = False) -> Map:
    """The map."""
    return Map(
        "load-step", "Load step of the 3D crossover",
        f"A quarter crossover of S-720 ({' x '.join(map(str, SIZE))} hexahedra a yarn) is pulled near to failure in "
        "equal steps. In the code a failed step is halved, and the contact softened and brought back; here it may not "
        "be, so that the map shows Newton's method itself.",
        Axis("load step, share of the path", (0.1, 1.0) if quick else STEPS),
        Axis("path", PATHS[1:2] if quick else PATHS), point, "tangents factorised",
        f"forces off by more than {100 * ALLOWED:g} %", "no convergence, a singular tangent, an inverted element",
        (Steps().largest, "warp only"), (ABOVE,), () if quick else PATHS,
    )  # fmt: skip
