"""The catalogue: fabrics as data files, one TOML file each, every number with its unit, source and status.

A number is written `{ value = "1420 denier", source = "...", status = "measured" }`, or just `"1420 denier"` in a
user's own file. Statuses: measured, computed, fitted, derived, assumed, corrected (a misprint of the thesis).
"""

from __future__ import annotations

import tomllib
from dataclasses import replace
from functools import cache
from pathlib import Path

from fabrics.checks import FilePath
from fabrics.compression import CompressionLaw
from fabrics.errors import InputError
from fabrics.fabric import Fabric
from fabrics.ply_law import STATUSES, PlyLaw
from fabrics.solid import SolidLaw
from fabrics.trellis import TrellisShear
from fabrics.units import si
from fabrics.weave import Weave
from fabrics.yarn import Yarn

_FOLDER = Path(__file__).parent

_YARN = {"crimp": "", "count": "1/m", "fibre_density": "kg/m^3", "modulus": "Pa", "failure_strain": ""}
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


def read(path: FilePath) -> Fabric:
    """Read one fabric file."""
    return _Reader(Path(path)).fabric()


class _Reader:
    """Takes the values of one file, in SI, and remembers where each came from; refuses keys that it does not know."""

    def __init__(self, path):
        self.path, self.sources = path, {}
        try:
            self.content = tomllib.loads(path.read_text(encoding="utf-8"))
        except OSError as problem:
            raise InputError(f"cannot be read ({problem.strerror})", file=path) from problem
        except (tomllib.TOMLDecodeError, UnicodeDecodeError) as problem:
            raise InputError(f"is not TOML: {problem}", file=path) from problem

    def fabric(self) -> Fabric:
        allowed = (
            "name",
            "section",
            "interlayer_gap",
            "areal_density_measured",
            "warp",
            "weft",
            "compression",
            "shear",
            "ply_contact",
        )
        self._known(self.content, (*allowed, "solid", "micrograph"), "")
        warp, weft = (self._yarn(family) for family in ("warp", "weft"))
        weave = self._build(Weave, "", warp, weft, *(self._number(f"{f}.count", "1/m") for f in ("warp", "weft")))
        effective = [self._number(f"{f}.effective_linear_density", "kg/m", True) for f in ("warp", "weft")]
        warp_width, weft_width = (self._number(f"{f}.width", "m", True) for f in ("warp", "weft"))
        fabric = self._build(
            Fabric,
            "",
            name=self._text("name", self.path.stem),
            weave=weave,
            laws=self._pair("compression", _LAW, self._law),
            shear=self._shear(),
            solid_laws=self._solids(),
            section=self._text("section", "sine"),
            areal_density_measured=self._number("areal_density_measured", "kg/m^2", True),
            interlayer_gap=self._number("interlayer_gap", "m", True),
            effective_linear_density=tuple(effective) if None not in effective else None,
            micrograph=self._micrograph(),
            sources=self.sources,
            yarn_width=(warp_width, weft_width),
        )
        if not self._has("ply_contact"):
            return fabric
        law = PlyLaw.from_table(self._find("ply_contact"), fabric, self.path)
        self.sources["ply_contact"] = {"value": law.words(), "source": law.source, "status": law.status}
        return replace(fabric, ply_contact=law)

    def _yarn(self, family):
        if not self._has(family):
            raise InputError("is missing", file=self.path, key=f"[{family}]", allowed="a table with the yarn's data")
        stiffness = self._has(f"{family}.axial_stiffness")
        extra = ("width", *(("axial_stiffness",) if stiffness else ("linear_density", "effective_linear_density")))
        self._known(self._find(family), (*_YARN, *extra), family)
        crimp, _, fibre_density, E, failure_strain = self._table(family, _YARN)
        if stiffness:
            linear_density = self._number(f"{family}.axial_stiffness", "N") / E * fibre_density
        else:
            linear_density = self._number(f"{family}.linear_density", "kg/m")
        return self._build(Yarn, family, linear_density, fibre_density, E, failure_strain, crimp)

    def _law(self, key):
        a, b = self._table(key, _LAW, ("form",))
        return self._build(CompressionLaw, key, a, b, self._text(f"{key}.form", "regularised"), f"{self.path.name}")

    def _shear(self):
        return self._build(TrellisShear, "shear", *self._table("shear", _SHEAR)) if self._has("shear") else None

    def _solids(self):
        return self._pair("solid", _SOLID, lambda key: self._build(SolidLaw, key, *self._table(key, _SOLID)))

    def _pair(self, key, units, build):
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
        if not isinstance(table, dict):
            raise InputError(file=self.path, key=key, value=table, allowed=f"a table with {', '.join(units)}")
        if key not in ("warp", "weft"):
            self._known(table, (*units, *others), key)
        return [self._number(f"{key}.{name}", unit) for name, unit in units.items()]

    def _number(self, key, unit, optional=False):
        entry = self._find(key)
        if entry is None and optional:
            return None
        if entry is None:
            example = f'such as "1 {unit}"' if unit else "a number"
            raise InputError("is missing", file=self.path, key=key, allowed=example)
        if not isinstance(entry, dict):
            entry = {"value": entry, "source": self.path.name, "status": "user"}
        self._known(entry, ("value", "source", "status"), key)
        status = entry.get("status", "user")
        if status not in STATUSES:
            raise InputError(file=self.path, key=f"{key}.status", value=status, allowed=f"one of {', '.join(STATUSES)}")
        number = si(entry.get("value"), unit, file=self.path, key=key)
        self.sources[key] = {
            "value": str(entry["value"]),
            "source": entry.get("source", ""),
            "status": status,
        }
        return number

    def _text(self, key, default):
        value = self._find(key)
        if value is None:
            return default
        if not isinstance(value, str):
            raise InputError(file=self.path, key=key, value=value, allowed="a text")
        return value

    def _find(self, key):
        value = self.content
        for part in key.split("."):
            value = value.get(part) if isinstance(value, dict) else None
        return value

    def _has(self, key):
        return self._find(key) is not None

    def _known(self, table, allowed, where):
        if not isinstance(table, dict):
            raise InputError(file=self.path, key=where, value=table, allowed=f"a table with {', '.join(allowed)}")
        for key in table:
            if key not in allowed:
                name = f"{where}.{key}" if where else key
                raise InputError("is not a known key", file=self.path, key=name, allowed=f"one of {', '.join(allowed)}")

    def _build(self, kind, where, *args, **kwargs):
        """Build an object whose own checks do not know the file, and name the file in what they raise."""
        try:
            return kind(*args, **kwargs)
        except InputError as problem:
            if problem.file is not None:
                raise
            key = {"E": "modulus"}.get(problem.key, problem.key)
            key = key.replace("_count", ".count") if key else key
            key = f"{where}.{key}" if where else key
            value = self.sources.get(key, {}).get("value", problem.value)  # as the user wrote it
            raise InputError(file=self.path, key=key, value=value, allowed=problem.allowed) from None
