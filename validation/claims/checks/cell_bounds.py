"""The cell between its bounds, and its energy over all strains (thesis sections 5.2.4, 6.4.1)."""

from __future__ import annotations

import itertools

import numpy as np
from scipy.optimize import brentq

from shellfabric.cell.model import MODELS
from validation.claims.checks.by_hand import departure
from validation.claims.checks.cell import cell, end, printed, warp_pull
from validation.claims.checks.geometry import KEVLAR, ranked
from validation.claims.registry import Found, check


@check()
def bounds(fabric: str, at: float) -> Found:
    """Warp extension with held weft between the bounds; `at` is the warp strain at which tensions are given."""
    cells = {model: cell(fabric, model) for model in MODELS}
    strain, stiff = warp_pull(cells["incompressible"])
    found = {"incompressible": stiff} | {m: cells[m].solve(1 + strain, 1.0) for m in ("compressible", "decoupled")}
    result = {}
    for T in ("T1", "T2"):
        rows = [found[model][T][1:] for model in ("incompressible", "compressible", "decoupled")]
        result[f"{T} least distance"] = min(float((a - b).min()) for a, b in itertools.pairwise(rows))
        at_strain = {m: float(np.interp(at, strain, found[m][T])) for m in MODELS}
        result |= {f"{T} {model}": value for model, value in at_strain.items()}
        result[f"{T} order"] = ranked(at_strain)  # type: ignore[assignment]
    room = found["incompressible"]["T1"] - found["decoupled"]["T1"]
    # shares mean little before there is a difference to share
    real = room > 0.01 * room.max()
    result["greatest share of the way"] = (
        (found["compressible"]["T1"] - found["decoupled"]["T1"])[real] / room[real]
    ).max()
    result["off the equations"] = max(departure(model, 1 + strain, 1.0) for model in cells.values())
    return result


@check()
def energy_bounds(fabric: str) -> Found:
    """Stored energy of the three cells over all pairs of strains at which no yarn fails."""
    share, W, off = _surfaces(fabric)
    least = min(float((a - b).min()) for a, b in (W[:2], W[1:]))
    return {
        "least distance over the highest": least / W[0].max(),
        "mean share of the way": share,
        "off the equations": off,
        "note": f"on average {share:.2f} of the way from decoupled to incompressible",
    }


@check()
def interaction(balanced: str, unbalanced: str) -> Found:
    found = {name: _surfaces(name) for name in (balanced, unbalanced)}
    shares = {name: share for name, (share, *_) in found.items()}
    return {
        "order": ranked(shares),
        "off the equations": max(off for *_, off in found.values()),
        "note": ", ".join(f"{name} {share:.2f}" for name, share in shares.items()),
    }


def _surfaces(fabric, n=41):
    """Mean share of the way, energies of the incompressible, the compressible and the decoupled cell, `departure`."""
    models = [cell(fabric, model) for model in ("incompressible", "compressible", "decoupled")]
    weave = models[0].fabric.weave
    grid = np.meshgrid(*(np.linspace(1, end(yarn), n) for yarn in weave.yarns), indexing="ij")
    found = [model.solve(*grid) for model in models]
    safe = (found[0]["T1"] <= weave.warp.strength) & (found[0]["T2"] <= weave.weft.strength)
    W = [part["W"][safe] for part in found]
    return float(np.mean(W[1] - W[2]) / np.mean(W[0] - W[2])), W, max(departure(model, *grid) for model in models)


@check()
def weft_energy(fabric: str, strain: float) -> Found:
    models = [cell(fabric, model) for model in ("compressible", "decoupled")]
    W = [float(model.solve(1.0, 1 + strain)["W"]) for model in models]
    return {
        "compressible over decoupled": W[0] / W[1],
        "off the equations": max(departure(model, 1.0, 1 + np.linspace(0, strain, 41)) for model in models),
        "note": f"{1e3 * W[0]:.3f} and {1e3 * W[1]:.3f} mJ",
    }


