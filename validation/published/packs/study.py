"""The runs of the study: what the thesis says of packs, what the model gives (thesis sections 5.2.2, 5.2.3, 6.4.4).

Published. 4 plies stop S-726 at 158, S-728 at 91 and S-731 at 136 m/s, 8 plies of S-726 stop 204. The captions of five
more say "perforating"; erratum E-21 calls one of them certainly an artefact of contact noise, three very unlikely in a
test, and 16 plies of S-726 at 243 m/s undecided.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from fabrics import catalogue, run_cache
from fabrics.errors import UnstableError
from shellfabric.cell.model import CellModel
from shellfabric.impact.simulation import ImpactSetup
from shellfabric.panel.model import Numerics, Panel
from shellfabric.plies.model import Pack
from shellfabric.solver.pack_solver import PackSolver
from validation.published.packs.crossings import count

STOPS, ARTEFACT = "stops", "perforates (certainly an artefact, E-21)"
UNLIKELY, OPEN = "perforates (very unlikely, E-21)", "perforates (undecided, E-21)"
PUBLISHED = (
    ("S-726", 4, 158.0, STOPS),
    ("S-728", 4, 91.0, STOPS),
    ("S-731", 4, 136.0, STOPS),
    ("S-726", 8, 204.0, STOPS),
    ("S-728", 8, 162.0, UNLIKELY),
    ("S-731", 8, 142.0, UNLIKELY),
    ("S-728", 16, 170.0, UNLIKELY),
    ("S-731", 16, 120.0, ARTEFACT),
    ("S-726", 16, 243.0, OPEN),
)
# shots that tear yarns, in which crossings of plies are counted; [m/s, s]
TORN = (
    ("S-726", 4, 243.0, 100e-6),
    ("S-726", 4, 300.0, 100e-6),
    ("S-726", 8, 340.0, 100e-6),
    ("S-728", 8, 340.0, 100e-6),
    ("S-726", 16, 450.0, 100e-6),
)
FABRICS = ("S-726", "S-728", "S-731")
GAPS = (0.12e-3, 0.62e-3, 1.12e-3)  # section 6.4.4: S-728, 16 plies, 170 m/s
STACKED = ("S-726", 4, 100.0)  # Figures 5-55 to 5-57
STACKINGS = ("aligned", "alternating")
_END = 500e-6


@dataclass(frozen=True)
class Case:
    """One shot at a pack.

    Parameters
    ----------
    fabric, plies, velocity, stacking, gap : [-, -, m/s, -, m]; the fabric's own gap where None
    end_time : [s]
    """

    fabric: str
    plies: int
    velocity: float
    stacking: str = "aligned"
    gap: float | None = None
    end_time: float = _END


@cache
def panel(fabric: str) -> Panel:
    """A ply of the 203 mm panel of one fabric, on the default mesh of packs."""
    given = catalogue.load(fabric).with_effective_density()
    return ImpactSetup(given, 100.0, numerics=Numerics(threads=1), plies=2).panel(CellModel(given).table(201))


def pack(case: Case) -> Pack:
    """The pack of a case."""
    return Pack.stacked(panel(case.fabric), case.plies, stacking=case.stacking, gap=case.gap)


def shoot(case: Case) -> dict[str, Any]:
    """One shot: a dict of numbers and lists, for a file."""
    march, message = PackSolver(pack(case), case.velocity, case.end_time), ""
    try:
        march.run()
    except UnstableError as problem:
        message = str(problem)
    strength = np.array([yarn.strength for yarn in march.panel.weave.yarns])
    tensions = march.peak_tensions[..., 0]
    turned = [1 if case.stacking == "alternating" and p % 2 else 0 for p in range(case.plies)]
    peaks = np.array([peak / (strength[::-1] if t else strength) for peak, t in zip(tensions, turned)])
    fine = np.concatenate(march.step_history) if march.step_history else np.empty((0, 3))
    every = max(1, len(fine) // 4000)
    return {
        "case": asdict(case),
        "outcome": "unstable" if message else march.outcome,
        "message": message,
        "time": march.time,
        "residual_velocity": march.residual_velocity,
        "deflection": float(march.sample("z").max()),
        "failed": march.ply_samples[-1][:, 0].tolist(),
        "peaks": peaks.max(axis=1).tolist(),
        "balance": float(np.abs(march.sample("error")).max() / march.strike_energy),
        "deepest": float(march.deepest.max(initial=0.0)),
        "wall": march.wall_time,
        "ns": 1e9 * march.wall_time / max(1, march.steps) / march.pack.elements,
        "t": (march.const.dt * np.arange(1, len(fine) + 1))[::every].tolist(),
        "v": fine[::every, 1].tolist(),
        "force": (fine[::every, 2] / march.panel.share).tolist(),
        "absorbed": (march.strike_energy - march.sample("kinetic_projectile")).tolist(),
        "instants": march.sample("t").tolist(),
        "energy": march.ply_sample("energy").tolist(),
    }


def crossings(case: Case) -> dict[str, Any]:
    """What crosses what at the samples of a shot, and how the guard kept the plies apart: a dict, for a file."""
    march, found = PackSolver(pack(case), case.velocity, case.end_time), []
    march.run((lambda run: found.append(count(run)),))
    torn = sum(int(np.count_nonzero(family)) for state in march.states for family in state.failed)
    return {
        "case": asdict(case),
        "outcome": march.outcome,
        "time": march.time,
        "failed": [torn],
        "crossings": found,
        "impulses": march.held_apart,
        "taken": float(march.sample("ply_guard")[-1] / march.strike_energy),
    }


def kept(folder: Path) -> Callable[..., dict[str, Any]]:
    """results(case, fire=shoot): what it found, from the folder; it is made and kept where there is none."""

    def results(case, fire=None):
        [found] = run_cache.results(fire or shoot, [(case,)], folder=folder)
        print(f"{case}: {found['outcome']} {found['time'] * 1e6:.0f} us, {sum(found['failed']):g} failed", flush=True)
        return found

    return results


def outcomes(results: Callable[..., dict[str, Any]]) -> list[tuple[Any, ...]]:
    """[(fabric, plies, velocity, published, found), ...]"""
    return [(*row, results(Case(*row[:3]))) for row in PUBLISHED]


def torn(results: Callable[..., dict[str, Any]]) -> list[dict[str, Any]]:
    """[found, ...] of the shots that tear yarns."""
    return [results(Case(*row[:3], end_time=row[3]), crossings) for row in TORN]


def gaps(results: Callable[..., dict[str, Any]]) -> dict[float, dict[str, Any]]:
    """{gap: found} of section 6.4.4."""
    return {gap: results(Case("S-728", 16, 170.0, gap=gap)) for gap in GAPS}


def stackings(results: Callable[..., dict[str, Any]]) -> dict[str, dict[str, Any]]:
    """{stacking: found} of Figure 5-57."""
    return {stacking: results(Case(*STACKED, stacking=stacking)) for stacking in STACKINGS}
