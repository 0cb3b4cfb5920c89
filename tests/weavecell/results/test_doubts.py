"""A number stands nowhere without its doubt: each place that shows a result says what is doubtful of it."""

import ast
import json
import re
from dataclasses import replace
from html import unescape
from pathlib import Path
from unittest import mock

import numpy as np
import pytest

import weavecell as wc
from shellfabric.membrane.indicator import Indicator
from tests.scene_text import toml
from tests.weavecell.golden_texts import cases
from tests.weavecell.session_runs import small_calibration
from weavecell.answers.result import Result
from weavecell.cli import app
from weavecell.report.shot import beside
from weavecell.results.finding import LABEL, Answer
from weavecell.runs import laboratory_tests, table
from weavecell.scenes import build
from weavecell.scenes.coupon import CouponScene
from weavecell.scenes.fabric_table import check_scene
from weavecell.studies import ballistic_limit, protocol

ROOT = Path(__file__).parents[3]
BAD = Indicator("energy error", 0.031, 0.01, meaning="what the balance misses")
SMALL = {"opening": "50 mm", "elements_per_crossover": 1}
# shots 1 to 3 once more and once more
PASTED = "velocity [m/s], outcome\n" + 3 * "90, PP\n124, CP\n105, CP\n"
SHORT = {"opening": "20 mm", "end_time": "10 us"}
MADE = {
    "critical_velocity": lambda out: wc.critical_velocity("S-720", **SMALL, out=out),
    "v50": lambda out: wc.v50("S-728", shots=6, batch=6, **SMALL, out=out),
    "compare": lambda out: wc.compare("S-720", "S-728", shots=4, **SMALL, out=out),
    "sweep": lambda out: wc.sweep(
        "S-720", over={"panel.opening": ["40 mm", "50 mm"]}, quantity="critical-velocity", out=out
    ),
    "tests": lambda out: wc.reduce_tests("pasted.csv", out=out),
    "impact": lambda out: _with_doubt(wc.impact("S-720", "150 m/s", **SHORT), out),
    "coupon": lambda out: _with_doubt(
        wc.coupon("S-720", "picture_frame", shear_angle="4 deg", crossovers=2, steps=2), out
    ),
    "mesh": lambda out: _with_doubt(wc.mesh("S-720", mesh="3,2,2"), out),
    "biaxial": lambda out: _with_doubt(wc.biaxial("S-731", ratio=["2:1"]), out),
    "biaxial fit": lambda out: _with_doubt(wc.calibrate("S-731", biaxial=_tests_of_paths()), out),
    "surface": lambda out: _with_doubt(_surface(), out),
    "crossover": lambda out: _with_doubt(wc.crossover.yarn("S-720", mesh="3,2,2"), out),
    "calibrate": lambda out: _with_doubt(_calibration(), out),
}
NEEDS_SOLIDS = ("surface", "crossover", "calibrate")
# results of seconds, each of a class whose siblings are quicker
SLOW = ("compare", "surface", "calibrate")


def _with_doubt(result, out):
    if "checks" in getattr(result, "__dataclass_fields__", {}):
        doubtful = replace(result, checks=(BAD,))
    else:
        # a class of its own, whose checks are not computed
        kind = type(result)
        doubtful = replace(result)
        judged = type(kind.__name__, (kind,), {"checks": (BAD,)})
        object.__setattr__(doubtful, "__class__", judged)
    doubtful.save(out)
    return doubtful


def _tests_of_paths():
    """A file of tests that were drawn from the cell itself."""
    path = wc.biaxial("S-731", ratio=["1:1"]).paths["1:1"]
    rows = zip(100 * path.strain[::16], path.tension[::16])
    lines = [f"k1, {e[0]}, {e[1]}, {T[0]}, {T[1]}" for e, T in rows]
    head = "test, warp strain [%], weft strain [%], warp load [N], weft load [N]"
    Path("paths.csv").write_text("\n".join([head, *lines]))
    return "paths.csv"


