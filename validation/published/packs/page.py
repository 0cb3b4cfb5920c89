"""docs/reports/packs.md: tables and pictures of the study of packs, and the limitations of the model."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from validation.published.packs.passages import AT_ONCE
from validation.published.packs.study import GAPS, LOOKED_AT, STACKED
from weavecell.report.marked_page import markdown


def page(found: dict[str, Any], run: str = "") -> str:
    """The page in Markdown, from the results of `__main__`; `run` is a line of `validation.commits.computed`."""
    return "\n".join([
        _TITLE, run, _HEAD, agreement(found["outcomes"]), outcomes(found["outcomes"]), _OUTCOMES, _PASSAGES,
        passages(found["torn"]), crossed(found["torn"]), _CONTACT, _GAPS, gaps(found["gaps"]), _STACKING,
        stacking(found["stackings"]), _LIMITS,
    ])  # fmt: skip


def agreement(rows: Iterable[Any]) -> str:
    """How many computed outcomes differ from the captions, and what fails where the projectile stops."""
    rows = list(rows)
    words = {"stopped": "stops", "perforated": "perforates"}
    other = sum(words.get(one["outcome"]) != published.split()[0] for *_, published, one in rows)
    stop = [one for *_, one in rows if one["outcome"] == "stopped"]
    torn = sum(any(one["failed"]) for one in stop)
    return (
        f"**{other} of the {len(rows)} computed outcomes differ from the captions.** {len(stop)} of {len(rows)} shots "
        f"stop; {f'in {torn} of these yarns fail' if torn else 'no yarn of these fails'}.\n"
    )


def outcomes(rows: Iterable[Any]) -> str:
    """One row a published shot."""
    lines = [["plies", "fabric", "strike, m/s", "thesis", "computed", "at, µs", "failed yarn segments by ply",
              "highest tension / strength", "deepest / thickness", "energy error, %"]]  # fmt: skip
    for fabric, plies, velocity, published, one in rows:
        lines.append([
            plies, fabric, f"{velocity:g}", published, outcome_text(one), f"{1e6 * one['time']:.0f}",
            by_ply(one["failed"]), f"{max(one['peaks']):.2f}", f"{one['deepest']:.2f}", f"{100 * one['balance']:.2f}",
        ])  # fmt: skip
    return markdown(lines)


def passages(rows: Iterable[dict[str, Any]]) -> str:
    """One row a shot that tears cloth."""
    lines = [["plies", "fabric", "strike, m/s", "until, µs", "failed segments of the quarter", "held apart, times",
              "with, % of the strike energy", "not held", f"back within {AT_ONCE} steps", "**crossings**"]]  # fmt: skip
    for one in rows:
        case = one["case"]
        lines.append([
            case["plies"], case["fabric"], f"{case['velocity']:g}", f"{1e6 * one['time']:.0f}", f"{one['failed'][0]:g}",
            f"{one['held']:g}", f"{100 * one['taken']:.2f}", f"{one['missed']:g}",
            f"{len(one['back'])}", f"**{len(one['passages'])}**",
        ])  # fmt: skip
    return markdown(lines)


def crossed(rows: Iterable[dict[str, Any]]) -> str:
    """How many crossings there are, and how many of them are between intact plies."""
    rows = list(rows)
    every = [one for row in rows for one in row["passages"]]
    if not every:
        return f"No ply interpenetrates another in these {len(rows)} shots."
    times = f"{len(every)} time{'s' * (len(every) > 1)}"
    whole = sum(bool(one.get("whole")) for one in every)
    shots = sum(bool(row["passages"]) for row in rows)
    return (
        f"**Plies interpenetrate in {shots} of these {len(rows)} shots, {times}**; {whole} of these at places where "
        "both plies are untorn."
    )


def outcome_text(one: dict[str, Any]) -> str:
    """The outcome, with the velocity where the shot goes on."""
    word = {"stopped": "**stops**", "perforated": "**perforates**"}.get(one["outcome"], f"**{one['outcome']}**")
    return word if one["outcome"] == "stopped" else f"{word}, {one['residual_velocity']:.0f} m/s left"


def by_ply(failed: Sequence[float]) -> str:
    """Numbers of failed segments, equal ones of neighbouring plies drawn together."""
    if not any(failed):
        return "none"
    parts, start = [], 0
    for end in range(1, len(failed) + 1):
        if end == len(failed) or failed[end] != failed[start]:
            count = end - start
            parts.append(f"{failed[start]:g}" if count == 1 else f"{count} x {failed[start]:g}")
            start = end
    return ", ".join(parts)


def gaps(found: dict[float, dict[str, Any]]) -> str:
    """One row a gap."""
    lines = [["gap, mm", "outcome", "at, µs", "deflection, mm", "highest force, kN (2 µs mean)",
              "jumps of the force, kN rms", "failed yarn segments"]]  # fmt: skip
    for gap in GAPS:
        one = found[gap]
        force, slow = smoothed(one, 2e-6), smoothed(one, 20e-6)
        first = np.array(one["t"]) < 100e-6
        jumps = float(np.sqrt(np.mean((force - slow)[first] ** 2)))
        lines.append([
            f"{1e3 * gap:.2f}", outcome_text(one), f"{1e6 * one['time']:.0f}", f"{1e3 * one['deflection']:.1f}",
            f"{1e-3 * force.max():.1f}", f"{1e-3 * jumps:.2f}", by_ply(one["failed"]),
        ])  # fmt: skip
    return markdown(lines)


def smoothed(one: dict[str, Any], width: float) -> np.ndarray:
    """(n,) [N] force that slows the projectile, averaged over `width` [s]."""
    t, force = np.array(one["t"]), -np.array(one["force"])
    count = max(1, round(width / (t[1] - t[0])))
    return np.convolve(force, np.ones(count) / count, "same")


def stacking(found: dict[str, Any]) -> str:
    """One row a stacking, and the difference."""
    instants = (100e-6, 150e-6, 200e-6)
    lines = [["stacking", "stops at, µs", "deflection, mm", *(f"absorbed by {1e6 * t:.0f} µs, J" for t in instants)]]
    absorbed = {}
    for name, one in found.items():
        absorbed[name] = np.interp(instants, one["instants"], one["absorbed"])
        lines.append([
            name, f"{1e6 * one['time']:.0f}" if one["outcome"] == "stopped" else outcome_text(one),
            f"{1e3 * one['deflection']:.1f}", *(f"{energy:.2f}" for energy in absorbed[name]),
        ])  # fmt: skip
    more = 100 * (absorbed["alternating"] / absorbed["aligned"] - 1)
    lines.append(["alternating against aligned", "", "", *(f"{value:+.1f} %" for value in more)])
    return markdown(lines)


_TITLE = """# Packs: contact between plies, shots of the thesis, gap and stacking

