"""`weavecell coupon`: resuming to the bit, the table of a pull-out, and the examples, of which one is unstable."""

import shutil
from pathlib import Path
from unittest import mock

import h5py
import numpy as np
import pytest

import weavecell
import weavecell as wc
from tests.scene_text import datasets, toml
from tests.weavecell.session_runs import SCENES
from tests.weavecell.written import names, table_of
from weavecell.results import run_folder
from weavecell.scenes import coupon as scenes_coupon

EXAMPLES = sorted((Path(__file__).parents[3] / "examples" / "coupons").glob("*.toml"))
LONG = {"S-728-bias": 30, "S-728-no-trellis": 6, "glass-biaxial": 3, "S-720-warp": 3}  # [CPU s]
UNSTABLE = {"S-728-no-trellis"}


def interrupted_after(states):
    """The user presses Ctrl-C when this number of states has been kept."""
    keep = run_folder.write_states
    calls = []

    def interrupted(*arguments):
        keep(*arguments)
        calls.append(1)
        if len(calls) == states:
            raise KeyboardInterrupt

    return mock.patch.object(run_folder, "write_states", interrupted)


def test_an_interrupted_run_goes_on_bit_for_bit(command, succeed, results, tmp_path):
    (tmp_path / "scene.toml").write_text(toml(SCENES["frame"]))
    with interrupted_after(2):
        code, _, err = command("coupon scene.toml --out r")
    assert code == 130
    assert err.splitlines()[-1] == "error: interrupted; --resume goes on from its last step"
    assert names(tmp_path / "r") == "checkpoint.h5"
    succeed("coupon scene.toml --out r --resume")
    assert datasets(tmp_path / "r" / "histories.h5") == datasets(
        results("coupon").folder / "histories.h5"
    )
    assert not (tmp_path / "r" / "checkpoint.h5").exists()


def test_resume_leaves_a_finished_run(succeed, results, tmp_path):
    folder = shutil.copytree(results("pull-out").folder, tmp_path / "r")
    out = succeed(f"coupon {folder}/scene.toml --out r --resume")
    assert out.splitlines()[-2:] == [
        "files       r/report.html",
        "done before with the same input and code",
    ]


def test_the_table_of_a_pull_out_is_its_histories(results):
    """And what the crossovers take is their threshold times the yarn that has passed through them."""
    folder = results("pull-out").folder
    table = wc.load(folder).to_dataframe()
    with h5py.File(folder / "histories.h5") as file:
        values = {name: values[()] for name, values in file["histories"].items()}
    assert len(table.columns) == len(values)
    for name, history in values.items():
        (column,) = (c for c in table if c.startswith(name.replace(" ", "_")))
        np.testing.assert_array_equal(table[column], history)
    still = (values["displacement of the crosshead"] > 0.3e-3) & (values["crossovers left"] == 0)
    passed, taken = (
        np.ptp(values[name][still])
        for name in ("displacement of the crosshead", "work of friction")
    )
    assert taken == pytest.approx(10 * 0.5 * passed, rel=0.02)


@pytest.mark.parametrize(
    "path",
    [
        pytest.param(p, marks=pytest.mark.slow(LONG[p.stem]) if p.stem in LONG else (), id=p.stem)
        for p in EXAMPLES
    ],
)
def test_examples_run(command, tmp_path, path):
    """Figure 4-27: without the trellis the shear runs into bands; what was computed is kept."""
    assert f"weavecell coupon examples/coupons/{path.name}" in path.read_text()
    code, out, err = command(f"coupon {path} --out r")
    summary = table_of(tmp_path / "r")
    assert (code == 3) == (summary["outcome"] == "unstable") == (path.stem in UNSTABLE), err
    if code == 0:
        assert summary.get("residual_max", 0.0) <= scenes_coupon.TOLERANCE
        return
    assert "error: the shear has run into bands" in err
    assert "unstable" in out
    assert summary["at_end"]["shear concentration"]["value"] > 3
    assert summary["failure_message"] in (tmp_path / "r" / "report.html").read_text()
    assert len(datasets(tmp_path / "r" / "histories.h5")) > 20


def test_a_number_of_an_assumed_law_says_so_in_every_place(tmp_path):
    """A picture frame of a fabric from a data sheet returns the law that was assumed for it."""
    file = Path(__file__).parents[1] / "own_fabrics" / "aramid-3300.toml"
    options = {"shear_angle": 0.4, "crossovers": 2, "steps": 2, "outputs": ["report"]}
    found = weavecell.coupon(file, "picture_frame", **options)
    said = "[shear] of para-aramid yarns"
    shown = [line for line in found.lines() if line.startswith(("shear stress", "trellis law"))]
    assert [line[-14:] for line in shown] == [" (assumed law)"] * 2
    for words in (*found.lines()[-2:-1], found.summary()["assumed"], found.details()):
        assert said in words
    assert f"assumed: {len(found._list_assumed_laws())} laws" in repr(found)
    assert said in found.to_dataframe().attrs["assumed"]
    found.save(tmp_path)
    written = table_of(tmp_path)
    for place in (written, written["provenance"], *written["at_end"].values()):
        assert said in place["assumed"]
    with h5py.File(tmp_path / "histories.h5") as content:
        assert said in content.attrs["assumed"]
    assert said in (tmp_path / "report.html").read_text()


def test_no_number_of_a_given_law_is_called_assumed(results):
    written = table_of(results("coupon").folder)
    assert "assumed" not in written["at_end"]["shear stress"]
