"""Fibre families: default laws of the yarns of one kind of fibre, each number with a range.

A data sheet states neither the trellis law of a fabric nor the transverse law of its yarns or the
diameter of their fibres. A family's file gives these, with the status "assumed", a source, and the
range (low, high) within which the value is taken to lie; where numbers are known also strength and
modulus at strain rates (`families.strain_rate`), and what stands in place of numbers of
`data_sheet.toml` for shots: strength after weaving and friction.
Angles and moduli of the trellis follow from the weave (`families.trellis`).

Every range has a soft and a stiff end. `Family.shear` and `Family.solid_laws` give the nominal law,
or the law of one of these ends. Yarns of no family may name one: ranges are then wider
(`Family.for_other_yarns`). LCP has modulus and density of para-aramid, and must be named.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cache
from math import inf
from pathlib import Path
from typing import Any

from fabrics.base.assumed_number import Assumed
from fabrics.base.checks import FilePath
from fabrics.base.files import read_data
from fabrics.base.units import si
from fabrics.families.strain_rate import RateLaw
from fabrics.families.trellis import Widths, from_weave
from fabrics.solid import SolidLaw
from fabrics.trellis import TrellisShear
from fabrics.weave import Weave
from fabrics.yarn import Yarn

__all__ = ["Entry", "Family", "entry", "find_family", "list_families"]

# the first that yarns belong to is theirs
FILES = ("para-aramid", "uhmwpe", "e-glass", "nylon", "polyester", "pbo", "carbon", "lcp")
_SHEAR = ("locking_share", "G1_over_G2", "gap", "K_s")
_SOLID = {"E_a": "Pa", "E_c": "Pa", "K_r": "", "K_G": "", "V_c": ""}
# the end of its range at which a value makes the fabric softer, other than the low one
_SOFT_AT_HIGH = ("gap", "V_c")


@dataclass(frozen=True)
class Entry:
    """One number of a family.

    Parameters
    ----------
    value, low, high : [SI] and the range in which it is taken to lie
    written : value and range as in the file
    source, status : where it comes from
    most : [SI] above which no range goes
    """

    value: float
    low: float
    high: float
    written: str
    source: str
    status: str
    most: float = inf

    @property
    def number(self) -> Assumed:
        """The value as a number that says that it is assumed, with its range."""
        return Assumed(self.value, self.low, self.high)

    def at(self, end: str, soft_at_high: bool) -> float:
        """Return the value [SI] at an end, "soft", "nominal" or "stiff"."""
        if end == "nominal":
            return self.value
        if (end == "soft") == soft_at_high:
            return self.high
        return self.low

    def widened(self, power: float) -> Entry:
        """Widen the range: low / value and high / value to a power; an entry without a range is
        returned as it is."""
        if self.low == self.high:
            return self
        low = min(self.value * (self.low / self.value) ** power, self.most)
        high = min(self.value * (self.high / self.value) ** power, self.most)
        value = self.written.partition(" (")[0]
        number, _, unit = value.partition(" ")
        ends = " .. ".join(
            f"{float(number) * end / self.value:.3g} {unit}".rstrip() for end in (low, high)
        )
        return replace(self, low=low, high=high, written=f"{value} ({ends})")


@dataclass(frozen=True)
class Family:
    """Default laws of the yarns of one kind of fibre.

    Parameters
    ----------
    name : such as "para-aramid"
    known_as : other names of such fibres, as users write them
    limits : {"modulus": (low, high) [Pa], "fibre_density": (low, high) [kg/m3]} of yarns that
        belong to it
    strengths : {"strength": (low, high) [Pa], "failure_strain": (low, high)} that such yarns may
        have
    entries : {dotted key: Entry} of [shear] and [solid]
    strain_rate : RateLaw, or None if no numbers are known
    typical : {"modulus", "fibre_density", "strength": row of the file} of a yarn whose sheet does not
        say it
    linear : whether such fibres are linear up to their strength
    shots : {name of an entry of data_sheet.toml: Entry in its place}
    power, of_others : [-] of the ranges (`Entry.widened`) of other yarns, and whether it stands for
        these
    """

    name: str
    limits: dict[str, tuple[float, float]]
    strengths: dict[str, tuple[float, float]]
    entries: dict[str, Entry]
    strain_rate: RateLaw | None = None
    typical: Mapping[str, dict[str, str]] = field(default_factory=dict)
    linear: bool = True
    known_as: tuple[str, ...] = ()
    shots: Mapping[str, Entry] = field(default_factory=dict)
    power: float = 1.0
    of_others: bool = False

    def for_other_yarns(self) -> Family:
        """Return this family with the wider ranges of yarns that do not belong to it."""
        entries = {key: entry.widened(self.power) for key, entry in self.entries.items()}
        return replace(self, entries=entries, of_others=True)

    def holds(self, yarn: Yarn) -> bool:
        """Tell whether a yarn belongs to the family, by modulus and fibre density."""
        return self.holds_fibre(yarn.E, yarn.fibre_density)

    def holds_fibre(self, modulus: float, fibre_density: float) -> bool:
        """Tell whether a fibre of modulus [Pa] and density [kg/m3] belongs to the family."""
        fibre = {"modulus": modulus, "fibre_density": fibre_density}
        return all(low <= fibre[key] <= high for key, (low, high) in self.limits.items())

    def allows(self, fibre: dict[str, float]) -> bool:
        """Tell whether {"strength": [Pa], "failure_strain": [-]} are those of such a yarn."""
        return all(low <= fibre[key] <= high for key, (low, high) in self.strengths.items())

    def _at(self, table, key, end):
        return self.entries[f"{table}.{key}"].at(end, key in _SOFT_AT_HIGH)

    def shear(
        self, weave: Weave, widths: Widths = (None, None), end: str = "nominal"
    ) -> TrellisShear:
        """Compute the trellis law of a weave of these yarns, or that of an end of its range.

        Parameters
        ----------
        weave : Weave
        widths : (warp, weft) [m] of the yarns if they are known; else they follow from `gap`
        end : "soft", "nominal" or "stiff"

        Raises
        ------
        InputError : the fabric has no thickness, since neither of its yarns is crimped
        """
        # a soft trellis locks late: yarns that pack densely, K_s high, become narrow
        numbers = {key: self._at("shear", key, end) for key in _SHEAR[:-1]}
        K_s = self.entries["shear.K_s"].at(end, soft_at_high=True)
        return from_weave(weave, widths, K_s=K_s, **numbers)

    def solid_laws(self, end: str = "nominal") -> tuple[SolidLaw, SolidLaw]:
        """Return the (warp, weft) solid laws, or those of an end of their range."""
        common = {key: self._at("solid", key, end) for key in _SOLID}
        warp = SolidLaw(**common, Vf0=self._at("solid.Vf0", "warp", end))
        weft = SolidLaw(**common, Vf0=self._at("solid.Vf0", "weft", end))
        return warp, weft

    def sources(self, table: str) -> dict[str, dict[str, str]]:
        """Collect the sources of "shear" or "solid" as `Fabric.sources` has them: {dotted key:
        {"value", "source", "status"}}."""
        if self.of_others:
            of = f"{self.name}, its range to the power {self.power:g} for another fibre"
        else:
            of = self.name
        sources = {}
        for key, entry in self.entries.items():
            if key == table or key.startswith(f"{table}."):
                source = f"{entry.source} ({of})"
                sources[key] = {"value": entry.written, "source": source, "status": entry.status}
        return sources


@cache
def list_families() -> tuple[Family, ...]:
    """Read all families."""
    return tuple(_read(Path(__file__).with_name(f"{name}.toml")) for name in FILES)


def find_family(text: str) -> Family | None:
    """Find the family of a name, or of another name of such fibres, in small or capital letters and
    with a type behind it, such as "kevlar 49"; None if there is none."""
    wanted = _bare(text)
    found = None
    longest = 0
    for family in list_families():
        for name in map(_bare, (family.name, *family.known_as)):
            # the longest: polyethylene terephthalate is not a polyethylene
            if wanted.startswith(name) and len(name) > longest:
                found = family
                longest = len(name)
    return found


def _bare(text):
    """A name without what is written in several ways."""
    return "".join(filter(str.isalnum, text.lower()))


def _read(path: FilePath) -> Family:
    content = read_data(path)
    units = {"modulus": "Pa", "fibre_density": "kg/m^3", "strength": "Pa", "failure_strain": ""}
    limits = {}
    for key, unit in units.items():
        row = content["yarns"][key]
        limits[key] = si(row["low"], unit), si(row["high"], unit)
    strengths = {key: limits.pop(key) for key in ("strength", "failure_strain")}
    Vf0 = content["solid"]["Vf0"]
    entries = {f"shear.{key}": entry(content["shear"][key], "") for key in _SHEAR}
    entries |= {f"solid.{key}": entry(content["solid"][key], unit) for key, unit in _SOLID.items()}
    entries |= {f"solid.Vf0.{family}": entry(Vf0[family], "") for family in ("warp", "weft")}
    rates = content.get("strain_rate")
    law = rates and RateLaw.from_table(rates, path)
    power = content["other_yarns"]["power"]["value"]
    shots = {name: entry(row, "") for name, row in content.get("shots", {}).items()}
    return Family(
        content["name"],
        limits,
        strengths,
        entries,
        strain_rate=law,
        typical=content["typical"],
        known_as=tuple(content["known_as"]),
        linear=content["yarns"].get("linear", True),
        shots=shots,
        power=power,
    )


def entry(table: dict[str, Any], unit: str) -> Entry:
    """Read an Entry from its table in a data file."""
    written = str(table["value"])
    if "low" in table:
        written += f" ({table['low']} .. {table['high']})"
    value, low, high = (
        si(table.get(key, table["value"]), unit) for key in ("value", "low", "high")
    )
    return Entry(
        value, low, high, written, table["source"], table["status"], table.get("most", inf)
    )


def entries(rows: dict[str, dict[str, Any]]) -> dict[str, Entry]:
    """Read tables of lengths and of numbers without a unit: {name: Entry}."""
    named = {}
    for name, row in rows.items():
        unit = ""
        if str(row["value"]).endswith("m"):
            unit = "m"
        named[name] = entry(row, unit)
    return named
