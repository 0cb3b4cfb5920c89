"""One shot by this code, by simpler and by finer models of it, and by another code that ran it once."""

from __future__ import annotations

import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

import weavecell as wc
from shellfabric.impact.run import run_impact
from validation.cases import noses
from validation.cases.laws import card_table, law_of_card
from validation.csv_file import read
from validation.models.cable.net import CableNet
from validation.values import Values
from weavecell.studies import mesh_uncertainty

# runs of decks that `weavecell export` wrote
RECORDED = Path(__file__).parents[2] / "docs" / "reports" / "data" / "kept" / "cards-6.csv"
# fields of ImpactSetup that no input file has
NOT_IN_A_FILE = ("table_size",)


def struck(
    *,
    fabric: str,
    velocity: float,
    model: str = "panel",
    card: str = "",
    match: str = "plane",
    finer: bool = False,
    **scene: Any,
) -> Values:
    """Fire a shot whose yarns do not fail.

    Parameters
    ----------
    fabric, velocity : name, [m/s]
    model : "panel"; "cable", the pin-jointed net; or "recorded", the run of another code with the deck of this scene
    card, match : of `laws.LAWS` and `decks.homogenised.MATCHES`: the law of a material card in place of the cell
    finer : whether elements about the impact point have half the side
    scene : other keywords of `weavecell.setup`

    Returns
    -------
    t, v (n,) [s, m/s]; cpu_s [s] of the run and of its tables
    """
    if model == "recorded":
        return _recorded(fabric, velocity)
    own = {name: scene.pop(name) for name in NOT_IN_A_FILE if name in scene}
    scene["numerics"] = {"threads": 1} | scene.get("numerics", {})
    setup = replace(wc.setup(fabric, velocity, yarn_failure=False, **scene), **own)
    setup = noses.with_friction(setup)
    began = time.process_time()
    if model == "cable":
        history = CableNet(replace(setup, elements_per_crossover=1)).run().step_history
        return {"t": history[:, 0], "v": history[:, 2], "cpu_s": time.process_time() - began}
    table = setup.table()
    if card:
        table = card_table(setup, law_of_card(setup, card, match))
    if finer:
        setup = mesh_uncertainty.finer(setup, table)
    result = run_impact(setup, table=table)
    return {"t": result.time, "v": result.velocity, "cpu_s": time.process_time() - began}


def _recorded(fabric, velocity):
    """The run of the deck of this fabric at this velocity in OpenRadioss, from the table that keeps it."""
    rows = [
        row
        for row in read(RECORDED)[1]
        if row["deck"].startswith(f"{fabric}, ") and row["deck"].endswith(f" at {velocity:g} m/s")
    ]
    return {
        "t": np.array([0.0, *(1e-6 * float(row["at [us]"]) for row in rows)]),
        "v": np.array([velocity, *(float(row["OpenRadioss [m/s]"]) for row in rows)]),
        "cpu_s": float(rows[0]["CPU time of the whole run [s]"]),
    }