def _surface():
    """The surface of an invented crossover, in place of a sampled one."""
    from fabrics.surface import ResponseSurface
    from unitcell3d.identify.interpolant import errors
    from unitcell3d.identify.response_surface import Sampled
    from weavecell.answers.surface import SurfaceResult

    d1, d2 = np.linspace(0, 2e-5, 5), np.linspace(0, 3e-5, 6)
    x, y = np.meshgrid(1e5 * d1, 1e5 * d2, indexing="ij")
    of = {"T1": 90 * x + 7 * x * y, "T2": 80 * y + 7 * x * y, "F_c": 3 + 5 * x * y}
    heights = {"h1": 6e-5 - 1e-5 * x, "h2": 5e-5 - 1e-5 * y}
    surface = ResponseSurface(d1, d2, **of, **heights, fabric="S-720", provenance="invented")
    sampled = Sampled(surface, errors(surface), {"sampling": 1.0}, 90, 30)
    return SurfaceResult(wc.fabric("S-720"), sampled, {"mesh": "none", "friction": 0.0})


def test_a_doubtful_law_is_told_wherever_it_is_used(tmp_path, caplog):
    """In the log as it is read, and beside its name in the results of what reads it."""
    law = replace(wc.fabric("S-728").laws[0], fabric="S-720", doubts="misfit of the law")
    law.to_json(tmp_path / "law.json")
    found = wc.setup("S-720", 90.0, law=tmp_path / "law.json")
    assert found.laws[0].doubts == "misfit of the law"
    assert "law.json is doubtful: misfit of the law" in caplog.text
    table = {
        "fabric": {"name": "S-720", "law": "law.json"},
        "picture_frame": {"shear_angle": "5 deg"},
    }
    scene = tmp_path / "scene.toml"
    scene.write_text(toml(table))
    case = build.build(check_scene(CouponScene, table, scene), scene, "scene")
    assert case.law_name == "fitted to the 3D crossover, DOUBTFUL: misfit of the law"


def _calibration():
    with small_calibration():
        return wc.calibrate("S-720", mesh="coarse", assumed_range=False)


def show_everywhere(result, folder):
    """{place: {label: words}} of a written result: terminal, JSON, loaded, page, exit code."""
    rows = dict(result.answer.rows)
    found = {}
    if type(result).answer is not Result.answer:
        found["terminal"] = _read_lines(str(result).splitlines()[1:])
        found["terminal"].pop("files", None)
    entries = [
        content["answer"]
        for path in folder.glob("*.json")
        if isinstance((content := json.loads(path.read_text())).get("answer"), dict)
    ]
    for entry in entries:
        found["JSON"] = dict(Answer.read(entry).rows)
    if entries:
        loaded = wc.load(folder)
        found["load"] = dict(loaded.answer.rows)
        if type(result).answer is not Result.answer:
            found["loaded terminal"] = _read_lines(str(loaded).splitlines()[1:])
            found["loaded terminal"].pop("files", None)
        found["exit code"] = rows if loaded.doubtful == result.doubtful else {}
    page = folder / "report.html"
    if page.exists():
        header = re.sub(r"</?abbr[^>]*>", "", page.read_text("utf-8").partition("<nav>")[0])
        words = " ".join(unescape(re.sub(r"<[^>]+>", " ", header)).split())
        # the page says what was asked in its title
        shown = {name: text for name, text in rows.items() if " ".join(text.split()) in words}
        found["page"] = {name: shown.get(name, "is not there") for name in rows if name != "next"}
    return found


def find_contradictions(result, shown):
    """(place, label) where a result is shown other than its Answer says."""
    wrong = []
    for place, told in shown.items():
        rows = dict(result.answer.rows)
        if place == "page":
            rows.pop("next", None)
        wrong += [(place, name) for name in {*told, *rows} if told.get(name) != rows.get(name)]
    return wrong


