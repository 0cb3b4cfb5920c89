"""What is sampled of one ply: its energies, cut yarns, edge reactions and deflection.

The energy that the yarns store follows from their stretches. The work done on them is more. In the
equilibrium form, whose forces are no gradient, the difference is the energy "formulation_residual".
In the variational form it is "yarn_snap": what the trapezoid of a step takes where yarns stiffen in
it (`membrane_kernels.pull_yarns`). The energy error is what is then left; quality checks hold
both.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fabrics.base.checks import BoolArray, FloatArray
from shellfabric.loop import ply_kernels as kernels
from shellfabric.loop.snapshots import yarn_tensions
from shellfabric.membrane import grading
from shellfabric.membrane.slots import by_element, by_node
from shellfabric.parts import parts_of

if TYPE_CHECKING:
    from shellfabric.membrane.model import Panel
    from shellfabric.state import Constants, State


def energies(const: Constants, state: State, rest: float) -> dict[str, float]:
    """Compute {name: [J]} of the modelled part of a ply, with those of its parts.

    Parameters
    ----------
    state : State whose contact forces are those of all that touches the ply
    rest : [J] stored at rest
    """
    out = audited(const, state)
    found = {
        "kinetic_fabric": out[kernels.KINETIC] + state.gripped_kinetic_energy,
        "yarn_strain": out[kernels.STORED],
        "formulation_residual": 0.0,
        "yarn_snap": 0.0,
        "shear": out[kernels.SHEAR],
        "bending": 0.0,
        "packing": 0.0,
        "viscous": float(state.viscous_work.sum()),
        "contact": state.contact_work,
        "friction": state.nose_friction_work,
        "failure_dissipation": state.lost_with_yarns + state.lost_with_elements,
        "clamp_friction": state.clamp_friction_work,
        "boundary_work": state.boundary_work,
    }
    # work of the forces that is neither stored nor lost, of either form
    form = "formulation_residual"
    if const.variational:
        form = "yarn_snap"
    found[form] = (
        float(state.edge_work.sum()) - (out[kernels.STORED] - rest) - state.lost_with_yarns
    )
    parts = parts_of(state.parts)
    for part, stored in zip(parts, out[kernels.PARTS :]):
        if part.energy:
            found[part.energy] = found.get(part.energy, 0.0) + stored
    for part in parts:
        if part.of_ply:
            add_energies(found, part.energies())
            found["kinetic_fabric"] += part.pushed(state)
    return found


def add_energies(total: dict[str, float], energies: dict[str, float]) -> None:
    """Add energies {name: [J]} to a total, which gets the names that it does not have."""
    for name, energy in energies.items():
        total[name] = total.get(name, 0.0) + energy


def stored_energy(const: Constants, state: State) -> float:
    """Compute the energy [J] that the yarns of the modelled part store."""
    return float(audited(const, state)[kernels.STORED])


def audited(const: Constants, state: State) -> FloatArray:
    """Compute the energies (n,) [J] that `ply_kernels.energies` finds."""
    out = np.empty(kernels.PARTS + state.parts.forces.size)
    kernels.energies(state, const, out)
    return out


def cut_yarns(panel: Panel, const: Constants, state: State) -> float:
    """Cut yarns of the whole ply, however often each is cut; of a yarn of several grid lines the
    part that is cut.

    A line stands for the yarns up to halfway to its neighbours. A plane of symmetry across a yarn
    makes no second one of it, a plane along it does.
    """
    total = 0.0
    for family, count in enumerate((panel.weave.warp_count, panel.weave.weft_count)):
        broken = by_node(state.failed[family], const) != 0
        edges = np.moveaxis(broken, family, 0)[:-1]  # along the family, lines
        yarns = (
            count
            * grading.tributary(np.diff(panel.lines()[1 - family]))
            * (1 + panel.mirrors[1 - family])
        )
        total += float(yarns[edges.any(axis=0)].sum())
    return total


def edge_reactions(
    panel: Panel, const: Constants, state: State, ends: tuple[tuple[int, int], tuple[int, int]]
) -> tuple[float, float]:
    """Compute the tension (warp, weft) [N] at the edge of the yarns nearest the impact point; ends
    : `edges.ends`."""
    warp_node, weft_node = (i * const.row_stride + j for i, j in ends)
    warp = -(state.f_int[0][warp_node] + state.f_int_above[0][warp_node]) * panel.weave.w2 * 2
    weft = -(state.f_int[1][weft_node] + state.f_int_above[1][weft_node]) * panel.weave.w1 * 2
    # of a yarn on a plane of symmetry half is in the model
    width_y = const.dy
    if const.mirror_y:
        width_y *= 0.5
    width_x = const.dx
    if const.mirror_x:
        width_x *= 0.5
    return warp / width_y, weft / width_x


def deflection(const: Constants, state: State, held: BoolArray | None) -> float:
    """Find the largest displacement [m] along the normal, of a node at the corner of a whole
    element connected to the edges.

    held : `perforation.held`, or None where no yarn has failed
    """
    z = by_node(state.u[2], const)
    if held is None:
        return float(z.max(initial=0.0))
    whole = held & (by_element(state.element_flag, const) == 0)
    return float(z[:-1, :-1].max(initial=0.0, where=whole))


def pull_in(const: Constants, state: State) -> float:
    """Find the largest way [m] of a node of a slipping side along the yarn that ends there; 0 if no
    side slips."""
    return float(np.abs(np.array(state.u)[const.slip_axis, const.slip_node]).max(initial=0.0))


def critical_strains(panel: Panel, const: Constants, state: State) -> tuple[float, float]:
    """Compute the strains (warp, weft) [-] of the fabric in the element whose yarn bears the largest
    share of its strength at this instant (thesis Figure 5-54)."""
    shares = (yarn_tensions(const, state) / panel.strengths).max(axis=2)
    i, j = np.unravel_index(int(np.argmax(shares)), shares.shape)
    warp, weft = (by_node(stretch, const) for stretch in state.stretch)
    # the two edges of the element along each family
    along_warp = 0.5 * (warp[i, j] + warp[i, j + 1])
    along_weft = 0.5 * (weft[i, j] + weft[i + 1, j])
    return float(along_warp) - 1, float(along_weft) - 1


def peak_tensions(panel: Panel, const: Constants, state: State, steps: int) -> FloatArray:
    """Return (2, 4) of warp and weft: highest tension [N] of a yarn segment so far, its time
    [s], and where the middle of the segment is at rest along warp and weft [m]; NaN but for the
    tension if there was none.

    steps : steps of the run; a ply of a pack counts its own from when it is first touched
    """
    found = np.full((2, 4), np.nan)
    found[:, 0] = state.peak_tension
    for family, (slot, step) in enumerate(zip(state.peak_slot, state.peak_step)):
        if step > 0:
            place = list(divmod(int(slot), const.row_stride))
            lines = panel.lines()
            found[family, 1] = const.dt * (step + steps - state.steps)
            found[family, 2:] = [lines[axis][at] for axis, at in enumerate(place)]
            found[family, 2 + family] = 0.5 * (
                lines[family][place[family]] + lines[family][place[family] + 1]
            )
    return found
