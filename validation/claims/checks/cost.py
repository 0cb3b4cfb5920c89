"""Sizes and cost of the thesis's models beside ours (thesis section 4.4.4, Table 4-3)."""

from __future__ import annotations

import time

import numpy as np

from fabrics import catalogue
from shellfabric.cell.model import CellModel
from shellfabric.panel.model import Panel
from validation.claims.registry import Found, Run, RunResult, check


def _panel(fabric):
    return Panel(CellModel(catalogue.load(fabric)).table(8))


@check()
def shell_elements() -> Found:
    one, other = _panel("S-720"), _panel("S-726")
    sides = [n * d for panel in (one, other) for n, d in zip(panel.counts, panel.spacing)]
    return {
        "S-720": one.elements,
        "S-726, four plies": 4 * other.elements,
        "side S-720": sides[0],
        "sides S-726, along weft": sides[3],
        "sides S-726, along warp": sides[2],
    }


@check()
def cable_elements(bars: int) -> Found:
    one, other = _panel("S-720"), _panel("S-726")
    return {"S-720": bars * one.elements, "S-726, four plies": bars * 4 * other.elements}


@check(lambda fabric, velocity: {"seconds": Run.of("pace", fabric=fabric, velocity=velocity)})
def shell_over_cable(seconds: RunResult, fabric: str, velocity: float) -> Found:
    return {
        "ratio": seconds["shell"] / seconds["cable"],
        "above one": seconds["shell"] / seconds["cable"] - 1,
        "note": f"{seconds['shell']:.2f} s the shell, {seconds['cable']:.2f} s the net, 250 us, in turns",
    }


@check()
def look_up(fabric: str, n: int, samples: int) -> Found:
    """Bilinear table of tensions against the cell itself, over all states up to failure; and their speed."""
    model = CellModel(catalogue.load(fabric), form="equilibrium")
    table, rng = model.table(n), np.random.default_rng(4)
    s1, s2 = (rng.uniform(axis[0], axis[-1], samples) for axis in (table.stretch1, table.stretch2))
    begun = time.perf_counter()
    exact = model.solve(s1, s2)
    solving = time.perf_counter() - begun
    d1, d2 = table.steps
    begun = time.perf_counter()
    x, y = (s1 - table.stretch1[0]) / d1, (s2 - table.stretch2[0]) / d2
    i, j = np.minimum(x.astype(int), n - 2), np.minimum(y.astype(int), n - 2)
    x, y = x - i, y - j
    c = table.tension1[i, j]
    T1 = c[:, 0] + c[:, 1] * x + c[:, 2] * y + c[:, 3] * x * y
    reading = time.perf_counter() - begun
    c = table.tension2[i, j]
    T2 = c[:, 0] + c[:, 1] * x + c[:, 2] * y + c[:, 3] * x * y
    weave = model.fabric.weave
    safe = (exact["T1"] <= weave.warp.strength) & (exact["T2"] <= weave.weft.strength)
    error = max(
        np.abs(T1 - exact["T1"])[safe].max() / weave.warp.strength,
        np.abs(T2 - exact["T2"])[safe].max() / weave.weft.strength,
    )
    return {"largest error over strength": error, "speed-up": solving / reading}
