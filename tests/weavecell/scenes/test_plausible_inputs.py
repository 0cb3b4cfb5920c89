"""Numbers that no woven yarn, block or test has are noted or refused wherever they enter."""

import logging
import re

import pytest

import weavecell as wc
from fabrics.base.errors import InputError
from tests.scene_text import merged, toml
from weavecell.api.target import read_target

YARN = {
    "linear_density": "1100 dtex",
    "fibre_density": "1.44 g/cm^3",
    "modulus": "90 GPa",
    "tenacity": "2060 mN/tex",
    "failure_strain": "3.3 %",
    "count": "8.5 / cm",
}
SHEET = {
    "name": "mine",
    "thickness": "0.30 mm",
    "areal_density": "190 g/m^2",
    "warp": YARN,
    "weft": YARN,
}
SHOT = {
    "fabric": {"file": "fabric.toml", "law": {"a": "0.04 mm", "b": "0.05 mm N^(1/3)"}},
    "projectile": {
        "mass": "1.1 g",
        "diameter": "5.5 mm",
        "edge_radius": "0.3 mm",
        "strike_velocity": "150 m/s",
    },
    "panel": {"opening": "80 mm"},
    "run": {"elements_per_crossover": 1},
}
SHEAR = {"G1": "8.66 MPa", "G2": "8.66 GPa", "gamma1": "0.24", "gamma2": "0.49"}
SOLID = {"E_a": "1 MPa", "E_c": "2 GPa", "K_r": 0.02, "K_G": 0.001, "V_c": 1.0, "Vf0": 0.6}
NO_THICKNESS = {"thickness": None, "areal_density": None}
BLOCK = {"material": "Roma Plastilina No. 1", "size": ["100 mm", "100 mm", "50 mm"]}


def both(**values):
    return {"warp": values, "weft": values}


def notes_of(folder, fabric=None, shot=None):
    """The notes of a set-up, or of its refusal."""
    (folder / "fabric.toml").write_text(toml(merged(SHEET, fabric or {})))
    (folder / "shot.toml").write_text(toml(merged(SHOT, shot or {})))
    try:
        read = read_target(str(folder / "shot.toml"), folder, "shot")
    except InputError as problem:
        return f"refused: {problem}"
    return " | ".join(read.setup.notes)


def test_an_input_as_it_is_has_no_notes(tmp_path):
    assert notes_of(tmp_path) == ""
    assert notes_of(tmp_path, {"shear": SHEAR}, {"backing": BLOCK}) == ""


@pytest.mark.parametrize(
    ("fabric", "shot", "words"),
    [
        (
            {"shear": SHEAR | {"gamma1": "0.0042", "gamma2": "0.0086"}},
            {},
            "refused: .*shear.gamma1",
        ),
        ({"shear": SHEAR | {"G1": "8.66 GPa", "G2": "8.66 MPa"}}, {}, "refused: .*shear.G"),
        ({"shear": SHEAR | {"G1": "866 GPa"}}, {}, "refused: .*shear.G1"),
        ({"shear": SHEAR | {"G2": "1e-6 MPa"}}, {}, "refused: .*shear.G2"),
        ({"failure_length": "7.5 mm"}, {}, "failure_length: failure length over"),
        (
            {"strain_rate": {"rates": ["1 / s", "99 / s"], "strength": [100.0, 120.0]}},
            {},
            "refused: .*strain_rate.strength",
        ),
        (both(effective_linear_density="2200 dtex"), {}, "refused: .*effective_linear_density"),
        (NO_THICKNESS | both(linear_density="110 dtex", crimp="1 %"), {}, "warp.linear_density"),
        (NO_THICKNESS | both(crimp=0.45), {}, "warp.crimp"),
        ({"solid": SOLID | {"E_c": "1.34 MPa"}}, {}, "refused: .*solid.E_c"),
        ({}, {"fabric": {"law": {"b": "50 mm N^(1/3)"}}}, "refused: .*fabric.law.b"),
        (
            {"ply_contact": {"closure": ["0 mm", "40 mm"], "pressure": ["0 Pa", "9 MPa"]}},
            {},
            "refused: .*ply_contact",
        ),
        (both(section_area="50 mm^2"), {}, "refused: .*section_area"),
        (both(width="0.05 mm"), {}, "width of the yarn"),
        ({}, {"backing": BLOCK | {"density": "1.5 kg/m^3"}}, "refused: .*backing.density"),
        ({}, {"backing": BLOCK | {"modulus": "3 Pa"}}, "refused: .*backing.modulus"),
        ({}, {"backing": BLOCK | {"yield_stress": "30 GPa"}}, "refused: .*backing.yield_stress"),
        ({}, {"backing": BLOCK | {"standoff": "10 m"}}, "refused: .*backing.standoff"),
        ({}, {"panel": {"plies": 2, "ply_gap": "5 m"}}, "refused: .*panel.ply_gap"),
        ({}, {"panel": {"strength": {"weibull_shape": 0.5}}}, "refused: .*weibull_shape"),
    ],
)
def test_what_no_woven_yarn_has_is_not_silent(tmp_path, fabric, shot, words):
    assert re.search(words, notes_of(tmp_path, fabric, shot))


