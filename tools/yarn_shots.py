"""Fire random shots at plies of resolved yarns, and say what they keep: energy and crossings.

    python tools/yarn_shots.py --seed 1 --shots 200 --cpu 600
    python tools/yarn_shots.py --seed 2 --shots 60 --small --plies 3

Shots are points of a scrambled Sobol sequence, from the seed and their number: six fabrics of the
catalogue, half of the time with other stiffness, strength and crimp; noses of 4 to 13 mm anywhere in a
repeat of the weave; 40 to 400 m/s; clamped, two sides free, or yarns that slip in their clamps; frictions
drawn. --small fires at panels of 20 to 40 crossovers, half of them resolved to their edges, and at packs of
18 to 24: a second or less a ply. Ends with code 1 if a guard ended a shot, its energy error is above LIMIT
or a crossing was lost.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Sequence
from math import exp, inf, log, radians
from pathlib import Path
from typing import Any

import numpy as np
from scipy.stats import qmc

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from fabrics import catalogue
from fabrics.base.errors import UnstableError
from shellfabric.impact.setup import ImpactSetup
from shellfabric.loop.pack_solver import PackSolver
from shellfabric.membrane.boundary import Grip
from shellfabric.projectile.projectile import Projectile
from shellfabric.yarns.model import YarnZone
from weavecell.studies.inputs import scale_fabric

FABRICS = "S-720", "S-726", "S-727", "S-728", "S-731", "S-745"
SHAPES = "flat", "sphere", "hemisphere", "cone", "chisel"
STEEL = 7850.0  # [kg/m3]
COORDINATES = 24  # of a point, no fewer than a shot draws
FRICTION_OF_PLIES = 0.2
# [spacings] of small panels of one ply, and of the plies of a pack: largest radius, opening
SMALL_NOSE = 3.0, 2.0
SMALL_OPENING = (20.0, 40.0), (18.0, 24.0)
LIMIT = 0.005  # [-] energy error over the strike energy


class Draws:
    """A point of a scrambled Sobol sequence, whose coordinates are drawn one after another."""

    def __init__(self, seed: int, number: int):
        sequence = qmc.Sobol(COORDINATES, seed=seed)
        # it refuses to go on by none
        if number:
            sequence.fast_forward(number)
        self._left = iter(sequence.random()[0])

    def uniform(self, low: float, high: float) -> float:
        """Draw a number between two others."""
        return low + (high - low) * float(next(self._left))

    def choice(self, listed: Sequence[Any]) -> Any:
        """Draw one of those listed."""
        return listed[int(len(listed) * next(self._left))]


def draw_shot(seed: int, number: int, small: bool = False, plies: int = 1) -> ImpactSetup:
    """Draw the set-up of a number; `small` is one of at most 20 to 40 crossovers, `plies` are the most."""
    draws = Draws(seed, number)
    fabric = catalogue.load(draws.choice(FABRICS))
    if draws.uniform(0.0, 1.0) < 0.5:
        factors = ("modulus", "failure_strain", "crimp_warp", "crimp_weft")
        fabric = scale_fabric(fabric, **{name: draws.uniform(0.7, 1.4) for name in factors})
    count = draws.choice(range(1, plies + 1))
    spacing = 2 * max(fabric.weave.w)
    radius = draws.uniform(2e-3, 6.5e-3)
    if small:
        radius = draws.uniform(1.2, SMALL_NOSE[count > 1]) * spacing
    shape = draws.choice(SHAPES)
    own = {"edge_radius": 0.05 * radius}
    if shape == "sphere":
        own = {}
    if shape == "cone":
        own = {"half_angle": radians(draws.uniform(20, 60)), "tip_radius": 0.2 * radius}
    if shape == "chisel":
        own |= {"flat_width": 0.94 * radius, "flat_angle": radians(35)}
    mass = STEEL * 4 * radius**3 * draws.uniform(0.7, 2.0)
    on_nose = draws.uniform(0.0, 0.2)
    nose = Projectile(mass=mass, radius=radius, shape=shape, friction=on_nose, **own)
    grip = Grip(clamp_force=draws.uniform(5, 50))
    edge = draws.choice(("clamped", ("clamped", "free"), grip))
    friction = draws.uniform(0.05, 0.4)
    opening = draws.uniform(0.07, 0.11)
    half_width = min(max(8e-3, 2.2 * radius + 6e-3), 0.4 * opening)
    if small:
        opening = draws.uniform(*SMALL_OPENING[count > 1]) * spacing
        half_width = radius + 5.5 * spacing
    # plies of a pack are shifted against each other, and none is resolved to its edges
    if small and count == 1:
        half_width = draws.choice((half_width, inf))
    velocity = exp(draws.uniform(log(40), log(400)))
    # anywhere in a repeat of plain weave, which has two crossovers each way
    aim = tuple(2 * float(w) * draws.uniform(-1.0, 1.0) for w in fabric.weave.w)
    return ImpactSetup(
        fabric,
        velocity,
        projectile=nose,
        opening=opening,
        boundary=edge,
        symmetry="whole",
        impact_point=aim,
        crossovers=YarnZone(half_width, friction),
        plies=count,
        ply_friction=FRICTION_OF_PLIES,
        end_time=200e-6,
    )


def fire(setup: ImpactSetup) -> dict[str, float | str]:
    """Fire a shot; what it kept."""
    solver = PackSolver(setup.target(setup.table(kept=True)), setup.strike_velocity, setup.end_time)
    ended = ""
    try:
        solver.run()
    except UnstableError as problem:
        ended = str(problem)
    zones = [part.zone for parts in solver.parts for part in parts if part.name == "yarns"]
    errors = np.abs(solver.sample("error")) / solver.strike_energy
    made = solver.energy_made()
    largest = "not booked by part"
    if made:
        most = max(made, key=lambda name: abs(made[name]))
        largest = f"{most} made {100 * made[most] / solver.strike_energy / solver.share:.3f} %"
    return {
        "made": largest,
        "outcome": solver.outcome,
        "ended": ended,
        "error": float(errors.max()),
        "snap": float(solver.sample("yarn_snap")[-1] / solver.strike_energy),
        "torn": float(sum(zone.torn_segments for zone in zones)),
        "lost": float(sum(zone.tangled for zone in zones)),
    }


def main() -> int:
    """Fire the shots, a line each, until their number or the CPU time is used up."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--shots", type=int, default=200)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--small", action="store_true", help="panels of 20 to 40 crossovers")
    parser.add_argument("--plies", type=int, default=1, help="of a shot at most")
    parser.add_argument("--only", type=int, nargs="*", help="numbers of the shots to fire")
    parser.add_argument("--cpu", type=float, default=600.0, help="[s] after which no shot begins")
    asked = parser.parse_args()
    rows = []
    for number in asked.only or range(asked.first, asked.first + asked.shots):
        if time.process_time() > asked.cpu:
            break
        setup = draw_shot(asked.seed, number, asked.small, asked.plies)
        began = time.process_time()
        row = fire(setup)
        rows.append(row)
        print(
            f"{number} {setup.plies} of {setup.fabric.name} {setup.projectile.shape} "
            f"{2e3 * setup.projectile.radius:.1f} mm {setup.strike_velocity:.0f} m/s "
            f"mu {setup.crossovers.friction:.2f} {_edge(setup)}: {row['outcome']}, "
            f"error {100 * row['error']:.3f} %, snap {100 * row['snap']:.2f} %, "
            f"{row['torn']:.0f} segments torn, "
            f"{row['lost']:.0f} crossings lost, {row['made']}, "
            f"{time.process_time() - began:.1f} s "
            f"{row['ended']}",
            flush=True,
        )
    ended = [row for row in rows if row["ended"]]
    worst = max(row["error"] for row in rows)
    lost = sum(row["lost"] for row in rows)
    print(
        f"{len(rows)} shots: {len(ended)} ended by a guard; worst energy error "
        f"{100 * worst:.3f} %; {lost:.0f} crossings lost in "
        f"{sum(row['lost'] > 0 for row in rows)} shots; CPU {time.process_time():.0f} s"
    )
    return int(bool(ended) or worst > LIMIT or lost > 0)


def _edge(setup):
    """The edges in a word."""
    if setup.boundary == "clamped":
        return "clamped"
    if isinstance(setup.boundary, tuple):
        return "two sides free"
    return f"slips at {setup.boundary.clamp_force:.0f} N"


if __name__ == "__main__":
    raise SystemExit(main())
