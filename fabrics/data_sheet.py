"""What follows from the quantities of a data sheet: crimp from thickness, failure strain from strength, checks.

Warp and weft touch at the crossover, so that the sum of the heights of their centrelines is half of the sum of the
yarns' thicknesses there; where the faces of both families are level that sum is the thickness of the fabric:

    t = 2 (h1 + h2),   h1 = s t / 2,   h2 = (1 - s) t / 2,   crimp_i = S(w_i, h_i) / 2 w_i - 1

with S of thesis eq. 4-3. t is also the thickness of the shell (thesis section 6.6). The share s of the warp is on no
data sheet: `data_sheet.toml` has its value with a range, and that of the thickness.
"""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import TypeAlias

from fabrics.errors import InputError
from fabrics.fabric_tables import FAMILIES, OF_YARN
from fabrics.families import Entry, entry
from fabrics.weave import Weave, arc_length, height_from_length
from fabrics.yarn import CLOSEST_PACKING, Yarn

Crimps: TypeAlias = tuple[float | None, float | None]


FROM_THICKNESS = "computed from the thickness"


@cache
def entries() -> dict[str, Entry]:
    """{name: Entry} of `data_sheet.toml`."""
    content = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))
    return {
        name: entry(table, "m" if name.endswith("length") else "")
        for name, table in content.items()
    }


def crimps(
    w: Sequence[float], thickness: float, known: Crimps = (None, None), share: float | None = None
) -> tuple[float, float]:
    """Crimp of warp and weft [-] of a weave of this thickness.

    Parameters
    ----------
    w : (w1, w2) [m] half cell lengths along warp and weft
    thickness : [m] 2 (h1 + h2)
    known : crimps that are given; where one of two is, the other yarn has the rest of the thickness
    share : height of the warp over the sum of both, where neither is given; None takes that of `data_sheet.toml`

    Raises
    ------
    InputError : the yarn whose crimp is known is alone higher than half of the thickness, or a crimp out of bounds
    """
    share = entries()["warp_share"].value if share is None else share
    half = thickness / 2
    heights = [share * half, (1 - share) * half]
    for i, j in ((0, 1), (1, 0)):
        crimp = known[i]
        if crimp is None:
            continue
        heights[i] = height_from_length(w[i], 2 * w[i] * (1 + crimp))
        if known[j] is None:
            heights[j] = half - heights[i]
            if not heights[j] > 0:
                least = f"above {2e3 * heights[i]:.3f} mm, twice the height that the crimp of the {FAMILIES[i]} takes"
                raise InputError(key="thickness", value=thickness, allowed=least)
    first, second = (
        float(arc_length(w_i, h)) / (2 * w_i) - 1 if c is None else c
        for w_i, h, c in zip(w, heights, known)
    )
    limits = OF_YARN["crimp"]
    if max(first, second) > limits.limits("")[1]:
        percent = 100 * max(first, second)
        allowed = (
            f"one that gives a crimp from {limits.bounds['']} at these counts, not {percent:.4g} %"
        )
        raise InputError(key="thickness", value=thickness, allowed=allowed)
    return first, second


def strain_at_strength(
    strength: float, unit: str, linear_density: float, fibre_density: float, E: float
) -> float:
    """Strain [-] at which a yarn of modulus `E` [Pa] carries its strength.

    Parameters
    ----------
    strength : in `unit`: "N" of a yarn, "Pa" of the fibre, or "N/(kg/m)", the tenacity
    linear_density, fibre_density : [kg/m], [kg/m3]
    """
    stress = {"N": fibre_density / linear_density, "Pa": 1.0, "N/(kg/m)": fibre_density}[
        unit
    ] * strength
    return stress / E


def strength_note(yarn: Yarn, failure_strain: float | None, written: str) -> str:
    """A line where a given failure strain disagrees with the strength by more than 1 %, else an empty text."""
    if failure_strain is None or abs(failure_strain / yarn.failure_strain - 1) < 0.01:
        return ""
    by_strain = failure_strain * yarn.EA
    return (
        f"the strength {written} is {yarn.strength:.1f} N a yarn; modulus times failure strain gives {by_strain:.1f} N "
        f"({100 * (by_strain / yarn.strength - 1):+.1f} %); the strength is used, at a strain of "
        f"{100 * yarn.failure_strain:.2f} %"
    )


def mass_note(computed: float, stated: float) -> list[str]:
    """A line where the areal density of the weave [kg/m2] differs from the stated one by more than 1 %.

    Raises
    ------
    InputError : it differs by more than the limit of `data_sheet.toml`
    """
    limit, off = entries()["areal_density"].value, computed / stated - 1
    if abs(off) > limit:
        raise InputError(
            key="areal_density",
            value=f"{1e3 * stated:g} g/m^2",
            allowed=f"within {100 * limit:g} % of {1e3 * computed:.1f} g/m^2, which counts, linear densities and crimp "
            "give: check these",
        )
    if abs(off) < 0.01:
        return []
    return [
        f"note: counts, linear densities and crimp give {1e3 * computed:.1f} g/m^2, {100 * off:+.1f} % of the stated "
        f"{1e3 * stated:g} g/m^2"
    ]


def thickness_note(weave: Weave, stated: float) -> list[str]:
    """A line where the thickness of a weave is outside the range about the stated one [m].

    Raises
    ------
    InputError : warp and weft, their fibres closest packed, are together thicker than the stated thickness
    """
    layers = (
        count * (1 + yarn.crimp) * yarn.A_s
        for yarn, count in zip(weave.yarns, (weave.warp_count, weave.weft_count))
    )
    least = sum(layers) / CLOSEST_PACKING
    if stated < least:
        allowed = (
            f"at least {1e3 * least:.3g} mm, which the closest packed fibres of warp and weft take"
        )
        raise InputError(key="thickness", value=stated, allowed=allowed)
    one, computed = entries()["thickness"], weave.thickness
    if one.low <= computed / stated <= one.high:
        return []
    return [
        f"note: the crimps give a thickness of {1e3 * computed:.3f} mm, the file states {1e3 * stated:g} mm; the "
        "crimps are used"
    ]
