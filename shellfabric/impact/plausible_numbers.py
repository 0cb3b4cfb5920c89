"""Numbers of a set-up beside those of its fabrics, which are compared with `fabrics.plausible`."""

from __future__ import annotations

from collections.abc import Iterator
from math import cos, isfinite, pi
from typing import Any

import numpy as np

from fabrics import plausible
from fabrics.plausible import Number
from shellfabric.membrane.boundary import Grip, PullIn

# [kg/m3] steel, of which a projectile without a length is taken to be
_STEEL = 7850.0


def list_numbers(setup: Any) -> Iterator[Number]:
    """List the numbers of an ImpactSetup, or the groups that they belong to, with their keys."""
    yield from _of_projectile(setup)
    yield from _of_panel(setup)
    yield from _of_plies(setup)
    shape = setup.strength and setup.strength.weibull_shape
    if shape is not None and isfinite(shape):
        yield Number("panel.strength.weibull_shape", "weibull_shape", shape)
    if setup.crossovers is not None or setup.instead is not None:
        yield from _of_zone(setup)
    if setup.backing is not None:
        yield from _of_block(setup)
    yield from _of_times(setup)
    yield from _of_numerics(setup)


def _of_projectile(setup):
    projectile = setup.projectile
    yield Number("projectile.strike_velocity", "strike_velocity", setup.strike_velocity)
    yield Number("projectile.friction", "friction", projectile.friction)
    if projectile.known.edged:
        ratio = projectile.edge_radius / projectile.radius
        yield Number("projectile.edge_radius", "edge_radius", ratio)
    if projectile.tip_radius is not None:
        # the circle on which the rounding goes over into the flank
        ratio = projectile.tip_radius * cos(projectile.half_angle) / projectile.radius
        yield Number("projectile.tip_radius", "tip_radius", ratio)
    for key in ("nose_length", "tip_diameter"):
        length = getattr(projectile, key)
        # an ogive may be flat, and its tip be none
        if length:
            yield Number(f"projectile.{key}", key, length / (2 * projectile.radius))
    diameter = 2 * projectile.radius
    section = pi * projectile.radius**2
    length = projectile.length
    if not projectile.known.edged:
        length = 2 / 3 * diameter
    # a bar is bored to its mass, and a body from a file has its own check
    if projectile.known.from_file or projectile.body != "rigid":
        return
    if length is None:
        ratio = projectile.mass / (_STEEL * section * diameter)
        yield Number("projectile.mass", "projectile_length", ratio)
    else:
        density = projectile.mass / (section * length)
        yield Number("projectile.mass", "projectile_density", density)


def _of_panel(setup):
    smaller = float(np.min(setup.opening))
    ratio = smaller / (2 * setup.projectile.radius)
    yield Number("panel.opening", "opening", ratio)
    strength = setup.fabric.weave.warp.strength
    for side in _sides(setup.boundary):
        if isinstance(side, Grip):
            ratio = side.clamp_force / strength
            yield Number("panel.boundary.clamp_force", "clamp_force", ratio, setup.fabric.idealised)
        elif isinstance(side, PullIn):
            yield Number("panel.boundary.pull_in", "pull_in", side.pull_in / smaller)
            yield Number("panel.boundary.zone", "pull_in_zone", side.zone / smaller)


def _sides(boundary):
    """Each side of a boundary, of those that are given together."""
    if isinstance(boundary, tuple):
        for side in boundary:
            yield from _sides(side)
    else:
        yield boundary


def _of_plies(setup):
    thickness = setup.fabric.weave.thickness
    taken = setup.fabric.idealised
    gaps = [("panel.ply_gap", setup.ply_gap)]
    gaps += [("panel.ply.gap", ply.gap) for ply in setup.lay_up]
    for key, gap in gaps:
        if gap is not None and thickness > 0:
            yield Number(key, "ply_gap", gap / thickness, taken)
    yield Number("panel.ply_friction", "friction", setup.ply_friction)
    if thickness > 0:
        gap = setup.crossover_gap / thickness
        yield Number("fabric.crossover_gap", "crossover_gap", gap, taken)
    for yarn, bending in zip(setup.fabric.weave.yarns, np.broadcast_to(setup.bending, 2)):
        # of a round rod of its fibres, which would be as stiff as a yarn can be
        rod = yarn.EA * yarn.A_s / (4 * pi)
        yield Number("fabric.bending", "bending", float(bending) / rod, taken)


def _of_zone(setup):
    zone = setup.crossovers or setup.instead
    if isfinite(zone.friction):
        yield Number("panel.crossover_friction", "friction", zone.friction)
    if zone.half_width is not None and isfinite(zone.half_width):
        ratio = zone.half_width / setup.projectile.radius
        yield Number("panel.zone", "zone", ratio)


def _of_block(setup):
    yield from plausible.of_block(setup.backing.material)
    smaller = float(np.min(setup.opening))
    yield Number("backing.standoff", "block_standoff", setup.backing.standoff / smaller)
    yield Number("backing.size", "block_size", max(setup.backing.size) / smaller)
    depth = setup.backing.refined_depth / (2 * setup.projectile.radius)
    yield Number("backing.refined_depth", "refined_depth", depth)
    yield Number("backing.growth", "block_growth", setup.backing.growth)
    strain = setup.backing.material.erosion_strain
    # a block that is never eroded
    if isfinite(strain):
        yield Number("backing.erosion_strain", "erosion_strain", strain)


def _of_times(setup):
    """The end of the run over the time of the tension wave from the impact point to the nearest edge."""
    ways = 0.5 * np.broadcast_to(setup.opening, 2) - np.abs(setup.impact_point)
    speeds = [setup.fabric.weave.tension_wave_speed(family) for family in (0, 1)]
    reached = float(np.min(ways / speeds))
    # an impact point on the edge, or beyond it, is refused by the panel
    if reached > 0:
        yield Number("run.end_time", "end_time", setup.end_time / reached)


def _of_numerics(setup):
    numerics = setup.numerics
    for key in ("nose_stiffness", "contact_damping", "erosion_gap"):
        yield Number(f"numerics.{key}", key, getattr(numerics, key))
