"""The fibre bars of a set of yarns, and their failure (thesis App. B.1, erratum E-18).

A bar whose strain passes the failure strain e_f of its yarn loses its stiffness over a further
`FADE` e_f of strain,

    N = (1 - D) E A s(e) + D r E A s(e),   D = (e - e_f) / (FADE e_f)  between 0 and 1,

and never gets it back: D only grows. The fraction r is what a slack fibre keeps
(`numerics.Numerics`). The bars lie on the crimped path, so their strain is strain beyond crimp. D
is constant while an equilibrium is sought: it is raised by `Fibres.fail` where a state has been
accepted, and the equilibrium sought again until nothing more fails.
"""

from __future__ import annotations

import numpy as np

from fabrics.base.checks import FloatArray, IntArray
from fabrics.fabric import Fabric
from meshing.mesh import YarnMesh
from unitcell3d.material import fibre_kernels
from unitcell3d.material.numerics import Numerics

FADE = 0.01
# of the damage between two equilibria: what a fibre held is handed on in parts
LARGEST_RISE = 0.25


class Fibres:
    """Bars with their stiffness and what has failed of them.

    Parameters
    ----------
    mesh : meshing.mesh.YarnMesh
    fabric : Fabric
    failure : bars fail

    Attributes
    ----------
    pairs : (b, 2) node numbers
    yarn : (b,) number of the yarn
    length : (b,) [m] undeformed
    damage : (b,) [-] D
    """

    def __init__(self, mesh: YarnMesh, fabric: Fabric, failure: bool = False) -> None:
        self.pairs = np.concatenate(mesh.bars).astype(np.int64)
        self.yarn = np.repeat(np.arange(len(mesh.bars)), [len(pairs) for pairs in mesh.bars])
        yarns = [fabric.weave.yarns[family] for family in mesh.families]
        area = np.concatenate(mesh.bar_area)
        edge = mesh.points[self.pairs[:, 1]] - mesh.points[self.pairs[:, 0]]
        self.length = np.linalg.norm(edge, axis=1)
        self.damage = np.zeros(len(self.pairs))
        self._whole = np.array([yarn.E for yarn in yarns])[self.yarn] * area
        self._share = area * self.length
        self._limit = np.array([yarn.failure_strain for yarn in yarns])[self.yarn]
        self._fails = failure

    def stiffness(self, numerics: Numerics) -> FloatArray:
        """Compute E A of the intact fibres, (b,) [N]."""
        return self._whole * (1 - self.damage * (1 - numerics.slack_stiffness))

    def strains(self, x: FloatArray) -> FloatArray:
        """Compute the strain of every bar (b,) at the positions `x` : (n, 3) [m]."""
        strain = np.empty(len(self.pairs))
        fibre_kernels.bar_strains(x, self.pairs, self.length, strain)
        return strain

    def means(self, strain: FloatArray) -> FloatArray:
        """Compute the mean (yarns,) of the strains `strain` : (b,) over the fibres of each yarn."""
        volume = np.bincount(self.yarn, self._share)
        return np.bincount(self.yarn, self._share * strain) / volume

    def worst(self, strain: FloatArray) -> FloatArray:
        """Find the largest strain (yarns,) of each yarn among its whole bars; -1 if none is
        left."""
        return np.array(
            [
                strain[(self.yarn == yarn) & (self.damage == 0)].max(initial=-1.0)
                for yarn in range(self.yarn[-1] + 1)
            ]
        )

    def broken(self) -> FloatArray:
        """Compute the share (yarns,) [-] of the bars of each yarn that has failed."""
        failed = (self.damage > 0).astype(float)
        return np.bincount(self.yarn, failed) / np.bincount(self.yarn)

    def overload(self, strain: FloatArray) -> float:
        """Find the largest strain of a whole bar over its failure strain [-]; 0 if bars do not
        fail."""
        if not self._fails:
            return 0.0
        whole = self.damage == 0
        return float((strain[whole] / self._limit[whole]).max(initial=0.0))

    def fail(self, x: FloatArray) -> bool:
        """Raise the damage to that of the positions `x`, first of the most overstrained; returns
        whether any rose."""
        if not self._fails:
            return False
        beyond = np.clip((self.strains(x) / self._limit - 1) / FADE, 0, None)
        risen = np.minimum(beyond, 1) > self.damage + 1e-6
        if risen.any():
            risen &= beyond >= 0.5 * beyond[risen].max()
        self.damage[risen] = np.minimum(np.minimum(beyond, 1), self.damage + LARGEST_RISE)[risen]
        return bool(risen.any())

    def forces(self, x: FloatArray, numerics: Numerics, forces: FloatArray) -> None:
        """Add the internal forces of the bars to `forces` : (n, 3) [N]."""
        n = numerics
        fibre_kernels.bar_forces(
            x, self.pairs, self.length, self.stiffness(n), n.slack_stiffness, n.slack_width, forces
        )

    def tangent(
        self, x: FloatArray, numerics: Numerics, places: IntArray, values: FloatArray
    ) -> None:
        """Add their tangent to the blocks `values`; `places`: (b, 2, 2) as for `bar_tangent`."""
        n = numerics
        fibre_kernels.bar_tangent(
            x,
            self.pairs,
            self.length,
            self.stiffness(n),
            n.slack_stiffness,
            n.slack_width,
            places,
            values,
        )
