"""What is read off a panel: its shape, tensions, failed yarns, contact pressures, and the pyramid
of its back face."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from fabrics.base import sums
from fabrics.base.checks import BoolArray, FloatArray, IntArray
from shellfabric.membrane import edges
from shellfabric.membrane.slots import by_element, by_node
from shellfabric.state import ERODED

if TYPE_CHECKING:
    from shellfabric.membrane.model import Panel
    from shellfabric.state import State


@dataclass(frozen=True)
class Snapshot:
    """The panel at one instant.

    Parameters
    ----------
    t : [s]
    nose_position : [m] foremost point of the projectile
    projectile_position : (3,) [m] position of its nose
    nodes : (ni+1, nj+1, 3) [m], as projectile_position in the frame of the pack that the panel is
        in; those beyond the edge of the opening on it (`edges.shown`)
    tension : (ni, nj, 2) [N] of warp and weft
    failed : (ni, nj, 3) bool: a warp or a weft at its side failed, element eroded
    pressure : (ni+1, nj+1, k) [Pa] contact force on the node along the panel's normal, over `area`:
        from the projectile (k = 1); in a pack or before a block (k = 3) also from the ply in front
        and from the ply or block behind, all positive where pressed
    area : (ni+1, nj+1) [m2] of the node at rest, of the modelled part
    failed_segments : (ni+1, nj+1, 2) broken edges of warp and weft that begin at the node, in yarn
        segments
    body, plastic : (nodes, 2) [m] r and z of a projectile of metal, its foremost point at z = 0, and
        (elements,) effective plastic strain, both with the first ply; of another body empty
    face : (nx + 1, ny + 1, 3) [m] nodes of the face of the block behind the last ply, in the frame
        of the pack, as the nodes, with the first ply; without a block empty
    yarn_surface, yarn_tension, yarn_family : of resolved yarns (`yarns.drawn.draw_yarns`), in the
        frame of the pack, as the nodes: sections (n, k, 3) [m] about the nodes of the chains, tension
        (n,) [N] to the next node, not a number where there is no segment, and 0 of warp, 1 of weft;
        empty of a ply without them
    resolved : (ni, nj) bool, elements that these yarns stand for; empty without
    """

    t: float
    nose_position: float
    projectile_position: np.ndarray
    nodes: np.ndarray
    tension: np.ndarray
    failed: np.ndarray
    pressure: np.ndarray
    area: np.ndarray
    failed_segments: np.ndarray
    body: np.ndarray = field(default_factory=lambda: np.empty((0, 2)))
    plastic: np.ndarray = field(default_factory=lambda: np.empty(0))
    face: np.ndarray = field(default_factory=lambda: np.empty((0, 0, 3)))
    yarn_surface: np.ndarray = field(default_factory=lambda: np.empty((0, 0, 3)))
    yarn_tension: np.ndarray = field(default_factory=lambda: np.empty(0))
    yarn_family: np.ndarray = field(default_factory=lambda: np.empty(0, np.int8))
    resolved: np.ndarray = field(default_factory=lambda: np.empty((0, 0), bool))


def snapshot(
    panel: Panel,
    state: State,
    t: float,
    pressing: Sequence[FloatArray] = (),
) -> Snapshot:
    """Take a snapshot of a panel's state at the time `t` [s].

    Parameters
    ----------
    pressing : of `loop.pack_solver.PackSolver.normal_contact_forces`
    """
    X, Y = edges.shown(panel)
    nodes = _stacked(panel, state.u)
    nodes[..., 0] += X
    nodes[..., 1] += Y
    position = panel.in_pack(state.projectile_position.copy())
    c = panel.constants()
    broken = failures(c, state)
    z = float(state.projectile_position[2] + panel.projectile.top)
    lost = _stacked(panel, state.failed) * np.stack(panel.segments, axis=2)
    pressure = _stacked(panel, pressing) / panel.areas[..., None]
    return Snapshot(
        t,
        z,
        position,
        panel.in_pack(nodes),
        yarn_tensions(c, state),
        broken,
        pressure.astype(np.float32),
        panel.areas,
        lost.astype(np.float32),
    )


def _stacked(panel, arrays):
    """(ni+1, nj+1, k) of k arrays of slots."""
    found = np.empty((*panel.areas.shape, len(arrays)))
    for number, array in enumerate(arrays):
        found[..., number] = array[: panel.areas.size].reshape(panel.areas.shape)
    return found


def of_plies(solver: Any) -> tuple[Snapshot, ...]:
    """Take snapshots (plies,) of the plies of a PackSolver, counted from the plane of the first ply
    at rest."""
    found: list[Snapshot] = []
    for ply, ((panel, _, state), z) in enumerate(zip(solver.plies, solver.pack.places)):
        one = snapshot(panel, state, solver.time, solver.normal_contact_forces(ply))
        one.nodes[..., 2] += z
        for part in solver.parts[ply]:
            if part.name == "yarns":
                one = replace(one, **part.draw())
                one.yarn_surface[..., 2] += z
        # the position of the nose is counted from the first ply
        nose = (found or [one])[0].projectile_position.copy()
        found.append(replace(one, nose_position=one.nose_position + z, projectile_position=nose))
    body = solver.part("metal")
    if body is not None:
        places, plastic = body.as_it_is()
        found[0] = replace(found[0], body=places, plastic=plastic)
    behind = solver.part("block")
    if behind is not None:
        face = behind.face()
        face[..., 2] += solver.pack.places[-1]
        found[0] = replace(found[0], face=solver.pack.plies[-1].in_pack(face))
    return tuple(found)


def failures(c: Any, state: Any) -> BoolArray:
    """Mark failures (ni, nj, 3) bool: a warp or a weft at its side failed, element eroded; `c` are
    the panel's constants."""
    warp, weft = (by_node(segments, c) != 0 for segments in state.failed)
    eroded = by_element(state.element_flag, c) & ERODED != 0
    return np.stack(
        [warp[:-1, :-1] | warp[:-1, 1:], weft[:-1, :-1] | weft[1:, :-1], eroded], axis=2
    )