*Do packs stop the shots of the thesis, and how far does the contact between plies decide this?*
"""
_HEAD = """
Not to be edited by hand. How packs are modelled: [Theory II](../theory-panel.md); how they are computed:
[packs](../pack.md). The panels are 203 mm wide and clamped; the projectile is the rigid flat cylinder of 3 g and
5.5 mm; a quarter is modelled. The mesh is the default of packs, with two elements per crossover about the impact point;
the contact law of the plies is the default, that of solid fibre.

**Gap between plies.** Without `ply_gap` the gap is the closure that tests of packs show, less the closure of the
contact law. The former is the fabric's `interlayer_gap`; without one it is assumed:

- for a fabric with `areal_density_measured` (Kevlar 129 of the catalogue) from the pressure law of packs (thesis
  eqs. 5-1 to 5-4, erratum E-02);
- for any other, and below 148 g/m² where K'' of that law vanishes, as 0.33 times the thickness, the mean over the
  six Kevlar fabrics of the pressure law's gap over the thickness.

The range of an assumed gap is 0.79 to 2.3 times its value: the smallest ratio of the six fabrics, and the pressure
law with a start load of 1 N instead of 10 N, since the thesis finds its gaps too small (section 6.4.4).

## Shots of the thesis (section 5.2.2)

