"""The inputs of the runs that are made once a session, one of each command, and the same runs by the Python interface.

The fixture `results` of conftest.py makes a run when it is first asked for, and keeps its folder for all tests.
"""

import contextlib
import copy
import fcntl
import io
import json
import shlex
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple
from unittest import mock

import weavecell as wc
from tests.scene_text import merged, toml

CYLINDER = {"mass": "3 g", "diameter": "5.5 mm", "edge_radius": "0.3 mm"}
BLOCK = {"size": ["60 mm", "60 mm", "30 mm"], "min_size": "3 mm", "growth": 1.5}
ALL = ["paraview", "pictures", "report"]


def shot(velocity, opening, end_time, *, fabric="S-720", **more):
    """The table of an input file."""
    table = {
        "fabric": {"name": fabric}, "projectile": CYLINDER | {"strike_velocity": velocity},
        "panel": {"opening": opening}, "run": {"end_time": end_time},
    }  # fmt: skip
    return merged(table, more)


PLY = shot(
    "155 m/s", "80 mm", "60 us", title="a <small> & thin panel",
    history={"interval": "1 us", "warp": ["0 mm", "5 mm"], "report_positions": ["5 mm", "20 mm", "90 mm"]},
    run={"snapshot_interval": "20 us", "checkpoint_interval": "10 us", "outputs": ALL},
)  # fmt: skip
PACK = shot(
    "200 m/s", "45 mm", "12 us", fabric="S-728", projectile={"body": "elastic_bar"}, backing=BLOCK,
    panel={"ply_friction": 0.2, "ply": [{}, {"name": "S-726", "angle": "30 deg", "gap": "0.05 mm"},
                                        {"name": "S-726", "angle": "135 deg"}]},
    history={"interval": "2 us"},
    run={"elements_per_crossover": 1, "snapshot_interval": "4 us", "checkpoint_interval": "4 us", "outputs": ALL},
)  # fmt: skip
SLIDING = shot(
    "130 m/s", "45 mm", "30 us", panel={"crossovers": "sliding", "crossover_friction": 0.2},
    run={"snapshot_interval": "8 us", "outputs": ["paraview", "report"]},
)  # fmt: skip
PLIES = shot("90 m/s", "40 mm", "60 us", panel={"plies": 2}, run={"elements_per_crossover": 1})
DRAWN = shot("90 m/s", "30.6 mm", "60 us")
LIMIT = shot("155 m/s", "50 mm", "10 us")
FRAME = {
    "fabric": {"name": "S-720"}, "picture_frame": {"shear_angle": "24 deg", "crossovers": 4},
    "run": {"steps": 4, "outputs": ["pictures", "report"]},
}  # fmt: skip
PULL = {
    "fabric": {"name": "S-726"},
    "pull_out": {"crossings": 10, "displacement": "1.2 mm", "crossover_friction": 0, "crossover_cohesion": "0.5 N"},
}
SHORT = {"warp only": (1, 0), "equibiaxial": (1, 1)}  # paths of a calibration
LAW = '{"format": "weavecell compression law 1", "a": "45 um", "b": "58 um * N**(1/3)"}'


@contextlib.contextmanager
def small_calibration():
    """Calibrations on the least of meshes, along two paths."""
    from unitcell3d.identify import calibrate as solver

    small = {"size": (2, 2, 2), "plates_size": (2, 2, 2), "paths": SHORT}
    one = lambda fabric, *, run=solver.calibrate, **more: run(fabric, **more | small)  # noqa: E731
    all_of = lambda fabrics, *, run=solver.calibrate_all, **more: run(fabrics, **more | small)  # noqa: E731
    with mock.patch.multiple(solver, calibrate=one, calibrate_all=all_of):
        yield


class Command(NamedTuple):
    """Words of a command, the files that it reads, and what is replaced while it runs."""

    words: str
    files: Mapping = MappingProxyType({})
    within: object = contextlib.nullcontext


RUNS = {
    "impact": Command("impact scene.toml", {"scene.toml": PLY}),
    "pack": Command("impact scene.toml", {"scene.toml": PACK}),
    "sliding": Command("impact scene.toml", {"scene.toml": SLIDING}),
    "draws": Command("impact scene.toml --draws 3 --seed 4 --jobs 1", {"scene.toml": DRAWN}),
    "critical-velocity": Command("critical-velocity scene.toml --residual-shots 4 --jobs 1", {"scene.toml": LIMIT}),
    "v50": Command("v50 scene.toml --shots 8 --batch 4 --seed 2 --jobs 1", {"scene.toml": DRAWN}),
    "sensitivity": Command("sensitivity scene.toml --samples 2 --jobs 1", {"scene.toml": PLIES}),
    "sweep": Command(
        "sweep scene.toml --over 'projectile.strike_velocity=90 m/s,150 m/s' --over 'projectile.mass=3 g,2 g' --jobs 1",
        {"scene.toml": PLIES},
    ),
    "coupon": Command("coupon scene.toml", {"scene.toml": FRAME}),
    "pull-out": Command("coupon scene.toml", {"scene.toml": PULL}),
    "export": Command("export scene.toml --to lsdyna --units g-mm-ms", {"scene.toml": PLIES}),
    "calibrate": Command("calibrate S-720 --mesh coarse --jobs 1", {}, small_calibration),
    "crossover": Command(
        "crossover S-720 --case pull-out --mu 0.15 --end-displacement '5 um,9 um' --mesh 3,2,2 --law law.json",
        {"law.json": LAW},
    ),
    "surface": Command("surface S-720 --mesh coarse --points 5 --d1 '0 mm .. 0.01 mm' --d2 '0 um .. 8 um' --jobs 1"),
}


class Run(NamedTuple):
    """What a command left: its folder and exit code, and what it printed."""

    folder: Path
    code: int
    out: str
    err: str


def made(name, folder):
    """The Run of a name of RUNS, in `folder`; other processes wait until it is made, and then read it."""
    folder.mkdir(exist_ok=True)
    with open(folder / "lock", "w") as lock, contextlib.chdir(folder):
        fcntl.flock(lock, fcntl.LOCK_EX)
        printed = folder / "printed.json"
        if not printed.exists():
            printed.write_text(json.dumps(_called(RUNS[name])))
        return Run(folder / "r", *json.loads(printed.read_text()))


def write(files):
    """Write the files of a command to this folder."""
    for name, content in files.items():
        Path(name).write_text(content if isinstance(content, str) else toml(content))


def _called(command):
    """(exit code, standard output, standard error) of a command in this folder and process."""
    from weavecell.cli import app

    write(command.files)
    out, err = io.StringIO(), io.StringIO()
    code = None
    with command.within(), contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            app.main([*shlex.split(command.words), "--out", "r"])
        except SystemExit as leaving:
            code = leaving.code
    return code, out.getvalue(), err.getvalue()


def set_up(table):
    """The set-up of the table of an input file, by the Python interface."""
    table = copy.deepcopy(table)
    fabric, velocity = table["fabric"].pop("name"), table["projectile"].pop("strike_velocity")
    options = table.pop("fabric") | table.pop("panel") | table.pop("run") | table
    for key in ("title", "outputs", "checkpoint_interval"):
        options.pop(key, None)
    if "history" in options:
        options["history"].pop("report_positions", None)
    return wc.setup(fabric, velocity, **options)


@cache
def fired(name):
    """The ShotResult of a run of `weavecell impact`, by the Python interface."""
    return wc.sweep([set_up(RUNS[name].files["scene.toml"])])[0]
