"""Messages name options in the words of the door that was used, and suggest names by value."""

import re
from pathlib import Path

import numpy as np
import pytest

import weavecell as wc
from fabrics import backings, catalogue, projectiles
from fabrics.base import door, executors
from fabrics.base.errors import InputError, nearest_name
from tests.scene_text import impact_scene
from weavecell.scenes import fabric_file

ROOT = Path(__file__).parents[3]
PARTS = ("api", "studies", "results", "scenes", "report/shot")


def test_options_have_the_words_of_the_door():
    assert door.option("mesh_error") == "mesh_error=True"
    assert door.option("end_displacement", "") == "end_displacement"
    with door.open_terminal():
        assert door.option("mesh_error") == "--mesh-error"
        assert door.option("end_displacement", "") == "--end-displacement"
    assert door.option("resume") == "resume=True"


def refuse_executor():
    with pytest.raises(InputError) as refused:
        executors.open_executor("slurm", 1).__enter__()
    return str(refused.value)


def refuse_two_curves():
    draft = fabric_file.Draft("mine", {})
    with pytest.raises(InputError) as refused:
        fabric_file.with_curves(draft, frame="a.csv", bias="b.csv")
    return str(refused.value)


@pytest.mark.parametrize(
    "tell, terminal, python",
    [
        (refuse_executor, "--executor = 'slurm'", "executor = 'slurm'"),
        (refuse_two_curves, "--picture-frame or --bias-extension", "picture_frame or bias_ext"),
    ],
)
def test_a_message_names_the_option_as_the_user_writes_it(tell, terminal, python):
    with door.open_terminal():
        assert terminal in tell()
    assert python in tell()
    assert "--" not in tell()


def test_no_message_has_an_option_of_the_command_line_in_it():
    """Texts of the packages below the command line go through `door.option`."""
    found = []
    for folder in ("fabrics/base", *(f"weavecell/{part}" for part in PARTS)):
        for path in (ROOT / folder).glob("*.py"):
            code = re.sub(r'"""[\s\S]*?"""|#.*', "", path.read_text())
            for text in re.findall(r'"[^"\n]*--[a-z][^"\n]*"', code):
                # what is kept in files, and named by `door.name_options` when it is shown
                kept = path.name == "gone.py" or re.fullmatch(r'"--[a-z-]+( \d+)?"', text)
                # commands are quoted, and arguments of git begin so
                quoted = re.search(r"`(--|weavecell )", text)
                if not quoted and path.name != "provenance.py" and not kept:
                    found.append((path.name, text))
    assert found == []


@pytest.mark.parametrize(
    "name, suggested",
    [
        ("FSP 18 gr", "FSP 1.10 g"),
        ("FSP 16 grain", "FSP 1.10 g"),
        ("FSP .22", "FSP 1.10 g"),
        ("FSP 200 grain", "FSP 13.4 g"),
        ("FSP 46 gr", "FSP 2.79 g"),
        ("RCC 1.04 g", "RCC 16 grain"),
        ("FSP 20 g", None),
        ("FSP 8 g", None),
        ("bullet", None),
    ],
)
def test_a_projectile_is_suggested_by_its_value(name, suggested):
    with pytest.raises(InputError) as refused:
        projectiles.entry(name)
    said = re.search('did you mean "([^"]*)"', str(refused.value))
    assert (said and said[1]) == suggested


@pytest.mark.parametrize("name", ["FSP 1.1 g", "fsp 1.1 g"])
def test_a_projectile_is_the_only_one_that_a_name_means(name):
    assert projectiles.entry(name) == projectiles.entry("FSP 1.10 g")


def test_a_sphere_of_steel_is_one_of_any_diameter():
    shape, data = projectiles.entry("sphere 12.1 mm")
    assert (shape, data["mass"]["value"]) == (
        "sphere",
        "7.282 g",
    )  # pi / 6 (12.1 mm)^3 of 7.85 g/cm^3


def test_a_name_with_another_number_is_no_suggestion():
    assert nearest_name("S-721", catalogue.list_names()) is None
    assert nearest_name("S728", catalogue.list_names()) == "S-728"
    assert nearest_name("gelatine 15 %", backings.list_names()) is None
    assert nearest_name("gelatin 10 %", backings.list_names()) == "gelatine 10 %"


RUNS = {"projectile.strike_velocity": ["90 m/s"]}
FAR = {"opening": "100 mm", "snapshot_interval": "0.001 ns"}
TABLES = "must be a list of dicts with the keys of"


@pytest.mark.parametrize(
    "call, words",
    [
        (lambda: wc.impact("S-720", "155 m/s", plys=2), "did you mean plies?"),
        (lambda: wc.impact("S-720", "155 m/s", plys=[{}]), "did you mean ply?"),
        (lambda: wc.impact("S-720", "155 m/s", layers=2), "did you mean plies?"),
        (
            lambda: wc.impact("S-720", "155 m/s", ply=3),
            rf"{TABLES} \[\[panel.ply\]\]; equal plies are plies=3",
        ),
        (
            lambda: wc.impact("S-720", "155 m/s", numerics=3),
            r"must be a dict with the keys of \[numerics\]",
        ),
        (lambda: wc.impact("S-720", "155"), "velocity = '155': has no unit"),
        (lambda: wc.impact("S-720", 1550), "velocity = 1550: must be a speed"),
        (
            lambda: wc.impact("S-720", "155 m/s", check=True, **FAR),
            "^snapshot_interval: must be longer: ",
        ),
        (
            lambda: wc.sweep("S-720", over={"panel.plies": np.arange(2)} | RUNS, check=True),
            "^over, panel.plies = 0: must be a whole number",
        ),
        (
            lambda: wc.coupon("S-720", "picture_frame", shear="20 deg"),
            "is not a keyword of a coupon's picture_frame, did you mean shear_angle?",
        ),
        (lambda: wc.coupon("S-720", "pictureframe"), 'did you mean "picture_frame"?'),
    ],
)
def test_python_is_answered_in_its_words(call, words):
    with pytest.raises(InputError, match=words.replace("?", r"\?")):
        call()


def test_a_keyword_that_is_none_is_no_key_of_the_input_file(tmp_path):
    (tmp_path / "s.toml").write_text(impact_scene())
    for target in (tmp_path / "s.toml", "S-720", wc.setup("S-720", 90.0, opening=0.02)):
        with pytest.raises(InputError, match=r"bracket = .*is not a keyword of critical_velocity"):
            wc.critical_velocity(target, bracket=("80 m/s", "120 m/s"))


def test_numbers_of_numpy_are_values_of_a_sweep():
    sizes = wc.sweep("S-720", over={"panel.plies": np.arange(1, 3)} | RUNS, check=True)
    assert "2 x shot" in str(sizes)
