"""Load step of the 3D crossover: equilibria from step to step, without the halving that the code falls back on."""

from functools import cache

from fabrics.errors import UnstableError
from unitcell3d.stepping import Steps
from validation.crossover_study import cases, study
from validation.stability.core import ABOVE, STABLE, WRONG, Axis, Map, Outcome, guarded

SIZE = (4, 3, 1)
STEPS = (0.025, 0.05, 0.1, 0.2, 0.4, 0.7, 1.0)
PENALTIES = (0.1, 1.0, 10.0)
PATH = "equibiaxial"
ALLOWED = 1e-3


def solve(step, penalty):
    """Forces at the end of the path."""
    fabric, paths = study.scene()
    numbers = (("penalty", penalty * cases.Case().full_numerics.penalty),)
    only = (("first", step), ("largest", step), ("least", step))
    found = cases.solve(fabric, {PATH: paths[PATH]}, cases.Case(size=SIZE, numerics=numbers, steps=only))
    if found["failed"]:
        raise UnstableError(found["failed"][PATH])
    return found["values"], found["tangents"]


usual = cache(lambda penalty: solve(0.025, penalty)[0])


def point(step, penalty):
    """STABLE where the path reaches its end, with the forces that small steps give."""

    def run():
        values, tangents = solve(step, penalty)
        off = max(abs(value / usual(penalty)[name] - 1) for name, value in values.items())
        return Outcome(
            STABLE if off <= ALLOWED else WRONG, tangents, f"forces off by {100 * off:.1g} %" if off > ALLOWED else ""
        )

    return guarded(run)


def chart(quick=False):
    """The map."""
    return Map(
        "load-step", "Load step of the 3D crossover",
        "A quarter crossover of S-720 (4 x 3 x 1 hexahedra a yarn) is pulled equibiaxially to failure in equal steps. "
        "In the code a failed step is halved, and the contact softened and brought back; here it may not be, so that "
        "the map shows Newton's method itself.",
        Axis("load step, share of the path", (0.1, 1.0) if quick else STEPS),
        Axis("penalty over the default", (1.0,) if quick else PENALTIES), point, "tangents factorised",
        f"forces off by more than {100 * ALLOWED:g} %", "no convergence, a singular tangent, an inverted element",
        (Steps().largest, 1.0), (ABOVE,),
    )  # fmt: skip
