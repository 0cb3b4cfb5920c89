"""What a number leaves out: the mesh, the sampling, the model, and of a single run what nobody gave.

One place says so of each result; terminal, JSON, report and notebook take it from here.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from fabrics.base.door import name_options, option

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
    kind : MESH, SAMPLING, DATA, MODEL or what nobody gave
    brief : in a few words
    text : what is left out, and what covers it
    settle : what to run or to give, with options as the command line names them
    """

    kind: str
    brief: str
    text: str
    settle: str = ""


def find_left_out(
    setup: ImpactSetup,
    *,
    mesh_compared: bool = False,
    drawn: bool = False,
    one_shot: bool = False,
) -> tuple[LeftOut, ...]:
    """List what a velocity computed for a set-up leaves out.

    Parameters
    ----------
    mesh_compared : whether the result has a discretisation uncertainty
    drawn : whether yarns of drawn strengths were shot at
    one_shot : whether it is of an impact, which compares meshes
    """
    from shellfabric.impact.proposals import fill

    found = []
    if setup.crossovers is None:
        nose = "no slip, pull-out or opening of the weave"
        nose += "; a nose may push slippery yarns aside and pass far below a limit"
        text = f"yarns are pinned where they cross: {nose}"
        words = fill("{resolved yarns}", setup)
        if words:
            text += f" ({words})"
        found.append(LeftOut(MODEL, "slip of yarns, which are pinned", text, words))
    if not mesh_compared:
        text = f"the error of the mesh is not computed; {option('uncertainty')} of an impact, or docs/accuracy.md"
        found.append(LeftOut(MESH, "mesh", text, "--uncertainty" if one_shot else ""))
    if not drawn and setup.strength is None:
        text = "all yarns have one strength; v50 draws them"
        found.append(LeftOut(SAMPLING, "scatter of yarns", text, "v50"))
    return tuple(found)


def say_nominal(setup: ImpactSetup, way: str) -> tuple[LeftOut, ...]:
    """Say that one run stands for what nobody gave, at nominal values, which `way`, as the command
    line names it, draws."""
    from weavecell.studies import unknown

    ranges = unknown.find_unknown(setup)
    if not ranges:
        return ()
    said = unknown.say(ranges)
    if setup.crossovers is not None:
        said = f"{unknown.PLACE}, {said}"
    text = f"it is at nominal values of what nobody gave: {said}; {name_options(way)} draws them"
    return (LeftOut("what nobody gave", said, text, way),)


def lines_of(left_out: Iterable[LeftOut]) -> list[str]:
    """Write a line about each thing that is left out."""
    return [f"not in these numbers, {part.kind}: {part.text}" for part in left_out]


def summarise(left_out: Iterable[LeftOut]) -> dict[str, Any]:
    """Return the entry of a JSON file, {"left_out": {kind: text}}; nothing if nothing is."""
    entry = {part.kind: part.text for part in left_out}
    if not entry:
        return {}
    return {"left_out": entry}
