"""The page files.md: tables that follow from readers and writers of fabric files, surfaces and records."""

from __future__ import annotations

import ast
import re
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
sys.path[:0] = [str(ROOT), str(ROOT / "tools")]

from claims_page import markdown  # noqa: E402

from fabrics import fabric_tables, ply_laws, surface  # noqa: E402
from fabrics.families import strain_rate  # noqa: E402

LISTS = {
    "closure": "contact law of plies: thickness lost, a list of strings with units that begins at 0 and rises",
    "pressure": "contact law of plies: at each closure, a list of strings with units that begins at 0 and rises",
    "rates": "optional: rising strain rates, for `panel.rate_dependence`; without it by fibre family",
    "strength": "strength at these rates over that of the file, a list",
    "modulus": "optional: modulus at these rates over that of the file, a list",
}
ARRAYS = {
    "d1": "(n1,) end displacement of the warp, per end",
    "d2": "(n2,) end displacement of the weft, per end",
    "T1": "(n1, n2) tension of the warp",
    "T2": "(n1, n2) tension of the weft",
    "F_c": "(n1, n2) contact force",
    "h1": "(n1, n2) height of the warp's centreline",
    "h2": "(n1, n2) height of the weft's centreline",
}


HEAD = """# Files in full

Made from readers and writers. [Reference](../reference.md) says what the files are for."""


def page() -> str:
    """Write the text of the page."""
    parts = [HEAD, "## Output of the commands", markdown(outputs())]
    parts += [
        "## Fabric file",
        markdown(fabric_file()),
        "## Response surface",
        markdown(surface_file()),
    ]
    parts += ["## Case of the 3D crossover", case()]
    return "\n\n".join(parts) + "\n"


def case() -> str:
    """Tabulate case.h5, whose columns are declared by code that needs dolfinx."""
    try:
        return markdown(case_file())
    except ModuleNotFoundError:
        return "This table is made where dolfinx is installed."


def fabric_file() -> list[list[str]]:
    """Tabulate the keys of a fabric file."""
    rows = [["table", "key", "unit or bounds", "meaning"]]
    tables = {
        "top level": fabric_tables.FabricFile,
        "`[warp]`, `[weft]`": fabric_tables.YarnTable,
        "`[compression]`, or `[compression.warp]` and `[compression.weft]`": fabric_tables.LawTable,
        "`[shear]`": fabric_tables.ShearTable,
        "`[solid]`, or `[solid.warp]` and `[solid.weft]`": fabric_tables.SolidTable,
        "`[micrograph.warp]`, `[micrograph.weft]`": fabric_tables.MicrographTable,
    }
    for table, model in tables.items():
        for key, quantity in model.quantities().items():
            units = " or ".join(text or unit or "1" for unit, text in quantity.bounds.items())
            optional = "" if model.model_fields[key].is_required() else "optional: "
            rows.append([table, f"`{key}`", units, f"{optional}{quantity.meaning}"])
    lists = {"`[ply_contact]`, or its `file`": ply_laws.UNITS, "`[strain_rate]`": strain_rate.UNITS}
    rows += [
        [table, f"`{key}`", unit or "1", LISTS[key]]
        for table, keys in lists.items()
        for key, unit in keys.items()
    ]
    return rows


def surface_file() -> list[list[str]]:
    """Tabulate the datasets of surface.h5."""
    return [["dataset", "unit", "meaning"]] + [
        [f"`{name}`", unit, ARRAYS[name]] for name, unit in surface._UNITS.items()
    ]


def case_file() -> list[list[str]]:
    """Tabulate the columns of case.h5, of every case of `weavecell crossover`."""
    from unitcell3d.solver.recorded import MEANINGS

    rows = [["column", "unit and meaning"]]
    return rows + [[f"`columns/{name}`", words] for name, words in MEANINGS.items()]


def outputs() -> list[list[str]]:
    """Tabulate the files that each command writes, from the docstrings of the modules of the
    commands."""
    rows = [["command", "file", "contents"]]
    folders = (ROOT / "weavecell" / name for name in ("api", "results"))
    for path in sorted(
        (path for folder in folders for path in folder.glob("*.py")), key=lambda path: path.name
    ):
        text = ast.get_docstring(ast.parse(path.read_text("utf-8"))) or ""
        head = re.search(r"older of (`weavecell .*)$", text, re.MULTILINE)
        for line in text.splitlines() if head else ():
            found = re.match(r"    ([^\s,]+(?:, [^\s,]+)*)(?:\s+(\S.*))?$", line)
            if found:
                rows.append([head[1], f"`{found[1]}`", (found[2] or "").replace("|", "\\|")])
    return rows