@check()
def failure_lines(fabric: str, reach: float) -> Found:
    """End displacements [m] at which each yarn of the coupled cell reaches its strength.

    With the crossing yarn shortened by `reach` [m], so that it has lost contact; and, on the grid of Figure 4-28 of
    +-`reach`, the share of pairs in contact (region 1), separated (region 2) and failed (region 3).
    """
    model = cell(fabric)
    weave, found = model.fabric.weave, {}
    for family, (name, yarn) in enumerate(zip(("warp", "weft"), weave.yarns)):
        away = 1 - reach / weave.w[1 - family]

        def over(stretch, family=family, away=away, yarn=yarn):
            pair = (stretch, away) if family == 0 else (away, stretch)
            return float(model.solve(*pair)[f"T{family + 1}"]) - yarn.strength

        found[name] = weave.w[family] * (brentq(over, 1.0, 1.5, xtol=1e-12) - 1)
    d = np.linspace(-reach, reach, 81)
    state = model.solve(*np.meshgrid(*(1 + d / w for w in weave.w), indexing="ij"))
    failed = (state["T1"] > weave.warp.strength) | (state["T2"] > weave.weft.strength)
    touching = (state["F"] > 0) & ~failed
    k = int(np.argmin(np.abs(d)))
    return found | {
        "off the equations": departure(model, *np.meshgrid(*(1 + d / w for w in weave.w), indexing="ij")),
        "contact at rest and beyond": bool(touching[k + 1, k + 1]),
        "contact, both shortened": bool(touching[:k, :k].any()),
        "note": f"region 1 {100 * touching.mean():.0f} %, region 2 {100 * (~touching & ~failed).mean():.0f} %, "
        f"region 3 {100 * failed.mean():.0f} % of the pairs within {1e3 * reach:g} mm",
    }


@check()
def both_negative(fabric: str, reach: float) -> Found:
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
def energy_surface(fabric: str) -> Found:
    model = cell(fabric)
    weave = model.fabric.weave
    grid = np.meshgrid(*(np.linspace(1, end(yarn), 61) for yarn in weave.yarns), indexing="ij")
    found = model.solve(*grid)
    safe = (found["T1"] <= weave.warp.strength) & (found["T2"] <= weave.weft.strength)
    W = np.where(safe, found["W"], np.nan)
    steps = [np.nanmin(np.diff(W, axis=axis)) / np.nanmax(W) for axis in (0, 1)]
    return {"least growth over the highest": min(steps), "off the equations": departure(model, *grid)}


def _survived(name, n=61):
    """(warp strains (n,), stored energy [J] of the coupled cell (n, n)), nan where a yarn is past its strength."""
    model = cell(name)
    weave = model.fabric.weave
    s1, s2 = (np.linspace(1, end(yarn), n) for yarn in weave.yarns)
    found = model.solve(*np.meshgrid(s1, s2, indexing="ij"))
    safe = (found["T1"] <= weave.warp.strength) & (found["T2"] <= weave.weft.strength)
    return s1 - 1, np.where(safe, found["W"], np.nan)


@check()
def no_failure_extent() -> Found:
    """Warp strain up to which the coupled cell fails at no weft strain between rest and the weft's own failure."""
    extents, every = {}, {}
    for name in KEVLAR:
        strain, W = _survived(name)
        some, whole = np.isfinite(W).any(axis=1), np.isfinite(W[:, 0])
        extents[name], every[name] = float(strain[some][-1]), float(strain[whole][-1])
    off = [departure(cell(name), 1 + np.linspace(0, extents[name], 61), 1.0) for name in KEVLAR]
    return {
        "off the equations": max(off),
        "order": ranked(extents),
        "order, weft held": ranked(every),
        "note": ", ".join(f"{n} {100 * extents[n]:.1f} %" for n in ranked(extents)),
    }


@check()
def energy_level() -> Found:
    """Largest stored energy per area of the coupled cell over all strains at which no yarn is past its strength."""
    found, denier, mass = {}, {}, {}
    for name in KEVLAR:
        weave = cell(name).fabric.weave
        found[name] = float(np.nanmax(_survived(name, 121)[1])) / weave.cell_area
        denier[name], mass[name] = weave.warp.linear_density, weave.areal_density
    order = ranked(found)
    per_mass = [found[name] / mass[name] for name in KEVLAR]
    follows = all(denier[a] >= denier[b] for a, b in itertools.pairwise(order))
    return {
        "highest": order[0],
        "lowest": order[-1],
        "follows the denier": follows,
        "energy per mass, greatest over least": max(per_mass) / min(per_mass),
        "note": f"{', '.join(f'{n} {found[n]:.0f}' for n in order)} J/m2; "
        f"{min(per_mass) / 1e3:.1f} to {max(per_mass) / 1e3:.1f} kJ/kg",
    }