def _read_lines(lines):
    """{label: words} of the lines of an answer."""
    found = {}
    for line in lines:
        label, _, words = line.partition("  ")
        if len(label) > LABEL:
            label, words = line[:LABEL].strip(), line[LABEL:]
        found[label.strip()] = words.strip()
    return found


def test_what_a_page_and_a_file_say_is_the_answer_alone():
    """No other function of the interface makes one."""
    makers = set()
    folders = (ROOT / "weavecell/answers", ROOT / "weavecell/api")
    for path in [path for folder in folders for path in folder.glob("*.py")]:
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.FunctionDef):
                called = {
                    ast.unparse(one.func) for one in ast.walk(node) if isinstance(one, ast.Call)
                }
                if called & {"self._find_answer", "Answer"}:
                    makers.add(node.name)
    assert makers == {"answer", "_find_answer"}


def fire(setup, velocity, time, stops_below=0.0):
    """An invented shot, doubtful."""
    residual = max(velocity**2 - 104.0**2, 0.0) ** 0.5
    outcome = "perforated" if residual else "stopped"
    return ballistic_limit.Shot(
        velocity, residual, outcome, 1e-4, 3.0, (90.0, 70.0), 0.031, 0.5, (BAD,)
    )


@pytest.mark.filterwarnings("ignore::fabrics.base.errors.DoubtfulResult")
@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.slow if name in SLOW else ()) for name in MADE]
)
def test_every_place_that_shows_a_result_says_its_doubt(name, tmp_path, monkeypatch):
    """Terminal, notebook, summary, warning, JSON, what is loaded, banner, card and colour of the page, picture."""
    monkeypatch.chdir(tmp_path)
    Path("pasted.csv").write_text(PASTED)
    if name in NEEDS_SOLIDS:
        pytest.importorskip("dolfinx")
    with mock.patch.object(ballistic_limit, "_fire", fire):
        result = MADE[name]("r")
    (doubt, *_) = result.doubts
    assert result.doubtful
    assert "DOUBTFUL" in " ".join(str(result).splitlines()[:2])
    shown = show_everywhere(result, Path("r"))
    assert find_contradictions(result, shown) == []
    # what one place shows otherwise is found
    for place, rows in shown.items():
        for label, old, new in (("answer", "DOUBTFUL: ", ""), ("doubts", doubt, doubt[1:])):
            assert old in rows[label]
            planted = {**shown, place: {**rows, label: rows[label].replace(old, new, 1)}}
            assert find_contradictions(result, planted) == [(place, label)]
    assert doubt in str(result)
    notebook = result._repr_html_()
    assert "DOUBTFUL" in notebook.partition("</b>")[0]
    assert "DOUBTFUL" in repr(result) or "doubtful" in repr(result)
    assert doubt in result.summary()["doubts"]
    with pytest.warns(wc.DoubtfulResult, match="doubtful"):
        result.warn()
    written = [json.loads(path.read_text()) for path in Path("r").glob("*.json")]
    told = [content["doubts"] for content in written if content.get("doubts")]
    # a law of yarns has what is doubtful of it in words, as it is read by what uses it
    assert told
    for one in told:
        assert one in ([*result.doubts], "; ".join(result.doubts))
    if name not in ("impact", "coupon"):
        loaded = wc.load("r")
        assert loaded.doubts == result.doubts
        assert "DOUBTFUL" in " ".join(str(loaded).splitlines()[:2])
    page = Path("r/report.html")
    if page.exists():
        header = re.sub(r"</?abbr[^>]*>", "", page.read_text("utf-8").partition("<nav>")[0])
        (tone, banner) = re.search(r'<div class="answer (\w+)">(.*?)</p>', header, re.S).groups()
        assert (tone, "DOUBTFUL" in banner) == ("doubtful", True)
    if hasattr(result, "plot"):
        texts = " ".join(" ".join(text.get_text() for text in result.plot().texts).split())
        assert f"DOUBTFUL: {doubt}" in texts
    for picture in Path("r").rglob("*.svg"):
        assert "DOUBTFUL" in picture.read_text(), picture


