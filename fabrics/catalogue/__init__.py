"""The catalogue: fabrics as data files, one TOML file each, every number with its unit, source and status.

A number is written `{ value = "1420 denier", source = "...", status = "measured" }`, or just `"1420 denier"` in a
user's own file. What data sheets state is enough: strength or tenacity in place of the failure strain, the thickness of
the fabric in place of crimps (`fabrics.data_sheet`). Statuses: measured, computed, fitted, derived, assumed, corrected
(a misprint of the thesis, put right) and user.
"""

from __future__ import annotations

import difflib
import tomllib
from dataclasses import replace
from functools import cache, partial
from pathlib import Path

from fabrics.checks import FilePath
from fabrics.compression import CompressionLaw
from fabrics.data_sheet import (
    FAMILIES,
    FROM_THICKNESS,
    OF_YARN,
    QUANTITIES,
    crimps,
    mass_note,
    strain_at_strength,
    strength_note,
    thickness_note,
)
from fabrics.errors import InputError, together
from fabrics.fabric import Fabric
from fabrics.families.strain_rate import RateLaw
from fabrics.ply_law import STATUSES, PlyLaw
from fabrics.solid import SolidLaw
from fabrics.trellis import TrellisShear
from fabrics.units import example, si
from fabrics.weave import Weave
from fabrics.yarn import CLOSEST_PACKING, Yarn

_FOLDER = Path(__file__).parent

_TOP = (
    "name", "section", "interlayer_gap", "areal_density", "areal_density_measured", "thickness",
)  # fmt: skip
_TABLES = ("warp", "weft", "compression", "shear", "ply_contact", "solid", "micrograph", "strain_rate")
_MASS = ("linear_density", "effective_linear_density")
_LAW = {"a": "m", "b": "m * N**(1/3)"}
_SHEAR = {"G1": "Pa", "G2": "Pa", "gamma1": "", "gamma2": ""}
_SOLID = {"E_a": "Pa", "E_c": "Pa", "K_r": "", "K_G": "", "V_c": "", "Vf0": ""}
_MICROGRAPH = {
    "width": "m",
    "thickness": "m",
    "crossing_thickness": "m",
    "total_thickness": "m",
    "count": "1/m",
    "crimp": "",
    "void": "",
}


@cache
def list_names() -> tuple[str, ...]:
    """Names of the fabrics in the catalogue, sorted."""
    return tuple(sorted(path.stem for path in _FOLDER.glob("*.toml")))


def load(name_or_path: FilePath) -> Fabric:
    """Load a fabric of the catalogue by name, or a user's fabric file by path (it ends in .toml).

    Parameters
    ----------
    name_or_path : name of the catalogue, or path of a .toml file

    Raises
    ------
    InputError : no such fabric or file, or the file is wrong: one line naming the file, key, value and what is allowed
    """
    text = str(name_or_path)
    if text in list_names():
        return read(_FOLDER / f"{text}.toml")
    if not text.endswith(".toml"):
        raise InputError(
            key="fabric", value=text, allowed=f"one of {', '.join(list_names())}, or the path of a .toml file"
        )
    return read(Path(text))


def read(path: FilePath, text: str | None = None) -> Fabric:
    """Read one fabric file, or the `text` that is to become one.

    Raises
    ------
    InputError : as `load`; all that is wrong with the file, one line each
    """
    return _Reader(Path(path), text).fabric()


