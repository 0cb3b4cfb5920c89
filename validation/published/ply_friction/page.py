"""docs/reports/ply-friction.md: the method, the table and the chart."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from validation.published.ply_friction.study import FRICTIONS, PLIES, SHARES, STRIDE, Found
from weavecell.report.marked_page import markdown

LITERATURE = 0.10  # of V50
BEGIN, END = "<!-- cost of benchmarks/pack.py -->\n", "<!-- end of cost -->"


def page(found: Mapping[str, Sequence[Found]], seconds: float, cost: str = "", run: str = "") -> str:
    """The page in Markdown.

    Parameters
    ----------
    found : {fabric: rows}
    seconds : [s] of all shots together
    cost : text between the marks of the cost, which `benchmarks/pack.py --friction` makes
    run : line of `validation.commits.computed`
    """
    return (
        "\n".join(
            [
                _TITLE,
                run,
                _HEAD,
                rows(found),
                _FIGURE,
                answer(found),
                f"## Cost\n\n{BEGIN}{cost}{END}\n",
                _LIMITS,
                f"All shots took {seconds / 60:.1f} minutes on one core.",
            ]
        )
        + "\n"
    )


def rows(found: Mapping[str, Sequence[Found]]) -> str:
    """One row a fabric and coefficient."""
    lines = [[
        "fabric", "friction between plies", "first failure, m/s", "change", "ballistic limit, m/s", "change",
        "lowest perforation, m/s", "highest stop, m/s", "work of friction at the highest stop, % of the strike energy",
        "energy error, %", "stopped by a guard",
    ]]  # fmt: skip
    for fabric, of in found.items():
        for one in of:
            lines.append([
                fabric, f"{one.friction:g}", f"{one.onset:.1f}", change(one.onset, of[0].onset), f"{one.limit:.1f}",
                change(one.limit, of[0].limit), f"{one.perforation:.1f}", f"{one.stop:.1f}", f"{100 * one.rubbed:.2f}",
                f"{100 * one.balance:.2f}", f"{one.unstable}",
            ])  # fmt: skip
    return markdown(lines)


def change(value: float, first: float) -> str:
    """Change against the pack without friction."""
    return f"{100 * (value / first - 1):+.1f} %"


def overlap(of: Sequence[Found]) -> str:
    """How far the zone of mixed outcomes reaches at most."""
    most = max(one.stop - one.perforation for one in of)
    return f"overlap by up to {most:.0f} m/s" if most > 0 else "do not overlap"


def answer(found: Mapping[str, Sequence[Found]]) -> str:
    """What the table says, beside the literature."""
    texts = []
    for fabric, of in found.items():
        last, over = of[-1], [round(100 * (one.limit / one.onset - 1), 1) + 0.0 for one in (of[0], of[-1])]
        texts.append(
            f"- {fabric}: from 0 to {last.friction:g} the first failure moves by {change(last.onset, of[0].onset)} and "
            f"the ballistic limit by\n  {change(last.limit, of[0].limit)}; stops and perforations {overlap(of)}.\n"
            f"  Limit against first failure: {over[0]:+.1f} % without friction, {over[1]:+.1f} % at {last.friction:g}."
        )
    texts.append(f"- The strike velocities resolve a ballistic limit to ±{50 * STRIDE:g} %, and no smaller changes.")
    changes = [one.limit / of[0].limit - 1 for of in found.values() for one in of[1:]]
    met = "reproduces it" if max(changes) > 0.5 * LITERATURE else "does not reproduce it"
    met = "has the opposite sign" if max(changes) < 0 else met
    texts.append(
        f"- The literature has about {100 * LITERATURE:+.0f} % in V50 for all friction together. Friction between "
        f"plies alone changes the\n  limit by {100 * min(changes):+.1f} to {100 * max(changes):+.1f} %, which {met}. "
        "The literature's\n  figure includes friction at crossovers, which are pinned here, and at the nose."
    )
    return "\n".join(texts) + "\n"


_MU = ", ".join(f"{mu:g}" for mu in FRICTIONS)
_TITLE = """# Friction between plies

*How much does friction between the plies of a pack change first failure and ballistic limit?*
"""
_HEAD = f"""
Not to be edited by hand. In an input file: `ply_friction = 0.2` under `[panel]` of a pack. Without it plies slide
on each other without friction.

**Law.** Coulomb's, at the points of the contact between plies. A point that sticks is held by an elastic slip, a spring
and a damper along the surface; beyond the friction coefficient times the normal force it slides. The forces on the two
plies are equal and opposite to round-off. The work of friction is the entry `ply_friction` of the energies.

**Stability.** Spring and damper follow from the time step and the mass that a point stands for: the highest mode of a
ply in its own plane and the highest mode of a stack of plies on these springs together stay within the bound of central
differences (`shellfabric/plies/friction.py`). No coefficient of the regularisation is chosen.

**Runs.** {PLIES} plies, 203 mm, struck by the flat cylinder of 3 g and 5.5 mm. Coefficients {_MU}.
The mesh is the default of packs, with two elements per crossover about the impact point; the contact law of the plies
is the default, that of solid fibre.
Crossovers are pinned and the nose is frictionless, so that no other friction acts. First failure: bisection to 1 m/s.
Ballistic limit: torn packs have no single one, so the same {len(SHARES)} strike velocities, {100 * STRIDE:g} % apart,
are fired at every coefficient; the limit is the velocity with as many perforations below as stops above.
"""

_FIGURE = """
![First failure and ballistic limit against the friction between plies](figures/ply-friction.png)

*Four plies, 203 mm. Filled: ballistic limit; where stops and perforations overlap, a bar from the lowest
perforation to the highest stop. Open: first failure.*
"""

_LIMITS = """
## Limitations

- Fabric beside holes that is kept apart by the least impulse ([packs.md](packs.md)) has no friction there.
- The moment of friction about a ply's middle surface, half a thickness times the force, is neglected.
- Crossovers are pinned: no friction of yarns on each other within a ply.
"""
