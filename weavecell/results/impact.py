"""What an impact on one ply leaves, in one HDF5 file (histories.h5): scalars, histories, and the panel at the end.

Layout, besides the common part (`results.impact_base`): /reactions with one value an instant; /panel with the shape
and state at two instants; /measured, where a scene asks for it, with histories along yarns (samples by elements or
nodes), the forces on the edges (pull, lift) and the fronts; /bar, of an elastic projectile, with the histories of tip,
tail and centre of mass; /backing, of a block, with its quarter at the end.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from weavecell.results import keys
from weavecell.results.hdf5_file import put
from weavecell.results.impact_base import BaseRecord
from weavecell.results.impact_groups import SLIP, read_group, read_measured, write_group, write_measured
from weavecell.results.impact_shapes import Cut, Shape, read_shape, write_shape

if TYPE_CHECKING:
    from shellfabric.backing.coupling import BackingResult
    from shellfabric.impact.single_ply import ImpactResult
    from shellfabric.output.histories import Histories
    from shellfabric.projectile.dynamics import BarHistory
    from shellfabric.sliding.solver import SlipSummary

_PANEL = keys.units(keys.PANEL)


@dataclass(frozen=True, kw_only=True)
class ImpactRecord(BaseRecord):
    """One impact on one ply; further fields as in `BaseRecord`.

    Parameters
    ----------
    reactions : {"warp", "weft": (n,)} [N] tension at the clamped end of the yarn nearest the impact point
    quads : (m, 4) node numbers
    half_energy, final : Shape when the projectile had lost half of the energy that it lost (the snapshot nearest to
        it), and at the end
    rigid_check : whether a rigid projectile is justified, in words; "" where that is not known
    measured : shellfabric.output.histories.Histories, or None where nothing was to be recorded
    bar : shellfabric.projectile.dynamics.BarHistory of an elastic projectile, or None
    backing : shellfabric.backing.coupling.BackingResult, the block at the end, or None
    slip : shellfabric.sliding.solver.SlipSummary of sliding crossovers, or None
    """

    KIND = "impact"
    OWN_SCALARS = {"rigid_check": "rigid_check"}  # noqa: RUF012

    reactions: dict
    quads: np.ndarray
    half_energy: Shape
    final: Shape
    rigid_check: str = ""
    measured: Histories | None = None
    bar: BarHistory | None = None
    backing: BackingResult | None = None
    slip: SlipSummary | None = None

    @classmethod
    def of(cls, result: ImpactResult, title: str, law_name: str, message: str = "") -> ImpactRecord:
        """The record of a `shellfabric.impact.single_ply.ImpactResult`."""
        (ni, nj), (_, mirror_y) = result.panel.counts, result.mirrored
        last = Shape(
            float(result.t[-1]), float(result.nose_position[-1]), result.projectile_position, result.nodes,
            result.tension, result.failed,
        )  # fmt: skip
        grid = replace(last, nodes=last.nodes.reshape(ni + 1, nj + 1, 3), failed=last.failed.reshape(ni, nj, 3))
        shots = (*(shot for shot in result.snapshots if shot.t < last.t), grid)
        return cls._of(
            result, result.setup, title, law_name, message, elements=result.panel.elements,
            strength=np.array([yarn.strength for yarn in result.setup.fabric.weave.yarns]),
            thickness=np.array([result.panel.weave.thickness]),
            cuts=tuple(Cut.of((shot,), mirror_y) for shot in shots),
            reactions=dict(result.reactions), quads=result.quads, half_energy=_half_energy(result, last), final=last,
            measured=result.histories, rigid_check=str(result.rigidity or ""), bar=result.bar, backing=result.backing,
            slip=result.slip,
        )  # fmt: skip

    @property
    def drawn_shapes(self) -> tuple[Shape, Shape]:
        """See BaseRecord."""
        return self.half_energy, self.final

    @property
    def rear_quads(self) -> np.ndarray:
        """See BaseRecord."""
        return self.quads

    def _entries(self):
        found = {"failed_yarn_segments": int(self.failed_segments[-1])}
        if self.bar is not None:
            found |= {"plastic_shortening_m": self.bar.shortening, "bar_period_s": self.bar.period}
        if self.backing is not None:
            found |= {"crater_depth_m": self.backing.depth, "crater_wall_angle_rad": self.backing.steepness}
        if self.slip is not None:
            found |= {key: getattr(self.slip, name) for name, key in SLIP.items()}
        return found

    def _write(self, file):
        for name, unit in _PANEL.items():
            put(file, f"panel/{name}", getattr(self, name), unit)
        for shape in ("half_energy", "final"):
            write_shape(file, f"panel/{shape}", getattr(self, shape))
        for name, values in self.reactions.items():
            put(file, f"reactions/{name}", values, "N")
        if self.measured is not None:
            write_measured(file.create_group("measured"), self.measured)
        if self.bar is not None:
            write_group(file.create_group("bar"), self.bar, keys.BAR, ("period", "shortening"))
        if self.backing is not None:
            write_group(file.create_group("backing"), self.backing, keys.BACKING, ("face",))
        if self.slip is not None:
            write_group(file.create_group("slip"), self.slip, (), SLIP)

    @staticmethod
    def _read(file):
        values = {name: file[f"panel/{name}"][()] for name in _PANEL}
        values |= {shape: read_shape(file[f"panel/{shape}"]) for shape in ("half_energy", "final")}
        values["reactions"] = {name: data[()] for name, data in file["reactions"].items()}
        values["measured"] = read_measured(file["measured"]) if "measured" in file else None
        return values | {name: read_group(file, name) for name in ("bar", "backing", "slip")}


def _half_energy(result, last):
    """The shape nearest to the instant at which half of the energy lost had been lost."""
    kinetic = result.energies["kinetic_projectile"]
    lost = kinetic[0] - kinetic
    instant = result.t[int(np.argmax(lost >= 0.5 * lost[-1]))]
    shots = [shot for shot in result.snapshots if shot.t <= last.t]
    return Shape.of(min(shots, key=lambda shot: abs(shot.t - instant))) if shots else last
