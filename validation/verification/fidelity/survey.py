"""The survey: every model of the ladder on standard and on drawn scenes. `known` makes of it what models are chosen by.

Each run has one thread, and its cost is process time with the filling of its table.
"""

from __future__ import annotations

import time
from dataclasses import replace

from shellfabric.impact import single_ply
from validation.verification.fidelity import scenes
from weavecell.analysis.fidelity import quantities
from weavecell.analysis.fidelity.ladder import BY_NAME, FULL, LADDER, Tables, effort, simplest

SEED, COUNT = 7, 60
MOST = 6e8  # elements times steps of the full model to the end: a drawn scene that could take more is left out
LONG = ("S-731", 0), ("S-731", 1), ("S-727", 0)  # standard ones that take many minutes


def places():
    """[(fabric, number)] of all scenes: a number alone is a drawn one, a name with the number of a share a standard."""
    standard = [(name, number) for name in scenes.KEVLAR for number in range(len(scenes.SHARES))]
    return [place for place in standard if place not in LONG] + [("", number) for number in range(COUNT)]


def row(name, number):
    """{model: {"values", "seconds"}} of a scene, with its velocity; None of one that is left out."""
    setup = scenes.standard(name)[number] if name else scenes.drawn(number, SEED)
    setup = replace(setup, numerics=replace(setup.numerics, threads=1))
    tables = Tables()
    setup = simplest(setup, tables)
    cheap = tables.cheap(setup)
    if not name and effort(BY_NAME[FULL].panel(setup, cheap), setup.end_time) > MOST:
        return None
    found = {"fabric": setup.fabric.name, "velocity": setup.strike_velocity}
    return found | {model.name: run(model, setup) for model in LADDER if model.panel(setup, cheap) is not None}


def run(model, setup):
    """What a model answers, and its process time [s]."""
    began = time.process_time()
    this = model.of(setup)
    result = single_ply.run(this, table=this.table())
    return {"values": quantities.of(result), "seconds": time.process_time() - began}
