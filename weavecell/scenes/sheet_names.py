"""What makers of fabrics call the rows of a data sheet.

A row of a table of values is read in any case, with the unit behind its name as in any heading
(`fabrics.base.tables`), and under the names that makers use: "Weight [g/m2]" is areal_density. Rows
that describe a fabric, such as its style, are left out, and the log says so.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterable, Iterator, Mapping

from fabrics.base import tables
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
    "strength": ("tensile strength", "yarn strength", "yarn breaking force", "yarn break load"),
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
# of a number if the cell begins with one, else of the name of the yarn
NAME_OR_NUMBER = ("yarn",)
WEAVE = "weave", "weave pattern", "pattern", "weave style", "binding"


def named(
    rows: Iterable[Row], keys: Iterable[str], takes: Callable[[str, str], bool], path: FilePath
) -> Iterator[Row]:
    """Yield the rows with the key that each is of, and its unit behind its numbers.

    Parameters
    ----------
    rows : with the cells key, warp and, if wanted, others
    keys : that a row may have as its name; a row of none stays as it is
    takes : whether (key, unit) go together
    """
    titles = {key.replace("_", " "): key for key in keys}
    for key, names in NAMES.items():
        titles |= dict.fromkeys(names, key)

    def goes_with(title, unit):
        return title in titles and takes(titles[title], tables.plain_unit(unit))

    for line, cells in rows:
        written = cells["key"]
        found = tables.find_name(written, (*titles, *DESCRIPTIONS, *WEAVE), goes_with)
        if found is None:
            yield line, dict(cells)
            continue
        title, unit = found
        if title in WEAVE:
            if cells["warp"].strip():  # a cell that says nothing states no weave
                yield line, cells | {"key": "weave"}
            continue
        if title in DESCRIPTIONS or _is_name(title, cells["warp"]):
            LOG.info(f"{path}: left out, {line}: {written} {cells['warp']}".rstrip())
            continue
        key = titles[title]
        if title != key.replace("_", " "):
            LOG.info(f"{path}: {line}: {written} is taken for {key}")
        yield line, _with_unit(cells, tables.plain_unit(unit)) | {"key": key}


def _is_name(title, text):
    """Whether a row that may have a number says the name of the yarn."""
    return title in NAME_OR_NUMBER and text.strip()[:1].isalpha()


def _with_unit(cells: Mapping[str, str], unit: str) -> dict[str, str]:
    """The cells of which numbers alone have the unit that stands behind the name of their row."""
    changed = dict(cells)
    for family in ("warp", "weft"):
        text = changed.get(family, "")
        if unit and NUMBER.fullmatch(text):
            changed[family] = f"{text} {unit}"
    return changed
