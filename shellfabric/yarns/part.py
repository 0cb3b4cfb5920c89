"""The zone of resolved yarns of a panel in a run: what it replaces, its energies, and what pictures
show."""

from __future__ import annotations

from typing import Any

import numpy as np

from fabrics.base import sums
from fabrics.base.checks import FloatArray, IntArray
from shellfabric.guards import speed_limit
from shellfabric.membrane import quality
from shellfabric.membrane.indicator import Indicator
from shellfabric.parts import Part
from shellfabric.state import Constants, State
from shellfabric.yarns import coupling_kernels
from shellfabric.yarns.drawn import draw_yarns
from shellfabric.yarns.patch import kinetic_energy
from shellfabric.yarns.state import Zone

# energies of a zone that a ply without one does not have
ENERGIES = ("crossover_contact", "neighbour_contact", "crossover_friction", "slack_contact")


class ResolvedYarns(Part):
    """The resolved yarns of a panel, which take the place of the membrane about the nose.

    Parameters
    ----------
    panel : yarns.model.YarnPanel
    """

    name = "yarns"
    energy = ENERGIES[0]
    forces = coupling_kernels.yarn_forces
    nose = coupling_kernels.march_zone

    def __init__(self, panel: Any) -> None:
        self.panel = panel
        self.zone = panel.zone()
        self.row = self.zone

    def cut(self, state: State) -> None:
        """Take the membrane inside the rim out of a state, see Part."""
        self.panel.cut_out(state)

    def identity(self) -> tuple[Any, ...]:
        """Return what determines the zone, see Part."""
        patch = self.panel.patch
        drawn = patch.crossings, patch.origin, patch.law, patch.beside, patch.amplitudes
        return self.name, self.panel.resolved, *drawn, patch.images, patch.middle, patch.first

    def begin(self, state: State, const: Constants, stack: Any) -> None:
        """Know the ply of the zone, see Part."""
        self._ply = const, state

    def energies(self) -> dict[str, float]:
        """Return {energy: [J]} besides that of the crossings, by the names that its ply's have, or
        of ENERGIES."""
        zone = self.zone
        return {
            "kinetic_fabric": kinetic_energy(zone),
            "yarn_strain": float(zone.stored),
            "yarn_snap": float(zone.lost_in_snaps),
            "viscous": float(zone.damped),
            "failure_dissipation": float(zone.lost_with_yarns),
            "neighbour_contact": float(zone.stored_at_neighbours),
            "crossover_friction": float(zone.friction_work),
            "slack_contact": float(zone.lost_when_slack),
        }

    def energy_made(self) -> dict[str, float]:
        """Return the energy [J] that the yarns have made by themselves, and that their tie to rim and
        nose has, see Part. In a pack nobody books what other plies push the yarns by."""
        zone = self.zone
        if zone.has_shadow:
            return {}
        own = kinetic_energy(zone) + coupling_kernels.stored_and_lost(zone) + zone.given_work
        tie = zone.taken_work - zone.given_work
        return {"the resolved yarns": float(own), "the rim of the resolved yarns": float(tie)}

    def pushed(self, state: State) -> float:
        """Return the kinetic energy [J] that the coming half step's pushes on shadow nodes bring,
        see Part."""
        if not self.zone.has_shadow:
            return 0.0
        own = self.zone.mirror_first
        slots = shadow_slots(self.zone)[max(own[1], 0) :, max(own[0], 0) :].ravel()
        power = sum(sums.dot(v[slots], f[slots]) for v, f in zip(state.v, state.f_contact))
        if state.f_block_cloth[2].size > 0:
            power += sum(sums.dot(v[slots], f[slots]) for v, f in zip(state.v, state.f_block_cloth))
        return 0.5 * self.zone.dt * power

    def show(self, state: State) -> None:
        """Put the membrane where the yarns are, see Part; shadow nodes are there."""
        show(self.zone, state)

    def draw(self) -> dict[str, Any]:
        """Return what a snapshot has of the yarns (`drawn.draw_yarns`)."""
        return draw_yarns(self.zone, self.panel)

    def speeds(self, strike_velocity: float) -> tuple[FloatArray, float]:
        """Return the speeds of the yarns' nodes, see Part."""
        limit = speed_limit(strike_velocity, self.panel.weave.yarns)
        return np.sqrt((self.zone.v**2).sum(axis=0)), limit

    def where(self, node: int) -> str:
        """Say where a node is, see Part."""
        zone = self.zone
        family = int(node >= zone.first[1])
        yarn, number = divmod(int(node - zone.first[family]), int(zone.nodes[family]))
        x, y = 1e3 * zone.x[:2, node]
        name = ("warp", "weft")[family]
        return f"node {number} of the resolved {name} yarn {yarn} (x = {x:.1f} mm, y = {y:.1f} mm)"

    def guard(self, state: State) -> tuple[str, str] | None:
        """Check that the projectile keeps to the zone, see Part."""
        nose = state.projectile_position
        if self.panel.holds_nose(nose):
            return None
        x, y = 1e3 * nose[:2]
        return (
            "the projectile leaves the zone of resolved yarns",
            f"its nose at x = {x:.1f} mm, y = {y:.1f} mm",
        )

    def indicators(self) -> tuple[Indicator, ...]:
        """Return crossings whose yarns have changed sides, and the nodes past the next ply, see Part."""
        checks = [quality.indicator("yarns that changed sides", self.zone.tangled)]
        if self.panel.among_plies:
            share = self.zone.most_past / np.count_nonzero(self.zone.node_share)
            checks.append(quality.indicator("yarns past the next ply", share))
        return tuple(checks)


