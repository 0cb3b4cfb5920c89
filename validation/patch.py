"""May crossovers be pinned for a nose? One small patch is struck in three models: pinned crossovers, resolved
yarns, and woven solid yarns, which neither of the other two was built from.

    python -m validation patch examples/S-720-stops.toml [--struck crossover] [--duration "20 us"]
    python -m validation patch S-720 --velocity "60 m/s"

Of an input file count fabric, laws, nose, strike velocity, the friction between yarns and whether these fail. The
patch is one ply of its own, clamped all round and near: models are compared up to the first failure.
"""

from __future__ import annotations

from math import isfinite
from typing import cast

from fabrics.base.errors import InputError
from validation.cases import small_patch
from validation.cases.small_patch import COARSE, Place, SmallPatch, Struck
from weavecell.api import meshes, quantities
from weavecell.api.target import resolve_target

WORDS = {"pinned": "pinned crossovers", "yarns": "resolved yarns", "solids": "solid yarns"}
TIMES = (10e-6, 20e-6, 30e-6, 40e-6)  # [s] that are printed, if the models are compared so long
LEAST = 12  # crossings of each family
NOTES = {
    "target": "input file of a ply, or fabric",
    "velocity": 'of a fabric, such as "60 m/s"',
    "struck": "gap (between four yarns) or crossover",
    "crossings": "of each family, an even number; as few as the nose allows by default",
    "duration": 'such as "50 us"',
    "mesh": "hexahedra of the solids along, across and through a quarter of a yarn in one crossing",
}


def main(
    target: str,
    *,
    velocity: str | None = None,
    struck: str = "gap",
    crossings: int | None = None,
    duration: str = "50 us",
    mesh: str = ",".join(map(str, COARSE)),
) -> None:
    """Strike the patch in each model; print velocities of the nose beside each other, and the answer.

    Raises
    ------
    InputError : several plies, a block, a nose that is tilted, oblique, deforms or is too wide, or a
        fabric without solid laws
    UnstableError : the run of a model became unphysical
    """
    panel = resolve_target(target, {}, "shot", velocity, function="patch", one_shot=True)
    size = meshes.size(mesh)
    if not isinstance(size, tuple):
        raise InputError(key="mesh", value=mesh, allowed="three whole numbers, such as 2,2,1")
    seconds = quantities.read_positive(duration, "s", "duration")
    count = crossings
    if count is None:
        count = max(small_patch.fewest_crossings(panel.setup), LEAST)
    with panel.name_problems():
        patch = SmallPatch(panel.setup, count, cast("Place", struck), size, seconds)
    print(f"{panel.shot_title}: {count} x {count} crossovers of {patch.bricks:,} hexahedra,")
    print(f"struck: {struck}, friction {patch.friction:g} between yarns", flush=True)
    print(*table([strike() for strike in patch.strike()], panel.setup.strike_velocity), sep="\n")


def table(struck: list[Struck], strike_velocity: float) -> list[str]:
    """Write a line a model, with its velocity [m/s] at `TIMES`, what failed first, and the answer.

    Parameters
    ----------
    struck : Struck of pinned crossovers, resolved and solid yarns
    strike_velocity : [m/s]
    """
    until = small_patch.compare_until(struck)
    times = [*(t for t in TIMES if t < until), until]
    head = "".join(f"{1e6 * t:>8.3g} us" for t in times)
    lines = [f"{'velocity [m/s] at':<19}{head}   CPU s"]
    for one in struck:
        speeds = "".join(f"{one.velocity(t):>11.1f}" for t in times)
        lines.append(f"{WORDS[one.model]:<19}{speeds}{one.cpu:>8.2g}")
    for one in struck:
        if isfinite(one.first_failure):
            at = 1e6 * one.first_failure
            lines.append(f"{WORDS[one.model]}: the first fibre fails at {at:.3g} us")
    error = max(one.energy_error for one in struck)
    lines.append(f"energy error at most {error:.2%} of the strike energy")
    lines.append(small_patch.judge(struck, strike_velocity))
    return lines
