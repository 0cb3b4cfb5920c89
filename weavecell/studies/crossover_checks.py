"""Quality checks of what the 3D crossover gives: of its mesh, of a surface, and of a path.

Limits, measured on the eight fabrics of the catalogue. Hexahedra of coarse and medium meshes have a
scaled Jacobian of .85 and above; from .5 on is what mesh generators call acceptable. Facets of coarse
meshes, which are flat, overlap by .0021 of the thickness at most, and by a third of that where the
mesh is medium. The coarsest surface that the guide makes (5 x 5 lines) misses 1.7 N rms.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np

from fabrics.base.record import Record
from shellfabric.membrane.indicator import Check, Indicator

if TYPE_CHECKING:
    from fabrics.fabric import Fabric
    from fabrics.surface import ResponseSurface

DISTORTION = Check(
    "distortion of hexahedra",
    0.5,
    "one less the scaled Jacobian of the worst hexahedron",
    "sections of another shape, or a larger tip thickness",
)
OVERLAP = Check(
    "overlap of yarns",
    0.01,
    "depth to which facets of warp and weft overlap in the mesh, over the thickness of the fabric",
    "a finer mesh, or sections that do not overlap",
    note=0.005,
)
MISSED = Check(
    "interpolation of the surface",
    0.05,
    "largest error of a force on lines that were left out, over the largest of this force",
    "more points, or a tolerance",
    note=0.02,
)
CUT_SHORT = Check(
    "path cut short",
    0.0,
    "share of its path that the crossover did not go, since no equilibrium was found",
    "a finer mesh; state how far it went",
)
PRESSED = Check(
    "pressure not reached",
    0.01,
    "share of the pressure asked for that is missing where the platens have closed to half their distance at rest",
    "a lower pressure; state which one was reached",
)
BEYOND_STRENGTH = Check(
    "tension beyond the strength",
    1.05,
    "greatest tension of a yarn over its strength: fibres do not fail on this path",
    "a smaller displacement, or a path with failing fibres",
    note=1.0,
)
# of a surface
FORCES = ("T1", "T2", "F_c")


def of_mesh(mesh: Any, thickness: float) -> tuple[Indicator, ...]:
    """Return the Indicators of a YarnMesh of a fabric of this thickness [m]."""
    return (
        DISTORTION.judge(1 - mesh.min_scaled_jacobian),
        OVERLAP.judge(max(-mesh.least_gap, 0.0) / thickness),
    )


def of_surface(surface: ResponseSurface, errors: Any) -> tuple[Indicator, ...]:
    """Return the Indicators of a sampled surface, {force: error on lines that were left out}."""
    missed = [
        errors[name].largest / float(np.abs(getattr(surface, name)).max())
        for name in FORCES
        if name in errors
    ]
    return (MISSED.judge(max(missed)),) if missed else ()


def of_paths(paths: Iterable[Record]) -> tuple[Indicator, ...]:
    """Return the Indicators of paths that were to be gone to their ends: of the one that failed first."""
    left = [1 - float(path["path"][-1]) if path.failed else 0.0 for path in paths]
    return (CUT_SHORT.judge(max(left)),) if left else ()


def of_pressing(record: Record) -> tuple[Indicator, ...]:
    """Return the Indicators of plies that were to be pressed to a pressure; none of other records."""
    asked = record.facts.get("pressure_asked")
    if asked is None:
        return ()
    return (PRESSED.judge(max(1 - float(record["pressure"][-1]) / asked, 0.0)),)


def of_strength(record: Record, fabric: Fabric) -> tuple[Indicator, ...]:
    """Return the Indicators of tensions that no yarn of the fabric bears; none of records without
    tensions of warp and weft."""
    strengths = [yarn.strength for yarn in fabric.weave.yarns]
    pairs = [
        (float(np.max(record[name])), strength)
        for name, strength in zip(("T1", "T2"), strengths)
        if name in record.columns
    ]
    if len(pairs) < 2:
        return ()
    return (BEYOND_STRENGTH.judge(max(tension / strength for tension, strength in pairs)),)