CURVE = """shear angle [deg], shear stress [MPa]
5, 0.0873
10, 0.1745
15, 0.2618
20, 0.3491
25, 0.4363
30, 1.167
35, 3.185
40, 6.49
45, 11.08
50, 16.32
"""


def new_fabric(folder, caplog, curve, **options):
    """The lines of `fabrics new` with a picture-frame curve, or of its refusal."""
    rows = ["key,warp,weft"]
    rows += [f"{key},{value}," for key, value in YARN.items()]
    rows += ["thickness,0.30 mm,"]
    (folder / "mine.csv").write_text("\n".join(rows))
    (folder / "frame.csv").write_text(curve)
    with caplog.at_level(logging.INFO, "weavecell"):
        try:
            wc.new_fabric(
                folder / "new.toml",
                values=folder / "mine.csv",
                picture_frame=folder / "frame.csv",
                **options,
            )
        except InputError as problem:
            return f"refused: {problem}"
    return "\n".join(record.getMessage() for record in caplog.records)


def times(curve, angle=1.0, stress=1.0):
    heading, *rows = curve.split("\n")
    found = [heading]
    for row in filter(None, rows):
        first, second = map(float, row.split(","))
        found.append(f"{angle * first:.9g}, {stress * second:.9g}")
    return "\n".join(found)


def test_a_fitted_trellis_law_is_told_with_its_constants(tmp_path, caplog):
    lines = new_fabric(tmp_path, caplog, CURVE)
    found = re.search(
        "fitted: trellis law G1 (.*) MPa, G2 (.*) MPa, gamma1 (.*) deg, gamma2 (.*) deg, rms", lines
    )
    # the law that made the curve
    assert [float(text) for text in found.groups()] == pytest.approx([1, 60, 25, 45], rel=0.05)


@pytest.mark.parametrize("slip", [{"angle": 0.0174533}, {"stress": 1000.0}, {"stress": 0.0}])
def test_a_curve_in_another_unit_is_refused(tmp_path, caplog, slip):
    lines = new_fabric(tmp_path, caplog, times(CURVE, **slip))
    # the curve is named, and not the values of the data sheet
    assert lines.startswith(f"refused: {tmp_path / 'frame.csv'}: ")


def test_a_frame_of_200_metres_is_refused(tmp_path, caplog):
    force = CURVE.replace("shear stress [MPa]", "force [N]")
    force = times(force, stress=100.0)
    assert re.search("refused: .*frame_side", new_fabric(tmp_path, caplog, force, frame_side=200.0))
    assert "note: frame_side" in new_fabric(tmp_path, caplog, force, frame_side=2.0)


def test_a_factor_of_a_sweep_in_percent_is_refused():
    with pytest.raises(InputError, match="modulus"):
        wc.sweep(
            "S-720",
            over={"modulus": [80.0, 120.0], "projectile.strike_velocity": ["90 m/s"]},
            check=True,
        )
