"""Trials: random scenes that the survey has not seen, each answered to its targets and held against the full model.

refined      all four quantities of every scene, to 2, 5 or 10 %
refined-scene    targets as a user may set them: one or two quantities, drawn, each to 2, 5 or 10 %, drawn
packs        all four quantities of drawn packs, to 5 %, held against a third mesh, of twice as many elements per
             crossover near the impact point as the default has

Costs are process time, of one thread, with all scouts, repeated runs and tables, over that of the full model: on the
same part of the panel, and on the whole panel, which is run where that does not take too long. The projectile is rigid.
"""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from math import inf, nan
from typing import Any

import numpy as np

from shellfabric.impact import simulation
from validation.verification.fidelity import fit_error_database, scenes
from weavecell.analysis.fidelity import quantities, select
from weavecell.analysis.fidelity.ladder import BY_NAME, FULL, Model, Tables, simplest

TRIALS = {"refined": 505, "refined-scene": 606, "packs": 707}  # their seeds
COUNT, PACKS = 20, 40
PACK_TARGET = 0.05
THIRD = Model("third mesh of packs", (("table_size", 201),), near=2.0)
TARGETS = (0.02, 0.05, 0.1)
LONGEST = 1.0  # [s] of the full model on its part of the panel, beyond which the whole panel is not run


@dataclass(frozen=True)
class Row:
    """One scene of a trial.

    Parameters
    ----------
    number, fabric, velocity [m/s], shape : of the scene
    targets : {quantity: [-]}
    model : that was chosen in the end
    tried : how many answers it took
    confirmed : whether the code said that the promise holds
    outcome : of the full model
    promised, found : {quantity: [-]} errors, estimated and against the full model
    seconds, full_seconds, whole_seconds : process time with all that it took; of the full model with its table, on the
        same part of the panel, and on the whole (nan where it was not run)
    """

    number: int
    fabric: str
    velocity: float
    shape: str
    targets: dict
    model: str
    tried: int
    confirmed: bool
    outcome: str
    promised: dict
    found: dict
    seconds: float
    full_seconds: float
    whole_seconds: float

    @property
    def met(self) -> bool:
        """Whether every error is within its target, whatever the code said."""
        return all(not error > self.targets[name] for name, error in self.found.items())

    @property
    def cost(self) -> float:
        """[-] over the full model on the same part of the panel."""
        return self.seconds / self.full_seconds

    @property
    def whole_cost(self) -> float:
        """[-] over the full model on the whole panel; nan where that was not run."""
        return self.seconds / self.whole_seconds


def targets_of(trial: str, number: int) -> dict[str, float]:
    """{quantity: [-]} targets of the scene of a number."""
    if trial == "packs":
        return dict.fromkeys(quantities.NAMES, PACK_TARGET)
    if trial == "refined":
        return dict.fromkeys(quantities.NAMES, TARGETS[number % len(TARGETS)])
    draw = np.random.default_rng((TRIALS[trial], number, 1))
    names = draw.choice(quantities.NAMES, int(draw.integers(1, 3)), replace=False)
    return {str(name): float(draw.choice(TARGETS)) for name in names}


def count(trial: str) -> int:
    """Number of scenes."""
    return PACKS if trial == "packs" else COUNT


def truth(trial: str, number: int) -> dict[str, Any]:
    """What the full model finds of a scene: values, and process times [s] on the part of the panel and the whole."""
    setup = _setup(trial, number)
    values, seconds = _full(simplest(setup, Tables()))
    whole = seconds <= LONGEST and trial != "packs"
    return {"values": values, "seconds": seconds, "whole": _full(setup)[1] if whole else nan}


def answer(trial: str, number: int) -> Any:
    """The answer of the code to the targets of the scene: (select.Answer without its runs, process time [s])."""
    setup, wanted = _setup(trial, number), targets_of(trial, number)
    began = time.process_time()
    found = select.answer(setup, wanted, fixed=frozenset({"projectile"}))
    seconds = time.process_time() - began
    attempts = tuple(replace(attempt, result=None) for attempt in found.attempts)
    return replace(found, options=(), attempts=attempts), seconds


def row(trial: str, number: int, known_full: Any, answered: Any) -> Row:
    """The Row of a scene from its `truth` and its `answer`."""
    setup, wanted = _setup(trial, number), targets_of(trial, number)
    (found, seconds), full = answered, known_full["values"]
    final = found.final
    errors = {name: fit_error_database.error(final.values, full, name) for name in wanted}
    if final.values["outcome"] != full["outcome"]:
        errors = dict.fromkeys(wanted, inf)
    return Row(
        number, setup.fabric.name, setup.strike_velocity, setup.projectile.shape, wanted, final.option.model.name,
        len(found.attempts), found.confirmed, full["outcome"], final.errors, errors, seconds, known_full["seconds"],
        known_full["whole"],
    )  # fmt: skip


def _setup(trial, number):
    setup = (scenes.drawn_pack if trial == "packs" else scenes.drawn)(number, TRIALS[trial])
    return replace(setup, numerics=replace(setup.numerics, threads=1))


def _full(setup):
    """(quantities, process time [s]) of the full model on the panel of a set-up."""
    began = time.process_time()
    this = (BY_NAME[FULL] if setup.plies == 1 else THIRD).of(setup)
    result = simulation.run(this, table=this.table())
    return quantities.of(result), time.process_time() - began
