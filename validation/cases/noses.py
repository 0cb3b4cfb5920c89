"""The frictions on the nose and between plies of a study's shots.

Those of the thesis have none, and a study of meshes, models or costs compares shots with each other. A study that is
held against tests of others has `nose_friction = "assumed"` in its file: what users get who give none.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from fabrics.base.assumed_number import is_assumed
from fabrics.base.errors import InputError

if TYPE_CHECKING:
    from shellfabric.impact.setup import ImpactSetup

THESIS = 0.0
ASSUMED = "assumed"


def with_friction(setup: ImpactSetup, friction: float | str = THESIS) -> ImpactSetup:
    """Return the set-up with a friction [-] on the nose and none between plies, unless its keywords
    give them; ASSUMED leaves both as they are.

    Raises
    ------
    InputError : another word
    """
    nose = setup.projectile
    if isinstance(friction, str):
        if friction != ASSUMED:
            raise InputError(key="nose_friction", value=friction, allowed=f"a number, or {ASSUMED}")
        return setup
    if is_assumed(setup.ply_friction):
        setup = replace(setup, ply_friction=THESIS)
    if not is_assumed(nose.friction):
        return setup
    return replace(setup, projectile=replace(nose, friction=friction))
