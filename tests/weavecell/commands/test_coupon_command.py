"""`weavecell coupon`: its folder and numbers, resuming to the bit, an instability that names itself, bad scenes."""

import json
import math
from pathlib import Path

import h5py
import numpy as np
import pytest

from fabrics import catalogue
from tests.scene_text import datasets
from weavecell.results import coupon as results_coupon
from weavecell.scenes import build
from weavecell.scenes import coupon as scenes_coupon

ROOT = Path(__file__).parents[3]
EXAMPLES = sorted((ROOT / "examples" / "coupons").glob("*.toml"))
LONG, UNSTABLE = {"S-728-bias"}, {"S-728-no-trellis"}
FRAME = """
[fabric]
name = "S-720"
[picture_frame]
shear_angle = "24 deg"
crossovers = 4
[run]
steps = 4
outputs = OUTPUTS
"""
BIAS = """
[fabric]
file = "EXAMPLES/fabrics/S-728-balanced.toml"
[bias_extension]
length = "57 mm"
width = "29.6 mm"
elongation = "4 mm"
trellis = false
[run]
steps = 2
max_iterations = 4000
outputs = ["report"]
""".replace("EXAMPLES", str(ROOT / "examples"))

PULL = """
[fabric]
name = "S-726"
[pull_out]
crossings = 10
displacement = "1.2 mm"
crossover_friction = 0
crossover_cohesion = "0.5 N"
"""


@pytest.fixture
def scene(tmp_path):
    def write(text=FRAME, outputs="[]"):
        path = tmp_path / "scene.toml"
        path.write_text(text.replace("OUTPUTS", outputs))
        return path

    return write


def test_a_frame_gives_back_the_shear_law(command, scene, tmp_path):
    code, out, err = command("coupon", scene(outputs='["pictures", "report"]'), "--out", "r")
    assert code == 0, err
    folder = tmp_path / "r"
    everything = ["histories.h5", "pictures", "report.html", "scene.toml", "summary.json"]
    assert sorted(path.name for path in folder.iterdir()) == everything
    assert sorted(path.stem for path in (folder / "pictures").iterdir()) == ["coupon", "relaxation", "stress"]
    assert (folder / "report.html").read_text().count("<img") == 4
    summary = json.loads((folder / "summary.json").read_text())
    law = catalogue.load("S-720").shear.stress(math.radians(24))
    assert summary["at_end"]["shear stress"] == {"value": pytest.approx(law, rel=2e-3), "unit": "Pa"}
    assert summary["outcome"] == "complete"
    assert summary["provenance"]["commit"]
    assert "shear stress" in out
    with h5py.File(folder / "histories.h5") as file:
        assert file["states/x"].shape == (4, 25, 2)
        assert file["histories/shear angle"][-1] == pytest.approx(math.radians(24))
        assert file["histories/iterations"][()].sum() == len(file["relaxation"])


def test_an_interrupted_run_goes_on_bit_for_bit(command, scene, tmp_path, monkeypatch):
    path = scene()
    assert command("coupon", path, "--out", "whole")[0] == 0
    keep, calls = results_coupon.write_states, []

    def interrupted(*arguments):
        keep(*arguments)
        calls.append(1)
        if len(calls) == 2:
            raise KeyboardInterrupt

    monkeypatch.setattr(results_coupon, "write_states", interrupted)
    code, _, err = command("coupon", path, "--out", "parts")
    assert (code, err.splitlines()[-1]) == (130, "error: interrupted; --resume goes on from its last step")
    assert [p.name for p in (tmp_path / "parts").iterdir()] == ["checkpoint.h5"]
    assert command("coupon", path, "--out", "parts", "--resume")[0] == 0
    assert datasets(tmp_path / "parts" / "histories.h5") == datasets(tmp_path / "whole" / "histories.h5")
    assert not (tmp_path / "parts" / "checkpoint.h5").exists()


def test_yarns_that_resist_bending_are_held_by_the_pre_tension(command, scene, tmp_path):
    """Without cohesion the contact force is that of bent yarns: the load rises with the pre-tension."""
    text = PULL.replace("crossover_friction = 0", "crossover_friction = 0.2").replace('"0.5 N"', '"0 N"')
    text = text.replace('"1.2 mm"', '"0.3 mm"').replace("[pull", 'bending = "1e-8 N m^2"\n[pull')
    loads = []
    for tension in ("5 N", "10 N"):
        code, _, err = command("coupon", scene(text + f'pre_tension = "{tension}"\n'), "--out", tension[:-2])
        assert code == 0, err
        summary = json.loads((tmp_path / tension[:-2] / "summary.json").read_text())
        loads.append(summary["peak_load_N"])
    assert summary["yarn_bending_N_m2"] == 1e-8
    assert 0 < loads[0] < loads[1]


def test_resume_begins_a_new_run_and_leaves_a_finished_one(command, scene):
    path = scene(PULL)
    assert "done before" not in command("coupon", path, "--out", "r", "--resume")[1]
    code, out, _ = command("coupon", path, "--out", "r", "--resume")
    assert code == 0
    assert out.endswith(": complete; done before with the same input and code, in r\n")


def test_only_its_own_checkpoint_is_gone_on_with(command, scene, tmp_path, monkeypatch):
    path = scene()
    keep = results_coupon.write_states

    def interrupted(*arguments):
        keep(*arguments)
        raise KeyboardInterrupt

    monkeypatch.setattr(results_coupon, "write_states", interrupted)
    command("coupon", path, "--out", "r")
    path.write_text(path.read_text().replace("24 deg", "25 deg"))
    code, _, err = command("coupon", path, "--out", "r", "--resume")
    assert (code, err.splitlines()[-1]) == (2, "error: r/checkpoint.h5: is the checkpoint of another scene")


