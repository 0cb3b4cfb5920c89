"""Geometry of the weave: heights, thickness, areal density, crimp, micrographs (thesis chapters 2, 5, A)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import pi
from typing import Any

import numpy as np
from scipy.integrate import quad

from fabrics import catalogue
from fabrics.trellis import locking_modulus
from fabrics.weave import arc_length, height_from_length
from validation.claims.registry import Found, Run, RunResult, check

KEVLAR = ("S-720", "S-726", "S-727", "S-728", "S-731", "S-745")
FAMILIES = ("warp", "weft")


def micrographs() -> Iterator[Any]:
    """(fabric, family, yarn, values) of the twelve rows of Tables A-1 and A-2."""
    for name in KEVLAR:
        fabric = catalogue.load(name)
        for family, yarn in zip(FAMILIES, fabric.weave.yarns):
            yield fabric, family, yarn, fabric.micrograph[family]


def ranked(values: dict[str, float]) -> list[str]:
    """Names from the largest value to the smallest."""
    return sorted(values, key=lambda name: -values[name])


@check()
def heights(fabric: str) -> Found:
    h01, h02 = catalogue.load(fabric).weave.h0
    return {"h01": h01, "h02": h02}


@check()
def thickness(fabric: str) -> Found:
    return {"thickness": catalogue.load(fabric).weave.thickness}


@check()
def areal_density(fabric: str) -> Found:
    """Mass per area of the nodes of a panel, with nominal linear densities and with those that G2 implies.

    The effective linear densities (erratum E-07) are inferred from the areal densities themselves. Here the factor on
    the nominal ones is G2 of Table 4-1 over eq. 4-49, into which no areal density enters.
    """
    given = catalogue.load(fabric)
    weave = given.weave
    factor = given.shear.G2 / locking_modulus(weave.warp.E, weave.warp.A_s, weave.thickness, 2 * weave.w1)
    implied = given.with_yarns(linear_density=tuple(factor * yarn.linear_density for yarn in weave.yarns))
    return {"nominal": _panel_areal_density(given), "with the denier of G2": _panel_areal_density(implied)}


def _panel_areal_density(fabric):
    """[kg/m2] mass of the nodes of a panel over its area."""
    from shellfabric.cell.model import CellModel
    from shellfabric.panel.model import Panel

    panel = Panel(CellModel(fabric).table(8))
    return float(panel.masses().sum()) / float(np.prod([n * d for n, d in zip(panel.counts, panel.spacing)]))


@check()
def areal_density_agreement() -> Found:
    found = [catalogue.load(name) for name in KEVLAR]
    off = {f.name: 1 - f.with_effective_density().weave.areal_density / f.areal_density_measured for f in found}
    return {"largest difference": max(off.values(), key=abs), "fabric": max(off, key=lambda name: abs(off[name]))}


@check()
def cell_length(fabric: str) -> Found:
    w1, w2 = catalogue.load(fabric).weave.w
    return {"along warp": 2 * w1, "along weft": 2 * w2}


@check()
def arc_length_quadrature() -> Found:
    worst = 0.0
    for name in catalogue.list_names():
        weave = catalogue.load(name).weave
        for w, h in zip(weave.w, weave.h0):
            k = pi * h / (2 * w)
            S = 2 * quad(lambda x, k=k, w=w: np.sqrt(1 + (k * np.sin(pi * x / (2 * w))) ** 2), 0, w, epsrel=1e-13)[0]
            worst = max(worst, abs(arc_length(w, h) / S - 1))
    return {"relative difference": worst}


@check()
def small_crimp(length: float, crimp: float) -> Found:
    return {"height": height_from_length(length / 2, length * (1 + crimp))}


@check(lambda fabric: {"made": Run.of("sections", fabric=fabric)})
def fibre_area(made: RunResult, fabric: str) -> Found:
    """Sum of the bars that cut the meshed section of a yarn."""
    warp, weft = made["fibre"]
    return {"area": warp, "difference of warp and weft": abs(warp / weft - 1)}


@check()
def bar_area(fabric: str, bars: Sequence[int]) -> Found:
    area = catalogue.load(fabric).weave.warp.A_s
    return {"warp bar": area / bars[0], "weft bar": area / bars[1]}


@check(lambda fabric: {"made": Run.of("sections", fabric=fabric)})
def voided_area(made: RunResult, fabric: str) -> Found:
    """Sections of the meshed yarns of the 3D crossover, at right angles to the yarn: volume over length."""
    crest = made["crest"]
    return {
        "warp": made["area"][0],
        "weft": made["area"][1],
        "note": f"at the crossing {1e6 * crest[0]:.4f} and {1e6 * crest[1]:.4f} mm2",
    }


@check()
def total_crimp_order() -> Found:
    return {"order": ranked({name: sum(y.crimp for y in catalogue.load(name).weave.yarns) for name in KEVLAR})}


@check()
def crimp_ratio_order() -> Found:
    return {"order": ranked(_crimp_ratios())}


@check()
def balance_classes(threshold: float) -> Found:
    ratios = _crimp_ratios()
    return {
        "balanced": [n for n in KEVLAR if ratios[n] < threshold],
        "imbalanced": [n for n in KEVLAR if ratios[n] >= threshold],
    }


def _crimp_ratios():
    weaves = {name: catalogue.load(name).weave for name in KEVLAR}
    return {name: weave.warp.crimp / weave.weft.crimp for name, weave in weaves.items()}


@check()
def void_range() -> Found:
    voids = [row["void"] for *_, row in micrographs()]
    # the formula as printed, of the share of fibres that these voids leave
    printed = [(1 - (1 - void)) - 1 for void in voids]
    return {"lowest": min(voids), "highest": max(voids), "highest as printed": max(printed)}


@check()
def micrograph_crimp() -> Found:
    rows = list(micrographs())
    smaller = [f"{fabric.name} {family}" for fabric, family, yarn, row in rows if row["crimp"] <= yarn.crimp]
    return {"larger": len(rows) - len(smaller), "exception": ", ".join(smaller)}


@check()
def micrograph_thickness() -> Found:
    return {
        "largest difference": max(
            abs(row["thickness"] + row["crossing_thickness"] - row["total_thickness"]) for *_, row in micrographs()
        )
    }


@check()
def overlay() -> Found:
    wide = [
        f"{fabric.name} {family} {row['width'] * row['count']:.3f}"
        for fabric, family, _, row in micrographs()
        if row["width"] * row["count"] > 1
    ]
    return {"wider than spacing": len(wide), "note": ", ".join(wide)}


@check()
def section_shape() -> Found:
    shape = [yarn.A_s / (1 - row["void"]) / (row["width"] * row["thickness"]) for _, _, yarn, row in micrographs()]
    return {"least": min(shape), "greatest": max(shape)}


@check()
def projectile_mass(diameter: float, length: float, bore: float, depth: float, density: float) -> Found:
    """Mass of the nodes of the elastic projectile, solid and bored, and of the default one."""
    from shellfabric.projectile.bar import Bar

    full, tube = pi / 4 * diameter**2, pi / 4 * (diameter**2 - bore**2)
    steel = replace(Bar.cylinder().material, density=density)
    masses = [
        float(np.sum(Bar(sections, steel).nodal_mass))
        for sections in (((length, full),), ((length - depth, full), (depth, tube)))
    ]
    return {
        "solid": masses[0],
        "bored": masses[1],
        "default": float(np.sum(Bar.cylinder().nodal_mass)),
        "default density": Bar.cylinder().material.density,
    }


@check()
def shell_density(fabric: str, thickness: float) -> Found:
    """Mass of the nodes of a panel over the volume of its elements."""
    return {"density": _panel_areal_density(catalogue.load(fabric).with_effective_density()) / thickness}


@check(lambda fabric, sections: {"made": Run.of("meshes", fabric=fabric, sections=sections)})
def sections_offered(made: RunResult, fabric: str, sections: Sequence[str]) -> Found:
    return {
        "sections": sorted(made["sections"]),
        "axis off a cosine": max(part["cosine"] for part in made["sections"].values()),
    }


@check(lambda fabric: {"made": Run.of("meshes", fabric=fabric, sections=["ellipse", "sine"])})
def mesh_sections(made: RunResult, fabric: str) -> Found:
    part = made["sections"]["sine"]
    return {
        "overlap": part["overlap"],
        "change of section": part["spread"],
        "yarns of four crossovers": made["yarns"]["four"],
    }


@check()
def recipe() -> Found:
    from shellfabric.cell.model import CellModel
    from shellfabric.panel.model import Panel

    built = []
    for name in KEVLAR:
        panel = Panel(CellModel(catalogue.load(name)).table(21))
        if panel.elements > 0 and panel.time_step > 0:
            built.append(name)
    return {"built": built}
