"""What a shot takes for granted, in words, and the settings that it is computed with: each is asked of the
object that has the numbers. Report, forecast and summary ask here."""

from __future__ import annotations

from dataclasses import replace
from math import inf
from typing import Any

from fabrics import assumed
from fabrics.base.assumed_number import Assumed
from shellfabric.block.block import Backing
from shellfabric.impact.setup import ImpactSetup
from shellfabric.loop.histories import HistoryRequest

PINNED = (
    "Warp and weft are pinned to each other at every crossover: no slip, pull-out or opening of the weave.",
    "In the one pair of tests at hand (S-726) the computed limit is too high.",
)
FLOATS = (
    "Whether another weave would stop more is not decided by pinned yarns, "
    "which cannot slip under their floats."
)
MEAN_CROSSING = (
    "Beyond them the crossings of this weave, which are of several kinds, are taken by their mean: in 5-harness "
    "satin that is up to twice as stiff as resolved yarns are, in 3/1 twill up to 1.4 times."
)
# of a single ply
PUSHED_ASIDE = "A nose may push slippery yarns aside and pass far below this limit."


def list_assumptions(
    setup: ImpactSetup, *, body: str = "", drawn: bool = False
) -> list[tuple[str, str]]:
    """List what a run takes for granted: (of what, sentences).

    Parameters
    ----------
    setup : as it was run
    body : whether a rigid projectile is justified, in words
    drawn : whether each yarn has a strength of its own, also where the set-up has none
    """
    body_in_words, *flight = setup.projectile.assumptions
    if body:
        flight.insert(0, _sentence(body))
    crossovers = _of_crossovers(setup)
    if setup.crossovers is not None:
        crossovers.append(_say_aim(setup, drawn))
    drawn = drawn or setup.strength is not None
    rows = [
        ("crossovers", crossovers),
        ("failure of yarns", [setup.failure_in_words(drawn)]),
        ("strain rate", [setup.rate_in_words(setup.fabrics)]),
        ("edges", setup.frame_in_words),
        ("projectile", [body_in_words, *flight]),
    ]
    if setup.strength is not None:
        rows.append(("strengths", [setup.strength.words]))
    if setup.plies > 1:
        rows.append(("between plies", _between_plies(setup)))
    if setup.backing is not None:
        rows.append(("block behind", setup.backing.assumptions))
    said = [(name, " ".join(sentences)) for name, sentences in rows]
    ranges = [line for fabric in setup.fabrics for line in assumed.ranges_of_measured(fabric)]
    # fabrics of one yarn have theirs in common
    said += [("range of a number", line) for line in dict.fromkeys(ranges)]
    return said


def list_choices(setup: ImpactSetup) -> dict[str, str]:
    """List {name: value in SI units} of what the cells are made from, and of the settings that are not
    those of a set-up with nothing chosen but fabric and velocity."""
    plain = ImpactSetup(
        setup.fabric,
        setup.strike_velocity,
        backing=setup.backing and Backing(),
        history=setup.history and HistoryRequest(),
    )
    usual = list_settings(plain)
    for name in _list_materials(plain):
        del usual[name]
    chosen = {}
    for name, value in list_settings(setup).items():
        if name not in usual or usual[name] != value:
            chosen[name] = say(value)
    return chosen


def say(value: Any) -> str:
    """Write the value of a setting."""
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, tuple):
        return ", ".join(map(say, value))
    return str(value)


def list_settings(setup: ImpactSetup) -> dict[str, Any]:
    """List {name: value in SI units} of what a run was computed with: cell, mesh, time, projectile, block
    and numerical parameters."""
    found = {
        "opening": setup.opening,
        "impact point": setup.impact_point,
        "cell model": setup.cell_model,
        "cell formulation": setup.cell_formulation,
        "play of a crossover": setup.crossover_gap,
        "bending stiffness of yarns": setup.bending,
        "stretches along each side of the cell table": setup.table_size,
        "elements per crossover": setup.elements_per_crossover,
        "grading": setup.grading,
        "latest end": setup.end_time,
        "time between energy audits": setup.audit_interval,
        "time between snapshots": setup.snapshot_interval,
    }
    if setup.history is not None:
        found |= _named("histories", vars(setup.history))
    found |= _list_materials(setup)
    found |= _named("projectile", setup.projectile.settings)
    if setup.backing is not None:
        found |= _named("block", setup.backing.settings)
    return found | _named("", setup.numerics.settings)


def _list_materials(setup):
    """{name: value in SI units} of what the cells of the plies are made from."""
    found = {}
    for fabric in setup.fabrics:
        moduli = tuple(yarn.E for yarn in fabric.weave.yarns)
        found[f"{fabric.name}, modulus of warp and weft"] = moduli
    if setup.surface is not None:
        return found | {"cell": "response surface"}
    for number, (fabric, laws) in enumerate(setup.materials, 1):
        if laws is not None:
            name = f"material {number}, {fabric.name}, compression law of warp and weft"
            found[name] = tuple((law.a, law.b, law.form) for law in laws)
    return found


def _named(of, values):
    return {f"{of} {name}".strip().replace("_", " "): value for name, value in values.items()}


def _of_crossovers(setup):
    """Whether yarns are pinned at their crossovers or resolved, and what that means for the result."""
    if setup.crossovers is not None:
        panel = setup.plain_panels()[0]
        zone = replace(panel.resolved, half_width=panel.zone_width)
        sentences = list(zone.assumptions)
        alike = all(fabric.weave.pattern.has_like_crossings for fabric in setup.fabrics)
        if not alike and zone.width < inf:
            sentences.append(MEAN_CROSSING)
        return sentences
    sentences = list(PINNED)
    if not all(fabric.weave.pattern.is_plain for fabric in setup.fabrics):
        sentences.append(FLOATS)
    if setup.plies == 1:
        sentences.append(PUSHED_ASIDE)
    return [*sentences, *map(_sentence, setup.notes)]


def _say_aim(setup, drawn):
    """Say where resolved yarns are struck."""
    if drawn:
        return "The impact point within a cell of the weave is drawn for each shot."
    seed = setup.crossovers.seed
    if seed is not None:
        return f"The impact point within a cell of the weave is drawn, by the seed {seed}."
    along = [point / (2 * w) for point, w in zip(setup.impact_point, setup.fabric.weave.w)]
    if not any(along):
        return "The nose strikes the crossover in the middle."
    beside = " and ".join(f"{share:.3g}" for share in along)
    return f"The nose strikes {beside} spacings beside the crossover in the middle, along warp and weft."


def _between_plies(setup):
    """Friction, gap and contact of the plies of a pack."""
    words = "No friction"
    if setup.ply_friction:
        words = f"Friction {setup.ply_friction:g}"
    if isinstance(setup.ply_friction, Assumed):
        words += f", {setup.ply_friction.words}"
    yield f"{words}."
    gaps = {setup.ply_gap}
    if setup.lay_up:
        gaps = {ply.gap for ply in setup.lay_up[:-1]}
    given = sorted(1e3 * gap for gap in gaps if gap is not None)
    if given:
        yield f"Plies at rest are {' and '.join(f'{gap:g}' for gap in given)} mm apart."
    contact = setup.fabric.ply_contact
    if contact is not None:
        yield f"Their law of pressure is {contact.status}."


def _sentence(words):
    """A sentence with a capital at its beginning, names within it as they are."""
    return f"{words[0].upper()}{words[1:]}."
