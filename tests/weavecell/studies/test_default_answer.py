"""What a command answers by default: over what nobody knows, the same wherever the result is shown."""

import json
import re
from html import unescape
from pathlib import Path

import pandas as pd
import pytest

import weavecell as wc
from fabrics.base import door
from tests.scene_text import merged, toml
from weavecell.runs import table

pytestmark = pytest.mark.filterwarnings("ignore::UserWarning", "ignore::weavecell.DoubtfulResult")
FLAT = {"mass": "3 g", "diameter": "5.5 mm", "edge_radius": "0.3 mm"}
SPHERE = {"shape": "sphere", "mass": "0.69 g", "diameter": "5.5 mm"}
SCENE = {
    "fabric": {"name": "S-728"},
    "projectile": FLAT | {"strike_velocity": "140 m/s"},
    "panel": {"opening": "24 mm"},
    "run": {"end_time": "20 us", "outputs": ["report"]},
}
BLOCK = {
    "modulus": "100 MPa",
    "size": ["40 mm", "40 mm", "10 mm"],
    "min_size": "3 mm",
    "growth": 1.6,
}
# {what is shot at: changes of the scene}; each in less than a second
SCENES = {
    "one ply": {},
    "pack": {"panel": {"plies": 2, "stacking": "alternating"}, "run": {"end_time": "12 us"}},
    "chisel": {"projectile": {"name": "FSP 1.10 g", "strike_velocity": "150 m/s"}},
    "sphere": {"projectile": SPHERE | {"strike_velocity": "110 m/s"}},
    "block behind": {"backing": BLOCK, "run": {"end_time": "8 us"}},
}


def write(path, name):
    changes = SCENES[name]
    scene = merged(SCENE, changes)
    if "projectile" in changes:
        scene["projectile"] = changes["projectile"]
    path.write_text(toml(scene))


def shown_on(page):
    """The texts at the top of a page, without the marks of its words."""
    top = re.search(r'<div class="answer \w+">(.*?)</div>', page, re.S)[1]
    texts = re.findall(r"<(?:p|dt|dd)[^>]*>(.*?)</(?:p|dt|dd)>", top, re.S)
    return [unescape(re.sub(r"<[^>]*>", "", text)) for text in texts]


def check_alike(loaded, printed, folder, file):
    """Terminal, page, JSON file, loaded result: one answer, in eight lines."""
    answer = loaded.answer
    with door.open_terminal():
        lines = loaded.answer.lines(Path("r"))
    assert printed.splitlines() == lines
    assert len(lines) <= 8
    content = json.loads((folder / file).read_text())
    assert content["answer"]["value"] == loaded.summary()["answer"] == answer.value
    page = (folder / "report.html").read_text("utf-8")
    shown = shown_on(page)
    assert shown[0] == answer.rows[0][1]
    opened = re.sub(r"<details.*?</details>", "", page, flags=re.S)
    assert unescape(re.sub(r"<[^>]*>", "", opened)).count(answer.value) == 1
    for label, words in loaded.answer.rows[1:-1]:
        assert (label, words) in zip(shown[1::2], shown[2::2])
    return content


@pytest.mark.parametrize("name", SCENES)
def test_a_shot_answers_alike_wherever_it_is_shown(name, succeed, tmp_path, drawn_once):
    write(tmp_path / "scene.toml", name)
    printed = succeed("impact", "scene.toml", "--out", "r")
    loaded = wc.load(tmp_path / "r")
    content = check_alike(loaded, printed, tmp_path / "r", "summary.json")
    assert loaded.outcome == content["answer"]["outcome"] == content["outcome"]
    # Python answers as the command does, to the bit
    live = wc.impact(tmp_path / "scene.toml")
    assert live.answer.rows == loaded.answer.rows
    for key in ("residual_velocity_m_s", "max_deflection_m", "energy_error_max"):
        assert live.summary()[key] == content[key] == loaded.summary()[key]
    # a nominal value stays one that nobody gave, which shots draw
    assert live.target.setup.crossovers is not None
    assert "what nobody gave" in [part.kind for part in live.left_out]
    assert live.answer.over.startswith("one run: on a yarn, half-way from gap to crossover")


@pytest.mark.parametrize("name", ["one ply", "sphere"])
def test_drawn_shots_answer_alike_wherever_they_are_shown(name, succeed, tmp_path, drawn_once):
    write(tmp_path / "scene.toml", name)
    printed = succeed("impact", "scene.toml", "--draws", "4", "--out", "r")
    if "drawn shots" not in printed:
        pytest.skip("none has an outcome so soon")
    loaded = wc.load(tmp_path / "r")
    content = check_alike(loaded, printed, tmp_path / "r", "summary.json")
    assert content["draws"]["shots"] <= 4
    assert loaded.answer.over.startswith("4 drawn shots: place, friction between yarns 0.1 to 0.3")
    # pictures are of one run beside them
    assert loaded.run_words.startswith("one run: on a yarn, half-way from gap to crossover")
    assert "what nobody gave" not in content["left_out"]
    assert not (tmp_path / "r/draws").exists()


