"""What makers of fabrics call the rows of a data sheet.

A row of a table of values is read in any case, with the unit in brackets behind its name, and under
the names that makers use: "Weight [g/m2]" is areal_density. Rows that describe a fabric, such as
its style, are left out, and the log says so.
"""

from __future__ import annotations

import logging
import re
from collections.abc import Iterable, Iterator, Mapping

from fabrics.base.checks import FilePath
from fabrics.base.units import NUMBER

LOG = logging.getLogger("weavecell")
Row = tuple[str, dict[str, str]]  # "line 7", its cells by the name of the column

NAMES = {
    "linear_density": (
        "yarn",
        "yarn count",
        "yarn size",
        "yarn titre",
        "yarn linear density",
        "titre",
        "titer",
        "fineness",
        "denier",
        "dtex",
    ),
    "fibre_density": ("fiber density", "density of the fibre", "density of the fiber"),
    "modulus": (
        "tensile modulus",
        "young's modulus",
        "initial modulus",
        "elastic modulus",
        "fibre modulus",
        "fiber modulus",
        "yarn modulus",
    ),
    "failure_strain": (
        "elongation",
        "elongation at break",
        "breaking elongation",
        "strain at break",
        "strain to failure",
        "yarn elongation",
    ),
    "strength": ("yarn strength", "yarn breaking force", "yarn break load"),
    "tenacity": ("yarn tenacity", "breaking tenacity", "fibre tenacity", "fiber tenacity"),
    "breaking_strength": (
        "strip strength",
        "strip tensile strength",
        "breaking load",
        "fabric breaking strength",
        "fabric tensile strength",
    ),
    "crimp": ("yarn crimp", "waviness"),
    "count": (
        "ends picks",
        "ends and picks",
        "thread count",
        "threads",
        "yarns",
        "fabric count",
        "construction",
        "sett",
        "set",
    ),
    "width": ("yarn width",),
    "areal_density": (
        "weight",
        "mass",
        "fabric weight",
        "areal weight",
        "basis weight",
        "grammage",
        "mass per unit area",
        "mass per area",
    ),
    "thickness": ("fabric thickness",),
}
# of which nothing is computed
DESCRIPTIONS = (
    "style",
    "article",
    "product",
    "name",
    "fibre",
    "fiber",
    "material",
    "yarn type",
    "finish",
    "colour",
    "color",
    "fabric width",
    "roll width",
    "roll length",
)
WEAVE = "weave", "weave pattern", "pattern", "weave style", "binding"
# a name, and the unit in brackets behind it
_BRACKETS = re.compile(r"(.*?)\s*[\[(]([^\[\]()]*)[\])]\s*")


def named(rows: Iterable[Row], keys: Iterable[str], path: FilePath) -> Iterator[Row]:
    """Yield the rows with the key that each is of, and its unit behind its numbers.

    Parameters
    ----------
    rows : with the cells key, warp and, if wanted, others
    keys : that a row may have as its name; a row of none stays as it is
    """
    known = {_fold(key): key for key in keys}
    for key, names in NAMES.items():
        known |= dict.fromkeys(names, key)
    for line, cells in rows:
        written = cells["key"]
        name, unit = _split(written)
        if name in WEAVE:
            if cells["warp"].strip():  # a cell that says nothing states no weave
                yield line, cells | {"key": "weave"}
            continue
        if name in DESCRIPTIONS:
            LOG.info(f"{path}: left out, {line}: {written} {cells['warp']}".rstrip())
            continue
        key = known.get(name, written)
        if name in known and name != _fold(key):
            LOG.info(f"{path}: {line}: {written} is taken for {key}")
        yield line, _with_unit(cells, unit) | {"key": key}


def _fold(text):
    """A name in small letters, its words apart."""
    plain = text.lower().replace("’", "'")
    return " ".join(re.sub(r"[_/\s-]+|:$", " ", plain).split())


def _split(written):
    """(folded name, unit in brackets or ""), of the cell that names a row."""
    found = _BRACKETS.fullmatch(written)
    if found is None:
        return _fold(written), ""
    return _fold(found[1]), found[2].strip()


def _with_unit(cells: Mapping[str, str], unit: str) -> dict[str, str]:
    """The cells of which numbers alone have the unit that stands behind the name of their row."""
    changed = dict(cells)
    for family in ("warp", "weft"):
        text = changed.get(family, "")
        if unit and NUMBER.fullmatch(text):
            changed[family] = f"{text} {unit}"
    return changed
