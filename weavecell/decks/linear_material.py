"""Yarn materials at rest, for the files of other solvers: linear, and no more than a first state of
the real laws.

The solid is orthotropic without Poisson effects (thesis section 3.4.2):

    axial E_a Vf0 (eq. 3-2),   transverse K_r E_c (eq. 3-10),   shear K_G E_c / 2.

Fibre bars are elastic. An explicit code needs mass in both: each carries half of the fibres' mass,
so that the whole is linear density times length and neither time step collapses.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from fabrics.fabric import Fabric

# share of the mass that the bars carry
BAR_SHARE = 0.5


@dataclass(frozen=True)
class RestMaterial:
    """Moduli [Pa] and densities [kg/m3] of one yarn at rest.

    Parameters
    ----------
    fibre, axial, transverse, shear : [Pa] of the bars and of the solid
    packed : [Pa] E_c, transverse modulus of the packed yarn; that of the end shells
    bar_density, solid_density : [kg/m3] over the volumes of bars and of hexahedra
    failure_strain : [-] of the fibres
    """

    fibre: float
    axial: float
    transverse: float
    shear: float
    packed: float
    bar_density: float
    solid_density: float
    failure_strain: float


def linearise(fabric: Fabric, Vf0: Sequence[float]) -> tuple[RestMaterial, ...]:
    """Linearise the materials of warp and weft, meshed with the fibre volume fractions `Vf0` :
    (2,)."""
    # a fabric without a solid law has no mesh
    assert fabric.solid_laws is not None
    return tuple(map(_material, fabric.weave.yarns, fabric.solid_laws, Vf0))


def _material(yarn, solid, Vf0):
    return RestMaterial(
        fibre=yarn.E,
        axial=solid.E_a * Vf0,
        transverse=solid.K_r * solid.E_c,
        shear=solid.G,
        packed=solid.E_c,
        bar_density=BAR_SHARE * yarn.fibre_density,
        solid_density=(1 - BAR_SHARE) * yarn.fibre_density * Vf0,
        failure_strain=yarn.failure_strain,
    )
