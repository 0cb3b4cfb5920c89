"""Convergence of packs: critical velocity, peak tensions, absorbed energy and failure times, with the mesh and one key
at a time.

    python -m validation.verification.mesh_convergence.packs [--fabrics F ...] [--plies N ...] [--levels N ...]
        [--variations NAME ...] [--budget HOURS] [--draws N] [--jobs N] [--out FOLDER] [--page FILE.md]

The mesh of level n has elements with sides of 1/n crossover to f crossovers from the impact point, all that can come
under the nose, then of one crossover to 2 f, and of two beyond; all levels share the outer mesh. For each case:

- the critical velocity is bisected, and further shots about the bracket look for mixed outcomes;
- a shot at 0.7 times the critical velocity of the reference level gives the highest tensions of warp and weft;
- a shot at 1.5 times it gives the absorbed energy and the time at which each ply first fails;
- with --draws the last is repeated at drawn strengths of yarn, for a mean with its standard error.

Every shot is kept in the folder as soon as it is done, so that the study can be interrupted and done in parts: cases
run from the cheapest on, those beyond the budget are left, and the page has what there is.
"""

from __future__ import annotations

import time
import tomllib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache
from importlib import resources
from math import ceil, inf
from pathlib import Path
from typing import Any

from fabrics import catalogue, run_cache
from fabrics.errors import InputError
from fabrics.ply_law import PlyLaw
from fabrics.units import si
from shellfabric.impact import simulation
from shellfabric.impact.ballistic_limit import UNDECIDED
from shellfabric.impact.bracket import Bracket
from shellfabric.impact.simulation import ImpactSetup
from shellfabric.panel.numerics import Numerics
from shellfabric.plies.gap import ply_gap
from shellfabric.plies.numerics import PlyContact
from validation.program import program, publish
from validation.verification.mesh_convergence.packs_page import pages
from validation.verification.study import known
from weavecell.results import provenance
from weavecell.studies import draws, inputs

LEAST = 10  # [crossovers] of the first zone
SEARCH = 20.0, 900.0  # [m/s] for the critical velocity
MARKS = "<!-- tables of mesh_convergence.packs -->", "<!-- end of packs -->"
NAME = "python -m validation.verification.mesh_convergence.packs"


@dataclass(frozen=True)
class Case:
    """A pack on a mesh.

    Parameters
    ----------
    fabric, plies, level : elements per crossover about the nose
    variation : its name, or "" of the base case
    stiffness, damping, step : factors on the contact's stiffness, its damping and the time step
    gap : [m] added between plies
    law : of the contact, as of PlyLaw.chosen; "" that of the fabric
    stacking, symmetry : as of ImpactSetup
    outer : [crossovers] elements far from the nose
    """

    fabric: str
    plies: int
    level: int
    variation: str = ""
    stiffness: float = 1.0
    damping: float = 1.0
    step: float = 1.0
    gap: float = 0.0
    law: str = ""
    stacking: str = "aligned"
    symmetry: str = "quarter"
    outer: int = 2


@dataclass(frozen=True)
class Shot:
    """One shot: outcome, velocities [m/s], energy [J], highest tensions of any ply [N], first failure of each ply [s]
    (infinite where none), elements, wall time [s], error of the energy balance over the strike energy."""

    velocity: float
    outcome: str
    residual: float
    absorbed: float
    warp: float
    weft: float
    failures: tuple[float, ...]
    elements: int
    seconds: float
    balance: float


@dataclass(frozen=True)
class Found:
    """What a case came to; parts that have not been computed are None.

    Parameters
    ----------
    low, high : [m/s] bracket of the critical velocity
    mixed : (lowest perforation, highest stop) [m/s] where they overlap, or None
    stop, through : Shot for the tensions, Shot for energy and failure times
    drawn : draws.Estimate of the absorbed energy over draws
    """

    low: float
    high: float
    mixed: tuple[float, float] | None
    stop: Shot | None = None
    through: Shot | None = None
    drawn: draws.Estimate | None = None

    @property
    def middle(self) -> float:
        return 0.5 * (self.low + self.high)


