"""The cell between its bounds, and its energy over all strains (source thesis sections 5.2.4, 6.4.1)."""

from __future__ import annotations

import itertools

import numpy as np

from fabrics import catalogue
from shellfabric.cell.model import MODELS
from validation.claims.checks.cell import cell, end, printed, warp_pull
from validation.claims.checks.geometry import KEVLAR, ranked
from validation.claims.registry import check


@check()
def bounds(fabric, at):
    """Warp extension with held weft between the bounds; `at` is the warp strain at which tensions are told."""
    cells = {model: cell(fabric, model) for model in MODELS}
    strain, stiff = warp_pull(cells["incompressible"])
    found = {"incompressible": stiff} | {m: cells[m].solve(1 + strain, 1.0) for m in ("compressible", "decoupled")}
    result = {}
    for T in ("T1", "T2"):
        rows = [found[model][T][1:] for model in ("incompressible", "compressible", "decoupled")]
        result[f"{T} least distance"] = min(float((a - b).min()) for a, b in itertools.pairwise(rows))
        told = {m: float(np.interp(at, strain, found[m][T])) for m in MODELS}
        result |= {f"{T} {model}": value for model, value in told.items()}
        result[f"{T} order"] = ranked(told)
    room = found["incompressible"]["T1"] - found["decoupled"]["T1"]
    # shares mean little before there is a difference to share
    real = room > 0.01 * room.max()
    result["greatest share of the way"] = (
        (found["compressible"]["T1"] - found["decoupled"]["T1"])[real] / room[real]
    ).max()
    return result


@check()
def energy_bounds(fabric):
    """Stored energy of the three cells over all pairs of strains at which no yarn fails."""
    share, W = _surfaces(fabric)
    least = min(float((a - b).min()) for a, b in (W[:2], W[1:]))
    return {
        "least distance over the highest": least / W[0].max(),
        "mean share of the way": share,
        "note": f"on average {share:.2f} of the way from decoupled to incompressible",
    }


@check()
def interaction(balanced, unbalanced):
    shares = {name: _surfaces(name)[0] for name in (balanced, unbalanced)}
    return {"order": ranked(shares), "note": ", ".join(f"{name} {share:.2f}" for name, share in shares.items())}


def _surfaces(fabric, n=41):
    """Mean share of the way, and energies of the incompressible, the compressible and the decoupled cell."""
    models = [cell(fabric, model) for model in ("incompressible", "compressible", "decoupled")]
    weave = models[0].fabric.weave
    grid = np.meshgrid(*(np.linspace(1, end(yarn), n) for yarn in weave.yarns), indexing="ij")
    found = [model.solve(*grid) for model in models]
    safe = (found[0]["T1"] <= weave.warp.strength) & (found[0]["T2"] <= weave.weft.strength)
    W = [part["W"][safe] for part in found]
    return float(np.mean(W[1] - W[2]) / np.mean(W[0] - W[2])), W


@check()
def weft_energy(fabric, strain):
    W = [float(cell(fabric, model).solve(1.0, 1 + strain)["W"]) for model in ("compressible", "decoupled")]
    return {"compressible over decoupled": W[0] / W[1], "note": f"{1e3 * W[0]:.3f} and {1e3 * W[1]:.3f} mJ"}


@check()
def failure_lines(fabric):
    weave = catalogue.load(fabric).weave
    return {name: w * (end(yarn) - 1) for name, w, yarn in zip(("warp", "weft"), weave.w, weave.yarns)}


@check()
def both_negative(fabric, reach):
    model = cell(fabric)
    d = np.linspace(-reach, -1e-9, 41)
    s = [1 + d / w for w in model.fabric.weave.w]
    found = model.solve(*np.meshgrid(*s, indexing="ij"))
    raw = printed(fabric).solve(1 - 0.005, 1 - 0.005)
    return {
        "contact force": found["F"].max(),
        "tension": max(found["T1"].max(), found["T2"].max()),
        "note": f"the printed law leaves {float(raw['F']):.2f} N at -0.5 % of both",
    }


@check()
def energy_surface(fabric):
    model = cell(fabric)
    weave = model.fabric.weave
    found = model.solve(*np.meshgrid(*(np.linspace(1, end(yarn), 61) for yarn in weave.yarns), indexing="ij"))
    safe = (found["T1"] <= weave.warp.strength) & (found["T2"] <= weave.weft.strength)
    W = np.where(safe, found["W"], np.nan)
    steps = [np.nanmin(np.diff(W, axis=axis)) / np.nanmax(W) for axis in (0, 1)]
    return {"least growth over the highest": min(steps)}


@check()
def no_failure_extent():
    extents = {name: end(catalogue.load(name).weave.warp) - 1 for name in KEVLAR}
    return {"order": ranked(extents)}


@check()
def energy_level():
    """Stored energy per area where both yarns are at their strength."""
    found, denier, mass = {}, {}, {}
    for name in KEVLAR:
        model = cell(name)
        weave = model.fabric.weave
        # both at their failure strain, straight: what one yarn stores at its strength, over the cell
        W = sum(0.5 * yarn.strength * yarn.failure_strain * S0 for yarn, S0 in zip(weave.yarns, weave.S0))
        found[name] = W / weave.cell_area
        denier[name], mass[name] = weave.warp.linear_density, weave.areal_density
    order = ranked(found)
    per_mass = [found[name] / mass[name] for name in KEVLAR]
    follows = all(denier[a] >= denier[b] for a, b in itertools.pairwise(order))
    return {
        "highest": order[0],
        "lowest": order[-1],
        "follows the denier": follows,
        "note": f"{', '.join(f'{n} {found[n]:.0f}' for n in order)} J/m2; "
        f"{min(per_mass) / 1e3:.1f} to {max(per_mass) / 1e3:.1f} kJ/kg",
    }