def shadow_slots(zone: Zone) -> IntArray:
    """Return the slots (warp yarns, weft yarns) of the membrane's nodes at the crossings at
    rest."""
    warp = int(zone.yarns[0])
    rows = zone.tied_slot[2 * warp :: 2]  # slots of the rim at which the weft yarns begin
    return rows[None, :] + np.arange(warp)[:, None] + 1


def show(zone: Zone, state: State) -> None:
    """Put the membrane inside the rim where the yarns are, with their tensions, for pictures,
    histories and the deflection. Its nodes bear and weigh nothing.

    A crossing of which a yarn is torn is where the other one is, and stays if both are.
    """
    warp, weft = (int(count) for count in zone.yarns)
    slots = shadow_slots(zone)
    stride = slots[0, 1] - slots[0, 0]
    moved = np.zeros((warp, weft, 3))
    count = np.zeros((warp, weft))
    for family in range(2):
        last = zone.first[family] + zone.yarns[family] * zone.nodes[family]
        own = slice(zone.first[family], last)
        shape = (int(zone.yarns[family]), int(zone.nodes[family]))
        place = zone.x[:, own].T.reshape(*shape, 3)[:, 2:-2:2]
        whole = np.broadcast_to(~zone.torn[family, : shape[0], None], place.shape[:2])
        if family == 1:
            place, whole = place.swapaxes(0, 1), whole.swapaxes(0, 1)
        moved += whole[..., None] * place
        count += whole
        tension = zone.tension[own].reshape(shape)[:, :-1].reshape(shape[0], -1, 2).mean(axis=2)
        begin = zone.tied_slot[2 * warp * family :][: 2 * shape[0] : 2]
        steps = (stride, 1)[family] * np.arange(tension.shape[1])
        at = begin[:, None] + steps
        own_y = np.arange(shape[0])[:, None] >= zone.mirror_first[1 - family]
        own_k = np.arange(tension.shape[1])[None, :] > zone.mirror_first[family]
        real = np.broadcast_to(own_y & own_k, at.shape)
        state.T[family][at[real]] = tension[real]
    if zone.has_shadow:
        return
    shown = count > 0
    shown &= np.arange(warp)[:, None] >= zone.mirror_first[1]
    shown &= np.arange(weft)[None, :] >= zone.mirror_first[0]
    slots = slots[shown]
    moved /= np.maximum(count, 1)[..., None]
    moved[..., 0] -= zone.tied_rest[2 * warp :: 2, 0]
    moved[..., 1] -= zone.tied_rest[: 2 * warp : 2, 1, None]
    for c in range(3):
        state.u[c][slots] = moved[..., c][shown]
