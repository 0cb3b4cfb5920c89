"""The label of an axis that shows a column is that of its key, with the unit and factor of the key's unit."""

import ast
from pathlib import Path

import pytest

from weavecell import report
from weavecell.results import keys

FOLDER = Path(report.__file__).parent
# what no column of a result has: places, shares and differences that a figure computes itself, columns of the record
# of a 3D crossover, whose names are symbols, and the axes of pictures
BY_HAND = {
    "pictures.py": {
        "contact force F [N]",
        "compression of one yarn d$_c$ [µm]",
        "strain of the cell [%]",
        "yarn tension [N]",
    },
    "pictures_biaxial.py": {
        "measured less computed [N]",
        "rise of the sum of squares / s²",
    },
    "pictures_body.py": {"from the centre [µm]", "r [mm]", "along the axis [mm]"},
    "pictures_comparison.py": {
        "A less B [m/s]: above 0, A is better",
        "share that passes [-]",
    },
    "pictures_coupon.py": {
        "mm",
        "crossovers",
        "iterations, all steps",
        "out of balance / reaction",
    },
    "pictures_crossover.py": {
        "strain of the end distance [%]",
        "tension [N]",
        "closure of the plates per ply [µm]",
        "mean pressure [MPa]",
        "force [N]",
        "share of the path [%]",
        "end displacement [µm]",
        "shear stress [MPa]",
        "shear angle γ [rad]",
        "contact force [N]",
        "pull along the axis [µm]",
        "axial force [N]",
        "contact force F$_c$ [N]",
        "slip threshold T$_f$ [N]",
        "closed by the plates [µm]",
        "pressure [MPa]",
    },
    "pictures_quality.py": {"scaled Jacobian", "share of the yarns' hexahedra [%]"},
    "pictures_records.py": {
        "pressure [MPa]",
        "closed since the first load [µm]",
        "record less curve [µm]",
        "displacement of the crosshead without slack [mm]",
        "load [N]",
        "number of crossings",
        "peak load [N]",
    },
    "pictures_shot.py": {"energy [J]", "error [%]", "z [mm]", "x [mm]"},
    "pictures_surface.py": {
        "d$_1$ [µm]",
        "d$_2$ [µm]",
        "force [N]",
        "largest miss [% of the largest]",
        "strain along the warp [%]",
        "strain along the weft [%]",
    },
    "pictures_uncertainty.py": {"share that passes [-]", "share that stops [-]", "plies [-]"},
}


def labels_by_hand(tree):
    """The texts that are given as labels of axes."""
    for node in ast.walk(tree):
        given = ()
        if isinstance(node, ast.keyword) and node.arg in ("xlabel", "ylabel"):
            given = (node.value,)
        elif isinstance(node, ast.Call) and getattr(node.func, "attr", "") in (
            "set_xlabel",
            "set_ylabel",
        ):
            given = node.args
        yield from (one.value for one in given if isinstance(one, ast.Constant))


def test_no_label_is_written_by_hand_where_a_column_is_drawn():
    found = {}
    for file in sorted(FOLDER.rglob("pictures*.py")):
        if labels := set(labels_by_hand(ast.parse(file.read_text(encoding="utf-8")))):
            found[file.name] = labels
    assert found == BY_HAND


@pytest.mark.parametrize(
    "name, of, axis",
    [
        ("deflection", "histories", ("deflection of the back face [mm]", 1e3)),
        ("time", "histories", ("time after strike [µs]", 1e6)),
        ("time_s", "shot", ("time [µs]", 1e6)),
        ("strain", "yarn", ("strain of the fibres [%]", 100.0)),
        ("force_N", "shot", ("force [N]", 1.0)),
        ("v50_m_s", "", ("V50 [m/s]", 1.0)),
        ("residual_velocity_m_s", "", ("residual velocity [m/s]", 1.0)),
    ],
)
def test_an_axis_has_words_unit_and_factor_of_its_key(name, of, axis):
    assert keys.find_axis(name, of) == axis