@cache
def plan() -> dict[str, Any]:
    """The content of packs.toml."""
    return tomllib.loads((resources.files(__package__) / "packs.toml").read_text("utf-8"))


@cache
def _ply(name: str, law: str) -> ImpactSetup:
    fabric = catalogue.load(name).with_effective_density()
    if law:
        fabric = replace(fabric, ply_contact=PlyLaw.chosen(law, fabric))
    return ImpactSetup(fabric, 100.0, elements_per_crossover=1, end_time=UNDECIDED, audit_interval=5e-7)


def setup(case: Case, velocity: float = 100.0) -> ImpactSetup:
    """The set-up of a case."""
    ply = _ply(case.fabric, case.law)
    panel = replace(ply, table_size=11).panel()
    first = max(LEAST, *(ceil(far / side) + 1 for far, side in zip(panel.reach(), panel.spacing)))
    inner = ((first, 1 / case.level),) if case.level > 1 else ()
    outer = ((inf, 2),) if case.outer == 2 else ()
    zones = (*inner, (2 * first if outer else inf, 1), *outer)
    base, contact = Numerics(threads=1), PlyContact()
    numerics = replace(base, cfl=base.cfl * case.step)
    contact = replace(
        contact, stiffness=case.stiffness, damping=contact.damping * case.damping, courant=contact.courant * case.step
    )
    law = PlyLaw.of(ply.fabric)
    gap = ply_gap(ply.fabric, law).value + case.gap
    return replace(
        ply, strike_velocity=velocity, grading=zones, numerics=numerics, symmetry=case.symmetry, plies=case.plies,
        stacking=case.stacking, ply_gap=gap, contact=contact,
    )  # fmt: skip


def shoot(case: Case, velocity: float) -> Shot:
    """One shot at a case."""
    given = setup(case, velocity)
    result, problem = simulation.fired(given, table=given.table(kept=True))
    outcome = "unstable" if problem else result.outcome
    left = 0.0 if outcome == "stopped" else float(result.residual_velocity)
    failed = result.plies["cut_yarns"] > 0
    times = tuple(float(result.t[column.argmax()]) if column.any() else inf for column in failed.T)
    warp, weft = result.peak_tension
    absorbed = 0.5 * given.projectile.mass * (velocity**2 - left**2)
    return Shot(
        velocity, outcome, left, absorbed, warp, weft, times, sum(panel.elements for panel in result.panels),
        float(result.wall_time), float(result.energy_error_max),
    )  # fmt: skip


def cases(fabrics: Sequence[str], plies: Sequence[int], levels: Sequence[int], names: Sequence[str]) -> list[Case]:
    """The cases of packs.toml among these, the base cases of the reference level first, then by cost."""
    given = plan()
    base = [Case(f, n, level) for f in fabrics for n in plies for level in levels]
    varied = []
    for name in names:
        change = dict(given["variations"][name])
        if "gap" in change:
            change["gap"] = si(change["gap"], "m", key="gap")
        varied += [
            Case(f, n, given["reference_level"], name, **change)
            for f in fabrics for n in plies if n in given["variations"]["plies"]
        ]  # fmt: skip
    first = [Case(f, n, given["reference_level"]) for f in fabrics for n in plies]
    return sorted(dict.fromkeys([*first, *base, *varied]), key=lambda case: (case not in first, weight(case)))


@cache
def weight(case: Case) -> float:
    """Elements of all plies times the elements of a crossover, to which the cost of a shot is in proportion."""
    panel = replace(setup(case), table_size=11).panel()
    return case.plies * panel.elements * max(case.level, 2) / case.step


