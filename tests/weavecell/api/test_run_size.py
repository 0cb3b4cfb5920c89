"""`impact --check`: what it says a run takes is what the run takes, and nothing is written."""

from dataclasses import replace

import pytest

import weavecell as wc
from shellfabric.impact import simulation
from tests.scene_text import impact_scene

PACK = {"opening": "30 mm", "plies": 2, "ply_gap": "0.1 mm", "end_time": "10 us"}


@pytest.mark.parametrize(
    "panel", [{"opening": "30 mm", "end_time": "10 us"}, PACK], ids=["ply", "pack"]
)
def test_elements_and_steps_are_those_of_the_run(panel):
    size = wc.impact("S-720", "90 m/s", **panel, check=True)
    setup = wc.setup("S-720", "90 m/s", **panel)
    result, _ = simulation.fired(setup)
    assert size.elements == setup.target().elements
    assert size.steps == round(result.t[-1] / size.time_step)
    assert size.cpu_time[0] < size.cpu_time[1]
    assert "; 0.98 to 1200 s of CPU time" in str(replace(size, cpu_time=(0.98, 1234.5)))


def test_the_command_writes_nothing(command, tmp_path):
    scene = tmp_path / "scene.toml"
    scene.write_text(impact_scene("90 m/s", "30 mm", "10 us"))
    code, out, _ = command("impact", scene, "--check", "--out", "out")
    assert code == 0
    assert "nothing is run" in out
    assert not (tmp_path / "out").exists()
