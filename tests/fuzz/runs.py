"""One random scene from its files to its outcome, as `weavecell impact` runs it but for the writing of results.

Outcomes
    ok         the run terminated normally; "end" says stopped, perforated or in flight
    rejected   InputError: one line to the user
    guard      UnstableError: the run stopped itself
    time       the limit of CPU time; the run was going on
    traceback  any other exception
and, of a process that had to be ended or died (`pool`): "timeout" and "crash".
"""

from __future__ import annotations

import tempfile
import time
import traceback
import warnings
from dataclasses import replace
from pathlib import Path

from fabrics.errors import InputError, UnstableError
from tests.fuzz import scenes
from weavecell.scenes import build
from weavecell.scenes import impact as scene_files

TIME_LIMIT = 120.0  # [s] of CPU time


class TimeLimit(Exception):
    """A run that took too long."""


def outcome(seed, index, limit=TIME_LIMIT) -> dict:
    """Run scene (seed, index): a row of the table."""
    return outcome_of(scenes.scene(seed, index), limit) | {"seed": seed, "index": index}


def outcome_of(scene, limit=TIME_LIMIT) -> dict:
    """Run a RandomScene: {"outcome", "end", "message", "energy_error" [-], "cpu_time" [s], ...}."""
    began = time.process_time()
    row = {"outcome": "ok", "end": "", "message": "", "energy_error": None, "failed_yarns": None, "warnings": ""}

    def watch(march):
        if time.process_time() - began > limit:
            raise TimeLimit(f"at {1e6 * march.time:.4g} us of the run")

    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            row |= _of_result(run(scene.write(folder), hooks=(watch,)))
        except InputError as problem:
            row |= {"outcome": "rejected", "message": str(problem).replace(f"{folder}/", "")}
        except UnstableError as problem:
            row |= {"outcome": "guard", "message": str(problem)}
            if getattr(problem, "result", None) is not None:
                row |= _of_result(problem.result)
        except TimeLimit as problem:
            row |= {"outcome": "time", "message": str(problem)}
        except Exception as problem:
            frame = traceback.extract_tb(problem.__traceback__)[-1]
            ours = [f for f in traceback.extract_tb(problem.__traceback__) if "site-packages" not in f.filename]
            place = f"{Path(ours[-1].filename).name}:{ours[-1].lineno}" if ours else frame.filename
            row |= {"outcome": "traceback", "message": f"{type(problem).__name__}: {problem} ({place})"}
    row["warnings"] = "; ".join(sorted({f"{Path(w.filename).name}:{w.lineno} {w.message}" for w in caught}))
    row["cpu_time"] = time.process_time() - began
    return row | flat(scene)


def compile_kernels():
    """Run a single ply and a pack without a limit, so that kernels are compiled and kept before runs are timed."""
    missing, index = {"ply", "pack"}, 0
    while missing:
        scene = scenes.scene("compile", index)
        kind = "pack" if {"plies", "ply"} & set(scene.scene["panel"]) else "ply"
        if kind in missing:
            outcome_of(scene, limit=float("inf"))
            missing.remove(kind)
        index += 1


def run(path, hooks=()):
    """The result of `shellfabric` for the scene at `path`, on one thread."""
    from shellfabric.impact import simulation

    return simulation.run(setup_of(path)[1], hooks=hooks)


def setup_of(path):
    """(Scene, ImpactSetup) of the scene at `path`, on one thread."""
    asked, _ = scene_files.load(path)
    setup = build.setup(build.build(asked, path, path.stem), path)
    return asked, replace(setup, numerics=replace(setup.numerics, threads=1), snapshot_interval=None)


def _of_result(result):
    return {
        "end": result.outcome, "energy_error": result.energy_error_max,
        "failed_yarns": float(result.failed_segments[-1]),
        "steps": result.steps, "time_us": 1e6 * float(result.t[-1]), "residual_velocity": result.residual_velocity,
    }  # fmt: skip


def flat(scene) -> dict:
    """The scene's own entries by their dotted keys."""
    found = {}

    def visit(table, path):
        for key, value in table.items():
            if isinstance(value, dict):
                visit(value, (*path, key))
            elif isinstance(value, list) and value and isinstance(value[0], dict):
                found[".".join((*path, key))] = len(value)
            else:
                found[".".join((*path, key))] = value

    visit({key: table for key, table in scene.scene.items() if key != "title"}, ())
    visit({key: table for key, table in scene.fabric.items() if key != "name"}, ("cloth",))
    return found
