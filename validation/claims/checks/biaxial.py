"""Biaxial tension of the glass weaves on the crossover (source thesis section 5.3), with the source's parameters."""

from __future__ import annotations

import itertools

import numpy as np

from fabrics import catalogue
from shellfabric.cell.model import CellModel
from validation.claims.registry import check
from weavecell.analysis.biaxial_test.curves import at_ratio, free_edge


@check()
def inputs(fabric):
    weave, law = catalogue.load(fabric).weave, catalogue.load(fabric).laws[0]
    found = {}
    for name, yarn in zip(("warp", "weft"), weave.yarns):
        found |= {
            f"EA {name}": yarn.EA,
            f"strength {name}": yarn.strength,
            f"failure strain {name}": yarn.failure_strain,
        }
    return found | {"a": law.a, "b": law.b}


@check()
def free_shift(fabric):
    """Where the loaded part of the curve with a free edge, drawn on, meets no load."""
    curve = free_edge(CellModel(catalogue.load(fabric), form="equilibrium"), "warp")
    loaded = curve.tension[:, 0] > 0.2 * curve.tension[-1, 0]
    slope, start = np.polyfit(curve.strain[loaded, 0], curve.tension[loaded, 0], 1)
    return {"shift": -start / slope}


@check()
def symmetry(fabric, k):
    cell = CellModel(catalogue.load(fabric), form="equilibrium")
    one, other = at_ratio(cell, k), at_ratio(cell, 1 / k)
    end = min(one.strain[-1, 0], other.strain[-1, 1])
    e = np.linspace(0, end, 100)
    warp = cell.solve(1 + e, 1 + e / k)["T1"]
    weft = cell.solve(1 + e / k, 1 + e)["T2"]
    return {"difference over strength": np.abs(warp - weft).max() / cell.fabric.weave.warp.strength}


@check()
def order(fabric):
    """Warp tension at each own strain up to the first failure, from the most to the least stretched cross direction."""
    cell = CellModel(catalogue.load(fabric), form="equilibrium")
    curves = {f"k = {k:g}": at_ratio(cell, k) for k in (0.5, 1.0, 2.0)} | {"free": free_edge(cell, "warp")}
    e = np.linspace(0, min(curve.strain[-1, 0] for curve in curves.values()), 50)[1:]
    T = {name: np.interp(e, curve.strain[:, 0], curve.tension[:, 0]) for name, curve in curves.items()}
    names = sorted(T, key=lambda name: -T[name].mean())
    gaps = [float((T[a] - T[b]).min()) for a, b in itertools.pairwise(names)]
    return {"order": names, "least distance": min(gaps)}


@check()
def used_up(fabric):
    given = catalogue.load(fabric)
    return {"2a over heights": 2 * given.laws[0].a / sum(given.weave.h0)}
