"""Fire random shots at one ply of resolved yarns, and say what they keep: energy and crossings.

    python tools/yarn_shots.py --seed 1 --shots 200 --cpu 600

Six fabrics of the catalogue, half of the time with other stiffness, strength and crimp; noses of 4
to 13 mm; 40 to 400 m/s; clamped, two sides free, or yarns that slip in their clamps; friction of
0.05 to 0.4. Every shot follows from the seed and its number alone. Ends with code 1 if a guard ended
a shot, its energy error is above LIMIT or a crossing was lost.

    python tools/yarn_shots.py --seed 2 --shots 60 --small

fires at panels of 20 to 40 crossovers, half of them resolved to their edges: a second or less a shot.
"""

from __future__ import annotations

import argparse
import sys
import time
from math import radians
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from fabrics import catalogue
from fabrics.base.errors import UnstableError
from shellfabric.impact.setup import ImpactSetup
from shellfabric.loop.pack_solver import PackSolver
from shellfabric.membrane.boundary import Grip
from shellfabric.projectile.projectile import Projectile
from shellfabric.yarns.model import YarnZone, aim
from weavecell.studies.inputs import scale_fabric

FABRICS = "S-720", "S-726", "S-727", "S-728", "S-731", "S-745"
SHAPES = "flat", "sphere", "hemisphere", "cone", "chisel"
STEEL = 7850.0  # [kg/m3]
LIMIT = 0.005  # [-] energy error over the strike energy


def draw_shot(seed: int, number: int, small: bool = False) -> ImpactSetup:
    """Draw the set-up of a number; `small` is one of 20 to 40 crossovers."""
    random = np.random.default_rng([seed, number])
    fabric = catalogue.load(str(random.choice(FABRICS)))
    if random.uniform() < 0.5:
        low, high = 0.7, 1.4
        factors = ("modulus", "failure_strain", "crimp_warp", "crimp_weft")
        fabric = scale_fabric(fabric, **{name: random.uniform(low, high) for name in factors})
    spacing = 2 * max(fabric.weave.w)
    radius = random.uniform(2e-3, 6.5e-3)
    if small:
        radius = random.uniform(1.2, 3.0) * spacing
    shape = str(random.choice(SHAPES))
    own = {"edge_radius": 0.05 * radius} if shape != "sphere" else {}
    if shape == "cone":
        own = {"half_angle": radians(random.uniform(20, 60)), "tip_radius": 0.2 * radius}
    if shape == "chisel":
        own |= {"flat_width": 0.94 * radius, "flat_angle": radians(35)}
    mass = STEEL * 4 * radius**3 * random.uniform(0.7, 2.0)
    nose = Projectile(
        mass=mass, radius=radius, shape=shape, friction=float(random.choice([0.0, 0.2])), **own
    )
    edge = (
        "clamped",
        ("clamped", "free"),
        Grip(clamp_force=float(random.uniform(5, 50))),
    )[random.integers(3)]
    friction = float(random.uniform(0.05, 0.4))
    opening = float(random.uniform(0.07, 0.11))
    half_width = min(max(8e-3, 2.2 * radius + 6e-3), 0.4 * opening)
    if small:
        opening = random.uniform(20, 40) * spacing
        half_width = float(random.choice([radius + 5.5 * spacing, np.inf]))
    return ImpactSetup(
        fabric,
        float(np.exp(random.uniform(np.log(40), np.log(400)))),
        projectile=nose,
        opening=opening,
        boundary=edge,
        symmetry="whole",
        impact_point=aim(fabric.weave, [seed, number]),
        crossovers=YarnZone(half_width, friction),
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
    zone = solver.part("yarns").zone
    errors = np.abs(solver.sample("error")) / solver.strike_energy
    made = solver.energy_made()
    most = max(made, key=lambda name: abs(made[name]))
    return {
        "made": f"{most} made {100 * made[most] / solver.strike_energy / solver.share:.3f} %",
        "outcome": solver.outcome,
        "ended": ended,
        "error": float(errors.max()),
        "snap": float(solver.sample("yarn_snap")[-1] / solver.strike_energy),
        "torn": float(zone.torn_segments),
        "lost": float(zone.tangled),
    }


def main() -> int:
    """Fire the shots, a line each, until their number or the CPU time is used up."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--shots", type=int, default=200)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--small", action="store_true", help="panels of 20 to 40 crossovers")
    parser.add_argument("--only", type=int, nargs="*", help="numbers of the shots to fire")
    parser.add_argument("--cpu", type=float, default=600.0, help="[s] after which no shot begins")
    asked = parser.parse_args()
    rows = []
    for number in asked.only or range(asked.first, asked.first + asked.shots):
        if time.process_time() > asked.cpu:
            break
        setup = draw_shot(asked.seed, number, asked.small)
        began = time.process_time()
        row = fire(setup)
        rows.append(row)
        print(
            f"{number} {setup.fabric.name} {setup.projectile.shape} "
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
