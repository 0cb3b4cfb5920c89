"""Plies of four crossovers that lie shifted on each other, repeated in their plane.

A shift leaves neither mirror planes nor glides that all plies share, only the repetition after two crossings: each ply
is a patch of 2 x 2, tied between its ends, ply p moved by p times the shift. Between two plies only exposed parts meet:
below the upper ply the yarn that lies under at each crossing, above the lower ply the one that lies over, in the cell
or in its next images.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.interpolate import RegularGridInterpolator

from fabrics.errors import InputError
from fabrics.fabric import Fabric
from meshing.patch import Patch
from unitcell3d.assembly.constraints import VERTICAL, Ties
from unitcell3d.assembly.periodic_images import Images
from unitcell3d.contact.pairs import OuterPlates, SurfacePairs, facing
from unitcell3d.contact.periodic import exposed, mates
from unitcell3d.model import submeshes
from unitcell3d.model.crossover import Numerics, YarnsModel, check
from unitcell3d.model.periodic_cell import CellConstraints

PERIOD = 2


class ShiftedModel(YarnsModel):
    """Shifted plies between plates, their repetition held at its length.

    Parameters
    ----------
    patch : meshing.patch.Patch of 2 x 2
    fabric : Fabric
    plies : number
    shift : (x, y) [crossings] of each ply against the one under it
    numerics : model.crossover.Numerics

    Raises
    ------
    InputError : another mesh
    """

    def __init__(
        self,
        patch: Patch,
        fabric: Fabric,
        plies: int,
        shift: Sequence[float],
        numerics: Numerics | None = None,
    ) -> None:
        check(patch, fabric)
        if getattr(patch, "count", None) != (2, 2):
            raise InputError("shifted plies need a patch of 2 x 2")
        step = np.array([2 * w * part for w, part in zip(patch.w, shift)])
        own = len(patch.names)
        pitch = self._pitch(patch, step)
        offsets = [(*(ply * step), (ply - (plies - 1) / 2) * pitch) for ply in range(plies)]
        mesh = submeshes.stacked(patch, offsets)
        images = Images(mesh, PERIOD, 1.0)
        of = [range(ply * own, (ply + 1) * own) for ply in range(plies)]
        inside = [mates(mesh, ply) for ply in of]
        between = [
            (a, images.image(yarn, m, n)[part], *families)
            for under, over in zip(of[1:], of)
            for a, (yarn, part), (m, n), families in _overlapping(mesh, under, over)
        ]
        points = images.points
        pairs = [
            facing(points, upper, lower, False, families)
            for group in inside
            for upper, lower, families in group
        ]
        self.inside = len(pairs)
        pairs += [
            facing(points, upper, lower, False, families) for upper, lower, *families in between
        ]
        self.plies, self.crossings = plies, PERIOD**2
        super().__init__(
            mesh,
            fabric,
            numerics,
            _tied(mesh, images),
            SurfacePairs(pairs),
            OuterPlates(
                points, [mesh.grids[yarn] for yarn in of[-1]], [mesh.grids[yarn] for yarn in of[0]]
            ),
            points=points,
        )

    @staticmethod
    def _pitch(patch, step):
        """[m] from ply to ply where they just touch."""
        two = submeshes.stacked(patch, [(0, 0, 0), (*step, 0)])
        own, least = len(patch.names), np.inf
        for upper, (yarn, part), (m, n), _ in _overlapping(two, range(own, 2 * own), range(own)):
            lower = two.grids[yarn][part]
            moved = np.array([m * 2 * PERIOD * patch.w[0], n * 2 * PERIOD * patch.w[1], 0.0])
            faces = two.points[upper[:, :, 0]], two.points[lower[:, :, -1]] + moved
            least = min(least, _gap(*faces, 1.0), _gap(*faces[::-1], -1.0))
        return -least


def _gap(slave, master, sign):
    """[m] least height of the points `slave` over the surface `master`, both (i, j, 3), by plan position."""
    if np.ptp(master[:, 0, 0]) < np.ptp(master[:, 0, 1]):
        master = master.transpose(1, 0, 2)
    lines = master[:, 0, 0], master[0, :, 1]
    height = RegularGridInterpolator(lines, master[..., 2], bounds_error=False, fill_value=np.nan)
    gaps = sign * (slave[..., 2] - height(slave[..., :2]))
    return np.inf if np.all(np.isnan(gaps)) else float(np.nanmin(gaps))


def _overlapping(mesh, under, over):
    """Exposed parts of two plies that lie over each other in plan.

    Yields (upper nodes (i, j, k), (lower yarn, its part), image (m, n), families).
    """
    for upper_yarn, upper_part in exposed(mesh, under, over=False):
        upper = mesh.grids[upper_yarn][upper_part]
        low, high = (
            reduce(mesh.points[upper][..., :2].reshape(-1, 2), axis=0)
            for reduce in (np.min, np.max)
        )
        for yarn, part in exposed(mesh, over, over=True):
            lower = mesh.points[mesh.grids[yarn][part]][..., :2].reshape(-1, 2)
            for m in (-1, 0, 1):
                for n in (-1, 0, 1):
                    moved = lower + np.array(
                        [m * 2 * PERIOD * mesh.w[0], n * 2 * PERIOD * mesh.w[1]]
                    )
                    common = np.minimum(high, moved.max(axis=0)) - np.maximum(
                        low, moved.min(axis=0)
                    )
                    if np.all(common > 1e-2 * (high - low)):
                        yield (
                            upper,
                            (yarn, part),
                            (m, n),
                            (mesh.families[upper_yarn], mesh.families[yarn]),
                        )


def _tied(mesh, images):
    """Ends tied to starts; the middle of one crossing of each yarn stays where it is in the plane."""
    ties = Ties(len(images.points), 12)
    for grid in mesh.grids:
        for component in (0, 1, VERTICAL):
            ties.follow(grid[-1], grid[0], component)
        middle = grid[grid.shape[0] // (2 * PERIOD), grid.shape[1] // 2, grid.shape[2] // 2]
        for component in (0, 1):
            ties.hold(middle, component)
    for image, base, _ in images.followers():
        for component in (0, 1, VERTICAL):
            ties.follow(image, base, component)
    held = ties.done(())
    return CellConstraints(
        held.unknown, held.sign, images.drive(), held.size, (), PERIOD**2, mesh.w
    )
