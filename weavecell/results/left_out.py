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
    from shellfabric.impact.proposals import fill
    from weavecell.studies import assumed_range

    found = []
    if setup.crossovers is None:
        nose = "no slip, pull-out or opening of the weave"
        nose += "; a nose may push slippery yarns aside and pass far below a limit"
        text = f"yarns are pinned where they cross: {nose}"
        if words := fill("{resolved yarns}", setup):
            text += f" ({words})"
        found.append(LeftOut(MODEL, "yarns pinned", text))
    names = ", ".join(assumed_range.changes(setup))
    friction = name_friction(setup, around)
    if around is None and names:
        first = f"{friction}; " if friction else ""
        brief = f"{first}range over what is assumed not computed"
        text = f"{first}the range over what is assumed is not computed ({names}); {option('assumed_range')} does"
        found.append(LeftOut(DATA, brief, text))
    elif around is not None and friction:
        found.append(LeftOut(DATA, friction, f"{around.quantity} rests on {friction}"))
    if not mesh_compared:
        way = option("uncertainty")
        text = f"the error of the mesh is not computed; {way} of an impact, or docs/accuracy.md"
        found.append(LeftOut(MESH, "", text))
    if not drawn and setup.strength is None:
        found.append(LeftOut(SAMPLING, "", "all yarns have one strength; v50 draws them"))
    return tuple(found)


def name_friction(setup: ImpactSetup, around: Any = None) -> str:
    """Name the friction between resolved yarns with its interval, where it is assumed: an answer
    rests on it first. With the velocities over that interval, where these were computed.

    Parameters
    ----------
    around : AssumedRange of the answer, or None
    """
    if setup.crossovers is None:
        return ""
    if around is not None:
        return around.over_friction_between_yarns
    if not setup.crossovers.friction_range:
        return ""
    return "friction between yarns assumed, {:g} to {:g}".format(*setup.crossovers.friction_range)


def brief_words(left_out: Iterable[LeftOut], chosen: str = "") -> str:
    """Say in a few words, for a headline, what is left out.

    Parameters
    ----------
    chosen : whether yarns are pinned or resolved and why, if the checks chose: in place of that they
        are pinned, and behind the friction that resolved ones rest on
    """
    parts = [part for part in left_out if part.brief]
    words = [part.brief for part in parts if not (chosen and part.kind == MODEL)]
    pinned = len(words) < len(parts)
    words.insert(0 if pinned else len(words), chosen)
    return "; ".join(filter(None, words))


def lines_of(left_out: Iterable[LeftOut]) -> list[str]:
    """Write a line about each thing that is left out."""
    return [f"not in these numbers, {part.kind}: {part.text}" for part in left_out]


def summarise(left_out: Iterable[LeftOut]) -> dict[str, Any]:
    """Return the entry of a JSON file, {"left_out": {kind: text}}; nothing if nothing is."""
    entry = {part.kind: part.text for part in left_out}
    if not entry:
        return {}
    return {"left_out": entry}
