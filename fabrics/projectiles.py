"""Projectiles by name: fragment simulators, right circular cylinders and spheres of steel, and
bullets (`projectiles.toml`).

An entry holds keys of the table [projectile] of an input file as they would be written there ("1.10
g"), each with its source and status, and the tolerance of the mass if one is known. A file of a
user (*.toml) is such an entry too.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from contextlib import suppress
from math import pi
from pathlib import Path
from typing import Any

from fabrics.base.checks import FilePath
from fabrics.base.errors import InputError
from fabrics.base.sourced import Constants, SourcedTables, read_constants
from fabrics.base.units import si

_FILE = Path(__file__).with_name("projectiles.toml")
_GRAINS = re.compile(r"[0-9] *-?(?:grains?|gr)\b")
_UNITS = {"g", "mm", "inch", "grain"}
# a sphere of any diameter is one of steel
_SPHERE = re.compile(r"sphere +([0-9.]+ *[a-z]+)", re.IGNORECASE)
# [-] a mass or a diameter that differs by more is of another projectile
CLOSE = 0.1
_OF_ANY_NOSE = ("mass", "diameter", "length", "edge_radius")
# of a body of metal alone
_OF_METAL = (
    "core",
    "jacket",
    "jacket_thickness",
    "bare_tip",
    "open_base",
    "cavity_diameter",
    "cavity_depth",
    "element_size",
)
_OF_SHAPE = {"sphere": ("mass", "diameter"), "stl": ("mass", "edge_radius")}

TABLES = SourcedTables(_FILE, "projectile", group="weavecell.projectiles")
list_names = TABLES.list_names


def density() -> float:
    """Return the density [kg/m3] of the steel that all of them but the bullets are made of."""
    return si(TABLES.content["steel"]["density"]["value"], "kg/m^3")


def entry(name: str, *, file: FilePath | None = None, key: str = "name") -> tuple[str, Constants]:
    """Look up a projectile by name, or by the path of its file from the folder of `file`: (shape,
    data).

    Raises
    ------
    InputError : an unknown name; one line with the `file` and `key` that it is read from, and the
        names there are
    """
    if name.endswith(".toml"):
        return _take_shape(read_constants(Path(file or "").parent / name, "projectile"))
    near = None
    name = known_name(name)
    ball = _SPHERE.fullmatch(name)
    if name not in list_names() and ball is not None:
        with suppress(InputError):
            return "sphere", _sphere(ball[1])
    if name not in list_names():
        near = _nearest_by_value(name)
    return _take_shape(TABLES.entry(name, file=file, key=key, near=near))


def _take_shape(constants):
    """(shape, the other constants); our own file has the shape as a text."""
    data = dict(constants)
    shape = data.pop("shape", "flat")
    if isinstance(shape, dict):
        shape = shape["value"]
    return shape, data


def _sphere(diameter):
    """Return the data of a sphere of steel of a diameter, a text with its unit.

    Raises
    ------
    InputError : it is no length
    """
    mass = density() * pi / 6 * si(diameter, "m") ** 3
    return {
        "mass": {
            "value": f"{1e3 * mass:.4g} g",
            "source": "diameter, and density of steel",
            "status": "derived",
        },
        "diameter": {"value": diameter, "source": "the name", "status": "nominal"},
    }


def known_name(name: str) -> str:
    """Return the name of the projectile that a name means: the only one that has its words and
    numbers, such as "9 mm FMJ"; of one in grain, such as "FSP 17 grain", the one of that kind whose
    mass is so within its tolerance. Any other name is returned as it is."""
    if name in list_names():
        return name
    words, numbers = _parts(name)
    alike = [other for other in list_names() if _has(other, words, numbers)]
    if words and len(alike) == 1:
        return alike[0]
    if not _GRAINS.search(name):
        return name
    near = _nearest_by_value(name)
    if near is None or "mass_tolerance" not in TABLES.content["projectile"][near]:
        return name
    data = TABLES.content["projectile"][near]
    tolerance = si(data["mass_tolerance"]["value"], "kg") / si(data["mass"]["value"], "kg")
    if _differences(name)[near] > tolerance:
        return name
    return near


def _parts(name):
    """Return the words of a name, and its numbers with their units, in small letters."""
    numbers = re.findall(r"([0-9]*\.?[0-9]+) *([a-z]*)", name.lower())
    words = set(re.findall(r"[a-z]+", name.lower())) - _UNITS
    return words, [(float(number), unit if unit in _UNITS else "") for number, unit in numbers]


def _has(name, words, numbers):
    """Tell whether a name has all of some words and numbers, of which a unit may be left out."""
    there, amounts = _parts(name)
    known = {*amounts, *((number, "") for number, _ in amounts)}
    return words <= there and known.issuperset(numbers)


def _nearest_by_value(name):
    """The projectile whose mass or diameter is nearest to the quantity in a name, within CLOSE; of
    the kind that the name has as a word."""
    off = _differences(name)
    nearest = min(off, key=off.__getitem__, default=None)
    if nearest is None or off[nearest] > CLOSE:
        return None
    return nearest


def _differences(name):
    """{projectile: [-] by how much its mass or diameter differs from the quantity in a name}, of the
    kind that the name has as a word. A number such as .22 is a calibre [inch]."""
    found = re.search(r"([0-9]*\.?[0-9]+) *([a-zA-Z]*)", name)
    if found is None:
        return {}
    number, unit = found.groups()
    if number.startswith(".") and not unit:
        unit = "inch"
    if _GRAINS.search(name):
        unit = "grain"
    first, *others = name.lower().split()
    # a calibre behind a kind is no kind
    kinds = {first, *filter(str.isalpha, others)}
    off = {}
    for other, data in TABLES.content["projectile"].items():
        if other.split()[0].lower() not in kinds:
            continue
        for key, si_unit in (("mass", "kg"), ("diameter", "m")):
            if key not in data:
                continue
            with suppress(InputError):
                ratio = si(f"{number} {unit}", si_unit) / si(data[key]["value"], si_unit)
                off[other] = abs(ratio - 1)
    return off


def table(
    name: str,
    given: Mapping[str, Any] | None = None,
    *,
    file: FilePath | None = None,
    key: str = "name",
) -> dict[str, Any]:
    """Return the table [projectile] of a projectile: its name and data, with the keys in `given` in
    their place.

    With another shape, only the data that the shapes share are taken.

    Raises
    ------
    InputError : as `entry`
    """
    given = given or {}
    name = known_name(name)
    shape, data = entry(name, file=file, key=key)
    chosen = given.get("shape", shape)
    shared = _OF_SHAPE.get(chosen, _OF_ANY_NOSE)
    taken: dict[str, Any] = {"name": name, "shape": shape}
    rigid = given.get("body", "metal") != "metal"
    for quantity, row in data.items():
        if rigid and quantity in _OF_METAL:
            continue
        if quantity != "mass_tolerance" and (chosen == shape or quantity in shared):
            taken[quantity] = row.get("value")
    return taken | dict(given)
