"""Fixed random scenes, run in a process of their own; `make fuzz` runs a thousand."""

import os
import time

import pytest

from fabrics.errors import InputError, UnstableError
from tests.fuzz import pool, runs, scenes, table

SEED = 0


def described(rows):
    return "\n" + "\n".join(table.describe(row) for row in rows)


@pytest.mark.parametrize("count", [15, pytest.param(100, marks=pytest.mark.slow(150))])
def test_random_scenes(count):
    """Each ends as its input says, with its energy balanced; of a hundred one may be stopped, of a thousand five."""
    tasks = [(SEED, index) for index in range(count)]
    rows = [{"seed": SEED, "index": index} | row for (_, index), row in pool.outcomes(runs.outcome, tasks, jobs=1)]
    wrong = [row for row in rows if row["outcome"] in table.WRONG] + table.beyond_limit(rows)
    assert not wrong, described(wrong)
    stopped = [row for row in rows if row["outcome"] == "guard"]
    assert len(stopped) <= 1, described(stopped)
    assert sum(row["outcome"] == "rejected" for row in rows) <= 0.03 * count
    if count == 100:  # most kinds are there
        assert {row["projectile.shape"] for row in rows} == set(scenes.SHAPES)
        assert {row.get("panel.plies", row.get("panel.ply", 1)) for row in rows} == {1, 2, 3, 4}
        assert sum("panel.ply" in row for row in rows) >= 5
        assert {row["fabric.cell_model"] for row in rows} == {"compressible", "incompressible", "decoupled"}
        assert {row["end"] for row in rows} >= {"perforated", "stopped", "in flight"}


def test_packs_before_a_block_are_set_ups(tmp_path):
    setups = [runs.setup_of(scenes.scene("backed1", index).write(tmp_path))[1] for index in range(12)]
    assert all(setup.backing is not None and setup.plies > 1 for setup in setups)
    assert {setup.projectile.shape == "stl" for setup in setups} == {True, False}
    assert {any(ply.angle for ply in setup.lay_up) for setup in setups} == {True, False}


def sleep_or_die(what):
    if what == "sleep":
        time.sleep(60)
    if what == "die":
        os._exit(7)
    return {"outcome": what}


def test_processes_that_hang_or_die_are_reported():
    tasks = [("ok",), ("die",), ("ok",), ("sleep",), ("ok",)]
    found = list(pool.outcomes(sleep_or_die, tasks, jobs=2, limit=20))
    assert sorted(row["outcome"] for _, row in found) == ["crash", "ok", "ok", "ok", "timeout"]
    assert {task: row["outcome"] for task, row in found}["die",] == "crash"
    assert "exit code 7" in next(row["message"] for task, row in found if task == ("die",))


@pytest.mark.parametrize(
    ("error", "outcome"),
    [(InputError("no"), "rejected"), (UnstableError("no"), "guard"), (KeyError("no"), "traceback")],
)
def test_outcome_of_an_error(monkeypatch, error, outcome):
    def fail(*_, **__):
        raise error

    monkeypatch.setattr(runs, "run", fail)
    row = runs.outcome(SEED, 0)
    assert row["outcome"] == outcome
    assert "no" in row["message"]


def test_what_counts_as_failure():
    def row(outcome, error=None):
        return {"seed": 0, "index": 0, "outcome": outcome, "end": "", "message": "", "energy_error": error}

    fine = [row("ok", 0.004), row("rejected"), row("guard", 3.0)]
    assert table.failures(fine, guards_allowed=1) == []
    assert len(table.failures(fine, guards_allowed=0)) == 1
    for wrong in (
        row("ok", 0.006),
        row("ok", float("nan")),
        row("traceback"),
        row("crash"),
        row("timeout"),
        row("time"),
    ):
        assert len(table.failures([*fine, wrong], guards_allowed=1)) == 1
