"""The trial: random scenes, each answered as it asks, and held against the full model on the same part of the panel."""

from __future__ import annotations

import time
from dataclasses import dataclass

from shellfabric import impact
from validation.fidelity import choose, quantities, scenes
from validation.fidelity.models import BY_NAME, FULL, Tables, simplest

ASKED = (0.02, 0.05, 0.1)


@dataclass(frozen=True)
class Row:
    """One scene of the trial.

    Parameters
    ----------
    number, fabric, velocity [m/s], shape : of the scene
    asked : [-] of every quantity
    model : that was chosen in the end
    confirmed : whether the code said that the promise holds
    outcome : of the full model
    promised, found : {quantity: [-]} errors, estimated and against the full model
    seconds, full_seconds : process time with all checks and tables; of the full model with its table
    """

    number: int
    fabric: str
    velocity: float
    shape: str
    asked: float
    model: str
    confirmed: bool
    outcome: str
    promised: dict
    found: dict
    seconds: float
    full_seconds: float

    @property
    def met(self):
        """Whether every error is within what was asked, whatever the code said."""
        return all(not error > self.asked for error in self.found.values())


def row(number, seed=20):
    """Run one scene of the trial."""
    setup, asked = scenes.drawn(number, seed), ASKED[number % len(ASKED)]
    began = time.process_time()
    found = choose.answer(setup, dict.fromkeys(quantities.NAMES, asked))
    middle = time.process_time()
    tables = Tables()
    full = BY_NAME[FULL].of(simplest(setup, tables))
    result = impact.run(full, table=tables.of(full))
    ended = time.process_time()
    final, truth = found.final, quantities.of(result)
    same = final.values["outcome"] == truth["outcome"]
    errors = quantities.differences(final.values, truth) if same else dict.fromkeys(quantities.NAMES, float("inf"))
    return Row(
        number, setup.fabric.name, setup.strike_velocity, setup.projectile.shape, asked, final.option.model.name,
        found.confirmed, result.outcome, final.errors, errors, middle - began, ended - middle,
    )  # fmt: skip
