"""What stands in for values that a data sheet does not print, as far as the fibre family is known.

Pages of fabrics print name, weave, areal density, thickness, counts, denier, and sometimes the
breaking strength of a strip. For a family that the user names, `[typical]` of its file has modulus,
fibre density and strength of its yarns. The breaking strength of a strip over its count is the
strength of a yarn in the fabric. A fibre that is not linear has a modulus at first and a smaller
one on the way to its strength: yarns are linear here, with a modulus between the two. Each value
says so in the file, with the status "assumed" or "derived", and those that decide have a range,
which results cover.
"""

from __future__ import annotations

import logging
from collections.abc import Mapping
from dataclasses import dataclass, field
from math import sqrt

from fabrics import data_sheet
from fabrics.base.units import si
from fabrics.fabric_tables import FAMILIES, Quantity
from fabrics.families import Family, list_families

LOG = logging.getLogger("weavecell")
BREAKING = "breaking_strength"
# of the fabric, in a CSV file alone: the file that is made of it has the strength of the yarn
OF_STRIP = Quantity(
    {"N/m": "1 to 5000 N/mm"},
    "900 lbf/inch",
    "force at which a strip of fabric breaks over its width",
)
STRENGTHS = ("strength", "tenacity", "failure_strain")
# a yarn alone over its share of the strip
ALONE = 1.25
UNEVEN = "yarns of a strip do not break at once: alone they bear up to a quarter more, a guess"


@dataclass(frozen=True)
class Value:
    """One value of both families, as written, with where it comes from.

    Parameters
    ----------
    warp, weft, source, status : as a fabric file has them
    ranges : {"warp", "weft": (low, high) as written}; empty without
    stands_in : whether no sheet has it
    row : line of the sheet, 0 where it has none
    curve : file that it is fitted to, "" of others
    """

    warp: str
    weft: str
    source: str
    status: str = "user"
    ranges: Mapping[str, tuple[str, str]] = field(default_factory=dict)
    stands_in: bool = False
    row: int = field(default=0, compare=False)
    curve: str = ""

    def line(self, key: str) -> str:
        """Write what stands in for the value of a key, and why."""
        texts = [self._with_range(family) for family in FAMILIES]
        both = (
            texts[0] if texts[0] == texts[1] else f"{texts[0]} of the warp, {texts[1]} of the weft"
        )
        return f"{self.status}: {key} {both}: {self.source}"

    def _with_range(self, family):
        low, high = self.ranges.get(family, ("", ""))
        text = getattr(self, family)
        return f"{text} ({low} .. {high})" if low else text


def complete(values: Mapping[str, Value], family: str | None) -> dict[str, Value]:
    """Return the values of a sheet with those that stand in for what it does not print.

    Parameters
    ----------
    values : {key: Value}, each checked by itself
    family : named by the user, or None

    Raises
    ------
    InputError : a value that is no quantity
    """
    found = dict(values)
    named = next((each for each in list_families() if each.name == family), None)
    for key in ("fibre_density", "modulus"):
        if named is not None and key not in found:
            found[key] = _typical(named, key)
    of_strip = found.pop(BREAKING, None)
    if of_strip is not None and "count" in found:
        of_yarn = _of_yarn(of_strip, found["count"], named)
        stated = [key for key in STRENGTHS if key in found]
        if stated:
            _compare(of_strip, of_yarn, stated[0], found)
        else:
            found["strength"] = of_yarn
    if named is not None and not set(STRENGTHS) & set(found):
        found["strength"] = _typical(named, "strength")
    return _as_straight_line(found, named)


def _typical(family: Family, key: str) -> Value:
    row = family.typical[key]
    ranges = {}
    # no result depends on the density by itself
    if "low" in row:
        ranges = dict.fromkeys(FAMILIES, (row["low"], row["high"]))
    source = f"typical of {family.name}, not of this yarn: {row['source']}"
    return Value(row["value"], row["value"], source, row["status"], ranges, True)


