"""python -m validation.published.packs.limits [PART ...] [--out FOLDER] [--page docs/reports/pack-limits.md]

Ballistic limits of packs beside what is published of them: number of plies, Cunniff's scaling, the order of two
fabrics, one mass in one, two or four plies, and friction.

Published: V50^2 is a straight line in the number of plies (Prosser, Cohen and Segars, Text. Res. J. 70, 709, 2000); V50
grows with the cube root of U* = (strength x failure strain / 2 density) x (modulus / density)^(1/2) (Cunniff 1999); the
order of two fabrics matters at 340 and hardly at 620 m/s (10.1177/00405175231194365); two to four folded plies of 70
g/m2 take over 7 % more energy than one ply of the same mass (10.1177/00405175221139634); friction raises V50 by about
10 % (quoted in 10.1177/0040517514527376).

All yarns have the strength of the data sheet, so a limit is the velocity between a stop and a perforation. Each shot is
kept in the folder. PART: one or more of plies, cunniff, orders, mass, friction; all by default.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from math import log, sqrt
from pathlib import Path
from typing import Any

import numpy as np
from scipy import stats

import weavecell as wc
from fabrics import catalogue, run_cache
from fabrics.fabric import Fabric
from fabrics.units import si
from meshing.pictures_style import BLUE, FAINT, GREEN, ORANGE, RED
from shellfabric.impact import ballistic_limit
from shellfabric.impact.bracket import Bracket
from shellfabric.impact.simulation import ImpactSetup, Ply
from shellfabric.plies.model import Pack
from shellfabric.sliding.model import CrossoverFriction
from validation.commits import computed
from validation.marked_page import markdown
from validation.program import marks, program, publish, save
from weavecell.results import provenance

MODULE = "validation.published.packs.limits"
FSP, SPHERE = "FSP 1.10 g", "sphere 5.5 mm"
COUNTS = (2, 4, 8, 16, 32)
SERIES = (("S-726", FSP), ("S-728", FSP), ("S-726", SPHERE), ("S-728", SPHERE))
# (V50 / (100 m/s))^2 = a + b n of a fabric that the source does not name: (projectile, a, b, R^2)
PUBLISHED = (
    ("fragment simulator", 4.14, 0.992, 0.996),
    ("sharp", 4.41, 1.004, 0.995),
    ("rounded .22", 3.64, 0.855, 0.984),
)
SCALES = (  # factors of modulus, failure strain and fibre density
    (1.0, 1.0, 1.0),
    (0.5, 1.0, 1.0),
    (2.0, 1.0, 1.0),
    (1.0, 0.7, 1.0),
    (1.0, 1.4, 1.0),
    (1.0, 1.0, 0.7),
    (1.0, 1.0, 1.4),
    (2.0, 0.7, 1.0),
)
A, B = "S-728", "S-726"
ORDERS = ((A, A), (B, A), (A, B), (B, B), (B, B, A), (A, B, B))
VELOCITIES = (340.0, 620.0)  # [m/s] of the shots at two fabrics
AROUND = (0.94, 0.97, 1.0, 1.03, 1.06)  # times these: in which order yarns fail differs from one velocity to the next
SIZES = (  # plies, size of S-728 and mass of its yarns over those of the data sheet, elements a crossover
    (1, 2.0, 4.0, 4),
    (2, 1.0, 1.0, 2),
    (4, 0.5, 0.25, 2),
    (1, 0.5, 1.0, 2),
)
FRICTIONS = (  # between plies, of yarns at their crossovers (None: pinned), of the projectile; elements a crossover
    (0.0, None, 0.0, 2),
    (0.1, None, 0.0, 2),
    (0.2, None, 0.0, 2),
    (0.3, None, 0.0, 2),
    (0.0, None, 0.2, 2),
    (0.0, None, 0.0, 1),
    (0.0, 0.1, 0.0, 1),
    (0.0, 0.2, 0.0, 1),
    (0.0, 0.3, 0.0, 1),
    (0.2, 0.2, 0.2, 1),
)
WIDTH = 0.02  # of a bracket over its velocity
_STEP = 1.06  # first step from a guess


@dataclass(frozen=True)
class Case:
    """A pack and its projectile.

    Parameters
    ----------
    fabrics : name of each ply's fabric, from the front
    projectile : name of a projectile
    factors : of modulus, failure strain and fibre density of all yarns; linear densities stay
    size : of all lengths of the weave over those of the data sheet
    mass : of the yarns' linear density over that of the data sheet
    elements : for each crossover about the nose; of a single ply, and where it is 1, everywhere
    frictions : [-] Coulomb's coefficient between plies, of yarns that slide at their crossovers (None: pinned), and of
        the projectile
    """

    fabrics: tuple[str, ...]
    projectile: str = FSP
    factors: tuple[float, float, float] = (1.0, 1.0, 1.0)
    size: float = 1.0
    mass: float = 1.0
    elements: int = 2
    frictions: tuple[float, float | None, float] = (0.0, None, 0.0)


Shots = Callable[[Case, float], dict[str, Any]]


def changed(fabric: Fabric, case: Case) -> Fabric:
    """The fabric with a case's factors, size and mass; forces of its compression laws grow with the mass."""
    size, mass, yarns = case.size, case.mass, fabric.weave.yarns
    values = {
        name: [factor * getattr(yarn, name) for yarn in yarns]
        for name, factor in zip(("E", "failure_strain", "fibre_density", "linear_density"), (*case.factors, mass))
    }
    fabric = fabric.with_yarns(**values)
    weave, gap = fabric.weave, fabric.interlayer_gap
    # closure = a - b / (F + F0)^(1/3): closures grow with the size, forces with the mass of a yarn's length
    warp, weft = (replace(law, a=size * law.a, b=size * mass ** (1 / 3) * law.b) for law in fabric.laws)
    return replace(
        fabric,
        weave=replace(weave, warp_count=weave.warp_count / size, weft_count=weave.weft_count / size),
        laws=(warp, weft),
        interlayer_gap=None if gap is None else size * gap,
    )


