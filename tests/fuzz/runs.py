"""One random scene from its files to its outcome, as `weavecell impact` runs it but for the writing of results.

Outcomes
    ok         the run terminated normally; "end" says stopped, perforated or in flight
    rejected   InputError: one line to the user
    guard      UnstableError: the run stopped itself
    time       the limit of CPU time; the run was going on
    traceback  any other exception
A run that hangs ends its process, with a traceback.
"""

import faulthandler
import tempfile
import time
import traceback
from collections import Counter
from dataclasses import replace

from fabrics.base.errors import InputError, UnstableError
from fabrics.base.schema import read_toml
from shellfabric.impact.run import run_impact
from weavecell.scenes import build
from weavecell.scenes import impact as scene_files

TIME_LIMIT = 120.0  # [s] of CPU time of the steps
WALL_LIMIT = 3000.0  # [s] of a run that hangs, on a machine that does other things too
ENERGY_ERROR_LIMIT = 0.005  # of the strike energy, at normal termination


class TimeLimit(Exception):
    """A run that took too long."""


ERRORS = {
    InputError: "rejected",
    UnstableError: "guard",
    TimeLimit: "time",
    Exception: "traceback",
}


def outcome(scene):
    """Run a RandomScene: {"name", "outcome", "end", "message", "energy_error" [-], "doubtful", "cpu_time" [s], ...}."""
    row = dict.fromkeys(("end", "message", "doubtful"), "")
    row |= {"name": scene.name, "outcome": "ok", "energy_error": None}
    begun = []

    def watch(march):
        begun[:] = begun or [time.process_time()]
        if time.process_time() - begun[0] > TIME_LIMIT:
            raise TimeLimit(f"at {1e6 * march.time:.4g} us of the run")

    faulthandler.dump_traceback_later(WALL_LIMIT, exit=True)
    with tempfile.TemporaryDirectory() as folder:
        try:
            row |= _of_result(run(scene.write(folder), hooks=(watch,)))
        except Exception as problem:
            row["outcome"] = next(
                name for kind, name in ERRORS.items() if isinstance(problem, kind)
            )
            row["message"] = str(problem).replace(f"{folder}/", "")
            if row["outcome"] == "traceback":
                row["message"] = traceback.format_exc(limit=-3)
            if getattr(problem, "result", None) is not None:
                row |= _of_result(problem.result)
        finally:
            faulthandler.cancel_dump_traceback_later()
    return row | {"cpu_time": time.process_time() - begun[0] if begun else 0.0}


def run(path, hooks=()):
    """The result of `shellfabric` for the scene at `path`, on one thread."""
    return run_impact(setup_of(path)[1], hooks=hooks)


def setup_of(path):
    """(Scene, ImpactSetup) of the scene at `path`, on one thread."""
    asked = scene_files.check(read_toml(path, what="input")[1], path)
    setup = build.setup(build.build(asked, path, path.stem), path)
    return asked, replace(
        setup, numerics=replace(setup.numerics, threads=1), snapshot_interval=None
    )


def _of_result(result):
    return {
        "end": result.outcome,
        "energy_error": result.energy_error_max,
        "steps": result.steps,
        "cut_yarns": float(result.cut_yarns[-1]),
        "residual_velocity": result.residual_velocity,
        "doubtful": "; ".join(str(check) for check in result.checks if not check.ok),
    }


def is_wrong(row):
    """Whether a run did not end as it has to; the energy error of one that ended well has to be a number."""
    if row["outcome"] == "ok":
        return not row["energy_error"] <= ENERGY_ERROR_LIMIT
    return row["outcome"] not in ("rejected", "guard")


def failures(rows, guards):
    """What must not be, in lines: wrong runs, and more than `guards` runs that were stopped by a guard."""
    stopped = [row for row in rows if row["outcome"] == "guard"]
    found = [row for row in rows if is_wrong(row)] + (stopped if len(stopped) > guards else [])
    return [
        f"{row['name']}: {row['outcome']}, {row['message']} energy error {row['energy_error']}"
        for row in found
    ]


def summary(rows):
    """Counts of the outcomes, the largest energy error, and how many runs are doubtful."""
    ended = [row for row in rows if row["outcome"] == "ok"]
    counts = Counter(row["end"] if row["outcome"] == "ok" else row["outcome"] for row in rows)
    error = max((row["energy_error"] for row in ended), default=0)
    cpu = sum(row["cpu_time"] for row in rows)
    torn, doubtful = (sum(bool(row[name]) for row in ended) for name in ("cut_yarns", "doubtful"))
    return (
        f"{len(rows)} scenes: {', '.join(f'{n} {name}' for name, n in counts.most_common())}; {torn} with torn yarns, "
        f"{doubtful} doubtful, energy error at most {100 * error:.2g} %, {cpu:.0f} s of CPU"
    )
