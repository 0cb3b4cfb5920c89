"""Tables of docs/reference/files.md that follow from readers and writers of fabric files, surfaces and records.

`tools/pages.py` puts them there. Needs dolfinx, whose cases declare the columns of their records.
"""

from __future__ import annotations

import ast
import re
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT))

from fabrics import catalogue, data_sheet, ply_law, surface  # noqa: E402
from fabrics.families import strain_rate  # noqa: E402

MEANINGS = {
    "linear_density": "mass per length of the yarn",
    "effective_linear_density": "optional: linear density of the runs of the thesis (erratum E-07)",
    "axial_stiffness": "in place of linear_density: force per strain",
    "fibre_density": "density of the fibre",
    "modulus": "axial modulus of the fibre",
    "failure_strain": "failure strain of the fibre; optional where strength or tenacity is given",
    "strength": "of one yarn, or a stress of the fibre; the failure strain is then strength over stiffness",
    "tenacity": "the same as strength over linear density, such as 2350 mN/tex, 23.5 cN/dtex or 26.6 g/den",
    "top.thickness": "optional: of the data sheet; crimp that is missing is computed from it",
    "top.areal_density": "optional: of the data sheet; checked against counts, linear densities and crimp",
    "top.areal_density_measured": "optional: of Kevlar 129, for the pressure law of thesis eq. 2-6",
    "top.interlayer_gap": "optional: approach of neighbouring plies of a pack in a test up to 19.4 MPa",
    "strain_rate.rates": "optional: rising strain rates, for `panel.rate_dependence`; without it by fibre family",
    "strain_rate.strength": "strength at these rates over that of the file, a list",
    "strain_rate.modulus": "optional: modulus at these rates over that of the file, a list",
    "crimp": "length of the yarn over length of the fabric, minus one; optional where thickness is given",
    "count": "yarns per width of fabric",
    "width": "optional: width of the yarn in the fabric",
    "section_area": "optional: area of the yarn's section; gives the fibre volume fraction where [solid] is assumed",
    "a": "compression law, thesis eq. 4-12",
    "b": "compression law, thesis eq. 4-12",
    "G1": "trellis law: tangent shear modulus before parallel yarns touch (eq. 4-35)",
    "G2": "trellis law: tangent shear modulus after locking (eq. 4-35)",
    "gamma1": "trellis law: shear angle in radians at which parallel yarns touch",
    "gamma2": "trellis law: shear angle in radians of locking",
    "E_a": "solid law: axial modulus of the solid (eq. 3-2); the fibre bars carry the tension",
    "E_c": "solid law: transverse modulus of the packed yarn (eq. 3-14)",
    "K_r": "solid law: share of E_c in a loose yarn (eq. 3-10)",
    "K_G": "solid law: shear modulus over E_c / 2 (eq. 3-16)",
    "V_c": "solid law: fibre volume fraction at which the yarn is packed",
    "Vf0": "solid law: fibre volume fraction at rest",
    "closure": "contact law of plies: thickness lost, a list of strings with units that begins at 0 and rises",
    "pressure": "contact law of plies: at each closure, a list of strings with units that begins at 0 and rises",
    "thickness": "section of the yarn in a micrograph",
    "crossing_thickness": "thickness of the yarn at a crossover",
    "total_thickness": "thickness of the fabric at a crossover",
    "void": "share of voids in the cell",
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


def fabric_file() -> list[list[str]]:
    """Keys of a fabric file."""
    rows = [["table", "key", "unit or bounds", "meaning"]]
    bounds = {key: " or ".join(quantity.bounds.values()) for key, quantity in data_sheet.QUANTITIES.items()}
    yarn = (*data_sheet.OF_YARN, "effective_linear_density", "axial_stiffness")
    tables = {
        "top level": {key: text for key, text in bounds.items() if key not in yarn},
        "`[warp]`, `[weft]`": {key: bounds[key] for key in yarn},
        "`[compression]`, or `[compression.warp]` and `[compression.weft]`": catalogue._LAW,
        "`[shear]`": catalogue._SHEAR,
        "`[solid]`, or `[solid.warp]` and `[solid.weft]`": catalogue._SOLID,
        "`[ply_contact]`, or its `file`": ply_law.UNITS,
        "`[strain_rate]`": {f"strain_rate.{key}": unit for key, unit in strain_rate.UNITS.items()},
        "`[micrograph.warp]`, `[micrograph.weft]`": catalogue._MICROGRAPH,
    }
    for table, keys in tables.items():
        rows += [
            [table, f"`{key.split('.')[-1]}`", unit or "1", MEANINGS[f"top.{key}" if table == "top level" else key]]
            for key, unit in keys.items()
        ]
    return rows


def surface_file() -> list[list[str]]:
    """Datasets of surface.h5."""
    return [["dataset", "unit", "meaning"]] + [
        [f"`{name}`", unit, ARRAYS[name]] for name, unit in surface._UNITS.items()
    ]


def case_file() -> list[list[str]]:
    """Columns of case.h5, of every case of `weavecell crossover`."""
    from unitcell3d.cases import load_path, periodic_cell, single_yarn, stack

    rows = [["case", "column", "unit and meaning"]]
    cases = {
        "biaxial, path, platens": load_path,
        "shear, and any with `--domain periodic`": periodic_cell,
        "stack": stack,
        "yarn": single_yarn,
    }
    for name, module in cases.items():
        rows += [[name, f"`columns/{column}`", words] for column, words in module.MEANINGS.items()]
    return rows


def outputs() -> list[list[str]]:
    """Files that each command writes, from the docstrings of the modules of the commands."""
    rows = [["command", "file", "contents"]]
    folders = (ROOT / "weavecell" / name for name in ("api", "results"))
    for path in sorted((path for folder in folders for path in folder.glob("*.py")), key=lambda path: path.name):
        text = ast.get_docstring(ast.parse(path.read_text("utf-8"))) or ""
        head = re.search(r"older of (`weavecell .*)$", text, re.MULTILINE)
        for line in text.splitlines() if head else ():
            found = re.match(r"    ([^\s,]+(?:, [^\s,]+)*)(?:\s+(\S.*))?$", line)
            if found:
                rows.append([head[1], f"`{found[1]}`", (found[2] or "").replace("|", "\\|")])
    return rows
