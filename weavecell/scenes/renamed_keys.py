"""Old names of scene keys and result keys, read for one release; docs/keys.md lists them.

A scene with an old key is read as if it had the new one, with one warning line a key. A scene with `format = 2`, or
with an old key beside the new one, is refused.
"""

from __future__ import annotations

import sys

from fabrics.errors import InputError

UNTIL = "the next release"
SCENE_FORMATS = (1, 2)  # 1, or none: old keys are read

SCENE_KEYS = {
    "fabric.cell_form": "fabric.cell_formulation",
    "fabric.gap": "fabric.crossover_gap",
    "fabric.yarn_toe": "fabric.fibre_slack",
    "projectile.bore": "projectile.bore_diameter",
    "panel.gap": "panel.ply_gap",
    "panel.yarns_fail": "panel.yarn_failure",
    "panel.boundary.warp.grip": "panel.boundary.warp.clamp_force",
    "panel.boundary.weft.grip": "panel.boundary.weft.clamp_force",
    "measure": "history",
    "measure.places": "history.report_positions",
    "numerics.safety": "numerics.cfl",
    "backing.room": "backing.standoff",
    "backing.far": "backing.outer_boundary",
    "backing.finest": "backing.min_size",
    "backing.fine": "backing.refined_depth",
    "run.most_iterations": "run.max_iterations",
    "picture_frame.shear": "picture_frame.shear_angle",
    "biaxial.drawn": "biaxial.cross_yarns_removed",
}
SCENE_VALUES = {"projectile.body": {"bar": "elastic_bar"}}


def warn(file, old, new):
    """One line on stderr."""
    print(f"warning: {file}: {old} is now called {new}; the old name is read until {UNTIL}", file=sys.stderr)


def upgraded(table, file):
    """A scene's table with the new names of its keys, in the order of the file; `file` is named in messages.

    Raises
    ------
    InputError : an unknown `format`; an old key in a scene of format 2, or beside the new one
    """
    number = table.get("format", 1)
    if isinstance(number, bool) or number not in SCENE_FORMATS:
        raise InputError(file=file, key="format", value=number, allowed=" or ".join(map(str, SCENE_FORMATS)))
    return _upgraded(table, file, "", number < 2)


def _upgraded(value, file, path, old_allowed):
    """`path` is the old dotted key of the value, which lists share with their entries."""
    if isinstance(value, list):
        return [_upgraded(part, file, path, old_allowed) for part in value]
    if not isinstance(value, dict):
        return _new_value(value, file, path, old_allowed)
    found = {}
    for name, inner in value.items():
        key = f"{path}.{name}" if path else name
        new_key = SCENE_KEYS.get(key, key)
        new_name = new_key.rpartition(".")[2]
        if new_name != name:
            if new_name in value:
                raise InputError(f"is the old name of {new_key}, which is given too", file=file, key=key)
            _old(file, key, new_key, old_allowed)
        found[new_name] = _upgraded(inner, file, key, old_allowed)
    return found


def _new_value(value, file, path, old_allowed):
    new = SCENE_VALUES.get(path, {}).get(value) if isinstance(value, str) else None
    if new is None:
        return value
    _old(file, f'{path} = "{value}"', f'"{new}"', old_allowed)
    return new


def _old(file, old, new, allowed):
    if not allowed:
        raise InputError(f"is called {new} in a scene of format 2", file=file, key=old)
    warn(file, old, new)