def test_a_pulled_yarn_meets_its_closed_forms(command, scene, tmp_path):
    """Without Coulomb friction the plateau is the number of crossovers times the cohesion."""
    code, out, err = command("coupon", scene(PULL), "--out", "r")
    assert code == 0, err
    folder = tmp_path / "r"
    assert sorted(path.name for path in folder.iterdir()) == [
        "histories.h5", "load.csv", "pictures", "report.html", "scene.toml", "summary.json",
    ]  # fmt: skip
    assert [path.name for path in (folder / "pictures").iterdir()] == ["load.svg"]
    summary = json.loads((folder / "summary.json").read_text())
    assert (summary["test"], summary["outcome"], summary["checks"]["status"]) == ("pull_out", "complete", "ok")
    assert summary["plateau_load_N"] == pytest.approx(10 * 0.5, rel=0.02)
    assert summary["peak_load_N"] > summary["plateau_load_N"]
    assert summary["slip_length_m"] == pytest.approx(10 * 2 * catalogue.load("S-726").weave.w1)
    assert summary["crossovers_left"] == 1  # beyond half a spacing, and the stretch of the yarn
    assert "plateau load" in out
    head, *rows = (folder / "load.csv").read_text().splitlines()
    assert head.startswith("time [s],displacement of the crosshead [m],load [N],crossovers in slip [1]")
    values = np.array([[float(part) for part in row.split(",")] for row in rows])
    assert values[-1, 1] == pytest.approx(1.2e-3, rel=0.02)
    assert np.all(np.diff(values[:, 5]) > -1e-12)
    with h5py.File(folder / "histories.h5") as file:
        np.testing.assert_allclose(file["histories/load"][()], values[:, 2], rtol=1e-8)
    # what the crossovers take is their threshold times the yarn that has passed through them
    late = values[:, 1] > 0.3e-3
    passed = values[late, 1] - values[late, 1][0]
    taken = values[late, 5] - values[late, 5][0]
    still = values[late, 4] == 0
    assert taken[still][-1] == pytest.approx(5.0 * passed[still][-1], rel=0.02)


def test_bands_end_the_run_and_are_reported(command, scene, tmp_path):
    """Figure 4-27: without the trellis the shear runs into bands; exit code 3, and what was computed is kept."""
    code, out, err = command("coupon", scene(BIAS), "--out", "r")
    assert code == 3
    assert "error: the shear has run into bands" in err
    assert "unstable" in out
    summary = json.loads((tmp_path / "r" / "summary.json").read_text())
    assert summary["outcome"] == "unstable"
    assert summary["at_end"]["shear concentration"]["value"] > 3
    assert summary["failure_message"] in (tmp_path / "r" / "report.html").read_text()
    found = datasets(tmp_path / "r" / "histories.h5")
    assert len(found) > 20
    with h5py.File(tmp_path / "r" / "histories.h5") as file:
        assert all("unit" in file[name].attrs for name in found)


def test_options_of_the_cell(command, scene, tmp_path):
    """The load of a strip whose yarns have a toe is EA e_t less, once they are straight."""
    text = """
[fabric]
name = "glass-balanced"
cell_profile = "straight"
fibre_slack = TOE
[uniaxial]
direction = "warp"
length = "37 mm"
width = "14 mm"
strain = "1.2 %"
[run]
steps = 2
outputs = []
"""
    loads = []
    for toe in ("0", '["0.1 %", "0 %"]'):
        code, _, err = command("coupon", scene(text.replace("TOE", toe)), "--out", f"r{len(loads)}")
        assert code == 0, err
        with h5py.File(tmp_path / f"r{len(loads)}" / "histories.h5") as file:
            loads.append(next(v for k, v in _datasets(file) if "load of a yarn" in k)[-1])
    assert loads[0] - loads[1] == pytest.approx(38000 * 1e-3, rel=0.05)


def _datasets(group):
    found = []
    group.visititems(lambda name, item: found.append((name, item[()])) if isinstance(item, h5py.Dataset) else None)
    return found


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_examples_are_good_scenes(path):
    got, text = scenes_coupon.load(path)
    build.build(got, path, path.stem)
    assert f"weavecell coupon examples/coupons/{path.name}" in text


@pytest.mark.parametrize(
    "path",
    [pytest.param(p, marks=pytest.mark.slow(30) if p.stem in LONG else (), id=p.stem) for p in EXAMPLES],
)
def test_examples_run(command, tmp_path, path):
    code, _, err = command("coupon", path, "--out", "r")
    summary = json.loads((tmp_path / "r" / "summary.json").read_text())
    assert (code == 3) == (summary["outcome"] == "unstable") == (path.stem in UNSTABLE), err
    assert code or summary.get("residual_max", 0.0) <= scenes_coupon.TOLERANCE


def test_a_cross_carries_what_its_cell_does(command, scene, tmp_path):
    """The record's closed form is that of the solver: the cell at the strains of the middle, within 1 %."""
    text = '[fabric]\nname = "glass-balanced"\n[biaxial]\nstrain = ["1 %", "1 %"]\ncentre = 6\narm = 3\n'
    assert command("coupon", scene(text + "[run]\nsteps = 4\noutputs = []\n"), "--out", "r")[0] == 0
    with h5py.File(tmp_path / "r" / "histories.h5") as file:
        for family in ("warp", "weft"):
            found, cell = (
                file[f"histories/{name}"][-1]
                for name in (f"load of a {family} yarn", f"cell at these strains, {family}")
            )
            assert found == pytest.approx(cell, rel=0.01)
        assert np.all(np.diff(file["histories/load of a warp yarn"][()]) >= 0)
