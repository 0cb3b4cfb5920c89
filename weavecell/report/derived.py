"""What follows from the data of a fabric, as text: geometry, mass, stiffness and strength of its
yarns."""

from __future__ import annotations

from fabrics.base.units import si
from fabrics.fabric import Fabric


def derive_rows(fabric: Fabric) -> list[tuple[str, str]]:
    """Compute the rows (quantity, value) that follow from a fabric's data: geometry, mass,
    strength."""
    weave = fabric.weave
    pair = " / ".join
    rows = [
        ("cell, warp x weft direction", f"{2e3 * weave.w1:.4f} x {2e3 * weave.w2:.4f} mm"),
        ("height of the centreline, warp / weft", pair(f"{1e3 * h:.4f}" for h in weave.h0) + " mm"),
        ("thickness, twice the sum of these heights", f"{1e3 * weave.thickness:.4f} mm"),
        ("areal density", f"{1e3 * weave.areal_density:.1f} g/m²"),
        ("fibre area", pair(f"{1e6 * yarn.A_s:.4f}" for yarn in weave.yarns) + " mm²"),
        ("axial stiffness EA", pair(f"{yarn.EA:.0f}" for yarn in weave.yarns) + " N"),
        ("yarn strength", pair(f"{yarn.strength:.1f}" for yarn in weave.yarns) + " N"),
    ]
    if fabric.effective_linear_density is not None:
        rows.insert(0, ("linear density", _densities(fabric)))
    if not weave.pattern.is_plain:
        rows.insert(0, ("weave", weave.pattern.name))
    if fabric.areal_density_measured is not None:
        rows.insert(
            -2, ("areal density, measured", f"{1e3 * fabric.areal_density_measured:.1f} g/m²")
        )
    if fabric.thickness is not None:
        rows.insert(-2, ("thickness, data sheet", f"{1e3 * fabric.thickness:.4g} mm"))
    return rows


def density_kind(fabric: Fabric) -> str:
    """Return "effective" of a fabric that has the linear densities of the published runs, "nominal"
    of the data sheet's."""
    used = tuple(yarn.linear_density for yarn in fabric.weave.yarns)
    if used == tuple(fabric.effective_linear_density or ()):
        return "effective"
    return "nominal"


def _densities(fabric):
    """Which linear densities are used, and what follows from the others, in words."""
    nominal = (
        si(fabric.sources["warp.linear_density"]["value"], "kg/m"),
        si(fabric.sources["weft.linear_density"]["value"], "kg/m"),
    )
    both = {"effective": fabric.effective_linear_density, "nominal": nominal}
    kind = density_kind(fabric)
    if kind == "effective":
        other = "nominal"
    else:
        other = "effective"
    weave = fabric.with_yarns(linear_density=both[other]).weave
    names = {
        "effective": "effective, of the published runs",
        "nominal": "nominal, of the data sheet",
    }
    denier = {
        name: " / ".join(f"{9e6 * value:.0f}" for value in pair) for name, pair in both.items()
    }
    return (
        f"{denier[kind]} denier: {names[kind]}; with {denier[other]} denier ({names[other]}) a yarn has "
        f"{weave.warp.strength:.1f} N and the fabric {1e3 * weave.areal_density:.1f} g/m²"
    )
