"""Biaxial tension of the glass weaves on the crossover (thesis section 5.3), with the thesis's parameters."""

from __future__ import annotations

import itertools

import numpy as np

from fabrics import catalogue
from shellfabric.cell.model import CellModel
from validation.claims.checks.by_hand import departure
from validation.claims.registry import Found, check
from validation.published.biaxial_glass.curves import at_ratio, free_edge


@check()
def inputs(fabric: str) -> Found:
    weave, law = catalogue.load(fabric).weave, catalogue.load(fabric).laws[0]
    found: Found = {}
    for name, yarn in zip(("warp", "weft"), weave.yarns):
        found |= {
            f"EA {name}": yarn.EA,
            f"strength {name}": yarn.strength,
            f"failure strain {name}": yarn.failure_strain,
        }
    return found | {"a": law.a, "b": law.b}


@check()
def lone_curve(fabric: str) -> Found:
    """Stiffness [N] of the loaded part of the curve with a free edge, and the strain of the yarn at its strength."""
    curve = free_edge(CellModel(catalogue.load(fabric), form="equilibrium"), "warp")
    yarn = catalogue.load(fabric).weave.warp
    strain = (1 + curve.strain[:, 0]) / (1 + yarn.crimp) - 1  # of the yarn's own length
    loaded = curve.tension[:, 0] > 0
    failed = np.interp(yarn.strength, curve.tension[loaded, 0], strain[loaded])
    return {
        "EA warp": np.polyfit(strain[loaded], curve.tension[loaded, 0], 1)[0],
        "failure strain warp": float(failed),
        "strength": float(curve.tension[-1, 0]),
    }


@check()
def free_shift(fabric: str) -> Found:
    """Where the loaded part of the curve with a free edge, drawn on, meets no load."""
    curve = free_edge(CellModel(catalogue.load(fabric), form="equilibrium"), "warp")
    loaded = curve.tension[:, 0] > 0.2 * curve.tension[-1, 0]
    slope, start = np.polyfit(curve.strain[loaded, 0], curve.tension[loaded, 0], 1)
    return {"shift": -start / slope}


@check()
def symmetry(fabric: str, k: float) -> Found:
    cell = CellModel(catalogue.load(fabric), form="equilibrium")
    one, other = at_ratio(cell, k), at_ratio(cell, 1 / k)
    end = min(one.strain[-1, 0], other.strain[-1, 1])
    e = np.linspace(0, end, 100)
    warp = cell.solve(1 + e, 1 + e / k)["T1"]
    weft = cell.solve(1 + e / k, 1 + e)["T2"]
    return {
        "difference over strength": np.abs(warp - weft).max() / cell.fabric.weave.warp.strength,
        "off the equations": departure(cell, 1 + e, 1 + e / k),
    }


@check()
def order(fabric: str) -> Found:
    """Warp tension at each own strain up to the first failure, from the most to the least stretched cross direction."""
    cell = CellModel(catalogue.load(fabric), form="equilibrium")
    curves = {f"k = {k:g}": at_ratio(cell, k) for k in (0.5, 1.0, 2.0)} | {"free": free_edge(cell, "warp")}
    e = np.linspace(0, min(curve.strain[-1, 0] for curve in curves.values()), 50)[1:]
    T = {name: np.interp(e, curve.strain[:, 0], curve.tension[:, 0]) for name, curve in curves.items()}
    names = sorted(T, key=lambda name: -T[name].mean())
    gaps = [float((T[a] - T[b]).min()) for a, b in itertools.pairwise(names)]
    return {
        "order": names,
        "least distance": min(gaps),
        "off the equations": max(departure(cell, 1 + e, 1 + e / k) for k in (0.5, 1.0, 2.0)),
    }


@check()
def used_up(fabric: str) -> Found:
    given = catalogue.load(fabric)
    return {"2a over heights": 2 * given.laws[0].a / sum(given.weave.h0)}


@check()
def origin_shift(fabric: str, shift: float) -> Found:
    """RMS by which tensions move when the strain origin moves by `shift` [-], over the RMS of the curve itself."""
    cell, moved, over = CellModel(catalogue.load(fabric), form="equilibrium"), {}, {}
    for k in (0.5, 1.0, 2.0):
        curve = at_ratio(cell, k)
        for family, (name, yarn) in enumerate(zip(("warp", "weft"), cell.fabric.weave.yarns)):
            strain, tension = curve.strain[:, family], curve.tension[:, family]
            common = strain > shift
            off = np.sqrt(np.mean((tension[common] - np.interp(strain[common] - shift, strain, tension)) ** 2))
            moved[name, k] = off / np.sqrt(np.mean(tension[common] ** 2))
            over[name, k] = off / yarn.strength
    most = {name: max((0.5, 1.0, 2.0), key=lambda k, name=name: moved[name, k]) for name in ("warp", "weft")}  # type: ignore[misc]
    return {
        "most, warp": most["warp"],
        "most, weft": most["weft"],
        "at k = 0.5": min(moved[name, 0.5] for name in most),
        "note": "; ".join(
            f"{name}, k = {k:g}: {100 * value:.0f} % ({100 * over[name, k]:.1f} % of the strength)"
            for (name, k), value in moved.items()
        ),
    }
