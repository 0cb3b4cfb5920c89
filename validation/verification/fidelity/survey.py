"""The survey: every model of the ladder on standard and on drawn scenes. `fit_error_database` makes of them what models
are chosen by.

Each run has one thread, and its cost is process time with the filling of its table.
"""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from shellfabric.impact.simulation import ImpactSetup, run
from validation.verification.fidelity import scenes
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
