"""What a command answers by default: over what nobody knows, the same wherever the result is shown."""

import json
import re
from html import unescape
from pathlib import Path

import pytest

import weavecell as wc
from fabrics.base import door
from tests.scene_text import merged, toml

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
    printed = succeed("impact", "scene.toml", "--out", "r", "--no-assumed-range")
    loaded = wc.load(tmp_path / "r")
    content = check_alike(loaded, printed, tmp_path / "r", "summary.json")
    assert loaded.outcome == content["answer"]["outcome"] == content["outcome"]
    # Python answers as the command does, to the bit
    live = wc.impact(tmp_path / "scene.toml")
    assert live.answer.value == loaded.answer.value
    for key in ("residual_velocity_m_s", "max_deflection_m", "energy_error_max"):
        assert live.summary()[key] == content[key] == loaded.summary()[key]
    # a nominal value stays one that nobody gave, which shots draw
    assert live.target.setup.crossovers is not None
    assert "what nobody gave" in [part.kind for part in live.left_out]
    assert live.answer.over.startswith("one run: on a yarn, half-way from gap to crossover")


@pytest.mark.parametrize("name", ["one ply", "sphere"])
def test_drawn_shots_answer_alike_wherever_they_are_shown(name, succeed, tmp_path, drawn_once):
    write(tmp_path / "scene.toml", name)
    printed = succeed("impact", "scene.toml", "--draws", "4", "--out", "r", "--no-assumed-range")
    if "drawn shots" not in printed:
        pytest.skip("none has an outcome so soon")
    loaded = wc.load(tmp_path / "r")
    content = check_alike(loaded, printed, tmp_path / "r", "summary.json")
    assert content["draws"]["shots"] <= 4
    assert loaded.answer.over.startswith("4 drawn shots: place, friction between yarns 0.1 to 0.3")
    assert "what nobody gave" not in content["left_out"]
    assert not (tmp_path / "r/draws").exists()


STUDIES = {
    "critical-velocity": ("scene.toml", "--no-assumed-range"),
    "v50": ("scene.toml", "--shots", "4"),
    "difference": ("scene.toml", "scene.toml", "--shots", "4"),
    "sweep": ("scene.toml", "--over", "projectile.strike_velocity=130 m/s,150 m/s"),
}


@pytest.mark.parametrize("kind", STUDIES)
def test_a_study_answers_alike_wherever_it_is_shown(kind, succeed, tmp_path, drawn_once):
    write(tmp_path / "scene.toml", "sphere")
    name = "compare" if kind == "difference" else kind
    printed = succeed(name, *STUDIES[kind], "--jobs", "1", "--out", "r")
    check_alike(wc.load(tmp_path / "r"), printed, tmp_path / "r", f"{kind}.json")
