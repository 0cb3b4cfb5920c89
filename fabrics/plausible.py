"""Plausible ranges: what the numbers of a fabric, of a law and of a block are compared with.

`plausible.toml` holds all ranges. A number, or the dimensionless group that it belongs to, is noted
at an end of its range or beyond it, and refused beyond `least` or `most`, by default ten times
outside. Of a fabric that says `idealised = true` none is refused: all that is outside is one of its
assumptions (`fabrics.assumed`). The schema of a fabric file (`fabrics.fabric_tables`) says what a key may be at all;
`fabrics.data_sheet` finds numbers of one file that contradict each other.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fabrics.base.assumed_number import is_assumed
from fabrics.base.checks import FilePath
from fabrics.base.errors import AS_WRITTEN, InputError
from fabrics.base.files import read_data
from fabrics.base.units import NUMBER, si
from fabrics.data_sheet import FROM_MASS, FROM_THICKNESS
from fabrics.families import find_family

if TYPE_CHECKING:
    from fabrics.compression import CompressionLaw
    from fabrics.fabric import Fabric
    from fabrics.materials import Isotropic
    from fabrics.trellis import TrellisShear

_FAMILIES = ("warp", "weft")
_GLASS = "E-glass"
# a number so many times outside of its range is refused, unless its row says otherwise
REFUSED = 10.0
# [-] a tenth of a number in decimals may lie this much above the end of a range
_ROUNDING = 1e-9


@dataclass(frozen=True)
class PlausibleRange:
    """A row of `plausible.toml`, its numbers in SI units.

    Parameters
    ----------
    of : what the number is, in words
    low, high : ends of the open range that is plausible
    least, most : ends of what is not refused
    shown : unit that a reader sees, "" of a ratio
    factor : SI value of one such unit
    source : of the range
    """

    of: str
    low: float
    high: float
    least: float
    most: float
    shown: str
    factor: float
    source: str

    @classmethod
    def read(cls, entry: Mapping[str, Any]) -> PlausibleRange:
        """Make the row of a table of the file."""
        unit = entry.get("unit", "")
        ends = {
            key: si(entry[key], unit) for key in ("low", "high", "least", "most") if key in entry
        }
        ends.setdefault("least", ends["low"] / REFUSED)
        ends.setdefault("most", ends["high"] * REFUSED)
        shown = NUMBER.sub("", str(entry["high"]), count=1).strip()
        factor = 1.0
        if shown:
            factor = si(f"1 {shown}", unit)
        return cls(of=entry["of"], shown=shown, factor=factor, source=entry["source"], **ends)

    def holds(self, value: float) -> bool:
        """Tell whether a value is inside the range, and not at an end of it."""
        return self.low * (1 + _ROUNDING) < value < self.high * (1 - _ROUNDING)

    def allows(self, value: float) -> bool:
        """Tell whether a value is not refused."""
        return self.least <= value <= self.most

    def words(self, value: float) -> str:
        """Say what a number is, its value and its range."""
        number = f"{value / self.factor:.3g} {self.shown}".strip()
        high = f"{self.high / self.factor:.4g} {self.shown}".strip()
        if self.low < 0:
            return f"{self.of} is {number}, plausible is below {high}"
        return f"{self.of} is {number}, plausible is {self.low / self.factor:.4g} to {high}"


@dataclass(frozen=True)
class Number:
    """A number of an input that is compared with a row.

    Parameters
    ----------
    key : of the number in the input, or of that which decides a group
    row : name of the row in `plausible.toml`
    value : of the number or the group, in the SI unit of the row
    taken : whether it is noted, and never refused: it is measured by an idealised fabric, or by one
        that Python has changed
    """

    key: str
    row: str
    value: float
    taken: bool = False


@cache
def rows() -> dict[str, PlausibleRange]:
    """Read `plausible.toml`: {name: PlausibleRange}."""
    content = read_data(Path(__file__).with_suffix(".toml"))
    return {name: PlausibleRange.read(entry) for name, entry in content.items()}


def judge(
    numbers: Iterable[Number], *, file: FilePath | None = None, curve: FilePath | None = None
) -> tuple[str, ...]:
    """Compare numbers with their rows.

    Parameters
    ----------
    file : that they are read from, named in errors
    curve : that the numbers are fitted to, in place of a file that states them

    Returns
    -------
    notes : a line about each number outside of its range; keys of which the same is to be said
        share one

    Raises
    ------
    InputError : a number so far outside that it is refused
    """
    said: dict[str, list[str]] = {}
    for number in numbers:
        row = rows()[number.row]
        if row.holds(number.value):
            continue
        words = row.words(number.value)
        if not number.taken and not row.allows(number.value):
            message = f"{words}: check value and unit ({row.source})"
            if curve is not None:
                raise InputError(f"{number.key} is fitted to this curve: {message}", file=curve)
            raise InputError(message, key=number.key, value=AS_WRITTEN, file=file)
        said.setdefault(words, []).append(number.key)
    return tuple(f"{' and '.join(keys)}: {words}" for words, keys in said.items())


def of_fabric(fabric: Fabric, taken: bool = False) -> list[Number]:
    """List the numbers of a fabric that its file gives, with the groups they belong to.

    Parameters
    ----------
    taken : whether none is refused, as of an idealised fabric
    """
    numbers = [*_of_yarns(fabric), *_of_weave(fabric), *_of_lengths(fabric)]
    numbers += _of_micrographs(fabric)
    if fabric.laws is not None:
        numbers += of_laws(fabric.laws, fabric, "compression")
    if fabric.shear is not None and "shear" not in fabric.assumed:
        numbers += of_shear(fabric.shear, fabric)
    if fabric.solid_laws is not None and "solid" not in fabric.assumed:
        for family, law in zip(_FAMILIES, fabric.solid_laws):
            where = _where(fabric, "solid", family)
            glass = find_family(_GLASS)
            of_glass = glass is not None and all(map(glass.holds, fabric.weave.yarns))
            rows_of = {"K_r": "K_r_of_glass"} if of_glass else {}
            numbers += [
                Number(f"{where}.{name}", rows_of.get(name, name), value)
                for name, value in vars(law).items()
            ]
    if fabric.strain_rate is not None and "strain_rate" not in fabric.assumed:
        numbers += _of_rates(fabric.strain_rate)
    if fabric.ply_contact is not None:
        numbers += _of_ply_contact(fabric)
    return [replace(number, taken=taken or fabric.idealised) for number in numbers]


def _of_yarns(fabric):
    for family, yarn in zip(_FAMILIES, fabric.weave.yarns):
        strength = "failure_strain"
        for key in ("strength", "tenacity"):
            if f"{family}.{key}" in fabric.sources:
                strength = key
        yield Number(f"{family}.fibre_density", "fibre_density", yarn.fibre_density)
        yield Number(f"{family}.modulus", "wave_speed", yarn.wave_speed)
        yield Number(f"{family}.failure_strain", "failure_strain", yarn.failure_strain)
        yield Number(f"{family}.{strength}", "strength", yarn.E * yarn.failure_strain)
        # a straight yarn is meant to be straight
        if yarn.crimp > 0:
            yield _crimp(fabric, family, yarn)


def _crimp(fabric, family, yarn):
    """The crimp of a yarn, which may have been computed from areal density or thickness."""
    key = f"{family}.crimp"
    source = fabric.sources.get(key, {}).get("source")
    if source == FROM_MASS:
        return Number("areal_density", "crimp_of_mass", yarn.crimp)
    if source == FROM_THICKNESS:
        return Number("thickness", "crimp_of_thickness", yarn.crimp)
    return Number(key, "crimp", yarn.crimp)


def _of_weave(fabric):
    weave = fabric.weave
    if not weave.thickness > 0:
        return
    mass_key = "linear_density"
    if "warp.axial_stiffness" in fabric.sources:
        mass_key = "axial_stiffness"
    shares = []
    for yarn, count in zip(weave.yarns, (weave.warp_count, weave.weft_count)):
        shares.append(yarn.A_s * count * (1 + yarn.crimp) / weave.thickness)
    yield Number(f"warp.{mass_key}", "fibre_share", sum(shares))
    for family, share in zip(_FAMILIES, shares):
        yield Number(f"{family}.{mass_key}", "yarn_share", share)
    thickness_key = "thickness"
    if fabric.thickness is None:
        thickness_key = "warp.crimp"
    # the range is of plain weaves; yarns that float on leave room for thicker ones
    if weave.pattern.is_plain:
        spacing = 0.5 * sum(2 * half for half in weave.w)
        yield Number(thickness_key, "slenderness", weave.thickness / spacing)
    if all(yarn.crimp > 0 for yarn in weave.yarns):
        yield Number("warp.crimp", "warp_share", weave.h01 / sum(weave.h0))


def _of_lengths(fabric):
    weave = fabric.weave
    effective = fabric.effective_linear_density or ()
    for family, yarn, density in zip(_FAMILIES, weave.yarns, effective):
        ratio = density / yarn.linear_density
        yield Number(f"{family}.effective_linear_density", "effective_linear_density", ratio)
    spacings = (1 / weave.warp_count, 1 / weave.weft_count)
    for family, yarn, width, area, spacing in zip(
        _FAMILIES, weave.yarns, fabric.yarn_width, fabric.yarn_area, spacings
    ):
        if width is not None:
            yield Number(f"{family}.width", "width", width / spacing)
        if area is not None:
            yield Number(f"{family}.section_area", "packing", yarn.A_s / area)
    if "failure_length" not in fabric.assumed:
        ratio = fabric.failure_length / min(spacings)
        yield Number("failure_length", "failure_length", ratio)
    for key in ("gauge_length", "weibull_shape"):
        own = getattr(fabric, key)
        if not is_assumed(own):
            yield Number(key, key, own)
    if fabric.interlayer_gap and weave.thickness > 0:
        ratio = fabric.interlayer_gap / weave.thickness
        yield Number("interlayer_gap", "interlayer_gap", ratio)


def _of_micrographs(fabric):
    weave = fabric.weave
    counts = {"warp": weave.warp_count, "weft": weave.weft_count}
    for family, table in fabric.micrograph.items():
        for name, value in table.items():
            if name == "width":
                value *= counts[family]
            elif name == "count":
                value /= counts[family]
            elif name.endswith("thickness"):
                value /= weave.thickness
            yield Number(f"micrograph.{family}.{name}", f"micrograph_{name}", value)


def of_laws(laws: Iterable[CompressionLaw], fabric: Fabric, key: str) -> Iterator[Number]:
    """List the numbers of compression laws of warp and weft that stand under `key`."""
    thickness = fabric.weave.thickness
    if not thickness > 0:
        return
    for family, yarn, law in zip(_FAMILIES, fabric.weave.yarns, laws):
        # a yarn that cannot be compressed has a = b = 0
        if law.a > 0:
            where = _where(fabric, key, family)
            yield Number(f"{where}.a", "a", law.a / thickness, fabric.idealised)
            yield Number(f"{where}.b", "b", law.F0 / yarn.strength, fabric.idealised)


def of_shear(law: TrellisShear, fabric: Fabric) -> Iterator[Number]:
    """List the numbers of the trellis law of a fabric."""
    weave = fabric.weave
    yarn = weave.warp
    section = weave.thickness / weave.warp_count
    if section > 0:
        yield Number("shear.G1", "G1", law.G1 * section / yarn.EA, fabric.idealised)
        yield Number("shear.G2", "G2", law.G2 * section / yarn.EA, fabric.idealised)
    yield Number("shear.G2", "G1_over_G2", law.G1 / law.G2, fabric.idealised)
    yield Number("shear.gamma1", "gamma1", law.gamma1, fabric.idealised)
    yield Number("shear.gamma2", "gamma2", law.gamma2, fabric.idealised)


def _where(fabric, key, family):
    """The table of a law of both families, or of one."""
    if any(name.startswith(f"{key}.{family}.") for name in fabric.sources):
        return f"{key}.{family}"
    return key


def _of_rates(law):
    for rate in law.rates:
        yield Number("strain_rate.rates", "strain_rate", rate)
    for ratio in law.strength:
        yield Number("strain_rate.strength", "rate_strength", ratio)
    for ratio in law.modulus:
        yield Number("strain_rate.modulus", "rate_modulus", ratio)


def _of_ply_contact(fabric):
    law = fabric.ply_contact
    if fabric.weave.thickness > 0:
        ratio = law.travel / fabric.weave.thickness
        yield Number("ply_contact.closure", "ply_contact_travel", ratio)
    yield Number("ply_contact.pressure", "ply_contact_pressure", float(law.pressure[-1]))


def of_block(material: Isotropic) -> Iterator[Number]:
    """List the numbers of the material of a block."""
    yield Number("backing.density", "block_density", material.density)
    yield Number("backing.modulus", "block_modulus", material.modulus)
    yield Number("backing.poisson", "block_poisson", material.poisson)
    ratio = material.yield_stress / material.modulus
    # an elastic block never yields
    if ratio < float("inf"):
        yield Number("backing.yield_stress", "block_yield_strain", ratio)
    ratio = material.hardening / material.modulus
    yield Number("backing.hardening", "block_hardening", ratio)
    yield Number("backing.rate_exponent", "block_rate_exponent", material.rate_exponent)


def noted(
    fabric: Fabric, numbers: Iterable[Number] | None = None, *, file: FilePath | None = None
) -> Fabric:
    """Return the fabric with a note about each number that is not plausible.

    Parameters
    ----------
    numbers : that are judged; None takes those of the fabric, of which one that is idealised says
        itself (`fabrics.assumed.lines`)
    file : that they are read from, named in errors

    Raises
    ------
    InputError : as `judge`
    """
    if numbers is None and fabric.idealised:
        return fabric
    if numbers is None:
        numbers = of_fabric(fabric)
    found = [f"note: {note}" for note in judge(numbers, file=file)]
    return replace(fabric, notes=tuple(dict.fromkeys((*fabric.notes, *found))))