class _Reader:
    """Takes the values of one file, in SI, and remembers where each came from; collects all that is wrong with it."""

    def __init__(self, path, text=None):
        self.path, self.sources, self.problems, self.notes = path, {}, [], []
        self.strengths = {}  # {what is to be said of a strength: [families]}
        self.meant = set()  # keys that a mistyped one is taken for: that these are missing is not reported again
        try:
            self.content = tomllib.loads(path.read_text(encoding="utf-8") if text is None else text)
        except OSError as problem:
            raise InputError(f"cannot be read ({problem.strerror})", file=path) from problem
        except (tomllib.TOMLDecodeError, UnicodeDecodeError) as problem:
            raise InputError(f"is not TOML: {problem}", file=path) from problem

    def fabric(self) -> Fabric:
        self._known(self.content, (*_TOP, *_TABLES), "")
        tables = {f: self._has(f) and self._known(self._find(f), self._keys(f), f) for f in FAMILIES}
        thickness, areal_density = (self._quantity(key, True)[0] for key in ("thickness", "areal_density"))
        weave, made_crimp = self._weave(thickness, tables)
        self.notes += [f"note: {' and '.join(names)}: {text}" for text, names in self.strengths.items() if text]
        if weave is not None:
            self.notes += self._try(thickness_note, weave, thickness) or [] if thickness else []
            self.notes += self._try(mass_note, weave.areal_density, areal_density) or [] if areal_density else []
        effective = [self._quantity(f"{f}.effective_linear_density", True)[0] for f in FAMILIES]
        warp_width, weft_width = (self._quantity(f"{f}.width", True)[0] for f in FAMILIES)
        warp_area, weft_area = (self._area(f, weave) for f in FAMILIES)
        values = {
            "name": self._text("name", self.path.stem),
            "laws": self._pair("compression", self._law),
            "shear": self._shear(),
            "solid_laws": self._solids(),
            "section": self._text("section", None),
            "areal_density_measured": self._quantity("areal_density_measured", True)[0],
            "interlayer_gap": self._quantity("interlayer_gap", True)[0],
            "effective_linear_density": tuple(effective) if None not in effective else None,
            "micrograph": self._micrograph(),
            "sources": self.sources,
            "assumed": ("crimp",) if made_crimp else (),
            "yarn_width": (warp_width, weft_width),
            "yarn_area": (warp_area, weft_area),
            "thickness": thickness,
            "strain_rate": self._rate_law(),
            "notes": tuple(self.notes),
        }
        fabric = self._build(Fabric, "", weave=weave, **values)
        if self.problems:
            raise together(self.problems)
        if not self._has("ply_contact"):
            return fabric
        law = PlyLaw.from_table(self._find("ply_contact"), fabric, self.path)
        self.sources["ply_contact"] = {"value": law.words(), "source": law.source, "status": law.status}
        return replace(fabric, ply_contact=law)

    def _keys(self, family):
        """The keys that the table of a yarn may have."""
        mass = ("axial_stiffness",) if self._has(f"{family}.axial_stiffness") else _MASS
        return (*(key for key in OF_YARN if key not in _MASS), *mass)

    def _weave(self, thickness, tables):
        """The Weave, or None where a value of it is wrong; and whether a crimp was computed from the thickness."""
        for family in FAMILIES:
            if not self._has(family):
                allowed = "a table with the yarn's data"
                self.problems.append(InputError("is missing", file=self.path, key=f"[{family}]", allowed=allowed))
        counts = [self._quantity(f"{family}.count")[0] if tables[family] else None for family in FAMILIES]
        known = [self._quantity(f"{family}.crimp", True)[0] for family in FAMILIES]
        wrong = [self._has(f"{family}.crimp") and crimp is None for family, crimp in zip(FAMILIES, known)]
        open_ = [family for family in FAMILIES if tables[family] and not self._has(f"{family}.crimp")]
        crimp = known
        if open_ and thickness and None not in counts and not any(wrong):
            cells = 0.5 / counts[1], 0.5 / counts[0]  # half cell lengths along warp and weft
            crimp = self._try(crimps, cells, thickness, tuple(known)) or (None, None)
            for family, value in zip(FAMILIES, crimp):
                if family in open_ and value is not None:
                    entry = {"value": f"{100 * value:.3f} %", "source": FROM_THICKNESS, "status": "derived"}
                    self.sources[f"{family}.crimp"] = entry
        elif open_ and not self._has("thickness") and "thickness" not in self.meant:
            allowed = 'given, such as "1.2 %", or computed: give thickness, such as "0.3 mm", above [warp]'
            self.problems += [
                InputError("is missing", file=self.path, key=f"{family}.crimp", allowed=allowed)
                for family in open_ if f"{family}.crimp" not in self.meant
            ]  # fmt: skip
        warp, weft = (self._yarn(f, value) if tables[f] else None for f, value in zip(FAMILIES, crimp))
        return self._build(Weave, "", warp, weft, *counts), bool(open_)

    def _yarn(self, family, crimp):
        """The Yarn of a family, or None where a value of it is wrong."""
        stiffness = self._has(f"{family}.axial_stiffness")
        fibre_density, _ = self._quantity(f"{family}.fibre_density")
        E, unit = self._quantity(f"{family}.modulus")
        if None not in (E, fibre_density):
            E *= 1.0 if unit == "Pa" else fibre_density
        linear_density, _ = self._quantity(f"{family}.{'axial_stiffness' if stiffness else 'linear_density'}")
        if stiffness and None not in (linear_density, E, fibre_density):
            linear_density *= fibre_density / E
        given = [key for key in ("strength", "tenacity") if self._has(f"{family}.{key}")]
        strain, _ = self._quantity(f"{family}.failure_strain", bool(given))
        if not given:
            return self._build(Yarn, family, linear_density, fibre_density, E, strain, crimp)
        if len(given) == 2:
            self.problems.append(
                InputError("give strength or tenacity, which are the same", file=self.path, key=f"{family}.tenacity")
            )
        strength, unit = self._quantity(f"{family}.{given[0]}")
        if None in (strength, linear_density, fibre_density, E):
            return None
        reached = strain_at_strength(strength, unit, linear_density, fibre_density, E)
        written, strains = self.sources[f"{family}.{given[0]}"]["value"], OF_YARN["failure_strain"]
        low, high = strains.limits("")
        if not low <= reached <= high:
            allowed = (
                f"a strength that this modulus reaches at a strain from {strains.bounds['']}, not {100 * reached:.3g} %"
            )
            key = f"{family}.{given[0]}"
            self.problems.append(InputError(file=self.path, key=key, value=written, allowed=allowed))
            return None
        yarn = self._build(Yarn, family, linear_density, fibre_density, E, reached, crimp)
        if yarn is not None:
            self.strengths.setdefault(strength_note(yarn, strain, written), []).append(family)
        return yarn

    def _area(self, family, weave):
        """[m2] of a yarn's section, which has room for its fibres, or None."""
        key = f"{family}.section_area"
        area, _ = self._quantity(key, True)
        least = 0.0 if weave is None else getattr(weave, family).A_s / CLOSEST_PACKING
        if area is not None and area < least:
            allowed = f"at least {1e6 * least:.4g} mm^2, which the fibres of linear_density take when closest packed"
            self.problems.append(InputError(file=self.path, key=key, value=self.sources[key]["value"], allowed=allowed))
        return area

    def _try(self, function, *args):
        """What a function returns, or None where it raises an InputError, which is kept with the file's name."""
        try:
            return function(*args)
        except InputError as problem:
            if problem.file is None:
                value = self.sources.get(problem.key, {}).get("value", problem.value)
                problem = InputError(file=self.path, key=problem.key, value=value, allowed=problem.allowed)
            self.problems.append(problem)
            return None

    def _law(self, key):
        a, b = self._table(key, _LAW, ("form",))
        return self._build(CompressionLaw, key, a, b, self._text(f"{key}.form", "regularised"), f"{self.path.name}")

    def _shear(self):
        return self._build(TrellisShear, "shear", *self._table("shear", _SHEAR)) if self._has("shear") else None

    def _rate_law(self):
        """The RateLaw of the file, or None; its status is one of STATUSES."""
        if not self._has("strain_rate"):
            return None
        try:
            law = RateLaw.from_table(self._find("strain_rate"), self.path)
            if law.status not in STATUSES:
                allowed = f"one of {', '.join(STATUSES)}"
                raise InputError(file=self.path, key="strain_rate.status", value=law.status, allowed=allowed)
        except InputError as problem:
            self.problems.append(problem)
            return None
        self.sources |= law.sources()
        return law

    def _solids(self):
        return self._pair("solid", lambda key: self._build(SolidLaw, key, *self._table(key, _SOLID)))

    def _pair(self, key, build):
        """A table for both yarns, or one each under `.warp` and `.weft`; None where the file has none."""
        if not self._has(key):
            return None
        if not (self._has(f"{key}.warp") or self._has(f"{key}.weft")):
            both = build(key)
            return both, both
        self._known(self._find(key), ("warp", "weft"), key)
        return build(f"{key}.warp"), build(f"{key}.weft")

    def _micrograph(self):
        families = [family for family in ("warp", "weft") if self._has(f"micrograph.{family}")]
        return {f: dict(zip(_MICROGRAPH, self._table(f"micrograph.{f}", _MICROGRAPH))) for f in families}

    def _table(self, key, units, others=()):
        table = self._find(key)
        if not self._known(table, (*units, *others), key, f"a table with {', '.join(units)}"):
            return [None] * len(units)
        return [self._number(f"{key}.{name}", unit) for name, unit in units.items()]

    def _quantity(self, key, optional=False):
        """(value in SI, its SI unit) of one of QUANTITIES, within its bounds; (None, None) where missing or wrong."""
        quantity = QUANTITIES[key.rpartition(".")[2]]
        return self._value(key, quantity.read, f'such as "{quantity.example}"', optional) or (None, None)

    def _number(self, key, unit):
        """The value in SI `unit` of another key, which the law made from it checks; None where missing or wrong."""
        return self._value(key, partial(si, unit=unit), f'such as "{example(unit)}"' if unit else "a number")

    def _value(self, key, read, allowed, optional=False):
        """What `read` makes of the value of a key, whose source is kept; None where missing or wrong, a problem."""
        return self._try(self._read, key, read, allowed, optional)

    def _read(self, key, read, allowed, optional):
        entry = self._find(key)
        if entry is None and (optional or key in self.meant):
            return None
        if entry is None:
            raise InputError("is missing", file=self.path, key=key, allowed=allowed)
        if not isinstance(entry, dict):
            entry = {"value": entry, "source": self.path.name, "status": "user"}
        elif not self._known(entry, ("value", "source", "status"), key):
            return None
        status = entry.get("status", "user")
        if status not in STATUSES:
            raise InputError(file=self.path, key=f"{key}.status", value=status, allowed=f"one of {', '.join(STATUSES)}")
        found = read(entry.get("value"), file=self.path, key=key)
        self.sources[key] = {"value": str(entry["value"]), "source": entry.get("source", ""), "status": status}
        return found

    def _text(self, key, default):
        value = self._find(key)
        if value is None or isinstance(value, str):
            return default if value is None else value
        self.problems.append(InputError(file=self.path, key=key, value=value, allowed="a text"))
        return default

    def _find(self, key):
        value = self.content
        for part in key.split("."):
            value = value.get(part) if isinstance(value, dict) else None
        return value

    def _has(self, key):
        return self._find(key) is not None

    def _known(self, table, allowed, where, what=None):
        """Whether `table` is a table; keys of it that are not allowed are problems."""
        if not isinstance(table, dict):
            what = what or f"a table with {', '.join(allowed)}"
            self.problems.append(InputError(file=self.path, key=where, value=table, allowed=what))
            return False
        for key in table:
            if key not in allowed:
                near = difflib.get_close_matches(key, allowed, n=1, cutoff=0.75)
                name, meant = (f"{where}.{one}" if where else one for one in (key, *(near or ("",))))
                self.meant.add(meant)
                words = f'is not a known key, did you mean "{near[0]}"?' if near else "is not a known key"
                known = None if near else f"one of {', '.join(allowed)}"
                self.problems.append(InputError(words, file=self.path, key=name, allowed=known))
        return True

    def _build(self, kind, where, *args, **kwargs):
        """Build an object whose own checks do not know the file; None where it, or what it is made from, is wrong."""
        if any(arg is None for arg in args) or kwargs.get("weave", kind) is None:
            return None
        try:
            return kind(*args, **kwargs)
        except InputError as problem:
            if problem.file is not None:
                raise
            key = {"E": "modulus"}.get(problem.key, problem.key)
            key = key.replace("_count", ".count") if key else key
            key = f"{where}.{key}" if where else key
            value = self.sources.get(key, {}).get("value", problem.value)  # as the user wrote it
            self.problems.append(InputError(file=self.path, key=key, value=value, allowed=problem.allowed))
            return None
