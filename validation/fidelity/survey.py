"""The survey: every model of the ladder on standard scenes, and what each gets wrong against the full model.

errors.json keeps, for each model and quantity, the error that four scenes in five stay below, its median, and the
factor on the difference from the model's check that its error stays below in 19 scenes of 20.
"""

from __future__ import annotations

import time

import numpy as np

from shellfabric import impact
from validation.fidelity import quantities, scenes
from validation.fidelity.models import BY_NAME, FULL, LADDER

OFTEN, SURE = 0.8, 0.95
_OF_PERFORATED = "residual_velocity", "absorbed_energy"
_APART = 1e-4  # share below which two answers are the same: a ratio to it says nothing


def runs(name):
    """[{model: {"values", "seconds"}}] of the standard scenes of one fabric; process time, with that of the table."""
    tables, found = {}, []
    for setup in scenes.standard(name):
        possible = [model for model in LADDER if model.panel(setup, _table(model.of(setup), tables)[0]) is not None]
        row = {model.name: _run(model, setup, tables) for model in possible}
        found.append({"fabric": name, "velocity": setup.strike_velocity, **row})
    return found


def _table(setup, tables):
    """(CellTable, process time [s] that filling it took)."""
    key = setup.cell_model, setup.table_size
    if key not in tables:
        began = time.process_time()
        tables[key] = setup.table(), time.process_time() - began
    return tables[key]


def _run(model, setup, tables):
    this = model.of(setup)
    table, filling = _table(this, tables)
    began = time.process_time()
    result = impact.run(this, table=table)
    return {"values": quantities.of(result), "seconds": time.process_time() - began + filling}


def errors(rows):
    """{model: {quantity: {"expected", "typical", "factor"}, "cost"}} from the rows of all fabrics."""
    return {model.name: _of_model(model, rows) for model in LADDER}


def _of_model(model, rows):
    rows = [row for row in rows if model.name in row]
    found = {"cost": float(np.median([row[model.name]["seconds"] / row[FULL]["seconds"] for row in rows]))}
    for quantity in quantities.NAMES:
        off, apart = [], []
        for row in rows:
            values, full = row[model.name]["values"], row[FULL]["values"]
            if quantity in _OF_PERFORATED and full["outcome"] != "perforated":
                continue  # it is nought there, with any model
            off.append(quantities.differences(values, full)[quantity])
            if model.check:
                apart.append(quantities.differences(values, row[model.check]["values"])[quantity])
        if np.any(np.isfinite(off)):
            found[quantity] = _summary(model, np.array(off), np.array(apart))
    return found


def _summary(model, off, apart):
    there = np.isfinite(off)
    if model.name == FULL:  # held against itself it has no error: what it is off by is what its check is, extrapolated
        off = apart * _left(model)
    known = {"expected": float(np.quantile(off[there], OFTEN)), "typical": float(np.median(off[there]))}
    if apart.size:
        told = there & np.isfinite(apart) & (apart > _APART)
        known["factor"] = float(np.quantile(off[told] / apart[told], SURE)) if np.any(told) else 1.0
    else:
        known["factor"] = 1.0
    return known


def _left(model):
    """What is left of the difference between a mesh and its check when errors fall in proportion to the element."""
    fine, coarse = (dict(one.changes)["elements_per_crossover"] for one in (model, BY_NAME[model.check]))
    return (1 / fine) / (1 / coarse - 1 / fine)
