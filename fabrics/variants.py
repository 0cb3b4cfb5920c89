"""Variants of a fabric: the one place where a fabric is changed into another.

Every function takes a `Fabric` and returns a new one. A value of the yarns, or a factor, is one
number for both families or a pair (warp, weft). Sources stay those of the given fabric.

Values of the yarns (crimp, modulus, ...) are also set by `Fabric.with_yarns`; laws that are assumed
by fibre family are in `fabrics.assumed`; which cell a fabric is solved with is a choice of the
model (`shellfabric.cell.model.CellModel`).
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import Any, TypeAlias

from fabrics.assumed import given, of_thickness
from fabrics.base.errors import InputError
from fabrics.base.run_cache import inputs_digest
from fabrics.fabric import Fabric, pair

Value: TypeAlias = float | Iterable[float]


def with_linear_density(fabric: Fabric, choice: str = "effective") -> Fabric:
    """Return the fabric with the "nominal" linear densities, or the "effective" ones if the fabric
    has such (erratum E-07).

    A caller that needs the effective ones uses `Fabric.with_effective_density`, which refuses a
    fabric without them.
    """
    if choice == "nominal" or fabric.effective_linear_density is None:
        return fabric
    return fabric.with_effective_density()


def scale_yarns(fabric: Fabric, **factors: Value) -> Fabric:
    """Multiply values of the yarns by factors [-], named by the fields of `Yarn`."""
    warp, weft = fabric.weave.yarns
    changed = {}
    for name, of_family in factors.items():
        of_warp, of_weft = pair(of_family)
        changed[name] = getattr(warp, name) * of_warp, getattr(weft, name) * of_weft
    return fabric.with_yarns(**changed)


def scale_areal_density(fabric: Fabric, factor: float) -> Fabric:
    """Multiply the linear densities by a factor [-] at constant axial stiffness E A_s of the yarns
    (thesis section 6.3.3).

    The section of the fibres grows with the linear density, so that the modulus is divided by the
    factor.
    """
    return fabric.with_yarns(
        E=tuple(yarn.E / factor for yarn in fabric.weave.yarns),
        linear_density=tuple(yarn.linear_density * factor for yarn in fabric.weave.yarns),
    )


def scale_laws(fabric: Fabric, a: float = 1.0, b: float = 1.0) -> Fabric:
    """Multiply both constants of the compression laws by factors [-]; a fabric without laws is
    returned as it is."""
    if fabric.laws is None:
        return fabric
    warp, weft = (replace(law, a=a * law.a, b=b * law.b) for law in fabric.laws)
    return replace(fabric, laws=(warp, weft))


def with_shear(fabric: Fabric, **values: float) -> Fabric:
    """Replace values of the trellis.

    Parameters
    ----------
    values : fields of `TrellisShear`: G1, G2 [Pa], gamma1, gamma2 [rad]

    Raises
    ------
    InputError : the fabric has no trellis law, or a value that `TrellisShear` does not allow
    """
    if fabric.shear is None:
        raise InputError(f"fabric {fabric.name} has no trellis law")
    return replace(fabric, shear=replace(fabric.shear, **values))


def scale_shear(fabric: Fabric, moduli: float = 1.0, angles: float = 1.0) -> Fabric:
    """Multiply moduli and angles of the trellis by factors [-]; a fabric without trellis is
    returned as it is."""
    if fabric.shear is None:
        return fabric
    law = fabric.shear
    return with_shear(
        fabric,
        G1=moduli * law.G1,
        G2=moduli * law.G2,
        gamma1=angles * law.gamma1,
        gamma2=angles * law.gamma2,
    )


def with_solids(fabric: Fabric, **values: Value) -> Fabric:
    """Replace values of the solid laws, named by the fields of `SolidLaw`.

    Raises
    ------
    InputError : the fabric has no solid laws, or a value that `SolidLaw` does not allow
    """
    pairs = {name: pair(value) for name, value in values.items()}
    if fabric.solid_laws is None:
        raise InputError(f"fabric {fabric.name} has no solid law of its yarns")
    warp, weft = (
        replace(law, **{name: two[k] for name, two in pairs.items()})
        for k, law in enumerate(fabric.solid_laws)
    )
    return replace(fabric, solid_laws=(warp, weft))


def with_failure_length(fabric: Fabric, length: float) -> Fabric:
    """Set another failure length [m], which then counts as given.

    Raises
    ------
    InputError : it is not above 0
    """
    return replace(given(fabric, "failure_length"), failure_length=length)


def as_written(fabric: Fabric) -> Fabric:
    """Return the fabric with the crimp that its data sheet gives; the 3D crossover may have taken a
    thicker one, for room (`meshing.mesh_plan.with_room`)."""
    if "crimp" in fabric.assumed:
        return of_thickness(fabric)
    return fabric


def data_digest(fabric: Fabric) -> str:
    """Digest what a compression law of the fabric is computed from: its weave, sections and solid
    laws, as its data sheet gives them.

    The linear densities are the effective ones, so that it is the same for either choice; laws of
    the solid that are assumed are left out.
    """
    fabric = as_written(fabric)
    solid = None
    if "solid" not in fabric.assumed:
        solid = fabric.solid_laws
    weave = with_linear_density(fabric, "effective").weave
    sections = fabric.section, fabric.yarn_width, fabric.yarn_area
    return inputs_digest((weave, sections, solid))


# what a fabric has of (warp, weft)
PAIRS = ("laws", "solid_laws", "effective_linear_density", "yarn_width", "yarn_area")
# tables by names that may begin, or have in them, that of a family
_NAMED = ("sources", "ranges", "micrograph")
_OTHER = {"warp": "weft", "weft": "warp"}


def rotated_90(fabric: Fabric) -> Fabric:
    """Rotate the fabric by a right angle: warp and weft are exchanged, with all that is known of
    each."""
    weave = fabric.weave
    weave = replace(
        weave,
        warp=weave.weft,
        weft=weave.warp,
        warp_count=weave.weft_count,
        weft_count=weave.warp_count,
        pattern=weave.pattern.rotated(),
    )
    exchanged: dict[str, Any] = {"guessed": tuple(map(_of_other, fabric.guessed))}
    for name in PAIRS:
        pair = getattr(fabric, name)
        exchanged[name] = pair and pair[::-1]
    for name in _NAMED:
        table = getattr(fabric, name)
        exchanged[name] = {_of_other(key): value for key, value in table.items()}
    return replace(fabric, weave=weave, **exchanged)


def _of_other(key):
    """The dotted key of the other family, such as "solid.weft.E_c"."""
    return ".".join(_OTHER.get(part, part) for part in key.split("."))
