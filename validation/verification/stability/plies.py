"""Contact between plies: its time step and form against premature failure (`shellfabric.plies.contact_kernels`)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

from fabrics import catalogue
from fabrics.ply_law import PlyLaw
from shellfabric.cell.model import CellModel
from shellfabric.panel import quality
from shellfabric.panel.model import Numerics, Panel
from shellfabric.plies.model import Pack, PlyContact
from shellfabric.plies.solver import PackSolver
from validation.verification.stability.core import ABOVE, STABLE, WRONG, Axis, Map, Outcome, guarded

FABRIC, VELOCITY, OPENING, PLIES, END = "S-728", 91.0, 0.12, 4, 170e-6
TABLE, ALLOWED = 51, 0.15
COURANTS = (0.1, 0.2, 0.3, 0.45, 0.5, 0.6, 0.7, 0.85, 1.0, 1.4)
FORMS = ("smooth", "smooth, 1 point", "smooth, undamped", "facets", "nodes")


@dataclass(frozen=True)
class Beyond(PlyContact):
    """Knobs that nobody checks."""

    def __post_init__(self):
        pass


@dataclass(frozen=True)
class Answer:
    """Peak tension (warp, weft) [N] of any ply, velocity left [m/s], failed yarn segments, deepest penetration [-]."""

    peak: tuple
    velocity: float
    failed: int
    deepest: float
    checks: tuple = ()

    def off(self, other: Answer) -> float:
        """[-] largest difference, peaks over the peaks and velocities over the strike velocity."""
        peaks = [abs(a / b - 1) for a, b in zip(self.peak, other.peak)]
        return max(*peaks, abs(self.velocity - other.velocity) / VELOCITY)


@cache
def ply() -> Panel:
    """A ply of the pack."""
    cell = CellModel(catalogue.load(FABRIC).with_effective_density())
    return Panel(cell.table(TABLE), (OPENING, OPENING), numerics=Numerics(threads=1))


def shot(courant: float, form: str) -> Answer:
    """Answer of a shot at the pack."""
    knobs = {"points": 1} if "1 point" in form else {"damping": 0.0} if "undamped" in form else {}
    contact = Beyond(courant=courant, form=form.split(",")[0], **knobs)
    stiffest = PlyLaw.solid(ply().fabric)  # other laws reach the stiffness that bounds the step only at high pressures
    march = PackSolver(Pack.stacked(ply(), PLIES, contact=contact, law=stiffest), VELOCITY, END).run()
    peak = tuple(float(tension) for tension in march.peaks.max(axis=0))
    failed = int(march.sample("failed_yarns")[-1])
    return Answer(peak, float(march.sample("v")[-1]), failed, float(march.deepest.max()), quality.of_solver(march))


usual = cache(lambda: shot(PlyContact.courant, FORMS[0]))


def point(courant: float, form: str) -> Outcome:
    """STABLE where peaks and velocity are those of the default, no yarn fails and no ply goes through the next."""

    def run():
        found = shot(courant, form)
        off = found.off(usual())
        good = off <= ALLOWED and found.failed == 0 and found.deepest < 1
        message = f"{found.failed} failed segments" if found.failed else ""
        message = message or (f"{found.deepest:.2g} of a ply's thickness deep" if found.deepest >= 1 else "")
        return Outcome(STABLE if good else WRONG, 100 * off, message, found.checks)

    return guarded(run)


def chart(quick: bool = False) -> Map:
    """The map."""
    return Map(
        "plies", "Contact between plies against premature failure",
        f"{PLIES} plies of {FABRIC} over {1e3 * OPENING:g} mm, struck at {VELOCITY:g} m/s, which stops the projectile "
        "without a failed yarn. In the thesis contact noise perforated many packs too early (section 5.2.2).",
        Axis("Courant number of the contact between plies", (0.2, PlyContact.courant, 1.4) if quick else COURANTS),
        Axis("form of the contact", FORMS[:1] if quick else FORMS), point, "difference from the default [%]",
        f"peaks or velocity off by more than {100 * ALLOWED:g} %, yarns that fail, or plies that go through each other",
        "a contact that gives energy it never took, beyond 1 % of the strike energy; drift of the energy balance",
        (PlyContact.courant, FORMS[0]), (ABOVE,),
    )  # fmt: skip
