"""Parameters of the contact of a model: numbers of the method, and the surfaces that may touch."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from fabrics.checks import FloatArray, IntArray
from unitcell3d.assembly.sparsity import Pattern


class PenaltyNumerics(Protocol):
    """Numbers of the contact (`model.crossover.Numerics`)."""

    @property
    def penalty(self) -> float:
        """[Pa/m] contact stiffness."""

    @property
    def toe(self) -> float:
        """[m] penetration over which it sets in."""

    @property
    def friction(self) -> float:
        """[-] Coulomb's coefficient."""

    @property
    def slip(self) -> float:
        """[m] over which friction sets in."""


class ContactSurfaces(Protocol):
    """Surfaces in contact, as residual and tangent: `surfaces.FacingSurfaces`, `pairs.SurfacePairs`."""

    @property
    def gaps(self) -> Sequence[FloatArray]:
        """[m] of the nodes of each surface at the last call of `assemble`, infinite without a partner."""

    @property
    def deepest(self) -> float:
        """[m] largest penetration where there was a force in the last call of `assemble`."""

    @property
    def anchors(self) -> list[FloatArray]:
        """Where each point stuck last; may be written to."""

    def expected_stencils(self) -> list[IntArray]:
        """Arrays (m, s) of nodes that all act on each other, to lay the tangent out for."""

    def build_pattern(self, pattern: Pattern) -> None:
        """Look up the places of the `expected_stencils` in a pattern that holds them."""

    def pattern_outdated(self) -> bool:
        """Whether the last call of `assemble` met what the pattern was not laid out for."""

    def assemble(
        self,
        x: FloatArray,
        numerics: PenaltyNumerics,
        forces: FloatArray,
        values: FloatArray | None = None,
    ) -> float:
        """Add internal forces (n, 3) [N] at positions x (n, 3) [m], and the tangent where `values` is given."""

    def commit(self, x: FloatArray, numerics: PenaltyNumerics) -> None:
        """The state of the last call of `assemble`, at `x`, is where friction goes on from."""