def yarn_tensions(c: Any, state: Any) -> FloatArray:
    """Compute the tension (ni, nj, 2) [N] of warp and weft in each element: the mean over its two
    edges, of whole yarn."""
    warp, weft = (by_node((failed == 0) * T, c) for failed, T in zip(state.failed, state.T))
    return np.stack(
        [0.5 * (warp[:-1, :-1] + warp[:-1, 1:]), 0.5 * (weft[:-1, :-1] + weft[1:, :-1])], axis=2
    )


def deflection_profile(
    panel: Panel, shot: Snapshot
) -> tuple[tuple[FloatArray, FloatArray], tuple[FloatArray, FloatArray]]:
    """Return the deflection along the warp and along the weft through the impact point: ((x, z),
    (y, z)) [m]."""
    i, j = panel.nearest_lines
    warp = shot.nodes[:, j]
    weft = shot.nodes[i, :]
    along_warp = sums.multiply(warp[:, :2], panel.axes[0])
    along_weft = sums.multiply(weft[:, :2], panel.axes[1])
    return (along_warp, warp[:, 2]), (along_weft, weft[:, 2])


def pyramid(panel: Panel, shot: Snapshot, share: float = 0.05) -> tuple[float, ...]:
    """Measure the half-diagonals [m] of the deflected pyramid along warp and weft: as far as z
    exceeds `share` of the highest."""
    profiles = deflection_profile(panel, shot)
    highest = max(float(z.max()) for _, z in profiles)
    if not highest > 0:
        return 0.0, 0.0
    return tuple(float(np.abs(x[z > share * highest]).max(initial=0.0)) for x, z in profiles)


def quads(panel: Panel) -> IntArray:
    """List the node numbers (m, 4) of the elements, in the order of a snapshot's nodes as (n,
    3)."""
    ni, nj = panel.counts
    first = (np.arange(ni)[:, None] * (nj + 1) + np.arange(nj)[None, :]).ravel()
    return np.stack([first, first + nj + 1, first + nj + 2, first + 1], axis=1)
