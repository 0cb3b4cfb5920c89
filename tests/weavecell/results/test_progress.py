"""A progress bar forecasts from the time of the run alone, and each folder of kernels is announced once."""

import io
import logging
import re
import sys
from types import SimpleNamespace

import numpy as np
import pytest

from fabrics.base import kernel_cache
from weavecell.results import progress

tqdm = pytest.importorskip("tqdm.std")
MODULE = "shellfabric.membrane.some_kernels"


@pytest.fixture
def clock(monkeypatch):
    """A list with the time [s], which a test sets."""
    now = [1000.0]
    monkeypatch.setattr(kernel_cache.time, "monotonic", lambda: now[0])
    monkeypatch.setattr(tqdm, "time", lambda: now[0])
    return now


def test_no_forecast_counts_the_compilation_of_kernels(clock, monkeypatch):
    terminal = io.StringIO()
    terminal.isatty = lambda: True
    monkeypatch.setattr(sys, "stderr", terminal)
    with progress.bar("a shot") as advance:
        clock[0] += 4.0
        kernel_cache.compiling(MODULE)
        clock[0] += 200.0
        # an inner one goes on inside of the outer one
        kernel_cache.compiling(MODULE)
        clock[0] += 90.0
        kernel_cache.compiling(MODULE, done=True)
        kernel_cache.compiling(MODULE, done=True)
        clock[0] += 6.0
        advance(0.1)
        assert re.findall(r"([\d:]+)<([\d:]+)", terminal.getvalue())[-1] == ("00:10", "01:30")
        clock[0] += 10.0
        advance(0.5)
        assert re.findall(r"([\d:]+)<([\d:]+)", terminal.getvalue())[-1] == ("00:20", "00:20")


def test_kernels_of_a_folder_are_announced_once(clock, monkeypatch, caplog):
    monkeypatch.setattr(kernel_cache, "_announced", set())
    with caplog.at_level(logging.WARNING, logger="weavecell"):
        for pause in (0.5, 60.0, 3600.0):
            clock[0] += pause
            for module in (MODULE, "shellfabric.cell.other_kernels"):
                kernel_cache.compiling(module)
                kernel_cache.compiling(module, done=True)
    assert [record.getMessage().partition(",")[0] for record in caplog.records] == [
        "compiling the kernels of a ply",
        "compiling the kernels of the unit cell",
    ]


def test_a_first_run_of_any_kind_says_that_it_compiles():
    """Each folder with kernels, but for those that every run of a ply calls."""
    folder = kernel_cache.ROOT / "shellfabric"
    kernels = {
        ".".join(("shellfabric", file.parent.name)) for file in folder.glob("*/*_kernels.py")
    }
    of_a_ply = {f"shellfabric.{name}" for name in ("contact", "loop", "projectile", "surface")}
    assert kernels - of_a_ply <= set(kernel_cache.MODELS)


def test_a_shot_shows_the_velocity_of_the_centre_of_mass(clock, monkeypatch):
    """The tip of a bullet of metal swings: its velocity rises from line to line while the bullet slows down."""
    terminal = io.StringIO()
    terminal.isatty = lambda: True
    monkeypatch.setattr(sys, "stderr", terminal)
    centre = [430.0]

    def run(hooks):
        solver = SimpleNamespace(ended=False, end_time=200e-6, time=0.0)
        solver.state = SimpleNamespace(projectile_velocity=np.array([0.0, 0.0, 231.6]))
        solver.sample = {"v": centre}.get
        for time, velocity in ((60e-6, 247.0), (80e-6, 226.3)):
            clock[0] += 30.0
            solver.time = time
            centre.append(velocity)
            for hook in hooks:
                hook(solver)
        return "the result"

    assert progress.run_with_bar(run, "a bullet") == ("the result", None)
    shown = terminal.getvalue()
    assert re.findall(r"(\d+) %.*?([\d.]+) m/s", shown)[:2] == [("30", "247.0"), ("40", "226.3")]
    assert "231.6" not in shown
