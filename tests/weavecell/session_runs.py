"""The runs of session_runs.toml: made when they are first asked for, kept for all tests; and set-ups of their inputs.

A scene is by its name in SCENES, a run by its name in RUNS; the fixture `results` of conftest.py makes runs.
"""

import contextlib
import copy
import io
import json
import shlex
import tomllib
from functools import cache
from pathlib import Path
from typing import NamedTuple
from unittest import mock

import weavecell as wc
from tests.scene_text import toml

_TABLES = tomllib.loads(Path(__file__).with_suffix(".toml").read_text("utf-8"))
SCENES = _TABLES["scene"]
RUNS = _TABLES["run"]
SHORT = {"warp only": (1, 0), "equibiaxial": (1, 1)}  # paths of a calibration


@contextlib.contextmanager
def small_calibration():
    """Calibrations on the least of meshes, along two paths."""
    from unitcell3d.identify import calibrate as solver

    small = {"size": (2, 2, 2), "plates_size": (2, 2, 2), "paths": SHORT}
    one = lambda fabric, *, run=solver.calibrate, **more: run(fabric, **more | small)  # noqa: E731
    all_of = lambda fabrics, *, run=solver.calibrate_all, **more: run(fabrics, **more | small)  # noqa: E731
    with mock.patch.multiple(solver, calibrate=one, calibrate_all=all_of):
        yield


class Run(NamedTuple):
    """What a command left: its folder and exit code, and what it printed."""

    folder: Path
    code: int
    out: str
    err: str


def make(name, folder):
    """Make the run of a name in a folder."""
    with contextlib.chdir(folder):
        write_inputs(name)
        Path("printed.json").write_text(json.dumps(_called(name)))


def run_in(folder):
    """The Run that `make` has made in a folder."""
    return Run(folder / "r", *json.loads((folder / "printed.json").read_text()))


def write_inputs(name):
    """Write the files that a run reads to this folder."""
    run = RUNS[name]
    scene = {"scene.toml": toml(SCENES[run["scene"]])} if "scene" in run else {}
    for file, text in (scene | run.get("files", {})).items():
        Path(file).write_text(text)


def _called(name):
    """(exit code, standard output, standard error) of a run in this folder and process."""
    from weavecell.cli import app

    out = io.StringIO()
    err = io.StringIO()
    code = None
    within = small_calibration() if name == "calibrate" else contextlib.nullcontext()
    with within, contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            app.main([*shlex.split(RUNS[name]["words"]), "--out", "r"])
        except SystemExit as leaving:
            code = leaving.code
    return code, out.getvalue(), err.getvalue()


def set_up(table):
    """The set-up of the table of an input file, by the Python interface."""
    table = copy.deepcopy(table)
    fabric = table["fabric"].pop("name")
    velocity = table["projectile"].pop("strike_velocity")
    options = table.pop("fabric") | table.pop("panel") | table.pop("run") | table
    for key in ("title", "outputs", "checkpoint_interval"):
        options.pop(key, None)
    if "history" in options:
        options["history"].pop("report_positions", None)
    return wc.setup(fabric, velocity, **options)


@cache
def fired(name):
    """The ShotResult of a run of `weavecell impact`, by the Python interface."""
    return wc.impact(set_up(SCENES[RUNS[name]["scene"]]))
