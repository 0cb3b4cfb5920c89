"""Fixed random scenes; `make fuzz` runs a thousand."""

import pytest

from fabrics.base import run_cache
from fabrics.base.errors import InputError, UnstableError
from tests.fuzz import runs, scenes

SEED = 0


# one ply and four, of 2 CPU s together; of the first five the others take 20
@pytest.mark.parametrize(
    "chosen",
    [range(3, 5), pytest.param(range(40), marks=[pytest.mark.nightly, pytest.mark.slow(400)])],
    ids=lambda chosen: f"{len(chosen)}",
)
def test_random_scenes_end_as_their_input_says_with_balanced_energy(tmp_path, chosen):
    """Of forty, each in a process of its own, one may be stopped by a guard, and one refused."""
    count = len(chosen)
    chosen = [scenes.scene(SEED, index) for index in chosen]
    rows = run_cache.results(runs.outcome, list(zip(chosen)), folder=tmp_path, fresh=count == 40)
    assert runs.failures(rows, guards=1) == []
    assert sum(row["outcome"] == "rejected" for row in rows) <= 0.03 * count
    if count == 40:  # most kinds are there
        shapes = set()
        plies = set()
        cells = set()
        for scene in chosen:
            panel = scene.scene["panel"]
            shapes.add(scene.scene["projectile"]["shape"])
            plies.add(len(panel.get("ply", [0] * panel.get("plies", 1))))
            cells.add(scene.scene["fabric"]["cell_model"])
        assert shapes == set(scenes.SHAPES)
        assert plies == {1, 2, 3, 4}
        assert len(cells) == 3
        assert {row["end"] for row in rows} >= {"perforated", "stopped", "in flight"}


def test_packs_before_a_block_are_set_ups(tmp_path):
    read = set()
    turned = set()
    for index in range(5):
        _, setup = runs.setup_of(scenes.scene("backed1", index).write(tmp_path))
        assert setup.backing is not None
        assert setup.plies > 1
        read.add(setup.projectile.shape == "stl")
        turned.add(any(ply.angle for ply in setup.lay_up))
    assert read == turned == {True, False}


@pytest.mark.parametrize(
    "error, outcome",
    [(InputError("no"), "rejected"), (UnstableError("no"), "guard"), (KeyError("no"), "traceback")],
)
def test_an_error_is_an_outcome(monkeypatch, error, outcome):
    def fail(*_, **__):
        raise error

    monkeypatch.setattr(runs, "run", fail)
    row = runs.outcome(scenes.scene(SEED, 0))
    assert row["outcome"] == outcome
    assert "no" in row["message"]
    assert (runs.failures([row], guards=1) == []) == (outcome != "traceback")
    assert (runs.failures([row], guards=0) == []) == (outcome == "rejected")


@pytest.mark.parametrize("error, fine", [(0.004, True), (0.006, False), (float("nan"), False)])
def test_an_energy_error_above_the_limit_is_a_failure(error, fine):
    row = {"name": "", "outcome": "ok", "message": "", "energy_error": error}
    assert (runs.failures([row], guards=0) == []) == fine
