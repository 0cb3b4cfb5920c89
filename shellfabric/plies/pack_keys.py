"""Numbers of a pack, each declared once, as `PanelNumbers` are. It imports no solver: an input file is
checked without one.

Models: a single "ply"; a "pack" of plies alike; and a "lay_up", of which each ply has a table of its own.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any

from pydantic import BeforeValidator, WithJsonSchema

from fabrics.base.schema import (
    TEXT,
    MayBeObject,
    NoPlace,
    described,
    in_python,
    key,
    named,
    number,
    quantity,
    whole,
)

MOST_PLIES = 100
STACKINGS = ("aligned", "alternating")


def _ply_contact(value, info):
    """A law of plies as it is named; in Python it may be an object."""
    known = value in (None, "solid", "pressure_law") or str(value).endswith((".json", ".csv"))
    if known or in_python(info):
        return value
    raise ValueError("no law")


@dataclass(frozen=True, kw_only=True)
class PackNumbers:
    """Numbers of a pack that keys of the table [panel] and the set-up have alike."""

    plies: Annotated[
        int,
        key(
            whole("number of plies; above 1 a pack with contact between plies", 1, MOST_PLIES),
            "ply pack",
        ),
    ] = 1
    stacking: Annotated[
        str,
        key(named("pack: all plies alike, or every second turned by 90 deg", *STACKINGS), "pack"),
    ] = STACKINGS[0]
    ply_gap: Annotated[
        float | None,
        key(
            quantity(
                "pack: clearance between plies at rest; if not given the gap of the fabric file, else an assumed gap "
                "with a range ([Packs](../pack.md))",
                "m",
                "0.12 mm",
                zero=True,
                ranged=True,
            ),
            "pack lay_up",
        ),
    ] = None


@dataclass(frozen=True, kw_only=True)
class PackKeys(PackNumbers):
    """What a table [panel] says of a pack: besides its numbers the law of the contact, which becomes one of
    the fabric, and the friction, which is assumed of the fabric if it is not given."""

    ply_contact: Annotated[
        Any,
        key(
            Annotated[
                Any,
                BeforeValidator(_ply_contact),
                WithJsonSchema(TEXT),
                described(
                    "pack: law of pressure against closure between two plies; if not given the law in the file of "
                    "`fabric.law`, in the fabric file, or of solid fibre, in this order ([theory](../theory-panel.md))",
                    '"solid", "pressure_law", or the path of a law.json of `weavecell calibrate` or of a *.csv',
                ),
            ],
            "pack lay_up",
        ),
        MayBeObject(),
        NoPlace("export", "contact has the stiffness of the code"),
    ] = None
    ply_friction: Annotated[
        float | None,
        key(
            number(
                "pack: Coulomb coefficient between plies; if not given assumed, by the fibre family",
                0.3,
                ranged=True,
                ge=0.0,
                le=2.0,
            ),
            "pack lay_up",
        ),
    ] = None
