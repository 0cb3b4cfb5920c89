"""`weavecell coupon` on every kind of scene, and the commands of shots on scenes of coupons and the other way round."""

import json

import pytest
from test_scene_matrix import SHOT, call, rejected, written
from test_supported import LAW, SURFACE, merged

STRIP = {
    "fabric": {"name": "S-720"},
    "uniaxial": {"direction": "warp", "length": "13 mm", "width": "6.5 mm", "strain": "1.5 %"},
    "run": {"steps": 1, "tolerance": 1e-3, "outputs": []},
}
FRAME = {"fabric": {"name": "S-720"}, "picture_frame": {"shear_angle": "20 deg", "crossovers": 2}, "run": STRIP["run"]}
REJECTED = {
    "surface": ({"surface": SURFACE}, f"fabric.surface = '{SURFACE}': must be left out: the cell of a coupon is made"),
    "bending": ({"bending": "1e-6 N m^2"}, "fabric.bending = '1e-6 N m^2': must be left out: the yarns of a coupon"),
    "form": ({"cell_formulation": "equilibrium"}, "fabric.cell_formulation = 'equilibrium': must be variational"),
    "unused law": ({"cell_model": "decoupled", "law": LAW}, "fabric.law: must be left out where fabric.cell_model"),
    "unused gap": (
        {"cell_model": "decoupled", "crossover_gap": "0.01 mm"},
        "fabric.crossover_gap = '0.01 mm': must be left out where",
    ),
}
# [fabric] of the strip: whether its load at the end is higher (1) or lower (-1) than with the defaults, or another (0)
SHOWN = {
    "toe": ({"fibre_slack": "0.5 %"}, -1),
    "law": ({"law": LAW}, 0),
    "incompressible": ({"cell_model": "incompressible"}, 1),
    "decoupled": ({"cell_model": "decoupled"}, -1),
    "play": ({"crossover_gap": "0.02 mm"}, -1),
    "straight": ({"cell_profile": "straight"}, 0),
    "nominal": ({"linear_density": "nominal"}, -1),
    "fabric": ({"name": "S-728"}, 0),
}


def end(capsys, folder, table):
    code, _, err = call(capsys, "coupon", written(folder, table), "--out", folder / "r")
    assert code == 0, err
    told = json.loads((folder / "r/summary.json").read_text())
    return told, {name: entry["value"] for name, entry in told["at_end"].items()}


@pytest.fixture(scope="module")
def known():
    return {}


@pytest.mark.parametrize("name", SHOWN)
def test_honoured(capsys, tmp_path, known, name):
    if not known:
        (tmp_path / "plain").mkdir()
        known.update(end(capsys, tmp_path / "plain", STRIP)[1])
    changes, sign = SHOWN[name]
    change = (
        end(capsys, tmp_path, merged(STRIP, {"fabric": changes}))[1]["load of a yarn"] / known["load of a yarn"] - 1
    )
    assert (sign or 1) * (change if sign else abs(change)) > 1e-3


def test_finer_elements_and_a_title(capsys, tmp_path):
    (tmp_path / "plain").mkdir()
    plain, _ = end(capsys, tmp_path / "plain", FRAME)
    told, _ = end(capsys, tmp_path, merged(FRAME, {"title": "mine", "run": {"elements_per_crossover": 2}}))
    assert (plain["elements"], told["elements"], told["title"]) == (4, 16, "mine")


@pytest.mark.parametrize("name", REJECTED)
def test_rejected(capsys, tmp_path, name):
    changes, told = REJECTED[name]
    path = written(tmp_path, merged(STRIP, {"fabric": changes}))
    rejected(capsys, tmp_path, ("coupon", path, "--out", tmp_path / "r"), told)


@pytest.mark.parametrize(
    ("command", "table", "told", "lines"),
    [
        ("coupon", SHOT, "run.end_time: unknown key", 5),
        ("impact", STRIP, "run.steps: unknown key", 5),
        ("critical-velocity", STRIP, "run.steps: unknown key", 5),
    ],
)
def test_a_scene_of_another_kind_is_rejected(capsys, tmp_path, command, table, told, lines):
    """Every key that is wrong or missing has its line."""
    rejected(capsys, tmp_path, (command, written(tmp_path, table), "--out", tmp_path / "r"), told, lines=lines)