def critical(shots: Callable[[Sequence[float]], list[Shot]], guess: float, *, ahead: int = 1) -> Found:
    """Bracket of the critical velocity and zone of mixed outcomes, of what shoots at velocities."""
    tolerance = si(plan()["tolerance"], "m/s", key="tolerance")
    bracket, seen = Bracket(guess, *SEARCH), dict[float, Shot]()
    while bracket.width > tolerance:
        if bracket.exhausted:
            raise InputError(f"no critical velocity between {SEARCH[0]:g} and {SEARCH[1]:g} m/s")
        wanted = bracket.ahead(ahead, tolerance)
        seen |= {round(V, 4): shot for V, shot in zip(wanted, shots(wanted))}
        while bracket.width > tolerance and round(bracket.next(), 4) in seen:
            bracket = bracket.after(seen[round(bracket.next(), 4)].outcome == "perforated")
    middle = 0.5 * (bracket.low + bracket.high)
    every = [*seen.values(), *shots([(1 + share) * middle for share in plan()["scan"]])]
    stop = max((shot.velocity for shot in every if shot.outcome != "perforated"), default=0.0)
    through = min((shot.velocity for shot in every if shot.outcome == "perforated"), default=inf)
    return Found(bracket.low, bracket.high, (through, stop) if through < stop else None)


def study(
    case: Case, reference: float | None, folder: Path, *, drawn: int = 0, jobs: int = 1, ends: float = inf
) -> Found:
    """All quantities of a case; `reference` is the critical velocity [m/s] of its reference level, None for that
    itself. TimeoutError where a shot is missing after `ends` of perf_counter()."""

    def shots(velocities):
        places, kept = [(case, round(float(V), 4)) for V in velocities], run_cache.RunCache(folder)
        keys = (run_cache.key((shoot.__qualname__, place), shoot.__module__) for place in places)
        if time.perf_counter() > ends and not all(key in kept for key in keys):
            raise TimeoutError
        return run_cache.results(shoot, places, folder=folder, jobs=jobs)

    found = critical(shots, reference or si(plan()["first_guess"], "m/s", key="first_guess"), ahead=jobs)
    limit = reference or found.middle
    velocities = [round(plan()[name] * limit) for name in ("stops", "perforates")]
    stop, through = shots(velocities)
    estimate = None
    if drawn:
        fast = setup(case, velocities[1])
        several = draws.study(fast, inputs.published(), drawn, folder=folder / "draws", jobs=jobs)
        estimate = several.estimate("absorbed_energy")
    return replace(found, stop=stop, through=through, drawn=estimate)


def main(
    *,
    fabrics: Sequence[str] | None = None,
    plies: Sequence[int] | None = None,
    levels: Sequence[int] | None = None,
    variations: Sequence[str] | None = None,
    budget: float = inf,
    draws: int = 0,
    jobs: int = 1,
    out: Path = Path("results/convergence-packs"),
    page: Path | None = None,
) -> None:
    given = plan()
    there = tuple(name for name in given["variations"] if name != "plies")
    names = there if variations is None else variations
    for fabric in fabrics or ():
        known("--fabrics", fabric, given["fabrics"])
    for name in names:
        known("--variations", name, there)
    found: dict[Case, Found] = {}
    ends = time.perf_counter() + 3600 * budget
    for case in cases(fabrics or given["fabrics"], plies or given["plies"], levels or given["levels"], names):
        base = Case(case.fabric, case.plies, given["reference_level"])
        words = f"{case.plies} x {case.fabric}, level {case.level}{', ' + case.variation if case.variation else ''}"
        try:
            if case != base and base not in found:
                raise TimeoutError
            limit = None if case == base else found[base].middle
            done = found[case] = study(case, limit, out, drawn=draws, jobs=jobs, ends=ends)
        except TimeoutError:
            print(f"{words}: left, the budget is spent")
            continue
        print(f"{words}: {done.low:.1f} to {done.high:.1f} m/s{' mixed' if done.mixed else ''}", flush=True)
    publish(pages(found, given), page, MARKS, f"Made by `{NAME}`, commit {provenance.stamp()['commit']}.\n\n")


if __name__ == "__main__":
    program(
        main,
        variations="of packs.toml; all if not given, none if empty",
        budget="hours after which no shot is begun",
        draws="repeat the fast shot at so many drawn packs",
    )
