"""What a number leaves out: the mesh, the sampling, assumed data and the model.

One place says so of each result; terminal, JSON, report and notebook take it from here.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from fabrics.base.door import option

if TYPE_CHECKING:
    from collections.abc import Iterable

    from shellfabric.impact.setup import ImpactSetup

MESH = "mesh"
SAMPLING = "sampling"
DATA = "assumed data"
MODEL = "model"


@dataclass(frozen=True)
class LeftOut:
    """One thing that a number does not cover.

    Parameters
    ----------
    kind : MESH, SAMPLING, DATA or MODEL
    brief : of a headline; "" where it says nothing of it
    text : what is left out, and what covers it
    """

    kind: str
    brief: str
    text: str


def find_left_out(
    setup: ImpactSetup, around: Any = None, *, mesh_compared: bool = False, drawn: bool = False
) -> tuple[LeftOut, ...]:
    """List what a velocity computed for a set-up leaves out.

    Parameters
    ----------
    around : AssumedRange that stands beside the number, or None
    mesh_compared : whether the result has a discretisation uncertainty
    drawn : whether yarns of drawn strengths were shot at
    """
    from weavecell.studies import assumed_range

    found = []
    if setup.crossovers is None:
        nose = "no slip, pull-out or opening of the weave"
        nose += "; a nose may push slippery yarns aside and pass far below a limit"
        text = f'yarns are pinned where they cross: {nose} (crossovers = "yarns")'
        found.append(LeftOut(MODEL, "yarns pinned", text))
    names = ", ".join(assumed_range.changes(setup))
    if around is None and names:
        first = _friction_between_yarns(setup)
        brief = f"{first}range over what is assumed not computed"
        text = f"{first}the range over what is assumed is not computed ({names}); {option('assumed_range')} does"
        found.append(LeftOut(DATA, brief, text))
    elif around is not None and setup.crossovers is not None:
        interval = around.over_friction_between_yarns
        if interval:
            found.append(LeftOut(DATA, interval, f"{around.quantity} rests on {interval}"))
    if not mesh_compared:
        way = option("uncertainty")
        text = f"the error of the mesh is not computed; {way} of an impact, or docs/accuracy.md"
        found.append(LeftOut(MESH, "", text))
    if not drawn and setup.strength is None:
        found.append(LeftOut(SAMPLING, "", "all yarns have one strength; v50 draws them"))
    return tuple(found)


def _friction_between_yarns(setup):
    """What an answer of resolved yarns rests on first, where it is assumed: their friction, with its interval."""
    if setup.crossovers is None or not setup.crossovers.assumed_lines:
        return ""
    from weavecell.studies.inputs import FRICTION_OF_CROSSOVERS, ranges

    entry = ranges()[FRICTION_OF_CROSSOVERS]
    return f"friction between yarns assumed, {entry.low:g} to {entry.high:g}; "


def brief_words(left_out: Iterable[LeftOut]) -> str:
    """Say in a few words, for a headline, what is left out."""
    return "; ".join(part.brief for part in left_out if part.brief)


def lines_of(left_out: Iterable[LeftOut]) -> list[str]:
    """Write a line about each thing that is left out."""
    return [f"not in these numbers, {part.kind}: {part.text}" for part in left_out]


def summarise(left_out: Iterable[LeftOut]) -> dict[str, Any]:
    """Return the entry of a JSON file, {"left_out": {kind: text}}; nothing if nothing is."""
    entry = {part.kind: part.text for part in left_out}
    if not entry:
        return {}
    return {"left_out": entry}