STUDIES = {
    "critical-velocity": ("scene.toml",),
    "v50": ("scene.toml", "--shots", "4"),
    "difference": ("scene.toml", "other.toml", "--shots", "4"),
    "sweep": ("scene.toml", "--over", "projectile.strike_velocity=130 m/s,150 m/s"),
}


@pytest.mark.parametrize("kind", STUDIES)
def test_a_study_answers_alike_wherever_it_is_shown(kind, succeed, tmp_path, drawn_once):
    write(tmp_path / "scene.toml", "sphere")
    write(tmp_path / "other.toml", "one ply")
    name = "compare" if kind == "difference" else kind
    printed = succeed(name, *STUDIES[kind], "--jobs", "1", "--out", "r")
    check_alike(wc.load(tmp_path / "r"), printed, tmp_path / "r", f"{kind}.json")


@pytest.mark.parametrize("yarns", ["pinned", "yarns", None])
def test_yarns_are_resolved_unless_pinned_ones_are_asked_for(yarns):
    """By an option and by a set-up, of a shot and of a study; the same for the place."""
    of_panel = {"opening": "30 mm", "crossovers": yarns, "impact_point": ["2 mm", "1 mm"]}
    setup = wc.setup("S-728", 90.0, **of_panel)
    for plan in (
        wc.impact.plan("S-728", 90.0, **of_panel),
        wc.impact.plan(setup),
        wc.v50.plan(setup, shots=4),
        wc.critical_velocity.plan("S-728", **of_panel),
    ):
        assert (plan.target.setup.crossovers is None) == (yarns == "pinned")
        assert plan.target.is_placed


def test_drawn_shots_go_on_where_they_were_interrupted(command, tmp_path, drawn_once, monkeypatch):
    """To the bit, with the shots that had ended; the numbers of the one run are there before."""
    write(tmp_path / "scene.toml", "sphere")
    line = "impact scene.toml --draws 4 --seed 3 --out"
    assert command(f"{line} whole")[0] == 0
    fire, fired = table.fire, []

    def until(setup, velocity, draw):
        if len(fired) == 2:
            raise KeyboardInterrupt
        fired.append(draw.number)
        return fire(setup, velocity, draw)

    until.__module__, until.__qualname__ = fire.__module__, fire.__qualname__
    with monkeypatch.context() as ending:
        ending.setattr(table, "fire", until)
        assert command(f"{line} r")[0] == 130
    assert "draws" not in json.loads((tmp_path / "r/summary.json").read_text())
    with monkeypatch.context() as going_on:
        fired.append(-1)
        going_on.setattr(table, "fire", until)
        assert command(f"{line} r --resume")[0] == 0
    assert fired == [0, 1, -1, 2, 3]
    tables = [pd.read_csv(tmp_path / name / "draws.csv") for name in ("r", "whole")]
    resumed, whole = (found.drop(columns="cpu_time_s") for found in tables)
    pd.testing.assert_frame_equal(resumed, whole, check_exact=True)
    told, wanted = (wc.load(tmp_path / name).answer for name in ("r", "whole"))
    assert told == wanted


def test_a_loaded_shot_names_options_as_the_door_has_them(tmp_path, drawn_once):
    """Whichever door it was written through."""
    write(tmp_path / "scene.toml", "one ply")
    live = wc.impact(tmp_path / "scene.toml", out=tmp_path / "r")
    loaded = wc.load(tmp_path / "r")
    told = [dict(one.answer.rows)["next"] for one in (live, loaded)]
    assert told[0] == told[1]
    assert "draws=16" in told[0]
    with door.open_terminal():
        told = [dict(one.answer.rows)["next"] for one in (live, loaded)]
    assert told[0] == told[1]
    assert "--draws 16" in told[0]


@pytest.mark.parametrize("plies, opening, resolved", [(1, 24, True), (2, 14, False), (2, 40, True)])
def test_the_one_run_is_of_pinned_yarns_where_no_zone_fits(plies, opening, resolved):
    """About the place that it strikes, which is not that of the input: the grid of a ply of a pack is shifted."""
    of_panel = {"opening": f"{opening} mm", "plies": plies}
    setup = wc.impact.plan("S-720", "150 m/s", **of_panel).target.setup
    assert (setup.crossovers is not None) == resolved
    assert setup.target(setup.table()).plies
