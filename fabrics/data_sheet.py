"""What follows from the quantities of a data sheet: crimp from thickness, failure strain from
strength, checks.

Warp and weft touch at the crossover, so that the sum of the heights of their centrelines is half of
the sum of the yarns' thicknesses there; where the faces of both families are level that sum is the
thickness of the fabric:

    t = 2 (h1 + h2),   h1 = s t / 2,   h2 = (1 - s) t / 2,   crimp_i = S(w_i, h_i) / 2 w_i - 1

with S of thesis eq. 4-3. t is also the thickness of the shell (thesis section 6.6). The share s of
the warp is on no data sheet: `data_sheet.toml` has its value with a range, and that of the
thickness.

In a weave with floats a yarn changes sides over a share f of its spacings, and how long it takes for
that is not known: from one spacing (x = 1) to the whole way to the next change (x = 0),

    crimp_i = f a (S(w_i, h_i / a) / 2 w_i - 1),   a = 1 + (1 - x) (1 / f - 1)

The areal density m = n1 lambda1 (1 + crimp_1) + n2 lambda2 (1 + crimp_2) does not depend on it. Where
a sheet states m, the crimp of such a weave is that of the thickness which gives m; so is that of any
weave without a stated thickness.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import TypeAlias

from fabrics.base.errors import InputError
from fabrics.base.files import read_data
from fabrics.fabric_tables import FAMILIES, OF_YARN, FabricFile, YarnTable
from fabrics.families import Entry, list_families
from fabrics.families import entries as of_tables
from fabrics.pattern import PLAIN, Pattern
from fabrics.weave import Weave, arc_length, height_from_length
from fabrics.yarn import CLOSEST_PACKING, Yarn

Crimps: TypeAlias = tuple[float | None, float | None]


FROM_THICKNESS = "computed from the thickness"
FROM_MASS = "computed from the areal density"
# names of `data_sheet.toml`: numbers that no fabric file has, for shots with fabrics that are not of the catalogue
STRENGTH_AFTER_WEAVING = "strength after weaving"
FRICTION_OF_PROJECTILE = "friction of the projectile"
FRICTION_BETWEEN_PLIES = "friction between plies"
FRICTION_BETWEEN_YARNS = "friction between yarns"  # of all fabrics
OF_SHOTS = (STRENGTH_AFTER_WEAVING, FRICTION_OF_PROJECTILE, FRICTION_BETWEEN_PLIES)
# if closest packed fibres are so many times thicker than the sheet, the mass of the yarn has
# another unit
TOO_THICK = 3.0
# [-] a stated quantity that differs by more from what other data give is mentioned
NOTED = 0.01


@cache
def entries() -> dict[str, Entry]:
    """Read `data_sheet.toml`: {name: Entry}."""
    return of_tables(read_data(Path(__file__).with_suffix(".toml")))


def failure_length(weave: Weave) -> Entry:
    """Return the assumed failure length [m] of a weave: at most its smallest yarn spacing, with the
    ends in proportion."""
    usual = entries()["failure_length"]
    spacing = 1 / max(weave.warp_count, weave.weft_count)
    share = min(1.0, spacing / usual.value)
    if share == 1.0:
        return usual
    value, low, high = (share * each for each in (usual.value, usual.low, usual.high))
    written = f"{1e3 * value:.3g} mm ({1e3 * low:.3g} mm .. {1e3 * high:.3g} mm)"
    source = f"one yarn spacing of this weave, and half and double; {usual.source}"
    return replace(usual, value=value, low=low, high=high, written=written, source=source)


def crimps(
    w: Sequence[float],
    thickness: float,
    known: Crimps = (None, None),
    share: float | None = None,
    pattern: Pattern = PLAIN,
    straight_floats: float | None = None,
) -> tuple[float, float]:
    """Compute the crimp of warp and weft [-] of a weave of this thickness.

    Parameters
    ----------
    w : (w1, w2) [m] half cell lengths along warp and weft
    thickness : [m] 2 (h1 + h2)
    known : crimps that are given; if one of two is, the other yarn has the rest of the thickness
    share : height of the warp over the sum of both, if neither is given; None takes that of
        `data_sheet.toml`
    pattern : of the weave; a yarn is straight where it floats on
    straight_floats : [-] x, the share of a float that is straight; None takes that of
        `data_sheet.toml`

    Raises
    ------
    InputError : the yarn whose crimp is known is alone higher than half of the thickness, or a
        crimp out of bounds
    """
    if share is None:
        share = entries()["warp_share"].value
    if straight_floats is None:
        straight_floats = entries()["straight_floats"].value
    half = thickness / 2
    heights = [share * half, (1 - share) * half]
    for i, j in ((0, 1), (1, 0)):
        crimp = known[i]
        if crimp is None:
            continue
        heights[i] = _height(w[i], crimp, pattern.interlacings[i], straight_floats)
        if known[j] is None:
            heights[j] = half - heights[i]
            if not heights[j] > 0:
                least = f"above {2e3 * heights[i]:.3f} mm, twice the height that the crimp of the {FAMILIES[i]} takes"
                raise InputError(key="thickness", value=thickness, allowed=least)
    first, second = (
        _crimp(w_i, h, f, straight_floats) if c is None else c
        for w_i, h, c, f in zip(w, heights, known, pattern.interlacings)
    )
    limits = OF_YARN["crimp"]
    if max(first, second) > limits.limits("")[1]:
        percent = 100 * max(first, second)
        allowed = (
            f"one that gives a crimp from {limits.bounds['']} at these counts, not {percent:.4g} %"
        )
        raise InputError(key="thickness", value=thickness, allowed=allowed)
    return first, second


def _crimp(w, height, share, straight_floats):
    """Crimp [-] of a yarn of a height that changes sides over a share of its spacings."""
    longer = 1 + (1 - straight_floats) * (1 / share - 1)
    return share * longer * (float(arc_length(w, height / longer)) / (2 * w) - 1)


def _height(w, crimp, share, straight_floats):
    """Height [m] of a yarn of a crimp: the inverse of `_crimp`."""
    longer = 1 + (1 - straight_floats) * (1 / share - 1)
    return longer * height_from_length(w, 2 * w * (1 + crimp / (share * longer)))


def crimps_of_mass(
    w: Sequence[float],
    straight: Sequence[float],
    areal_density: float,
    known: Crimps = (None, None),
    share: float | None = None,
    pattern: Pattern = PLAIN,
) -> tuple[float, float]:
    """Compute the crimp of warp and weft [-] of a weave of this areal density [kg/m2].

    Parameters
    ----------
    straight : (warp, weft) [kg/m2] areal densities of the yarns without crimp
    w, known, share, pattern : as of `crimps`

    Raises
    ------
    InputError : less mass than straight yarns have, or more than the most crimped ones
    """
    if share is None:
        share = entries()["warp_share"].value
    most = OF_YARN["crimp"].limits("")[1]

    def mass_of(crimp):
        return sum(mass * (1 + c) for mass, c in zip(straight, crimp))

    def crimp_of(thickness):
        heights = 0.5 * share * thickness, 0.5 * (1 - share) * thickness
        return [_crimp(*of, 1.0) for of in zip(w, heights, pattern.interlacings)]

    def with_unknown(crimp):
        return [crimp if one is None else one for one in known]

    low = mass_of(with_unknown(0.0))
    high = mass_of(with_unknown(most))
    found = [-1.0, -1.0]
    if None not in known:
        found = with_unknown(0.0)
    elif low < areal_density < high and known == (None, None):
        from scipy.optimize import brentq

        thickest = 8 * max(w)  # of far more crimp than the most
        thickness = brentq(
            lambda t: mass_of(crimp_of(t)) - areal_density, 0.0, thickest, xtol=1e-15, rtol=1e-14
        )
        found = crimp_of(thickness)
    elif low < areal_density < high:
        unknown = sum(mass for mass, one in zip(straight, known) if one is None)
        found = with_unknown((areal_density - low) / unknown)
    first, second = found
    if not 0 <= min(first, second) <= max(first, second) <= most:
        allowed = (
            f"{1e3 * low:.4g} to {1e3 * high:.4g} g/m^2, which these yarns have with a crimp of 0 to "
            f"{100 * most:g} %; or give crimp"
        )
        value = f"{1e3 * areal_density:g} g/m^2"
        raise InputError(key="areal_density", value=value, allowed=allowed)
    return first, second


def strain_at_strength(
    strength: float, unit: str, linear_density: float, fibre_density: float, E: float
) -> float:
    """Compute the strain [-] at which a yarn of modulus `E` [Pa] carries its strength.

    Parameters
    ----------
    strength : in `unit`: "N" of a yarn, "Pa" of the fibre, or "N/(kg/m)", the tenacity
    linear_density, fibre_density : [kg/m], [kg/m3]
    """
    stress = {"N": fibre_density / linear_density, "Pa": 1.0, "N/(kg/m)": fibre_density}[
        unit
    ] * strength
    return stress / E


def modulus(yarn: YarnTable) -> float:
    """Compute the modulus [Pa] of the fibre from a table [warp] or [weft], which may state it over
    the density."""
    return yarn.modulus.value * (1.0 if yarn.modulus.unit == "Pa" else yarn.fibre_density.value)


def linear_density(yarn: YarnTable) -> float:
    """Compute the linear density [kg/m] from a table [warp] or [weft], which may state the axial
    stiffness in its place."""
    if yarn.axial_stiffness is None:
        return yarn.linear_density.value
    return yarn.axial_stiffness.value * yarn.fibre_density.value / modulus(yarn)


def check_fibre(yarn: Yarn, key: str) -> None:
    """Refuse strength and failure strain of a yarn outside the ranges of the fibre families it may
    belong to (`ranges_of_fibre`).

    Parameters
    ----------
    key : under which the strength or the failure strain was given

    Raises
    ------
    InputError : outside the ranges of all of them
    """
    allowed = ranges_of_fibre(yarn)
    if allowed:
        raise InputError(key=key, allowed=allowed)


def ranges_of_fibre(yarn: Yarn) -> str:
    """Write the ranges that a yarn with its strength and failure strain is outside of: those of the
    fibre family it may belong to; "" inside, and of yarns of no family."""
    fibre = {"strength": yarn.E * yarn.failure_strain, "failure_strain": yarn.failure_strain}
    families = [family for family in list_families() if family.holds(yarn)]
    if not families or any(family.allows(fibre) for family in families):
        return ""
    limits = families[0].strengths
    strain = "{:g} to {:g}".format(*(100 * end for end in limits["failure_strain"]))
    stress = "{:g} to {:g}".format(*(1e-9 * end for end in limits["strength"]))
    return (
        f"a failure strain of {strain} % and a strength of {stress} GPa, the ranges of {families[0].name} "
        f"yarns, not {100 * yarn.failure_strain:.3g} % and {1e-9 * fibre['strength']:.3g} GPa"
    )


def disagreement(
    computed: float, stated: float, key: str, value: str, allowed: str
) -> float | None:
    """Compute by how much [-] what other data give is above a stated quantity; None if that is
    below NOTED.

    Raises
    ------
    InputError : above the limit of `data_sheet.toml`; its `allowed` is the text with {} for the
        limit
    """
    limit = entries()["contradiction"].value
    off = computed / stated - 1
    if abs(off) > limit:
        raise InputError(key=key, value=value, allowed=allowed.format(f"{100 * limit:g} %"))
    if abs(off) < NOTED:
        return None
    return off


def strength_note(yarn: Yarn, failure_strain: float, written: str, key: str) -> str:
    """Write a line if a given failure strain disagrees with the strength, else an empty text.

    Raises
    ------
    InputError : as `disagreement`, of the failure strain's `key`
    """
    by_strain = failure_strain * yarn.EA
    percent = 100 * yarn.failure_strain
    allowed = (
        f"within {{}} of {percent:.3g} %, at which this modulus reaches the strength {written}"
    )
    value = f"{100 * failure_strain:g} %"
    off = disagreement(
        failure_strain,
        yarn.failure_strain,
        key,
        value,
        f"{allowed}: check the three, or leave one out of a fibre that is not linear",
    )
    if off is None:
        return ""
    return (
        f"the strength {written} is {yarn.strength:.1f} N a yarn; modulus times failure strain gives {by_strain:.1f} N "
        f"({100 * off:+.1f} %); the strength is used, at a strain of {percent:.2f} %"
    )


def mass_notes(file: FabricFile, crimp: Sequence[float]) -> list[str]:
    """Write a line if counts, linear densities and crimps give another mass of the fabric than is
    stated.

    The measured areal density of the thesis's fabrics stands beside the nominal linear densities:
    it is compared without a note.

    Raises
    ------
    InputError : as `disagreement`
    """
    yarns = file.yarns.values()
    layers = [yarn.count.value * (1 + c) * linear_density(yarn) for yarn, c in zip(yarns, crimp)]
    computed = 1e3 * sum(layers)
    notes = []
    masses = [(yarn.linear_density or yarn.axial_stiffness).written for yarn in yarns]
    allowed = f"within {{}} of {computed:.1f} g/m^2, which counts, linear densities ({' and '.join(masses)}) and crimp "
    for key in ("areal_density", "areal_density_measured"):
        if (datum := getattr(file, key)) is None:
            continue
        stated = 1e3 * datum.value
        off = disagreement(
            computed, stated, key, f"{stated:g} g/m^2", f"{allowed}give: check these"
        )
        if off is not None and key == "areal_density":
            notes.append(
                f"note: counts, linear densities and crimp give {computed:.1f} g/m^2, {100 * off:+.1f} % of the stated "
                f"{stated:g} g/m^2"
            )
    return notes


def width_notes(file: FabricFile) -> list[str]:
    """Write a line about yarns that are wider than their spacing leaves room for.

    Raises
    ------
    InputError : as `disagreement`
    """
    notes = []
    for family, yarn in file.yarns.items():
        if yarn.width is None or yarn.width.value * yarn.count.value <= 1:
            continue
        spacing = 1 / yarn.count.value
        key = f"{family}.width"
        allowed = f"at most {{}} above the spacing of the yarns, {1e3 * spacing:.3g} mm: check width and count"
        off = disagreement(yarn.width.value, spacing, key, yarn.width.written, allowed)
        if off is not None:
            notes.append(
                f"note: {key} {yarn.width.written} is {100 * off:.1f} % above the spacing of the yarns, "
                f"{1e3 * spacing:.3g} mm; the gap of the fibre family is used"
            )
    return notes


def thickness_note(weave: Weave, stated: float) -> list[str]:
    """Write a line if the crimps give another thickness than the stated one [m]. That of a weave with
    floats also depends on how long a change of sides takes, and is not refused.

    Raises
    ------
    InputError : as `disagreement`; warp and weft, their fibres closest packed, are together thicker
    """
    layers = (
        count * (1 + yarn.crimp) * yarn.A_s
        for yarn, count in zip(weave.yarns, (weave.warp_count, weave.weft_count))
    )
    least = sum(layers) / CLOSEST_PACKING
    if least > TOO_THICK * stated:
        mass = f"{1e3 * weave.areal_density:.4g} g/m^2"
        message = f"with count it gives {mass}, {1e3 * least:.3g} mm of closest packed fibres"
        thin = f"a linear density of yarns that fit into the thickness, {1e3 * stated:g} mm"
        raise InputError(message, key="linear_density", allowed=thin)
    if stated < least:
        allowed = (
            f"at least {1e3 * least:.3g} mm, which the closest packed fibres of warp and weft take"
        )
        raise InputError(key="thickness", value=stated, allowed=allowed)
    computed = 1e3 * weave.thickness
    allowed = (
        f"within {{}} of {computed:.3f} mm, which the crimps give: check crimp, count and thickness"
    )
    if weave.pattern.is_plain:
        off = disagreement(weave.thickness, stated, "thickness", f"{1e3 * stated:g} mm", allowed)
        if off is None:
            return []
    elif abs(weave.thickness / stated - 1) < NOTED:
        return []
    return [
        f"note: the crimps give a thickness of {computed:.3f} mm, the file states {1e3 * stated:g} mm; the "
        "crimps are used"
    ]
