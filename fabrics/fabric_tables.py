"""Tables of a fabric file: every key with its units and bounds, an example and its meaning.

A number is written `{ value = "1420 denier", source = "...", status = "measured" }`, or just `"1420
denier"`; it is read as a `Datum`. With `low` and `high`, or as "1400 to 1440 denier" or "1420 denier ±
2 %" (`fabrics.base.range_texts`), it has a range. What lies outside the bounds is an error of the unit.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Annotated, Any, ClassVar

from pydantic import BeforeValidator, Discriminator, Field, Tag, model_validator

from fabrics.base import range_texts
from fabrics.base.errors import InputError, nearest, together
from fabrics.base.schema import Table, described, flag, one_of, string
from fabrics.base.units import example, in_one_of, si
from fabrics.pattern import ALLOWED, Pattern

# how a number of a fabric is known
STATUSES = ("measured", "computed", "fitted", "derived", "assumed", "corrected", "user")
OF_YARNS = ("modulus", "failure_strain", "strength", "tenacity", "crimp")
# numbers that may have a range
RANGED = (
    *OF_YARNS,
    "thickness",
    "areal_density",
    "failure_length",
    "G1",
    "G2",
    "gamma1",
    "gamma2",
    "E_a",
    "E_c",
    "K_r",
    "K_G",
    "V_c",
    "Vf0",
)
ENTRY = ("value", "low", "high", "source", "status")  # keys of a number
FAMILIES = ("warp", "weft")
# names of `fabrics.families`
FIBRES = ("para-aramid", "UHMWPE", "E-glass", "nylon", "polyester", "PBO", "carbon", "LCP")


@dataclass(frozen=True)
class Datum:
    """A number of a fabric file: value in the SI `unit`, text, where it comes from, ends of its
    range over it, and its standard deviation over it, 0 where any of the range is as likely."""

    value: float
    unit: str
    written: str
    source: str
    status: str
    sourced: bool = True
    ratios: tuple[float, float] | None = None
    deviation: float = 0.0

    @property
    def entry(self) -> dict[str, str]:
        """As `Fabric.sources` has it."""
        return {"value": self.written, "source": self.source, "status": self.status}


@dataclass(frozen=True)
class Quantity:
    """What a number of a fabric file may be.

    Parameters
    ----------
    bounds : {SI unit that a value converts to: lowest and highest value, such as "1 to 1000 GPa",
        or "" of a number that the law made from it checks}
    example, meaning : texts for messages and prompts
    """

    bounds: Mapping[str, str]
    example: str
    meaning: str

    def limits(self, unit: str) -> tuple[float, float]:
        """Return the (lowest, highest) value in the SI `unit`."""
        low, _, rest = self.bounds[unit].partition(" to ")
        return si(f"{low} {rest.partition(' ')[2]}", unit), si(rest, unit)

    def read(
        self, value: Any, *, key: str | None = None, idealised: bool = False
    ) -> tuple[float, str]:
        """Read a value as it is written: (number, its SI unit).

        Parameters
        ----------
        idealised : whether it may be out of bounds, with the sign that they have

        Raises
        ------
        InputError : no quantity of these units, or one out of bounds
        """
        number, unit = in_one_of(value, tuple(self.bounds), key=key)
        if self.bounds[unit]:
            low, high = self.limits(unit)
            has_sign = number > 0 or low == number == 0
            if not (low <= number <= high or (idealised and has_sign)):
                raise InputError(key=key, value=value, allowed=f"from {self.bounds[unit]}")
        return number, unit

    def takes(self, value: Any) -> bool:
        """Return whether a value has a unit of this number, within bounds or not."""
        try:
            in_one_of(value, tuple(self.bounds))
        except InputError:
            return False
        return True

    def datum(self, entry: Any, info: Any) -> Datum:
        """Return the Datum of an entry of a file, whose name is the source if the entry gives
        none."""
        sourced = isinstance(entry, dict) and bool(entry.get("source"))
        if not isinstance(entry, dict):
            entry = {"value": entry, "source": info.context["source"]}
        for key in sorted(set(entry) - set(ENTRY)):
            message, allowed = _unknown(nearest(key, ENTRY), ENTRY)
            raise InputError(message, key=key, allowed=allowed)
        status = entry.get("status", "user")
        if status not in STATUSES:
            raise InputError(key="status", value=status, allowed=f"one of {', '.join(STATUSES)}")
        idealised = info.context.get("idealised", False)
        written = str(entry.get("value"))
        as_range = range_texts.read(entry.get("value"))
        if as_range is not None:
            entry = {**entry, **as_range.texts}
        number, unit = self.read(entry.get("value"), idealised=idealised)
        ratios, deviation = None, 0.0
        if "low" in entry or "high" in entry:
            if info.field_name not in RANGED and as_range is not None:
                allowed = f"one value: only {', '.join(RANGED)} may have a range"
                raise InputError(value=written, allowed=allowed)
            if info.field_name not in RANGED:
                raise InputError(
                    key="low",
                    value=entry.get("low"),
                    allowed=f"left out, except of {', '.join(RANGED)}",
                )
            same = replace(self, bounds={unit: self.bounds[unit]})
            low, high = (
                same.read(entry.get(key), key=key, idealised=idealised)[0]
                for key in ("low", "high")
            )
            for key, fits in (("low", 0 < low <= number), ("high", high >= number)):
                if not fits:
                    allowed = "at least value"
                    if key == "low":
                        allowed = "above 0 and at most value"
                    raise InputError(
                        key=key, value=entry[key], allowed=f"{allowed}, {entry['value']}"
                    )
            ratios = low / number, high / number
            if as_range is None:
                written += f" ({entry['low']} .. {entry['high']})"
            elif as_range.deviations:
                deviation = (ratios[1] - 1) / as_range.deviations
        source = entry.get("source", "")
        return Datum(number, unit, written, source, status, sourced, ratios, deviation)


def _data(meaning, sample, bounds):
    """The type of a key that holds a Datum, `bounds` as in Quantity."""
    of = Quantity(bounds, sample, meaning)
    return Annotated[Any, of, BeforeValidator(of.datum), described(meaning, f'such as "{sample}"')]


def _number(meaning, unit):
    """The type of a key in SI `unit`, "" of a ratio, that the law made from it checks."""
    of = Quantity({unit: ""}, example(unit), meaning)
    allowed = 'a number, or a share such as "30 %"'
    if unit:
        allowed = f'such as "{of.example}"'
    return Annotated[Any, of, BeforeValidator(of.datum), described(meaning, allowed)]


def _angle(meaning):
    """Return the type of an angle, a number alone in radians, that the law made from it checks."""
    of = Quantity({"rad": "", "1": ""}, "0.2", meaning)
    allowed = 'a number in radians, or such as "12 deg"'
    return Annotated[Any, of, BeforeValidator(of.datum), described(meaning, allowed)]


def _unknown(near, keys):
    if near:
        return f'is not a known key, did you mean "{near}"?', None
    return "is not a known key", f"one of {', '.join(keys)}"


class DataTable(Table):
    """A table of a fabric file."""

    @classmethod
    def unknown(cls, key: str, near: str | None) -> tuple[str | None, str | None]:
        """Return the message of an unknown key, as `Table.unknown` does."""
        return _unknown(near, cls.model_fields)

    @classmethod
    def quantities(cls) -> dict[str, Quantity]:
        """Return the numbers of the table: {key: Quantity}."""
        parts = ((key, part) for key, field in cls.model_fields.items() for part in field.metadata)
        return {key: part for key, part in parts if isinstance(part, Quantity)}

    def data(self, prefix: str = "") -> dict[str, Datum]:
        """Collect all numbers of the table and of those in it: {dotted key: Datum}."""
        numbers = {}
        for key, value in self:
            if isinstance(value, Datum):
                numbers[prefix + key] = value
            elif isinstance(value, DataTable):
                numbers |= value.data(f"{prefix}{key}.")
        return numbers


class YarnTable(DataTable):
    """A yarn family, [warp] or [weft]."""

    synonyms: ClassVar = {
        "density": "fibre_density",
        "youngs_modulus": "modulus",
        "denier": "linear_density",
        "dtex": "linear_density",
        "ends": "count",
        "picks": "count",
        "elongation": "failure_strain",
    }

    fibre_density: _data("density of the fibre", "1.44 g/cm^3", {"kg/m^3": "0.5 to 23 g/cm^3"})
    modulus: _data(
        "axial modulus of the fibre",
        "90 GPa",
        {"Pa": "1 to 1000 GPa", "N/(kg/m)": "0.5 to 500 N/tex"},
    )
    linear_density: _data(
        "mass per length of the yarn; needed without axial_stiffness",
        "1100 dtex",
        {"kg/m": "5 to 100000 dtex"},
    ) = None
    effective_linear_density: _data(
        "linear density that gives the areal density of the published runs",
        "1100 dtex",
        {"kg/m": "5 to 100000 dtex"},
    ) = None
    failure_strain: _data(
        "failure strain of the fibre; needed without strength and tenacity",
        "3.3 %",
        {"": "0.1 to 50 %"},
    ) = None
    crimp: _data(
        "yarn length over length of fabric, minus one; needed without thickness",
        "1.2 %",
        {"": "0 to 50 %"},
    ) = None
    count: _data("yarns per width of fabric", "8.5 / cm", {"1/m": "0.5 to 100 / cm"})
    strength: _data(
        "of one yarn, or a stress of the fibre",
        "220 N",
        {"N": "0.1 to 100000 N", "Pa": "0.1 to 20 GPa"},
    ) = None
    tenacity: _data(
        "strength over linear density", "2350 mN/tex", {"N/(kg/m)": "0.05 to 10 N/tex"}
    ) = None
    width: _data(
        "width of the yarn in the fabric, across its family", "1.1 mm", {"m": "0.02 to 20 mm"}
    ) = None
    section_area: _data(
        "area of the yarn's section", "0.11 mm^2", {"m^2": "0.0001 to 100 mm^2"}
    ) = None
    axial_stiffness: _data(
        "force per strain of a yarn, in place of linear_density",
        "38000 N",
        {"N": "1 to 10000000 N"},
    ) = None

    @model_validator(mode="after")
    def _of_one_mass_and_one_strength(self):
        if self.axial_stiffness is not None:
            self.refuse(
                "linear_density effective_linear_density", "left out beside axial_stiffness"
            )
        elif self.linear_density is None:
            raise self._missing("linear_density")
        if self.strength is not None and self.tenacity is not None:
            raise InputError("give strength or tenacity, which are the same", key="tenacity")
        if self.strength is self.tenacity is self.failure_strain is None:
            raise self._missing("failure_strain")
        return self

    def _missing(self, key):
        return InputError("is missing", key=key, allowed=type(self).model_fields[key].description)


class LawTable(DataTable):
    """The compression law of both families, or of one (thesis eq. 4-12)."""

    a: _number("compression law", "m")
    b: _number("compression law", "m * N**(1/3)")
    form: string("form of the law", "a text") = "regularised"


class ShearTable(DataTable):
    """The trellis law (thesis eq. 4-35)."""

    G1: _number("tangent shear modulus before parallel yarns touch", "Pa")
    G2: _number("tangent shear modulus after locking", "Pa")
    gamma1: _angle("shear angle in radians at which parallel yarns touch")
    gamma2: _angle("shear angle in radians of locking")


class SolidTable(DataTable):
    """The yarn as a solid, of both families or of one."""

    E_a: _number("axial modulus of the solid; the fibre bars carry the tension", "Pa")
    E_c: _number("transverse modulus of the packed yarn", "Pa")
    K_r: _number("share of E_c in a loose yarn", "")
    K_G: _number("shear modulus over E_c / 2", "")
    V_c: _number("fibre volume fraction at which the yarn is packed", "")
    Vf0: _number("fibre volume fraction at rest", "")


class MicrographTable(DataTable):
    """What a micrograph of a section shows."""

    width: _number("width of the yarn", "m")
    thickness: _number("section of the yarn in a micrograph", "m")
    crossing_thickness: _number("thickness of the yarn at a crossover", "m")
    total_thickness: _number("thickness of the fabric at a crossover", "m")
    count: _number("yarns per width of fabric", "1/m")
    crimp: _number("length of the yarn over length of the fabric, minus one", "")
    void: _number("share of voids in the cell", "")


def _keys(kind):
    return f"a table with {', '.join(key for key in kind.model_fields if key != 'form')}"


def _table(kind):
    """The type of a table that may be left out."""
    return Annotated[kind | None, Field(description=_keys(kind))]


def _yarn(family):
    """The type of the table of a family, which messages write as a heading."""
    return Annotated[
        YarnTable,
        Field(
            description="a table with the yarn's data", json_schema_extra={"heading": f"[{family}]"}
        ),
    ]


class Laws(DataTable):
    """A compression law of each family."""

    warp: LawTable
    weft: LawTable


class Solids(DataTable):
    """A solid law of each family."""

    warp: SolidTable
    weft: SolidTable


class Micrographs(DataTable):
    """Micrographs of the families."""

    warp: _table(MicrographTable) = None
    weft: _table(MicrographTable) = None


def _of_both(value):
    if isinstance(value, dict) and {"warp", "weft"} & set(value):
        return "pair"
    return "inline"


def _both(table, pair):
    """The type of a table for both yarns, or of one each under warp and weft."""
    kinds = Annotated[table, Tag("inline")] | Annotated[pair, Tag("pair")]
    return Annotated[
        Annotated[kinds, Discriminator(_of_both)] | None, Field(description=_keys(table))
    ]


def _weave():
    """The type of the weave, which is read by a maker's name too."""
    meaning = "which yarn is on top at each crossing; assumed plain if left out"
    return Annotated[Any, BeforeValidator(_pattern), described(meaning, ALLOWED, example="plain")]


