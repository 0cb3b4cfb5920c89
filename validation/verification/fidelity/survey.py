"""The survey: every model of the ladder on standard and on drawn scenes. `fit_error_database` makes of them what models
are chosen by.

Each run has one thread, and its cost is process time with the filling of its table.
"""

from __future__ import annotations

import time
from collections.abc import Iterable, Mapping
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np

from shellfabric.impact.simulation import ImpactSetup, run
from validation.models.cable import solver as cable_solver
from validation.models.cable.model import CableNet
from validation.verification.fidelity import fit_error_database, scenes
from weavecell.analysis.fidelity import quantities
from weavecell.analysis.fidelity.ladder import (
    BY_NAME,
    FULL,
    LADDER,
    Model,
    Tables,
    effort,
    simplest,
)

CABLE = "cable net"  # beside the ladder, so that nobody need wonder: its yarns do not couple, and it is never cheapest
SEED, COUNT = 7, 60
MOST = 6e8  # elements times steps of the full model to the end: a drawn scene that could take more is left out
LONG = ("S-731", 0), ("S-731", 1), ("S-727", 0)  # standard ones that take many minutes


def places() -> list[tuple[str, int]]:
    """[(fabric, number)] of all scenes: a number alone is a drawn one, a name with the number of a share a standard."""
    standard = [(name, number) for name in scenes.KEVLAR for number in range(len(scenes.SHARES))]
    return [place for place in standard if place not in LONG] + [("", number) for number in range(COUNT)]


def rows(found: Mapping[tuple[str, int, str], Any]) -> list[dict[str, Any]]:
    """[{model: {"values", "seconds"}}] of the scenes that are not left out, from the answers of all `tasks`."""
    scenes_of = [{model.name: found[*place, model.name] for model in LADDER} for place in places()]
    known = [{name: answer for name, answer in scene.items() if answer is not None} for scene in scenes_of]
    return [scene for scene in known if FULL in scene]


def tasks() -> list[tuple[str, int, str]]:
    """[(fabric, number, model)] of all runs: each is kept, so that a model that comes later is run alone."""
    return [(*place, model.name) for place in places() for model in LADDER]


def sample(name: str, number: int, model: str) -> dict[str, Any] | None:
    """What a model answers to a scene, as `timed`; None of a scene that is left out, or that it cannot mesh."""
    setup: Any = scenes.standard(name)[number] if name else scenes.drawn(number, SEED)
    setup = replace(setup, numerics=replace(setup.numerics, threads=1))
    tables = Tables()
    setup = simplest(setup, tables)
    cheap = tables.cheap(setup)
    if not name and effort(BY_NAME[FULL].panel(setup, cheap), setup.end_time) > MOST:
        return None
    return None if BY_NAME[model].panel(setup, cheap) is None else timed(BY_NAME[model], setup)


def timed(model: Model, setup: ImpactSetup) -> dict[str, Any]:
    """What a model answers, and its process time [s]."""
    began = time.process_time()
    this = model.of(setup)
    result = run(this, table=this.table())
    return {"values": quantities.of(result), "seconds": time.process_time() - began}


def of_cable_net(name: str, number: int) -> dict[str, Any]:
    """What the net answers to a standard scene, and its process time [s]."""
    setup = scenes.standard(name)[number]
    setup = replace(setup, numerics=replace(setup.numerics, threads=1))
    began = time.process_time()
    found = cable_solver.run(CableNet.of(setup), setup.strike_velocity, setup.end_time, audit_interval=20e-6)
    seconds = time.process_time() - began
    result = SimpleNamespace(
        setup=setup, outcome=found.outcome, residual_velocity=found.residual_velocity, step_history=found.step_history,
        ply_tensions=[found.peak_tension],
    )  # fmt: skip
    return {CABLE: {"values": quantities.of(result), "seconds": seconds}}


def cable_errors(rows: Iterable[dict[str, Any]]) -> dict[str, Any]:
    """{"cost", "expected": {quantity: [-]}} as of a model of the ladder; rows joined to those of the survey."""
    expected = {}
    for name in quantities.NAMES:
        alike = [row for row in rows if quantities.is_defined(name, quantities.regime(row[FULL]["values"]))]
        off = np.array([fit_error_database.error(row[CABLE]["values"], row[FULL]["values"], name) for row in alike])
        expected[name] = float(np.quantile(off[np.isfinite(off)], fit_error_database.OFTEN))
    cost = float(np.median([row[CABLE]["seconds"] / row[FULL]["seconds"] for row in rows]))
    return {"cost": cost, "expected": expected}
