"""What a command answers by default: over what nobody knows, the same wherever the result is shown."""

import json
import re
from html import unescape

import pytest

import weavecell as wc
from fabrics.base.errors import InputError
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


def banner(page):
    """The first line of a page, without the marks of its words."""
    shown = re.search(r'<p class="outcome \w+">(.*?)</p>', page, re.S)[1]
    return " ".join(unescape(re.sub(r"<[^>]*>", "", shown)).split())


@pytest.mark.parametrize("name", SCENES)
def test_a_shot_answers_alike_wherever_it_is_shown(name, succeed, tmp_path, drawn_once):
    write(tmp_path / "scene.toml", name)
    printed = succeed("impact", "scene.toml", "--out", "r")
    live = wc.load(tmp_path / "r")
    answer = live.answer
    assert f": {answer}" in live.headline()
    assert any(line.startswith(live.headline()) for line in printed.splitlines())
    content = json.loads((tmp_path / "r/summary.json").read_text())
    assert content["answer"] == live.summary()["answer"] == answer
    assert answer.lower() in banner((tmp_path / "r/report.html").read_text("utf-8")).lower()
    assert live.headline() in re.sub(r"<[^>]*>", "", unescape(live._repr_html_()))
    # the shot that is shown is the first of the runs, and these are of resolved yarns alone
    runs = live.interval.to_dataframe()
    assert len(runs) == len(content["interval"]["runs"]) <= 6
    assert runs["residual_velocity_m_s"][0] == live.residual_velocity
    assert live.target.setup.crossovers is not None
    assert "friction to hold yarns" not in live.checks_text
    assert not [part for part in live.left_out if part.kind == "what nobody gave"]
    # one run, as before
    one = succeed("impact", "scene.toml", "--no-interval", "--check")
    assert "answer over what nobody knows" not in one
    assert "answer over what nobody knows" in succeed("impact", "scene.toml", "--check")


@pytest.mark.parametrize("name", ["one ply", "pack", "chisel", "sphere", "block behind"])
def test_a_limit_answers_alike_wherever_it_is_shown(name, succeed, tmp_path, drawn_once):
    from tests.weavecell.golden_texts import cases

    write(tmp_path / "scene.toml", name)
    with cases.invented():
        printed = succeed("critical-velocity", "scene.toml", "--jobs", "1", "--out", "r")
    loaded = wc.load(tmp_path / "r")
    label, answer = loaded.headline
    assert label == "Critical velocity"
    assert f": critical velocity {answer}" in printed
    assert loaded.content["answer"] == loaded.content["headline"][1] == answer
    assert answer in banner((tmp_path / "r/report.html").read_text("utf-8"))
    runs = loaded.tables["interval.csv"]
    assert len(runs) == len(loaded.content["interval"]["runs"]) <= 6
    assert "what nobody gave" not in loaded.content["left_out"]


GIVEN = {"crossovers": "yarns", "crossover_friction": 0.2, "impact_point": ["0 mm", "0 mm"]}


@pytest.mark.parametrize(
    "changes",
    [
        {"panel": {"crossovers": "pinned"}},
        {"panel": GIVEN, "projectile": {"friction": 0.1}},
        {"accuracy": {"quantity": "residual_velocity", "uncertainty": "20 %"}},
        {"run": {"elements_per_crossover": 2}},
    ],
)
def test_one_run_stays_where_nothing_is_open_or_resolved_yarns_cannot_answer(changes, tmp_path):
    scene = merged(SCENE, changes)
    (tmp_path / "scene.toml").write_text(toml(scene))
    made = wc.impact.plan(tmp_path / "scene.toml", interval="open")
    assert made.interval is None
    assert made == wc.impact.plan(tmp_path / "scene.toml")


def test_an_answer_that_was_interrupted_goes_on(succeed, command, tmp_path, monkeypatch):
    """What had ended is not fired again."""
    from weavecell.studies import sweep

    write(tmp_path / "scene.toml", "sphere")
    fire = sweep.shot
    fired = []

    def stop_at_second(setup):
        if len(fired) == 1:
            raise KeyboardInterrupt
        fired.append(setup.impact_point)
        return fire(setup)

    monkeypatch.setattr(sweep, "shot", stop_at_second)
    code, _, err = command("impact", "scene.toml", "--out", "r")
    assert code == 130
    assert "--resume goes on with the other runs of its answer" in err
    assert (tmp_path / "r/summary.json").exists()
    again = []

    def fire_again(setup):
        again.append(setup.impact_point)
        return fire(setup)

    monkeypatch.setattr(sweep, "shot", fire_again)
    succeed("impact", "scene.toml", "--out", "r", "--resume")
    found = wc.load(tmp_path / "r").interval
    assert len(found.runs) == 1 + len(fired) + len(again)
    assert not (tmp_path / "r/interval").exists()


@pytest.mark.filterwarnings("ignore::UserWarning", "ignore::weavecell.DoubtfulResult")
def test_what_one_run_takes_is_not_refused_by_default():
    """A yarn 101 mm beside the nose, within the pinned edge and beyond that of resolved yarns."""
    asked = {"opening": "203 mm", "history": {"weft": ["0 mm", "101 mm"]}}
    size = wc.impact("S-720", "92.5 m/s", interval="open", check=True, **asked)
    assert size.assumptions == wc.impact("S-720", "92.5 m/s", check=True, **asked).assumptions
    with pytest.raises(InputError, match=r"weft = 0\.101: must be at most"):
        wc.impact("S-720", "92.5 m/s", interval=True, check=True, **asked)
