"""The mesh of a crossover or a woven patch."""

from __future__ import annotations

import logging
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, TypedDict, Unpack

from fabrics import assumed, catalogue
from fabrics.base.checks import FilePath
from fabrics.base.door import option
from fabrics.base.errors import InputError
from fabrics.fabric import Fabric
from weavecell.answers.mesh import MeshResult, names_of
from weavecell.api import quantities
from weavecell.api.command import Plan, Running, command
from weavecell.api.run_size import WorkSize

if TYPE_CHECKING:
    from meshing.mesh import YarnMesh

FORMATS = ("msh", "geo", "vtu", "k", "inp", "rad")
SIZES = ("coarse", "medium", "fine", "auto")
# of calibrations and surfaces: a finer mesh costs five times as much, and is not closer (docs/reports/mesh-and-cost.md)
SOLVED = "8,6,4"
# yarns of the smallest cell that repeats in a plain weave
PERIODIC = (2, 2)


class Sections(TypedDict, total=False):
    """The sections of the yarns.

    Parameters
    ----------
    section : sine, ellipse or conforming; the fabric's own if not given
    yarn_gap : gap between parallel yarns [m]; none if not given
    """

    section: Literal["sine", "ellipse", "conforming"] | None
    yarn_gap: float | str


class Geometry(Sections, total=False):
    """The geometry of what is meshed.

    Parameters
    ----------
    section : sine, ellipse or conforming; the fabric's own if not given
    yarn_gap : gap between parallel yarns [m]; none if not given
    width : width of both yarns, or of warp and weft [m]; else the fabric's
    crimp : hand (default) or micrograph, as it was measured, or values for both yarns or warp and
        weft
    tip_thickness_ratio : thickness of the cut tips over that of the middle; 0.075 if not given
    overlap : what to do with sections that overlap by more than a shift removes: solve (default) or
        refuse
    end_shells : close the yarn ends with shells of this thickness [m]
    """

    width: float | str | Sequence[float] | None
    crimp: str | float | Sequence[float]
    tip_thickness_ratio: float
    overlap: Literal["solve", "refuse"]
    end_shells: float | str | None


@dataclass(frozen=True)
class MeshPlan(Plan[MeshResult]):
    """A mesh that is about to be made.

    Parameters
    ----------
    fabric : Fabric
    domain : "quarter", "whole" or "periodic"
    count : (warp, weft) yarns of a patch, or None
    options : of `build`
    formats : suffixes of the files
    """

    runs = ""

    fabric: Fabric
    domain: str
    count: Sequence[int] | None
    options: dict[str, Any]
    formats: tuple[str, ...]

    @property
    def files(self) -> list[str]:  # type: ignore[override]
        """The names of what is written."""
        stem = "crossover"
        if self.count is not None or self.domain == "periodic":
            stem = "patch"
        return names_of(stem, self.formats)

    def _build(self):
        return build(self.fabric, self.domain, self.count, **self.options)

    def forecast(self) -> WorkSize:
        """Count hexahedra and nodes of the mesh, which is made: what cannot be meshed is refused."""
        return size_of_mesh(f"{self.fabric.name}, mesh", self._build())

    def run(self, running: Running) -> MeshResult:
        """Mesh."""
        return running.save(MeshResult(self.fabric, self._build(), self.formats))


def size_of_mesh(title: str, mesh: Any, **amounts: int) -> WorkSize:
    """Return the WorkSize of what is computed on a mesh."""
    return WorkSize(title, {"hexahedron": len(mesh.hexes), "node": len(mesh.points), **amounts})


@command(MeshPlan)
def mesh(
    fabric: Fabric | FilePath,
    *,
    mesh: str | float | Sequence[int] = "medium",
    domain: Literal["quarter", "whole", "periodic"] | None = None,
    patch: str | Sequence[int] | None = None,
    format: str = "msh,vtu",
    check: bool = False,
    out: FilePath | None = None,
    **geometry: Unpack[Geometry],
) -> MeshPlan:
    """Mesh a crossover or a woven patch in hexahedra, with a picture of it and one of its quality.

    A gmsh mesh (msh), the geometry itself as a gmsh script (geo), ParaView (vtu), LS-DYNA (k),
    Abaqus (inp), OpenRadioss (rad). The fabric has the linear density of its data sheet.

    Parameters
    ----------
    fabric : name of the catalogue, or path of a fabric file; in Python also a Fabric
    mesh : auto, coarse, medium or fine, the numbers of hexahedra along, across and through a
        quarter yarn, such as 8,6,2, or an edge length
    domain : quarter by symmetry (default), one whole crossover, or a periodic cell of 2 x 2 yarns
    patch : a woven patch of N warp and M weft yarns instead, NxM
    format : files to write, separated by commas: msh, geo, vtu, k, inp, rad
    check : mesh, and write nothing: say how many hexahedra it has
    out : folder of the results; in Python None writes nothing
    **geometry : geometry of what is meshed, if not that of the fabric

    Returns
    -------
    MeshResult

    Raises
    ------
    InputError : an option that is not allowed, or a fabric that cannot be meshed; nothing has been
        written

    Examples
    --------
    >>> wc.mesh("S-720", mesh="coarse", domain="whole").summary()["hexahedra"]
    768
    """
    fabric = resolve_fabric_for_3d(fabric)
    if patch is not None and domain is not None:
        raise InputError(
            key="patch", value=patch, allowed=f"left out if {option('domain', '')} is given"
        )
    formats = [part.strip().lstrip(".").lower() for part in format.split(",")]
    for part in formats:
        if part not in FORMATS:
            raise InputError(
                key="format", value=part, allowed=f"one or more of {', '.join(FORMATS)}"
            )
    options = options_of(geometry, Geometry) | {"size": size(mesh)}
    count = None
    if patch is not None:
        count = _count(patch)
    return MeshPlan(fabric, domain or "quarter", count, options, tuple(dict.fromkeys(formats)))


