"""The source's Newton iteration on two heights (App. B.3) with its printed law, over the displacements (d1, d2).

`validation.ledger.checks.newton` holds the iteration; the root of the monotone equation stands beside it.
"""

from fabrics import catalogue
from validation.ledger.checks import newton
from validation.stability.core import FAILED, STABLE, WRONG, Axis, Map, Outcome

FABRIC = "S-720"
PLACES = tuple(round(i * 2e-6, 9) for i in range(-6, 11))
ALLOWED, FLOOR = 0.02, 0.01  # of the force; [N] below which two forces are alike


def root(d1, d2):
    """[N] contact force of the monotone equation, with the law and the form that the source prints."""
    from validation.ledger.checks.cell import printed

    w = catalogue.load(FABRIC).weave.w
    return float(printed(FABRIC).solve(1 + d1 / w[0], 1 + d2 / w[1])["F"])


def point(d1, d2):
    """How the iteration ends, and in how many steps."""
    found, right = newton.iterate(FABRIC, d1, d2), root(d1, d2)
    if not found.converged:
        return Outcome(
            FAILED, found.steps, f"no convergence in {newton.MOST} steps" if found.steps >= newton.MOST else "ran off"
        )
    if abs(found.F - right) > max(ALLOWED * abs(right), FLOOR):
        return Outcome(WRONG, found.steps, f"{found.F:.4g} N instead of {right:.4g} N")
    return Outcome(STABLE, found.steps)


def axes(quick):
    """Axes of both maps of the cell."""
    places = PLACES[::8] if quick else PLACES
    labels = tuple(f"{1e6 * d:g}" for d in places)
    return Axis("end displacement d1 of the warp [µm]", places, labels), Axis("d2 of the weft [µm]", places, labels)


def chart(quick=False):
    """The map."""
    return Map(
        "newton", "Newton's method on two heights, as the source prints it",
        f"The cell of {FABRIC} solved as in the source's App. B.3: two unknown heights, the printed law of "
        "compression, from the heights at rest. Nothing of this project uses it; it stands here for what it does where "
        "contact is light or lost.",
        *axes(quick), point, "steps", "a false root: its force is not that of the monotone equation",
        "none in the source; here the method is not used", failed="no convergence, or ran off",
    )  # fmt: skip
