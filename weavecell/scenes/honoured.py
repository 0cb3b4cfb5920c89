"""Keys of an input file that a function does not honour. One that is set is refused; none is passed
over.

Of each function {key or table: what is allowed}, completing "must be ..."; None of what means
nothing to the function by its definition, such as the strike velocity of a scene whose ballistic
limit is computed, and is therefore silent.
All other keys are honoured, new ones too. A test finds one that does not reach the solver.

A key at its default value counts as not set: it changes nothing, since every function does what the
defaults of the keys that it refuses describe (one ply, no block, no [history]).
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import accumulate
from typing import Any, TypeAlias

from fabrics.base.checks import FilePath
from fabrics.base.errors import InputError
from fabrics.base.schema import Table, changed, written

Keys: TypeAlias = dict[str, str | None]


def silent(table: str, names: str) -> Keys:
    """List the keys of a table, in one text, that mean nothing to a function by its definition:
    they are passed over in silence."""
    return dict.fromkeys(f"{table}.{name}".lstrip(".") for name in names.split())


NO_HISTORY = "left out: the shots record nothing along yarns; `weavecell impact` does"
IMPACT: Keys = {}
UNWRITTEN = silent(
    "run", "snapshot_interval checkpoint_interval outputs"
)  # by functions that shoot many times
SHOTS: Keys = (
    IMPACT
    | UNWRITTEN
    | {"accuracy": "left out: the shots are computed on the mesh of the input file"}
)
LIMITS: Keys = (
    SHOTS
    | {"title": None, "history": NO_HISTORY}
    | silent("", "projectile.strike_velocity run.end_time backing.after_stop")
)
V50: Keys = LIMITS | {"panel.strength": "left out: a V50 draws the strengths itself"}
SWEEP: Keys = SHOTS | {
    "title": None,
    "history": "left out: a sweep records nothing along yarns; `weavecell impact` does",
}
# a patch has edges, mesh and length of its own
PATCH: Keys = (
    UNWRITTEN
    | silent(
        "",
        "title history accuracy run.end_time panel.preset panel.opening panel.opening_shape panel.impact_point "
        "panel.aim_seed panel.zone panel.boundary panel.symmetry panel.weave_angle",
    )
    | {
        "fabric.bending": "left out: the yarns of a patch have no bending stiffness of their own",
        "numerics": "left out: solid yarns have numerical parameters of their own, and all models are compared at "
        "their defaults",
    }
)
COUPON: Keys = {"fabric.surface": "left out: the cell of a coupon is made from laws"}


def check(scene: Table, table: Mapping[str, Any], file: FilePath | None, refused: Keys) -> None:
    """Raise an InputError for the first key that a scene sets and a function refuses.

    Parameters
    ----------
    scene : the checked scene
    table : the same as it is written, for the value in the message
    """
    for name in (name for key in changed(scene) for name in with_tables(key)):
        if allowed := refused.get(name):
            raise InputError(file=file, key=name, value=written(table, name), allowed=allowed)


def with_tables(key: str) -> list[str]:
    """List the tables that a dotted key is in, from the outermost, and the key."""
    return list(accumulate(key.split("."), "{}.{}".format))