def read_fabric(fabric: Fabric | FilePath) -> Fabric:
    """Return a fabric, that of a name or file."""
    if isinstance(fabric, Fabric):
        return fabric
    return catalogue.load(fabric)


@contextmanager
def of_fabric(fabric: Fabric | FilePath) -> Iterator[None]:
    """Name the fabric in a refusal of this block that names no file or key."""
    try:
        yield
    except InputError as problem:
        if problem.file or problem.key:
            raise
        name = getattr(fabric, "name", str(fabric))
        raise InputError(str(problem), key="fabric", value=name) from None


def resolve_fabric_for_3d(fabric: Fabric | FilePath) -> Fabric:
    """Return a fabric with what a 3D crossover needs, with the linear density of its data sheet;
    log what is assumed.

    The densities of the runs of the thesis (erratum E-07) are those of its shells.

    Raises
    ------
    InputError : no such fabric, or one without [solid] tables for whose yarns none are assumed
    """
    from meshing.mesh_plan import with_room

    with of_fabric(fabric):
        whole = with_room(assumed.with_solid_laws(read_fabric(fabric)))
    for line in (*whole.notes, *assumed.lines(assumed.given(whole, "failure_length"))):
        logging.getLogger("weavecell").info(line)
    return whole


def options_of(given: Mapping[str, Any], known: type) -> dict[str, Any]:
    """Convert keywords to options of `meshing.crossover.build`, in SI units.

    Parameters
    ----------
    known : Sections or Geometry, whose keywords are allowed

    Raises
    ------
    InputError : another keyword, or a value that is not allowed
    """
    options: dict[str, Any] = {}
    for key, value in given.items():
        if key not in known.__annotations__:
            allowed = f"one of {', '.join(known.__annotations__)}"
            raise InputError(key=key, value=value, allowed=allowed)
        if value is None:
            continue
        if key == "yarn_gap":
            options["gap"] = quantities.number(value, "m", key)
        elif key == "width":
            options[key] = quantities.pair(value, "m", key)
        elif key == "end_shells":
            options[key] = quantities.number(value, "m", key)
        elif key == "crimp" and value not in ("hand", "micrograph"):
            options[key] = quantities.pair(value, "", key)
        else:
            options[key] = value
    return options


def size(value: Any, key: str = "mesh") -> Any:
    """Read a name, three numbers, an edge length [m], or a MeshFile of the path of a .msh file, as
    `meshing.inputs.size` takes it, also from a text; `key` names it in errors.

    Raises
    ------
    InputError : a text that is none of these, or a file that cannot be read
    """
    if isinstance(value, Path) or (isinstance(value, str) and value.endswith(".msh")):
        from meshing.mesh_file import MeshFile

        return MeshFile.load(value)
    if isinstance(value, (list, tuple)):
        return _whole_numbers(value, 3, key, "three whole numbers nx, ny, nz")
    if not isinstance(value, str):
        return quantities.read_positive(value, "m", key)
    if value in SIZES:
        return value
    if re.fullmatch(r"\s*\d+\s*(,\s*\d+\s*)*", value):
        return tuple(map(int, value.split(",")))
    if re.fullmatch(r"\s*[\d.+-][^,]*", value):
        return quantities.number(value, "m", key)
    raise InputError(
        key=key, value=value, allowed=f"{', '.join(SIZES)}, nx,ny,nz or a length such as 60um"
    )


PATCH = "numbers of warp and weft yarns, such as 3x4"


def _count(patch):
    """(n, m) numbers of warp and weft yarns, also of a text such as "3x4"."""
    if not isinstance(patch, str):
        return _whole_numbers(patch, 2, "patch", PATCH)
    counts = re.fullmatch(r"\s*(\d+)\s*[xX×]\s*(\d+)\s*", patch)
    if counts is None:
        raise InputError(key="patch", value=patch, allowed=PATCH)
    return int(counts[1]), int(counts[2])


def _whole_numbers(values, count, key, allowed):
    """A tuple of so many whole numbers above zero.

    Raises
    ------
    InputError : anything else
    """
    try:
        numbers = tuple(quantities.read_whole(value, key, 1) for value in values)
    except InputError:
        numbers = ()
    if len(numbers) != count:
        raise InputError(key=key, value=values, allowed=allowed)
    return numbers


def build(
    fabric: Fabric, domain: str, count: Sequence[int] | None = None, **options: Any
) -> YarnMesh:
    """Mesh a quarter or whole crossover, the periodic cell (of plain weave 2 x 2 yarns, of others the
    least, `Pattern.cell`), or a patch of `count` (n, m) yarns.

    `options` are those of `meshing.crossover.build`.
    """
    from meshing import crossover, patch

    if domain == "periodic":
        pattern = fabric.weave.pattern
        count = PERIODIC if pattern.is_plain else pattern.cell[:2]
    if count is None:
        return crossover.build(fabric, domain=domain, **options)
    return patch.build(fabric, count, **options)


def of_calibration(fabric: Fabric, size: Any) -> MeshResult:
    """Mesh a whole crossover to be shown beside a calibration; a mesh that is read as it is."""
    from meshing.mesh_file import MeshFile

    if isinstance(size, MeshFile):
        return MeshResult(fabric, build(fabric, "quarter", size=size), ("vtu",))
    return MeshResult(fabric, build(fabric, "whole", size=size))
