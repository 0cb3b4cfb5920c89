"""One crossover of a plain weave in hexahedra: the warp along x over the weft along y, the crossing
at the origin.

Centrelines (thesis eq. 4-1), moved apart by the shift that closes the sections
(`meshing.section_fit`):

    warp   z =   h_1 cos(pi x / 2 w_1) + shift/2
    weft   z = -(h_2 cos(pi y / 2 w_2) + shift/2)

"quarter" is x >= 0, y >= 0: half the length and half the width of each yarn, so half of its bars'
area.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Unpack

from fabrics.base.errors import InputError
from fabrics.fabric import Fabric
from fabrics.yarn import CLOSEST_PACKING
from meshing import geometry, inputs
from meshing.generate import of_script
from meshing.geometry import Yarn
from meshing.inputs import YARNS, MeshOptions, Size
from meshing.mesh import YarnMesh, assemble
from meshing.mesh_file import (
    HEIGHT_TOLERANCE,
    LENGTH_TOLERANCE,
    MeshFile,
    ReadSection,
    ReadSections,
)
from meshing.mesh_plan import Plan


@dataclass(frozen=True, eq=False)
class Crossover(YarnMesh):
    """The mesh of a crossover: a `YarnMesh` of two yarns, "warp" and "weft".

    Parameters
    ----------
    domain : "quarter" or "whole"; the bars that cut one section sum to `share` A_s
    """

    domain: str

    @property
    def share(self) -> float:
        """[-] of a yarn's section that is meshed: a half in a quarter crossover."""
        return 0.5 if self.domain == "quarter" else 1.0


def build(
    fabric: Fabric,
    *,
    domain: str = "quarter",
    size: Size = "medium",
    **options: Unpack[MeshOptions],
) -> Crossover:
    """Mesh one crossover of a fabric.

    Parameters
    ----------
    fabric : Fabric, with solid laws (for the fibre volume fractions)
    domain : "quarter" or "whole"
    size : "coarse", "medium", "fine", "auto", or (nx, ny, nz), hexahedra along, across and through
        a quarter of each yarn, or an edge length [m] (`meshing.inputs.size`); or a MeshFile, which
        is a quarter and leaves no option
    **options : of `meshing.inputs.MeshOptions`

    Raises
    ------
    InputError : a value is not allowed, or the sections overlap and this is refused or cannot be
        solved
    """
    inputs.one_of("domain", domain, ("quarter", "whole"))
    if isinstance(size, MeshFile):
        return _read(fabric, size, domain, options)
    plan = Plan.of(fabric, size=size, shift=True, **options)
    quarter = domain == "quarter"
    yarns = []
    for family, name in enumerate(YARNS):
        w = plan.weave.w[family]
        stations = (0.0, w) if quarter else (-w, 0.0, w)
        up = 1 - 2 * family
        yarns.append(Yarn(name, family, ups=(-up, up, -up), axis=0.0, first=0.0, stations=stations))
    script = geometry.script(plan, yarns, quarter=quarter, stem="crossover")
    found = assemble(of_script(script, plan.fabric), YARNS, (0, 1), quarter, plan.weave)
    return Crossover(domain=domain, script=script, **found, **plan.fields())


def _read(fabric, file, domain, options):
    """The Crossover of a MeshFile, whose yarns have the counts and the crimp of the fabric."""
    given = [key for key, value in options.items() if value is not None]
    if given:
        allowed = "left out if the mesh is read from a file"
        raise InputError(key=given[0], value=options[given[0]], allowed=allowed)
    if domain != "quarter":
        raise InputError(key="domain", value=domain, allowed="quarter if the mesh is read")
    fractions = inputs.fractions(fabric)
    weave = fabric.weave
    try:
        found = assemble(file.groups(), YARNS, (0, 1), True, weave)
    except InputError as problem:
        raise InputError(f"{file.name}: {problem}") from None
    sections = []
    middles = []
    for family, grid in enumerate(found["grids"]):
        places = found["points"][grid]
        _compare_with_fabric(file, fabric, family, places)
        thick = places[0, :, -1, 2] - places[0, :, 0, 2]
        sections.append(ReadSection(tuple(places[0, :, 0, 1 - family]), tuple(thick)))
        middles.append(places[0, 0, [0, -1], 2].mean())
    Vf0 = []
    for yarn, section, fraction in zip(weave.yarns, sections, fractions):
        Vf0.append(yarn.A_s * (1 + yarn.crimp) / section.area)
        if not fraction / 2 < Vf0[-1] <= CLOSEST_PACKING:
            raise InputError(
                f"{file.name}: a section of {1e6 * section.area:.4g} mm2 gives the fibres a volume "
                f"fraction of {Vf0[-1]:.3f}, which must be up to the closest packing "
                f"({CLOSEST_PACKING:.3f}) and above half of the fabric's ({fraction:.3f})"
            )
    warp, weft = sections
    shift = middles[0] - middles[1] - sum(weave.h0)
    fit = ReadSections((warp, weft), float(shift), (Vf0[0], Vf0[1]))
    return Crossover(
        fabric=fabric.name,
        w=weave.w,
        h0=weave.h0,
        S0=weave.S0,
        fibre_area=tuple(yarn.A_s for yarn in weave.yarns),
        section_fit=fit,
        end_shells=None,
        domain=domain,
        script="",
        **found,
    )


def _compare_with_fabric(file, fabric, family, places):
    """Refuse a yarn, nodes (nx+1, ny+1, nz+1, 3) [m], that the counts and the crimp of the fabric
    do not give."""
    name = YARNS[family]
    w = fabric.weave.w[family]
    h = fabric.weave.h0[family]
    along = places[[0, -1], 0, 0, family]
    axis = places[[0, -1], 0][:, [0, -1], 2].mean(axis=1)
    if abs(along[0]) > LENGTH_TOLERANCE * w or abs(along[1] - w) > LENGTH_TOLERANCE * w:
        raise InputError(
            f"{file.name}: the {name} runs from {1e3 * along[0]:.5g} to {1e3 * along[1]:.5g} mm, "
            f"but the counts of {fabric.name} want 0 to {1e3 * w:.5g} mm"
        )
    height = abs(axis[0] - axis[1])
    if abs(height - h) > HEIGHT_TOLERANCE * h:
        raise InputError(
            f"{file.name}: the centreline of the {name} rises by {1e6 * height:.4g} um, but the "
            f"crimp of {fabric.name} gives {1e6 * h:.4g} um: change the crimp in the fabric file"
        )
