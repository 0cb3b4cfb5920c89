"""What follows from the data of a fabric, as text: geometry, mass, stiffness and strength of its yarns."""

from __future__ import annotations

from fabrics.fabric import Fabric


def derived(fabric: Fabric) -> list[tuple[str, str]]:
    """(quantity, value) rows that follow from a fabric's data: geometry, mass, strength."""
    weave = fabric.weave
    pair = " / ".join
    rows = [
        ("cell, warp x weft direction", f"{2e3 * weave.w1:.4f} x {2e3 * weave.w2:.4f} mm"),
        ("yarn heights h01, h02 (eq. 4-5)", pair(f"{1e3 * h:.4f}" for h in weave.h0) + " mm"),
        ("thickness 2 (h01 + h02)", f"{1e3 * weave.thickness:.4f} mm"),
        ("areal density", f"{1e3 * weave.areal_density:.1f} g/m²"),
        ("fibre area", pair(f"{1e6 * yarn.A_s:.4f}" for yarn in weave.yarns) + " mm²"),
        ("axial stiffness EA", pair(f"{yarn.EA:.0f}" for yarn in weave.yarns) + " N"),
        ("yarn strength", pair(f"{yarn.strength:.1f}" for yarn in weave.yarns) + " N"),
    ]
    if fabric.areal_density_measured is not None:
        rows.insert(4, ("areal density, measured", f"{1e3 * fabric.areal_density_measured:.1f} g/m²"))
    if fabric.thickness is not None:
        rows.insert(3, ("thickness, data sheet", f"{1e3 * fabric.thickness:.4g} mm"))
    return rows
