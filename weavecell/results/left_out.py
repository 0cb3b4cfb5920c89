"""What a number leaves out: the mesh, the sampling, assumed data and the model.

One place says so of each result; terminal, JSON, report and notebook take it from here.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from fabrics.base.door import name_options, option

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

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
    around: Any = None,
    *,
    mesh_compared: bool = False,
    drawn: bool = False,
    one_shot: bool = False,
) -> tuple[LeftOut, ...]:
    """List what a velocity computed for a set-up leaves out.

    Parameters
    ----------
    around : AssumedRange that stands beside the number, or None
    mesh_compared : whether the result has a discretisation uncertainty
    drawn : whether yarns of drawn strengths were shot at
    one_shot : whether it is of an impact, which compares meshes
    """
    from shellfabric.impact.proposals import fill
    from weavecell.studies import assumed_range, unknown

    found = []
    if setup.crossovers is None:
        nose = "no slip, pull-out or opening of the weave"
        nose += "; a nose may push slippery yarns aside and pass far below a limit"
        text = f"yarns are pinned where they cross: {nose}"
        words = fill("{resolved yarns}", setup)
        if words:
            text += f" ({words})"
        found.append(LeftOut(MODEL, "slip of yarns, which are pinned", text, words))
    nominal = unknown.find_unknown(setup)
    listed = [name for name in assumed_range.changes(setup) if name not in nominal]
    names = ", ".join(listed)
    friction = ""
    if around is not None and setup.crossovers is not None:
        # an answer rests on it first
        friction = around.over_friction_between_yarns
    if around is None and names:
        text = f"the range over what is assumed is not computed ({names}); {option('assumed_range')} does"
        found.append(LeftOut(DATA, name_some(listed), text, "--assumed-range"))
    elif friction:
        found.append(LeftOut(DATA, friction, f"{around.quantity} rests on {friction}"))
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


def leave_out_drawn(parts: Sequence[LeftOut], setup: ImpactSetup) -> tuple[LeftOut, ...]:
    """Return what is left out of numbers over all that is drawn: of what is assumed that which is not."""
    from weavecell.studies import assumed_range, unknown

    drawn = unknown.find_unknown(setup)
    names = [name for name in assumed_range.changes(setup) if name not in drawn]
    others = tuple(part for part in parts if part.kind != DATA)
    if not names:
        return others
    return LeftOut(DATA, name_some(names), f"not drawn: {', '.join(names)}"), *others


def name_some(names: list[str]) -> str:
    """Name the first two of several things, and say how many others there are."""
    if len(names) < 4:
        return ", ".join(names)
    return f"{', '.join(names[:2])} and {len(names) - 2} more inputs"


def lines_of(left_out: Iterable[LeftOut]) -> list[str]:
    """Write a line about each thing that is left out."""
    return [f"not in these numbers, {part.kind}: {part.text}" for part in left_out]


def summarise(left_out: Iterable[LeftOut]) -> dict[str, Any]:
    """Return the entry of a JSON file, {"left_out": {kind: text}}; nothing if nothing is."""
    entry = {part.kind: part.text for part in left_out}
    if not entry:
        return {}
    return {"left_out": entry}
