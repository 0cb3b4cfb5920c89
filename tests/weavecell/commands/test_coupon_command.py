"""`weavecell coupon`: closed forms of its tests, resuming to the bit, an instability that names itself."""

import json
import math
import shutil
from pathlib import Path
from unittest import mock

import h5py
import numpy as np
import pytest

import weavecell as wc
from fabrics import catalogue
from tests.scene_text import datasets, merged, toml
from tests.weavecell.session_runs import FRAME
from weavecell.results import coupon as results_coupon
from weavecell.scenes import coupon as scenes_coupon

ROOT = Path(__file__).parents[3]
EXAMPLES = sorted((ROOT / "examples" / "coupons").glob("*.toml"))
LONG, UNSTABLE = {"S-728-bias"}, {"S-728-no-trellis"}
BIAS = {
    "fabric": {"file": f"{ROOT}/examples/fabrics/S-728-balanced.toml"},
    "bias_extension": {"length": "57 mm", "width": "29.6 mm", "elongation": "4 mm", "trellis": False},
    "run": {"steps": 2, "max_iterations": 4000, "outputs": ["report"]},
}
STRIP = {
    "fabric": {"name": "glass-balanced", "cell_profile": "straight"},
    "uniaxial": {"direction": "warp", "length": "37 mm", "width": "14 mm", "strain": "1.2 %"},
    "run": {"steps": 2, "outputs": []},
}


@pytest.fixture
def run(command, tmp_path):
    """Exit code, output and summary of a table's coupon, whose results are in the folder r."""

    def called(table, *words):
        (tmp_path / "scene.toml").write_text(toml(table))
        code, out, err = command("coupon", "scene.toml", "--out", "r", *words)
        summary = tmp_path / "r" / "summary.json"
        return code, out, err, json.loads(summary.read_text()) if summary.exists() else {}

    return called


def interrupted_after(states):
    """The user presses Ctrl-C when this number of states has been kept."""
    keep, calls = results_coupon.write_states, []

    def interrupted(*arguments):
        keep(*arguments)
        calls.append(1)
        if len(calls) == states:
            raise KeyboardInterrupt

    return mock.patch.object(results_coupon, "write_states", interrupted)


def test_a_frame_gives_back_the_shear_law(results):
    folder = results("coupon").folder
    law = catalogue.load("S-720").shear.stress(math.radians(24))
    with h5py.File(folder / "histories.h5") as file:
        assert file["histories/shear stress"][-1] == pytest.approx(law, rel=2e-3)
        assert file["histories/shear angle"][-1] == pytest.approx(math.radians(24))
        assert file["states/x"].shape == (4, 25, 2)
        assert file["histories/iterations"][()].sum() == len(file["relaxation"])


def test_an_interrupted_run_goes_on_bit_for_bit_and_from_no_other_checkpoint(run, results, tmp_path):
    with interrupted_after(2):
        code, _, err, _ = run(FRAME)
    assert (code, err.splitlines()[-1]) == (130, "error: interrupted; --resume goes on from its last step")
    assert [path.name for path in (tmp_path / "r").iterdir()] == ["checkpoint.h5"]
    code, _, err, _ = run(merged(FRAME, {"picture_frame": {"shear_angle": "25 deg"}}), "--resume")
    assert (code, err.splitlines()[-1]) == (2, "error: r/checkpoint.h5: is the checkpoint of another scene")
    assert run(FRAME, "--resume")[0] == 0
    assert datasets(tmp_path / "r" / "histories.h5") == datasets(results("coupon").folder / "histories.h5")
    assert not (tmp_path / "r" / "checkpoint.h5").exists()


def test_resume_leaves_a_finished_run(command, results, tmp_path):
    folder = shutil.copytree(results("pull-out").folder, tmp_path / "r")
    code, out, _ = command("coupon", folder / "scene.toml", "--out", "r", "--resume")
    assert code == 0
    assert out.endswith(": complete; done before with the same input and code, in r\n")


def test_a_pulled_yarn_meets_its_closed_forms(results):
    """Without Coulomb friction the plateau is the number of crossovers times the cohesion."""
    folder = results("pull-out").folder
    summary = json.loads((folder / "summary.json").read_text())
    assert summary["plateau_load_N"] == pytest.approx(10 * 0.5, rel=0.02)
    assert summary["peak_load_N"] > summary["plateau_load_N"]
    assert summary["slip_length_m"] == pytest.approx(10 * 2 * catalogue.load("S-726").weave.w1)
    assert summary["crossovers_left"] == 1  # beyond half a spacing, and the stretch of the yarn
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


def test_yarns_that_resist_bending_are_held_by_the_pre_tension():
    """Without cohesion the contact force is that of bent yarns: the load rises with the pre-tension."""
    given = {"crossings": 10, "displacement": "0.3 mm", "crossover_friction": 0.2, "crossover_cohesion": 0.0}
    slack, tight = (wc.coupon("S-726", "pull_out", **given, bending=1e-8, pre_tension=T).peak for T in (5.0, 10.0))
    assert 0 < slack < tight


def test_bands_end_the_run_and_are_reported(run, tmp_path):
    """Figure 4-27: without the trellis the shear runs into bands; exit code 3, and what was computed is kept."""
    code, out, err, summary = run(BIAS)
    assert code == 3
    assert "error: the shear has run into bands" in err
    assert "unstable" in out
    assert summary["outcome"] == "unstable"
    assert summary["at_end"]["shear concentration"]["value"] > 3
    assert summary["failure_message"] in (tmp_path / "r" / "report.html").read_text()
    assert len(datasets(tmp_path / "r" / "histories.h5")) > 20


def test_slack_fibres_take_no_load(run):
    """The load of a strip whose yarns have a toe is EA e_t less, once they are straight."""
    loads = []
    for toe in ("0", ["0.1 %", "0 %"]):
        code, _, err, summary = run(merged(STRIP, {"fabric": {"fibre_slack": toe}}))
        assert code == 0, err
        loads.append(next(value["value"] for key, value in summary["at_end"].items() if "load of a yarn" in key))
    assert loads[0] - loads[1] == pytest.approx(38000 * 1e-3, rel=0.05)


def test_a_cross_carries_what_its_cell_does():
    """The record's closed form is that of the solver: the cell at the strains of the middle, within 1 %."""
    made = wc.coupon("glass-balanced", "biaxial", strain=["1 %", "1 %"], centre=6, arm=3, steps=4).record.measures
    for family in ("warp", "weft"):
        found, cell = (made[f"{name}"][1] for name in (f"load of a {family} yarn", f"cell at these strains, {family}"))
        assert found[-1] == pytest.approx(cell[-1], rel=0.01)
        assert np.all(np.diff(found) >= 0)


@pytest.mark.parametrize(
    "path",
    [pytest.param(p, marks=pytest.mark.slow(30) if p.stem in LONG else (), id=p.stem) for p in EXAMPLES],
)
def test_examples_run(command, tmp_path, path):
    assert f"weavecell coupon examples/coupons/{path.name}" in path.read_text()
    code, _, err = command("coupon", path, "--out", "r")
    summary = json.loads((tmp_path / "r" / "summary.json").read_text())
    assert (code == 3) == (summary["outcome"] == "unstable") == (path.stem in UNSTABLE), err
    assert code or summary.get("residual_max", 0.0) <= scenes_coupon.TOLERANCE