@cache
def pack(case: Case) -> Pack:
    """The plies of a case in the clamped opening of 203 mm, on the default mesh of packs."""
    given = [changed(catalogue.load(name).with_effective_density(), case) for name in case.fabrics]
    lay_up = tuple(map(Ply, given)) if len(set(case.fabrics)) > 1 else ()
    between, yarns, nose = case.frictions
    setup: ImpactSetup = wc.setup(
        given[0], 100.0, projectile=case.projectile, plies=len(given), numerics={"threads": 1}
    )
    if len(given) == 1 or (case.elements == 1 and yarns is None):
        setup = replace(setup, elements_per_crossover=case.elements)
    if any(case.frictions):
        setup = replace(
            setup,
            ply_friction=between,
            crossovers=None if yarns is None else CrossoverFriction(yarns),
            projectile=replace(setup.projectile, friction=nose),
        )
    return replace(setup, lay_up=lay_up).target()


def shoot(case: Case, velocity: float) -> dict[str, Any]:
    """One shot: a dict of numbers, for a file."""
    [shot] = ballistic_limit.shoot(pack(case), [velocity])
    return {
        "velocity": velocity,
        "residual": shot.residual_velocity,
        "perforated": shot.perforated,
        "balance": shot.balance,
        "wall": shot.wall_time,
    }


def limit(case: Case, guess: float, results: Shots) -> tuple[float, float]:
    """(low, high) [m/s] a stop and a perforation, WIDTH apart, looked for from a guess."""
    bracket = Bracket(round(guess, 1), 20.0, 1000.0, factor=_STEP)
    while bracket.width > WIDTH * bracket.next() and not bracket.exhausted:
        bracket = bracket.after(results(case, bracket.next())["perforated"])
    return bracket.low, bracket.high


def of_plies(results: Shots, folder: Path) -> str:
    """Critical velocity against the number of plies, with the straight line through its square; draws it too."""
    rows = [["fabric", "projectile", *(f"{n} plies" for n in COUNTS), "a", "b", "R²"]]
    runs = {}
    for fabric, projectile in SERIES:
        found, guess = [], 170.0
        for n in COUNTS:
            found.append(limit(Case((fabric,) * n, projectile), guess, results))
            guess = sum(found[-1]) / 2 * sqrt((2 * n + 4) / (n + 4))
        square = (np.mean(found, axis=1) / 100) ** 2
        fit = stats.linregress(COUNTS, square)
        runs[f"{fabric}, {projectile}"] = square
        line = f"{fit.intercept:.2f}", f"{fit.slope:.3f}", f"{fit.rvalue**2:.3f}"
        rows.append([fabric, projectile, *map(words, found), *line])
    save(squares, runs, to=folder / "pack-limits.png")
    rows += [[f"published, {name}", "", *[""] * len(COUNTS), *map(str, (a, b, fit))] for name, a, b, fit in PUBLISHED]
    return markdown(rows)


def squares(pyplot: Any, runs: Mapping[str, Any]) -> Any:
    """Squares of the critical velocities over the number of plies, with their straight lines and the published ones.

    Parameters
    ----------
    runs : {label: squares [(100 m/s)^2] at COUNTS}
    """
    figure, axes = pyplot.subplots(figsize=(7.4, 4.6))
    ends = np.array([0.0, COUNTS[-1]])
    for (label, square), colour in zip(runs.items(), (BLUE, ORANGE, GREEN, RED)):
        fit = stats.linregress(COUNTS, square)
        axes.plot(COUNTS, square, "o", color=colour, label=label)
        axes.plot(ends, fit.intercept + fit.slope * ends, color=colour, lw=1)
    for (name, start, slope, _), style in zip(PUBLISHED, ("--", ":", "-.")):
        axes.plot(ends, start + slope * ends, color=FAINT, ls=style, label=f"tests, {name}")
    axes.set(
        xlabel="number of plies", ylabel="square of the ballistic limit [(100 m/s)²]", xlim=(0, None), ylim=(0, None)
    )
    axes.legend(fontsize=9)
    return figure