def _pattern(value):
    if isinstance(value, str):
        return Pattern.read(value)
    raise InputError(value=value, allowed=ALLOWED)


class FabricFile(DataTable):
    """A fabric file. [ply_contact] and [strain_rate] are read by the laws themselves."""

    name: string("name of the fabric", "a text") = None
    weave: _weave() = None
    section: string("shape of the yarns' sections in the 3D crossover", "a text") = None
    interlayer_gap: _data(
        "approach of neighbouring plies of a pack in a test up to 19.4 MPa",
        "0.1 mm",
        {"m": "0 to 5 mm"},
    ) = None
    areal_density: _data(
        "of the data sheet; checked against counts, linear densities and crimp; a missing crimp of a weave "
        "with floats, or without a thickness, is computed from it",
        "200 g/m^2",
        {"kg/m^2": "5 to 5000 g/m^2"},
    ) = None
    areal_density_measured: _data(
        "of Kevlar 129, for the pressure law between platens",
        "200 g/m^2",
        {"kg/m^2": "5 to 5000 g/m^2"},
    ) = None
    thickness: _data(
        "of the data sheet; a missing crimp is computed from it",
        "0.30 mm",
        {"m": "0.02 to 5 mm"},
    ) = None
    failure_length: _data(
        "half width, across the fibres, of the mean of the tension that fails a yarn",
        "0.75 mm",
        {"m": "0.01 to 10 mm"},
    ) = None
    gauge_length: _data(
        "length of the yarns whose strength is stated; yarns that are longer in the panel are weaker",
        "250 mm",
        {"m": "0.1 to 100000 mm"},
    ) = None
    weibull_shape: _data(
        "shape of the Weibull distribution of the yarns' strengths, which says how much weaker",
        "14.3",
        {"": "1 to 1000"},
    ) = None
    family: one_of(
        "fibre family whose laws are assumed; with wider ranges if modulus and fibre density are of another fibre",
        *FIBRES,
    ) = None
    idealised: flag(
        "whether numbers beyond the plausible are meant: they are taken, and each result names them"
    ) = False
    warp: _yarn("warp")
    weft: _yarn("weft")
    compression: _both(LawTable, Laws) = None
    shear: _table(ShearTable) = None
    ply_contact: Any = None
    solid: _both(SolidTable, Solids) = None
    micrograph: _table(Micrographs) = None
    strain_rate: Any = None

    @property
    def yarns(self) -> dict[str, YarnTable]:
        """{"warp", "weft": its table}"""
        return {family: getattr(self, family) for family in FAMILIES}

    @model_validator(mode="after")
    def _of_known_crimp(self):
        missing = [f"{family}.crimp" for family, yarn in self.yarns.items() if yarn.crimp is None]
        if missing and self.thickness is None and self.areal_density is None:
            allowed = (
                'given, such as "1.2 %", or computed: give thickness, such as "0.3 mm", or areal_density, '
                "above [warp]"
            )
            raise together([InputError("is missing", key=key, allowed=allowed) for key in missing])
        return self


# of a data sheet
OF_YARN = YarnTable.quantities()
OF_FABRIC = FabricFile.quantities()
for _key in ("effective_linear_density", "axial_stiffness"):
    del OF_YARN[_key]
del OF_FABRIC["areal_density_measured"]
