"""Keys of the result files of impacts and coupons, from keys.toml; docs/reference.md is made from
them.

One convention: name_unit in summary.json and in attributes; a dataset has the attribute "unit". A
quantity of an impact is one line of keys.toml: its key, unit and meaning, and where the record
(`results.impact.ImpactRecord`) holds it. summary.json, histories.h5, the tables of pandas and
xarray and the report take it from there.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

from fabrics.base.files import read_data
from weavecell.results import display

SUMMARY_FORMAT = "weavecell summary 2"
# the unit that ends a name
_UNIT = re.compile(r"_(J_m2_kg|m_s|ft_s|J_m2|kg_m2|kg|mm|m3|m|ns|s|N|J|Pa|rad)$")


class Key(NamedTuple):
    """A key of a result file, with its unit and its meaning.

    Parameters
    ----------
    unit : SI unit, "1" of a number without; "%" of a share, which is a number in files and shown in
        %; "wall s" of the time that a computer took; "" of what is no number
    path : where an object holds it, its name if not given: attributes, keys of dicts and indices
        with dots between them
    parts : names of the parts of a pair, which are columns of their own in tables
    of : table that has its meaning
    optional : whether it is absent where it is empty
    axis : what stands at the axis of a figure that draws it; the words of its name if not given
    """

    name: str
    unit: str
    meaning: str
    path: str = ""
    parts: tuple[str, ...] = ()
    of: str = ""
    optional: bool = False
    axis: str = ""

    @property
    def field(self) -> str:
        """Attribute of the object, where that holds the value itself."""
        return self.path or self.name

    @property
    def label(self) -> str:
        """The beginning of its meaning, with the unit in which it is shown."""
        return display.heading(self.meaning.partition(";")[0].replace("`", ""), self.unit)

    @property
    def si_unit(self) -> str:
        """Unit of the number in the files."""
        return display.si_unit(self.unit)

    def value(self, source: Any) -> Any:
        """Return the value of the key in an object, such as a record."""
        for part in self.field.split("."):
            if isinstance(source, Mapping):
                # what only some have, such as what was drawn of them
                source = source.get(part) if self.optional else source[part]
            else:
                if part.lstrip("-").isdigit():
                    source = source[int(part)]
                else:
                    source = getattr(source, part)
        if callable(source):
            return source()
        return source


def _prefix_keys(group: str, table: Iterable[Key]) -> tuple[Key, ...]:
    return tuple(Key(f"{group}/{key.name}", *key[1:]) for key in table)


TABLES: dict[str, tuple[Key, ...]] = {}


def _read_key(name, row):
    """A Key of a row: a list, or a table, which may take unit and meaning from another table."""
    if isinstance(row, list):
        return Key(name, *row)
    same = {}
    if "of" in row:
        key = next(key for key in TABLES[row["of"]] if key.name == name)
        same = {"unit": key.unit, "meaning": key.meaning}
    return Key(name, **(same | row | {"parts": tuple(row.get("parts", ()))}))


for _name, _rows in read_data(Path(__file__).with_suffix(".toml")).items():
    TABLES[_name] = tuple(_read_key(key, row) for key, row in _rows.items())
# a study of one's own has the shots of a V50
TABLES["runs"] += tuple(key for key in TABLES["v50"] if key.name.startswith("rows."))
# tables of summary.json that an impact has where this attribute of its record is not empty
OF_SOME = {"pack": "pack", "bar": "of_bar", "metal": "of_metal", "backing": "of_backing"}
OF_IMPACTS = (
    *_prefix_keys("histories", TABLES["histories"]),
    *_prefix_keys("energies", TABLES["energies"]),
    *_prefix_keys("plies", TABLES["plies"]),
    *_prefix_keys("plies/histories", TABLES["ply_histories"]),
    Key("projectile", "m", "surface of the projectile about its nose"),
    *_prefix_keys("half_energy/*", TABLES["shape"]),
    *_prefix_keys("final/*", TABLES["shape"]),
    *_prefix_keys("half_energy/*", TABLES["shape_of_yarns"]),
    *_prefix_keys("final/*", TABLES["shape_of_yarns"]),
    Key("measured/*/time", "s", "times of the samples of [history]"),
    *_prefix_keys("measured/*/yarns/*", TABLES["yarn"]),
    Key("measured/*/edges/*", "N", "in-plane and normal reaction of an edge of the panel"),
    *_prefix_keys("measured/*/fronts/*", TABLES["front"]),
    *_prefix_keys("bar", TABLES["bar"]),
    *_prefix_keys("metal", TABLES["metal"]),
    *_prefix_keys("backing", TABLES["backing"]),
    Key("quads/*", "1", "node numbers of a ply's elements"),
    *_prefix_keys("cuts/*", TABLES["cut"]),
    Key("cuts/*/face", "m", "nodes of the face of the block behind the last ply"),
    Key("cuts/*/lines/*", "m", "x and z of a ply's middle surface, NaN where its yarn has failed"),
    Key("checks", "", "quality indicators as JSON"),
    Key("pack", "", "what is stacked, as JSON; empty of one ply"),
    Key("failure", "", "what the strength came to at failures, as JSON; empty if it is constant"),
)
DATASETS = tuple(key for key in OF_IMPACTS if key.unit)
ATTRIBUTES = tuple(key for key in OF_IMPACTS if not key.unit)
COUPON_DATASETS = (
    *_prefix_keys("histories", TABLES["coupon_measures"]),
    *TABLES["coupon_datasets"],
    *_prefix_keys("coupon", TABLES["coupon_mesh"]),
)


def table(*names: str) -> tuple[Key, ...]:
    """Return the keys of tables of keys.toml, one after the other."""
    return tuple(key for name in names for key in TABLES[name])


SHARED = table("run", "folder")
# tables of the kinds of results that are no impact: each has a JSON file and, but for a mesh, a table
OF_KINDS = (
    *(
        "critical_velocity",
        "v50",
        "runs",
        "difference",
        "sweep",
        "tests",
    ),
    *("compression", "shot", "coupon", "biaxial", "law", "surface", "case", "mesh"),
)
# what a test on a coupon prescribes and measures: the columns of its record
COUPON_MEASURES = {key.name: key for key in table("coupon_measures")}
IMPACT = table("impact", *OF_SOME.values(), "failure", "stacking", "impact_folder")


# units of numbers of summaries and columns of tables, by name; of an impact before other results
_UNITS: dict[str, str] = {}
# and words of their axes
_AXES: dict[str, str] = {}
for _name in ("impact", *OF_SOME.values(), "failure", "run", *OF_KINDS):
    for _key in TABLES[_name]:
        _column = _key.name.removeprefix("rows.")
        _UNITS.setdefault(_column, _key.unit)
        if _key.axis:
            _AXES.setdefault(_column, _key.axis)


class Axis(NamedTuple):
    """An axis of a figure: its label, and the factor from SI units to those shown."""

    label: str
    factor: float

    @property
    def words(self) -> str:
        """The label without its unit."""
        return self.label.partition(" [")[0]


def find_axis(name: str, of: str = "") -> Axis:
    """Return the axis of a figure that draws a column.

    Parameters
    ----------
    name : of the column
    of : its table in keys.toml; without one the name tells the unit, as in `infer_key`

    Examples
    --------
    >>> find_axis("deflection", "histories"), find_axis("v50_m_s").label
    (Axis(label='deflection of the back face [mm]', factor=1000.0), 'V50 [m/s]')
    """
    inferred = infer_key(name)
    key = inferred
    words = _AXES.get(name, inferred.meaning)
    if of:
        # a number of the summary may have the name of a column
        known = {one.name: one for one in TABLES[of]}
        key = known.get(f"rows.{name}") or known[name]
        words = key.axis or inferred.meaning
    return Axis(display.heading(words, key.unit), display.choose_unit(key.unit)[1])


def infer_key(name: str) -> Key:
    """Return the key of a column by its name: its words, and the unit of this name in keys.toml,
    else the unit that it ends in.

    Examples
    --------
    >>> infer_key("strike_velocity_m_s").label, infer_key("energy_error_max").label
    ('strike velocity [m/s]', 'energy error max [%]')
    """
    words, *ending = _UNIT.split(name)
    unit = "1"
    if ending:
        # an energy over an areal density is no chain of quotients
        unit = ending[0].replace("J_m2_kg", "J m2/kg").replace("_", "/")
    unit = _UNITS.get(name) or unit
    return Key(name, unit, words.replace("_", " "))