def of_cunniff(results: Shots, folder: Path) -> str:
    """Critical velocity of four plies of S-728 against U*, with the slope of the logarithms."""
    heads = ("modulus", "failure strain", "density", "(U*)^(1/3) / first", "critical velocity, m/s", "velocity / first")
    rows: list[Sequence[str]] = [heads]
    x, y = [], []
    for factors in SCALES:
        modulus, strain, density = factors
        scale = modulus * strain**2 / density * sqrt(modulus / density)
        found = limit(Case(("S-728",) * 4, FSP, factors), 260.0 * scale ** (1 / 3), results)
        x.append(log(scale) / 3)
        y.append(log(sum(found) / 2))
        rows.append([*map(str, factors), f"{np.exp(x[-1]):.3f}", words(found), f"{np.exp(y[-1] - y[0]):.3f}"])
    fit = stats.linregress(x, y)
    return f"{markdown(rows)}\nSlope of log V on log U*: {fit.slope / 3:.3f} (Cunniff: 0.333), R² {fit.rvalue**2:.3f}."


def of_orders(results: Shots, folder: Path) -> str:
    """Energy that two and three plies of two fabrics absorb, by their order: mean over velocities, and its error."""
    rows = [["plies from the front", *(f"about {v:g} m/s: absorbed, J" for v in VELOCITIES)]]
    for fabrics in ORDERS:
        energies = [[absorbed(results(Case(fabrics), round(near * v, 1))) for near in AROUND] for v in VELOCITIES]
        rows.append([" / ".join(fabrics), *(f"{np.mean(one):.1f} ± {stats.sem(one):.1f}" for one in energies)])
    return markdown(rows)


def of_mass(results: Shots, folder: Path) -> str:
    """Critical velocity of one mass in 1, 2 and 4 plies of similar fabrics, and in one fine ply of heavy yarns."""
    heads = (
        "plies",
        "size",
        "mass of a yarn",
        "elements a crossover",
        "critical velocity, m/s",
        "energy, to first row",
    )
    rows: list[Sequence[str]] = [heads]
    first = None
    for plies, size, mass, elements in SIZES:
        found = limit(Case(("S-728",) * plies, FSP, size=size, mass=mass, elements=elements), 240.0, results)
        middle = sum(found) / 2
        first = first or middle
        change = f"{100 * ((middle / first) ** 2 - 1):+.1f} %"
        rows.append([str(plies), f"{size:g}", f"{mass:g}", str(elements), words(found), change])
    return markdown(rows)


def of_friction(results: Shots, folder: Path) -> str:
    """Critical velocity of four plies against the friction between plies, of yarns at crossovers, and of the nose."""
    heads = (
        "fabric",
        "between plies",
        "of yarns at crossovers",
        "of the projectile",
        "critical velocity, m/s",
        "change",
    )
    rows: list[Sequence[str]] = [heads]
    for fabric in (A, B):
        first: dict[int, float] = {}  # without friction, of each mesh
        for between, yarns, nose, elements in FRICTIONS:
            case = Case((fabric,) * 4, FSP, elements=elements, frictions=(between, yarns, nose))
            found = limit(case, first.get(elements, 340.0), results)
            middle = sum(found) / 2
            change = f"{100 * (middle / first.setdefault(elements, middle) - 1):+.1f} %"
            held = ("pinned, one element" if elements == 1 else "pinned") if yarns is None else f"{yarns:g}"
            rows.append([fabric, f"{between:g}", held, f"{nose:g}", words(found), change])
    return markdown(rows)


def absorbed(shot: Mapping[str, Any]) -> float:
    """[J] kinetic energy that the fragment simulator has lost."""
    return 0.5 * si(wc.projectile(FSP)["mass"], "kg") * (shot["velocity"] ** 2 - shot["residual"] ** 2)


def words(found: Sequence[float]) -> str:
    """A bracket as its middle and half its width."""
    low, high = found
    return f"{(low + high) / 2:.0f} ± {(high - low) / 2:.0f}"


PARTS = {"plies": of_plies, "cunniff": of_cunniff, "orders": of_orders, "mass": of_mass, "friction": of_friction}


def main(
    parts: Sequence[str] = tuple(PARTS), *, out: Path = Path("results/pack-limits"), page: Path | None = None
) -> None:
    stamp, shots = provenance.stamp(), []

    def results(case, velocity):
        [found] = run_cache.results(shoot, [(case, velocity)], folder=out)
        print(f"{case} {velocity:.1f} m/s: {found['residual']:.1f} m/s left, {found['wall']:.0f} s", flush=True)
        shots.append(found)
        return found

    folder = page.parent / "figures" if page else out
    for part in parts:
        shots.clear()
        text = PARTS[part](results, folder)
        worst = max(shot["balance"] for shot in shots)
        text += f"\n{len(shots)} shots; largest energy error {100 * worst:.2g} % of the strike energy. "
        publish(text + computed(f"python -m {MODULE} {part} --page {page}", stamp) + "\n", page, marks(part, MODULE))


if __name__ == "__main__":
    program(main)
