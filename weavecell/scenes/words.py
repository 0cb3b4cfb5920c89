"""Projectile and panel of a scene in words."""

from __future__ import annotations

from math import degrees

from shellfabric.projectile.shapes import SHAPES
from weavecell.scenes.impact import BackingTable, ProjectileTable
from weavecell.scenes.panel import PanelTable


def shot_in_words(shot: ProjectileTable) -> str:
    """Describe the projectile and how it comes, for the reader."""
    words = ""
    if shot.name:
        words = f"{shot.name}, "
    words += (
        f"{SHAPES[shot.shape].words} of {1e3 * shot.mass:.4g} g and {1e3 * shot.diameter:.4g} mm"
    )
    if shot.obliquity:
        words += f", {degrees(shot.obliquity):.3g}° off the normal"
    if shot.yaw:
        words += f", its axis {degrees(shot.yaw):.3g}° off its flight"
    if shot.body == "elastic_bar":
        words += ", elastic-plastic along its axis"
    if shot.body == "metal":
        words += f", of {shot.core or 'lead'}"
        if shot.jacket_thickness:
            words += f" in a jacket of {1e3 * shot.jacket_thickness:.3g} mm of {shot.jacket}"
    if shot.friction:
        words += f", with friction {shot.friction:g}"
    return words


def backing_in_words(block: BackingTable) -> str:
    """Describe the block behind the last ply, for the reader."""
    size = " x ".join(f"{1e3 * side:g}" for side in block.size)
    return f"a block{f' of {block.material}' if block.material else ''}, {size} mm"


def panel_in_words(panel: PanelTable) -> str:
    """Describe the panel and how it is held, for the reader."""
    if isinstance(panel.opening, tuple):
        words = " by ".join(f"{1e3 * side:g} mm" for side in panel.opening)
    else:
        words = (
            f"{1e3 * panel.opening:g} mm {'round' if panel.opening_shape == 'round' else 'square'}"
        )
    if panel.impact_point is not None and any(panel.impact_point):
        words += (
            f", struck {' and '.join(f'{1e3 * x:g}' for x in panel.impact_point)} mm off its middle"
        )
    if panel.weave_angle:
        words += f", its weave turned by {degrees(panel.weave_angle):.3g}°"
    if isinstance(panel.boundary, str):
        return f"{words} and {panel.boundary}"
    ends = " and ".join(
        f"{name} ends {_side_in_words(side)}" for name, side in panel.boundary.sides.items()
    )
    return f"{words}, {ends}"


def _side_in_words(side):
    if isinstance(side, tuple):
        return " / ".join(_side_in_words(end) for end in side)
    if isinstance(side, str):
        return side
    if side.clamp_force is not None:
        return f"clamped with {side.clamp_force:g} N a yarn"
    return f"slipping by {1e3 * side.pull_in:g} mm"
