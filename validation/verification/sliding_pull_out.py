"""Yarn pull-out of sliding crossovers: load against cohesion, pre-tension, number of crossovers and bending stiffness.

Part of `validation.verification.sliding`, which runs it.
"""

from __future__ import annotations

from typing import Any

from fabrics import catalogue
from meshing.pictures_style import BLUE, INK, ORANGE, PURPLE
from shellfabric.coupon import pull_out
from shellfabric.impact.simulation import ImpactSetup
from shellfabric.panel.numerics import Numerics
from shellfabric.sliding import contact_force
from shellfabric.sliding.model import CrossoverFriction
from validation.marked_page import markdown

PULL_MU, CROSSINGS, COHESION = (0.0, 0.1, 0.2, 0.3), (10, 20), 0.1  # [-], [-], [N]
LOADS, COUNTS, MU = (0.0, 100.0, 200.0, 400.0), (10, 20, 30), 0.2  # [N] on all crossing yarns of a strip, [-], [-]
STIFFNESS = ("flexible", "fibres alone", "geometric mean", "solid section")  # of the yarns in bending
SLOW, PULLED, LATE = 0.5, 450e-6, 0.6  # [m/s], [m] of the crosshead; share of that after which the load is averaged


def table_of(name: str = "S-726") -> Any:
    """The table of a fabric."""
    return ImpactSetup(catalogue.load(name).with_effective_density(), 1.0).table(kept=True)


def pulled(crossings: int, mu: float) -> tuple[float, float]:
    """(late load [N], largest energy error over the work) of S-726 with the cohesion COHESION, at 2 m/s."""
    friction = CrossoverFriction(mu, COHESION)
    coupon = pull_out.PullOut(table_of(), crossings, friction=friction, numerics=Numerics(threads=1))
    found = pull_out.run(coupon, 200e-6)
    return float(found.load[found.time > 100e-6].mean()), found.energy_error


def bending(which: str) -> tuple[float, float]:
    """(warp, weft) [N m2] of S-726."""
    bounds = [contact_force.bending_bounds(yarn) for yarn in catalogue.load("S-726").weave.yarns]
    shares = dict(zip(STIFFNESS[1:], (0.0, 0.5, 1.0)))
    warp, weft = (
        low ** (1 - shares[which]) * high ** shares[which] if which in shares else 0.0 for low, high in bounds
    )
    return warp, weft


def under_load(which: str, crossings: int, load: float) -> tuple[float, float, float]:
    """(mean load [N] of the end of the pull, pre-tension of a crossing yarn [N], energy error over the work) of S-726
    pulled at SLOW without cohesion, where the crossing yarns carry `load` [N] together."""
    tension, friction = load / crossings, CrossoverFriction(MU, 0.0, bending(which))
    coupon = pull_out.PullOut(
        table_of(), crossings, SLOW, tension, friction, Numerics(threads=1)
    )  # fmt: skip
    found = pull_out.run(coupon, PULLED / SLOW)
    late = found.displacement > LATE * PULLED
    return float(found.load[late].mean()), tension, found.energy_error


def cohesion_table(found: list) -> str:
    """Loads by coefficient and number of crossovers, under a cohesion."""
    rows = [["crossings", *(f"mu = {mu:g}" for mu in PULL_MU)]]
    for n, count in enumerate(CROSSINGS):
        cells = found[n * len(PULL_MU) : (n + 1) * len(PULL_MU)]
        rows.append([f"{count}", *(f"{load:.2f}" for load, _ in cells)])
    head = (
        f"### Pull-out\n\nLoad [N], mean from 100 to 200 µs, of one yarn of S-726 at 2 m/s; cohesion {COHESION:g} N.\n"
    )
    return f"{head}\n{markdown(rows)}"


def load_table(found: list) -> str:
    """Loads by bending stiffness, number of crossovers and pre-tension."""
    rows = [["bending stiffness", "N m^2", "crossings", *(f"{load:g} N" for load in LOADS)]]
    cases = [(which, count) for which in STIFFNESS for count in COUNTS]
    for n, (which, count) in enumerate(cases):
        cells = found[n * len(LOADS) : (n + 1) * len(LOADS)]
        rows.append([which, f"{bending(which)[0]:.2g}", f"{count}", *(f"{peak:.2f}" for peak, *_ in cells)])
    worst = max(error for *_, error in found)
    head = (
        f"### Pull-out under pre-tension\n\nLoad [N] of one yarn of S-726 at {SLOW:g} m/s, mean from "
        f"{1e3 * LATE * PULLED:.2f} to {1e3 * PULLED:.2f} mm of the crosshead, by the "
        f"load on all crossing yarns together; mu = {MU:g}, no cohesion. The largest energy error is "
        f"{100 * worst:.2f} % of the work of the crosshead.\n"
    )
    picture = "![Load of the pull-out](figures/sliding-pull-out.png)\n"
    return f"{head}\n{markdown(rows)}\n{picture}"


def chart(pyplot: Any, found: list) -> Any:
    """Loads against the load on the crossing yarns, and against the number of crossovers."""
    per = len(LOADS)
    figure, (left, right) = pyplot.subplots(1, 2, figsize=(9.2, 4.2), sharey=True)
    for colour, (place, which) in zip((INK, ORANGE, BLUE, PURPLE), enumerate(STIFFNESS)):
        rows = [
            found[(place * len(COUNTS) + n) * per : (place * len(COUNTS) + n + 1) * per] for n in range(len(COUNTS))
        ]
        left.plot(LOADS, [peak for peak, *_ in rows[1]], "o-", color=colour, label=which)
        right.plot(COUNTS, [row[LOADS.index(200.0)][0] for row in rows], "o-", color=colour)
    left.set(
        xlabel="load on the crossing yarns [N]",
        ylabel="load on the pulled yarn [N]",
        title=f"{COUNTS[1]} crossovers",
    )
    right.set(xlabel="crossovers", title="200 N on the crossing yarns", xlim=(0, None), ylim=(0, None))
    left.legend(title="bending stiffness")
    return figure