def _of_yarn(strip, count, family):
    """The strength of a yarn before weaving, from that of a strip: a run lowers it by weaving
    again."""
    name = data_sheet.STRENGTH_AFTER_WEAVING
    usual = data_sheet.entries()[name]
    share = (usual if family is None else family.shots.get(name, usual)).value
    texts = {}
    ranges = {}
    for yarn in FAMILIES:
        of_width = si(getattr(strip, yarn), "N/m")
        force = of_width / si(getattr(count, yarn), "1/m") / share
        texts[yarn] = f"{force:.4g} N"
        ranges[yarn] = (texts[yarn], f"{ALONE * float(texts[yarn].split()[0]):.4g} N")
    source = (
        f"breaking strength of the fabric, {strip.warp} / {strip.weft} ({strip.source}), over its count and the "
        f"{name}, {share:g}; {UNEVEN}"
    )
    return Value(texts["warp"], texts["weft"], source, "derived", ranges, True)


def _compare(of_strip, of_yarn, key, values):
    """Tell which of two strengths of a sheet is used, that of the strip or that of the yarn."""
    sentences = []
    for yarn in FAMILIES:
        force = si(getattr(of_yarn, yarn), "N")
        sentence = f"{force:.4g} N a yarn of the {yarn}"
        own = _force_of(key, yarn, values)
        if own is not None:
            share = 100 * (force / own - 1)
            sentence += f", {share:+.0f} % from the {own:.4g} N of the {key}"
        sentences.append(sentence)
    LOG.info(
        f"note: the {key} is used, not the {BREAKING} {of_strip.warp} / {of_strip.weft}, which makes "
        f"{'; '.join(sentences)}"
    )


def _force_of(key, yarn, values):
    """Strength [N] of a yarn that a sheet states under `key`; None where it takes more to know."""
    if key == "failure_strain":
        return None
    number, unit = data_sheet.OF_YARN[key].read(getattr(values[key], yarn))
    if unit == "N":
        return number
    if "linear_density" not in values:
        return None
    linear_density = si(getattr(values["linear_density"], yarn), "kg/m")
    if unit == "Pa":
        if "fibre_density" not in values:
            return None
        return number * linear_density / si(getattr(values["fibre_density"], yarn), "kg/m^3")
    return number * linear_density


def _as_straight_line(values, named):
    """The values, with a modulus between that at first and that to the strength, where a fibre that
    is not linear has modulus, strength and failure strain, which then disagree."""
    key = next((name for name in ("strength", "tenacity") if name in values), None)
    if key is None or not {"modulus", "failure_strain", "linear_density", "fibre_density"} <= set(
        values
    ):
        return values
    texts = {}
    ranges = {}
    for yarn in FAMILIES:
        at_first, to_strength, family = _moduli(values, key, yarn, named)
        limit = data_sheet.entries()["contradiction"].value
        if family is None or family.linear or at_first <= (1 + limit) * to_strength:
            return values
        texts[yarn] = f"{1e-9 * sqrt(at_first * to_strength):.4g} GPa"
        ranges[yarn] = (f"{1e-9 * to_strength:.4g} GPa", f"{1e-9 * at_first:.4g} GPa")
    stated = values["modulus"]
    source = (
        f"{family.name} is not linear: between {stated.warp} / {stated.weft} at first ({stated.source}) and the "
        f"straight line to the {key} at {values['failure_strain'].warp} / {values['failure_strain'].weft}, the "
        "geometric mean of both"
    )
    found = {name: value for name, value in values.items() if name != "failure_strain"}
    found["modulus"] = Value(texts["warp"], texts["weft"], source, "derived", ranges, True)
    return found


def _moduli(values, key, yarn, named):
    """(modulus at first [Pa], modulus of the straight line to the strength [Pa], the Family or
    None) of a yarn."""
    number = {name: getattr(value, yarn) for name, value in values.items()}
    density = si(number["fibre_density"], "kg/m^3")
    modulus, unit = data_sheet.OF_YARN["modulus"].read(number["modulus"])
    if unit != "Pa":
        modulus *= density
    strength, unit = data_sheet.OF_YARN[key].read(number[key])
    linear_density = si(number["linear_density"], "kg/m")
    strain = si(number["failure_strain"], "")
    line = data_sheet.strain_at_strength(strength, unit, linear_density, density, modulus)
    family = named or next(
        (each for each in list_families() if each.holds_fibre(modulus, density)), None
    )
    return modulus, modulus * line / strain, family
