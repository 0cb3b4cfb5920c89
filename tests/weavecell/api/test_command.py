"""A command is a plan: its check and its run are of one plan, and an option that changes no plan does nothing."""

import fcntl
import inspect

import pytest

import weavecell as wc
from fabrics.base.errors import InputError
from tests import commands
from tests.commands import without_effect
from weavecell.api.command import Plan
from weavecell.cli import app
from weavecell.results import out_folder

# they have a result, and compute nothing that takes long
WITHOUT_PLAN = {"reduce tests", "reduce compression", "reduce shot", "export", "next"}
TARGETS = {
    "ply": {},
    "pack": {"plies": 2},
    "yarns": {"crossovers": "yarns"},
    "auto": {"crossovers": "auto"},
    "block": {"backing": "gelatine 10 %"},
    "metal": {"projectile": "FSP 1.10 g"},
}
SCAN = {
    "scan": [True, False],
}
OF_V50 = {"shots": [8, 9], "seed": [1, 2]}
OPTIONS = {
    "impact": {
        "draws": [2, 3],
        "seed": [1, 2],
        "uncertainty": [True, False],
    },
    "critical_velocity": {
        "tolerance": ["1 m/s", "7 m/s"],
        "v50_shots": [5, 9],
        "residual_shots": [1, 5],
        **SCAN,
    },
    "v50": {
        "batch": [4, 5],
        "within": ["5 %", 0.1],
        **OF_V50,
    },
    "compare": {
        **OF_V50,
    },
}
SWEPT = {
    "tolerance": [1, 2],
    "shots": [8, 9],
    "seed": [1, 2],
}


@pytest.fixture
def arguments():
    """What comes first in a call of a command."""
    return {"compare": ["S-720", "S-728"], "impact": ["S-720", "90 m/s"]}


@pytest.mark.parametrize("name", OPTIONS)
@pytest.mark.parametrize("kind", TARGETS)
def test_each_option_is_refused_or_changes_the_plan(kind, name, arguments):
    function = getattr(wc, name)
    given = {"opening": "40 mm"} | TARGETS[kind]
    first = arguments.get(name, ["S-720"])
    assert without_effect(function, first, given, OPTIONS[name]) == []


@pytest.mark.parametrize("quantity", ["shot", "critical-velocity", "v50"])
def test_each_option_of_a_sweep_is_refused_or_changes_the_plan(quantity):
    over = {"panel.opening": ["30 mm", "40 mm"], "projectile.strike_velocity": ["90 m/s"]}
    given = {"over": over, "quantity": quantity}
    assert without_effect(wc.sweep, ["S-720"], given, SWEPT) == []


def test_the_options_that_are_tried_are_all_that_the_commands_have():
    for name, tried in (OPTIONS | {"sweep": SWEPT | {"over": [], "quantity": []}}).items():
        own = inspect.signature(getattr(wc, name)).parameters.values()
        named = {one.name for one in own if one.kind is one.KEYWORD_ONLY}
        assert named - {"check", "out", "resume"} == set(tried), name


def test_all_that_compute_have_a_plan_and_a_check():
    for words, (called, *_) in app.COMMANDS.items():
        function = app.find_function(called)
        computes = commands.answers(words) and words not in WITHOUT_PLAN
        assert hasattr(function, "plan") == computes, words
        has_check = "check" in inspect.signature(function).parameters
        assert has_check == hasattr(function, "plan"), words
    for kind in Plan.__subclasses__():
        assert {"forecast", "run"} <= vars(kind).keys(), kind


class Computed(Exception):
    """Something is computed."""


CALLS = {
    "impact": {"velocity": "90 m/s", "opening": "20 mm", "end_time": "10 us"},
    "critical_velocity": {"opening": "50 mm"},
    "v50": {"opening": "50 mm"},
    "compare": {"other": "S-728", "opening": "50 mm"},
    "sweep": {
        "over": {"panel.opening": ["20 mm"]},
        "quantity": "critical-velocity",
    },
    "biaxial": {},
    "coupon": {"test": "picture_frame", "crossovers": 2, "shear_angle": "4 deg"},
}
NAMES = {"impact": "report.html", "biaxial": "biaxial.csv"}


@pytest.mark.parametrize("name", CALLS)
@pytest.mark.parametrize("place", ["mine", "file", "file/inside", "locked", "others", "free"])
def test_a_check_refuses_the_folder_that_the_run_refuses(name, place, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)

    def computed(*_):
        raise Computed

    for kind in Plan.__subclasses__():
        monkeypatch.setattr(kind, "run", computed)
    function = getattr(wc, name)
    written = NAMES.get(name, "scene.toml" if name != "compare" else "difference.csv")
    for folder in ("mine", "locked"):
        (tmp_path / folder).mkdir()
    (tmp_path / "mine" / written).write_text("of the user")
    (tmp_path / "file").write_text("of the user")
    resumable = name != "biaxial"
    if place == "others" and resumable:
        with out_folder.hold("others", [], inputs=["another input"]):
            (tmp_path / "others" / "kept").write_text("")
    first = ["S-720"]

    def answer(check):
        given = CALLS[name] | {"out": place, "check": check}
        if place == "others" and resumable:
            given["resume"] = True
        try:
            function(*first, **given)
        except Computed:
            return ""
        except InputError as problem:
            return str(problem)
        return ""

    with open(tmp_path / "locked" / out_folder.LOCK, "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        said = [answer(True), answer(False)]
    assert said[0] == said[1]
    refused = place != "free" and (resumable or place != "others")
    assert bool(said[0]) == refused
    made = {path.name for path in tmp_path.rglob("*")}
    assert made <= {"mine", "locked", "others", "kept", "file", written, out_folder.LOCK, *_LISTS}


# the list of a folder, and the folder of runs
_LISTS = {".weavecell-files", "runs"}