The captions are of the thesis's simulations. Of the five perforations among them erratum E-21 calls one certainly an
artefact of contact noise and three very unlikely in a test, which the claims count as not comparable; one it leaves
undecided.
"""

_OUTCOMES = """
The target of the energy error is 0.5 % of the strike energy. "Deepest" is the largest penetration of a point of one
ply into the thickness of the next. At 1 the two middle surfaces touch; above 1 the point lies behind the contact
surface, and counts as an interpenetration (below) only if it has crossed the facets as well.
"""

_PASSAGES = f"""
## Interpenetration of plies

Counted independently of the contact in every step (`validation.published.packs.passages`): midpoints of elements with
intact yarns, up to {LOOKED_AT} crossovers from the impact point, that cross the fabric of the next ply or of the
second neighbour, in either direction. A hole, where the warp and weft next to a place have failed or its element has
eroded, does not count as fabric. A ply has two surfaces, the facets between nodes and midpoints of elements and the
spline of the contact, which lie on the two sides of a bend; a point counts when it has crossed both. When a yarn
fails the contact changes from one surface to the other, and a point between the two is behind fabric without having
moved; it is brought back ("back").
Sixteen plies have not been counted: a shot that tears them takes a quarter of an hour of one core or more.
"""

_CONTACT = """
The contact alone separates intact plies; a run in which it finds intact plies that interpenetrate ends with the place
and the step. Failed fabric has free edges, turns over and meets plies through the holes of others. Beside it the
positions of the coming step are predicted, and the smallest impulse that prevents a crossing is applied
(`shellfabric.plies.torn_contact_kernels`). It removes the velocity of approach; its work is part of the contact
energy of plies.

The law must be stiff enough to separate intact plies. Behind the wave that a projectile drives into a pack,
neighbouring plies of areal density A penetrate each other by v sqrt(A / K); with v up to 1.5 times the strike
velocity this has to stay within 0.85 thicknesses (`Pack.in_step_with`). Solid fibre meets this up to 1300 to 1800
m/s in plies of Kevlar 129; beyond that the law is made stiffer.

A spring between plies is loaded by motion alone. To first order a depth grows by the approach n.(v_x - v_y) dt on
any surface. A larger change, more than a tenth of the thickness in a step, comes from another fold, another side or
the facets that replace a torn spline, and loads no spring. The tenth lies between the few hundredths that sliding
over the narrowest bend makes (second order) and the several tenths of another fold.

What results depend on the stiffness of the contact, its damping, the gap and the mesh: [convergence](convergence.md).
"""

_GAPS = """
## Gap (section 6.4.4)

16 plies of S-728 at 170 m/s with the gap of Table 5-2, and with 0.5 and 1.0 mm more. "Jumps": the force (means over
2 µs) less its slow part (means over 20 µs), rms in the first 100 µs. As in the thesis a wider gap slows the
projectile later and less. The thesis has jumps at the small gap and attributes them to waves in its elastic
projectile; the projectile here is rigid.

![Velocity for three gaps](figures/packs-gaps.png)

![Force for three gaps](figures/packs-gap-forces.png)
"""

_STACKING = f"""
## Stacking (Figures 5-55 to 5-57)

{STACKED[1]} plies of {STACKED[0]} at {STACKED[2]:g} m/s; in the alternating pack every other ply is turned by a right
angle, so that its weft, which is nearly straight, lies along the others' warp.

![Velocity for two stackings](figures/packs-stacking.png)
"""

_LIMITS = """
## Limitations

- Through a hole, fabric of the plies before and behind is kept from passing, at a twentieth of a thickness, by the
  least impulse; it has no contact there with thickness and spring.
- Friction between plies acts only where the input sets it ([ply-friction.md](ply-friction.md)); the impulses beside
  failed fabric have none.
- A node that has lost all its yarns is out of contact, and flies on through the plies before it.
- The projectile presses on solid fibre: the travel of half a ply, some 20 µm, is not in its contact.
- Fabric that is drawn together until it folds, such as four free plies before a block ([pencilling.md](pencilling.md)),
  may go over the planes of symmetry, where nothing holds it off its own image.
- Points lie inside elements, so an edge of failed fabric may cross another edge.
- A ply has one closest point for each point: fabric that folds onto itself does not touch itself, and a second fold
  of the next ply is found beside failed fabric alone.
"""