@pytest.mark.filterwarnings("ignore::fabrics.base.errors.DoubtfulResult")
def test_doubtful_shots_beside_each_other_and_over_each_other(tmp_path):
    sure = wc.impact("S-720", "150 m/s", **SHORT)
    doubtful = replace(sure, checks=(BAD,))
    assert [name.endswith("(doubtful)") for name in beside.names([sure, doubtful])] == [False, True]
    labels = wc.overlay(sure, doubtful).axes[0].get_legend_handles_labels()[1]
    assert [label.endswith("(doubtful)") for label in labels] == [False, True]


def test_strict_is_for_every_doubt(tmp_path, monkeypatch, capsys):
    """Also one that is no check, such as a list that was pasted."""
    monkeypatch.chdir(tmp_path)
    Path("pasted.csv").write_text(PASTED)
    with pytest.raises(SystemExit) as leaving:
        app.main(["reduce", "tests", "pasted.csv", "--out", "r", "--strict"])
    assert leaving.value.code == 3
    assert "the 9 tests are the same 3 tests 3 times" in capsys.readouterr().out.splitlines()[0]


def test_exchanged_outcomes_have_no_v50_of_six_shots():
    strikes = [96.0, 99.0, 103.0, 104.0, 108.0, 111.0]
    right = protocol.six_shots(strikes, [False, False, True, False, True, True])
    assert (right.met, right.doubt) == (60, "")
    exchanged = protocol.six_shots(strikes, [True, True, False, True, False, False])
    assert exchanged.met is None
    assert "are the outcomes exchanged?" in exchanged.words()
    assert "meets" not in exchanged.words()


def test_only_a_list_that_comes_again_is_pasted():
    rows = [(90.0, "stopped"), (124.0, "perforated"), (105.0, "perforated")]
    assert laboratory_tests.doubt_repeats(2 * rows)
    assert not laboratory_tests.doubt_repeats([*rows, *rows[:2]])
    # two tests alike are chance
    assert not laboratory_tests.doubt_repeats(2 * rows[:2])
    assert not laboratory_tests.doubt_repeats(rows)


def test_residual_velocities_that_are_missing_are_the_reason(tmp_path):
    file = tmp_path / "t.csv"
    file.write_text("velocity [m/s], outcome\n90, PP\n124, CP\n105, CP\n112, PP\n131, CP\n")
    reduced = wc.reduce_tests(file).reduced
    assert reduced.lambert_jonas.reason == "3 of 3 perforations have no residual velocity"


@pytest.mark.parametrize("heavier", [True, False])
def test_panels_of_other_masses_are_compared_per_areal_density_first(heavier, monkeypatch):
    """A pack of two plies has twice the mass of one; what is alike in mass is compared by V50 alone."""
    monkeypatch.setattr(ballistic_limit, "_fire", fire)
    with cases.invented():
        wider = wc.setup("S-720", "100 m/s", **SMALL | {"opening": "60 mm"})
        alike = wc.compare(wc.setup("S-720", "100 m/s", **SMALL), wider, shots=8)
    assert "per areal density" not in alike.answer.value
    a, b = ("S-720", "S-728") if heavier else ("S-728", "S-720")
    with cases.invented():
        other = wc.compare(a, b, shots=8, **SMALL)
    value = other.answer.value
    assert value.startswith("per areal density ")
    assert ("more mass" if heavier else "less mass") in other.answer.over
    assert value.index("per areal density") < value.index("V50")


def test_a_drawn_shot_says_its_checks():
    of = (90.0, 0.0, False, 1)
    doubts = ("yarn snap", "energy error")
    assert table.Shot(*of).checks == "ok"
    assert table.Shot(*of, doubtful=doubts).checks == f"doubtful: {', '.join(doubts)}"
