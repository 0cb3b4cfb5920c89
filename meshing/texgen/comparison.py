"""Section and path of the meshed yarns held against those of TexGen.

TexGen's section is normal to the path and has any outline. Ours is vertical and of one of three shapes; its area is
A_s (1 + crimp) / Vf0, so that the volume of the yarn is TexGen's where no overlap had to be removed. TexGen's path is a
spline; ours is a sinusoid of the same length.
"""

from __future__ import annotations

import numpy as np
from scipy.integrate import trapezoid

from fabrics.checks import FloatArray
from fabrics.errors import InputError
from meshing.mesh import YarnMesh
from meshing.section import YarnSection
from meshing.texgen.geometry import WeaveGeometry, YarnGeometry

FAMILIES = ("warp", "weft")
_SAMPLES = 2001
_SAME = 0.01  # of the cells of one weave

Numbers = dict[str, float | dict[str, float]]


def compare(texgen: WeaveGeometry, mesh: YarnMesh) -> dict[str, Numbers]:
    """{family: {quantity: number}} of a mesh of the fabric that was made from the TexGen file.

    section_area_m2, section_width_m, section_height_m, path_amplitude_m and crimp are {"texgen", "mesh", "deviation"},
    the last one relative. section_shape_deviation: area in one of the two sections alone, over TexGen's.
    path_rms_over_thickness: rms distance of the two paths about their middle, over the thickness of the yarn.

    Raises
    ------
    InputError : the mesh is that of another weave
    """
    for name, yarn, w in zip(FAMILIES, texgen.yarns, mesh.w):
        if abs(2 * w / yarn.cell - 1) > _SAME:
            cells = f"a crossover is {1e3 * yarn.cell:.4g} mm long along the {name}, of {mesh.fabric} {2e3 * w:.4g} mm"
            raise InputError(cells, file=texgen.name, allowed="the TexGen file that the fabric was made from")
    return {name: _numbers(texgen.yarns[f], mesh, f) for f, name in enumerate(FAMILIES)}


def _numbers(yarn: YarnGeometry, mesh: YarnMesh, f: int) -> Numbers:
    section, h = mesh.sections[f], mesh.h0[f]
    places, z = yarn.path.T
    pairs = {
        "section_area_m2": (yarn.area, section.area),
        "section_width_m": (yarn.width, 2 * section.half_width),
        "section_height_m": (yarn.thickness, section.thickness),
        "path_amplitude_m": (yarn.amplitude, h),
        "crimp": (yarn.crimp, mesh.S0[f] / (2 * mesh.w[f]) - 1),
    }
    found: Numbers = {
        name: {"texgen": theirs, "mesh": ours, "deviation": ours / theirs - 1}
        for name, (theirs, ours) in pairs.items()
    }  # fmt: skip
    away = z - h * np.cos(np.pi * places / (2 * mesh.w[f]))
    rms = np.sqrt(trapezoid(away**2, places) / np.ptp(places))
    return found | {
        "section_shape_deviation": shape_deviation(yarn.outline, section),
        "path_rms_over_thickness": float(rms / yarn.thickness),
    }


def shape_deviation(outline: FloatArray, section: YarnSection) -> float:
    """Area that lies in one of two sections alone, over that of the outline (m, 2) [m], which is centred."""
    first, last = np.argmin(outline[:, 0]), np.argmax(outline[:, 0])
    turned = np.roll(outline, -first, axis=0)
    split = (last - first) % len(outline)
    faces = turned[: split + 1], np.vstack([turned[split:], turned[:1]])[::-1]
    reach = max(section.half_width, np.abs(outline[:, 0]).max())
    y = np.linspace(-reach, reach, _SAMPLES)
    half = np.abs(y)
    ours = np.where(half <= section.half_width, section.half_thickness(np.minimum(half, section.half_width)), 0)
    theirs = np.sort(np.stack([np.interp(y, face[:, 0], face[:, 1], 0.0, 0.0) for face in faces]), axis=0)
    apart = np.abs(theirs[1] - ours) + np.abs(theirs[0] + ours)
    return float(trapezoid(apart, y) / trapezoid(theirs[1] - theirs[0], y))
