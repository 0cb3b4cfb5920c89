"""Old names of scene keys and result keys, read for one release; docs/keys.md lists them.

A scene with an old key is read as if it had the new one, with one warning line a key. A scene with `format = 2`, or
with an old key beside the new one, is refused.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from typing import Any

from fabrics.checks import FilePath
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

# names in result files before format 2 of summary.json
ENERGIES = {
    "stored": "yarn_strain",
    "cell": "formulation_residual",
    "failed": "failure_dissipation",
    "grip": "clamp_friction",
    "external": "boundary_work",
    "jam": "jamming",
    "plies": "ply_contact",
    "balance": "error",
}
# keys of summary.json, and attributes of histories.h5
SUMMARY_KEYS = {
    "strike_velocity": "strike_velocity_m_s",
    "residual_velocity": "residual_velocity_m_s",
    "mass": "projectile_mass_kg",
    "message": "failure_message",
    "wall_time": "wall_time_s",
    "ns_per_element_step": "element_step_time_ns",
    "max_deflection": "max_deflection_m",
    "end_time": "end_time_s",
    "strike_energy": "strike_energy_J",
    "absorbed": "absorbed_energy_J",
    "worst_balance": "energy_error_max",
    "numerical_share": "viscous_energy_fraction",
    "energies_at_end": "energies_at_end_J",
    **{f"energies_at_end.{old}": f"energies_at_end_J.{new}" for old, new in ENERGIES.items()},
    "rigidity": "rigid_check",
    "plastic_shortening": "plastic_shortening_m",
    "bar_period": "bar_period_s",
    "crater_depth": "crater_depth_m",
    "crater_wall_angle": "crater_wall_angle_rad",
    "gap": "ply_gap_m",
    "energy_of_plies": "ply_energies_J",
    "deepest_over_thickness": "max_penetration_ratio",
    "held_apart": "torn_corrections",
    "not_held_apart": "torn_unresolved",
    "accuracy.asked": "accuracy.targets",
    "accuracy.checked_by": "accuracy.compared_with",
    "accuracy.estimated": "accuracy.estimated_errors",
    "accuracy.full_model_itself": "accuracy.reference_error",
    "accuracy.tried": "accuracy.models_run",
    "moved_name": "prescribed_name",
    "moved_unit": "prescribed_unit",
    "worst_residual": "residual_max",
    "at_the_end": "at_end",
}
# groups and datasets of histories.h5; a * stands for one level
HDF5_KEYS = {
    "histories/t": "histories/time",
    "histories/v": "histories/velocity",
    "histories/z": "histories/nose_position",
    "histories/failed": "histories/failed_segments",
    **{f"energies/{old}": f"energies/{new}" for old, new in ENERGIES.items()},
    "panel/middle": "panel/half_energy",
    "panel/last": "panel/final",
    **{
        f"{group}/*/{old}": f"{group}/*/{new}"
        for group in ("panel", "shapes")
        for old, new in (("t", "time"), ("z", "nose_position"), ("nose", "projectile_position"), ("broken", "failed"))
    },
    "measured/t": "measured/time",
    "measured/yarns/*/place": "measured/yarns/*/position",
    "measured/fronts/*/place": "measured/fronts/*/position",
    "bar/t": "bar/time",
    "backing/gone": "backing/eroded",
    "plies/places": "plies/z_rest",
    "plies/deepest": "plies/max_penetration_ratio",
    "plies/held_apart": "plies/torn_contact",
    "cuts/*/t": "cuts/*/time",
    "cuts/*/nose": "cuts/*/nose_position",
    "last": "final",
}


def new_path(path: str, names: Mapping[str, str], separator: str = "/") -> str:
    """The name of today of a group or dataset, or with "." of a key, of `names` ({old: new}, * for one level)."""
    parts = path.split(separator)
    found = []
    for n in range(len(parts)):
        patterns = (old for old in names if _matches(parts[: n + 1], old.split(separator)))
        old = next(patterns, None)
        found.append(parts[n] if old is None else names[old].rpartition(separator)[2])
    return separator.join(found)


def _matches(parts, pattern):
    return len(parts) == len(pattern) and all(part == other or other == "*" for part, other in zip(parts, pattern))


def warn_of_format(file: FilePath, number: int) -> None:
    """One line on stderr for a whole result file."""
    print(
        f"warning: {file}: format {number} has old names of keys (docs/keys.md); it is read until {UNTIL}",
        file=sys.stderr,
    )


def warn(file: FilePath, old: str, new: str) -> None:
    """One line on stderr."""
    print(f"warning: {file}: {old} is now called {new}; the old name is read until {UNTIL}", file=sys.stderr)


def upgraded(table: Mapping[str, Any], file: FilePath | None) -> dict[str, Any]:
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
