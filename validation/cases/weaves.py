"""Weaves with floats: resolved yarns of a pattern against the cell, which takes all its crossings as one."""

from __future__ import annotations

from math import ceil, inf

import numpy as np

import weavecell as wc
from fabrics.fabric import Fabric
from fabrics.pattern import Pattern
from shellfabric.cell.model import CellModel
from shellfabric.yarns import chain_kernels, zone_kernels
from shellfabric.yarns.patch import YarnPatch
from shellfabric.yarns.state import Zone
from validation.models.variants import with_pattern
from validation.values import Values

CROSSINGS = 12  # along each side of the patch
MIDDLE = 4  # of them at least whose tensions are read, in whole repeats of the pattern
VISCOSITY = 0.3  # damping ratio of its segments
COURANT = 0.5
LED, HELD = 6000, 4000  # time steps in which the rim moves, and rests


def led_apart(*, fabric: str, weave: str, crimp: float, stretch: list[float]) -> Values:
    """Compare the tensions of a patch with those of the cell (`compare_with_cell`).

    Parameters
    ----------
    fabric : name or file
    weave : pattern in which its yarns cross
    crimp : [-] of warp and weft
    stretch : (warp, weft) [-] of the patch, over its length at rest

    Returns
    -------
    dict with warp, weft [-], tension of the patch over that of the cell; taken, whether the cell takes
    the weave; tangled, crossings whose yarns changed sides
    """
    own = with_pattern(wc.fabric(fabric).with_yarns(crimp=crimp), Pattern.read(weave))
    return compare_with_cell(own, stretch)


def compare_with_cell(
    fabric: Fabric, stretch: list[float], first: tuple[int, int] = (0, 0)
) -> Values:
    """Lead the rim of a patch of pinned crossings apart, and compare the mean tensions of the yarns in
    its middle with those of the cell at their mean stretches.

    Parameters
    ----------
    fabric : Fabric
    stretch : (warp, weft) [-]
    first : of YarnPatch

    Returns
    -------
    dict of `led_apart`
    """
    model = CellModel(fabric, mean_crossing=True)
    patch = YarnPatch(
        model,
        (CROSSINGS, CROSSINGS),
        first=first,
        friction=inf,
        rim_rows=0,
        viscosity=VISCOSITY,
        failure=False,
    )
    zone = patch.arrays(COURANT * patch.critical_step)
    _lead_apart(zone, stretch)
    stretches, tensions = _read_middle(patch, zone)
    cell = model.solve(*stretches)
    return {
        "warp": tensions[0] / float(cell["T1"]),
        "weft": tensions[1] / float(cell["T2"]),
        "taken": fabric.weave.pattern.has_like_crossings,
        "tangled": int(zone.tangled),
    }


def _lead_apart(zone: Zone, stretch: list[float]) -> None:
    """Move the tied ends of the yarns apart, and hold them until the yarns rest."""
    tied = zone.tied_node
    from_middle = zone.x[:, tied] - zone.x[:, tied].mean(axis=1, keepdims=True)
    strain = np.array([*stretch, 0.0])
    zone.v[:, tied] = strain[:, None] * from_middle / (LED * zone.dt)
    _march(zone, LED)
    zone.v[:, tied] = 0.0
    _march(zone, HELD)


def _march(zone, steps):
    for _ in range(steps):
        chain_kernels.move(zone)
        zone_kernels.inner_forces(zone)


def _read_middle(patch, zone):
    """([stretch [-] of warp, weft], [tension [N]]), means over whole repeats in the middle."""
    middles = [_middle_of(repeat) for repeat in patch.weave.pattern.matrix.shape]
    stretches = []
    tensions = []
    for family in range(2):
        yarns, crossings = middles[family], middles[1 - family]
        # a yarn has two nodes for a crossing, and two before its first one
        nodes = slice(2 + 2 * crossings.start, 2 + 2 * crossings.stop)
        shape = zone.yarns[family], zone.nodes[family]
        start = zone.first[family]
        own = slice(start, start + np.prod(shape))
        tension = zone.tension[own].reshape(shape)
        place = zone.x[family, own].reshape(shape)[yarns]
        length = place[:, nodes.stop] - place[:, nodes.start]
        at_rest = (crossings.stop - crossings.start) * patch.spacing[family]
        stretches.append(length.mean() / at_rest)
        tensions.append(tension[yarns, nodes].mean())
    return stretches, tensions


def _middle_of(repeat):
    """The yarns in the middle of the patch, of a repeat [yarns]."""
    count = repeat * ceil(MIDDLE / repeat)
    begin = (CROSSINGS - count) // 2
    return slice(begin, begin + count)
