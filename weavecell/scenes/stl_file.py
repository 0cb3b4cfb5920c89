"""A projectile's body from an STL file: checks of its surface by trimesh, its signed distance on a
grid by VTK.

The z axis of the file is the axis of the projectile and points along its flight; x and y lie along
warp and weft at no obliquity and roll. Where the body lies along z makes no difference: its
foremost point is where the nose is.

Rounding. Where triangles meet at a convex edge by more than SHARP, the body is opened by a ball of
the edge radius rho: it becomes all positions of that ball in it. With K the points at least rho deep,
d = dist(p, K) - rho outside K.
"""

from __future__ import annotations

import hashlib
import io
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fabrics.base import files
from fabrics.base.checks import FilePath, FloatArray
from fabrics.base.errors import InputError, together
from fabrics.base.extras import explain_missing
from fabrics.base.units import si
from shellfabric.projectile import solid as solid_body
from shellfabric.projectile.shapes import SHAPES

if TYPE_CHECKING:
    from trimesh import Trimesh

# [m]
UNITS = {"um": 1e-6, "mm": 1e-3, "cm": 1e-2, "m": 1.0, "inch": 25.4e-3}
# [m] a narrower or wider projectile is a slip of the unit
WIDTHS = (0.5e-3, 100e-3)
# [kg/m3] mean density of a body, from light and hollow ones to osmium
DENSITIES = (500.0, 23000.0)
# [diameters] length of a body, from a disc to a long rod, if it is not given
LENGTHS = (0.25, 30.0)
# [deg] an edge is sharp if the normals of its triangles differ by more
SHARP = 30.0
# samples of the distance within an edge radius (docs/reports/numerics.md)
SAMPLES = 3
# deep inside a body samples may be so many times further apart
COARSE = 4
# about 0.7 GiB while they are computed, 64 MiB afterwards
MOST_SAMPLES = 8_000_000
# corners whose places agree to so many digits of the largest extent are one
_SAME = 6
_HEAD, _FACET = (
    84,
    50,
)  # [bytes] of a binary file: before its triangles, the last four their number, and of each


@dataclass(frozen=True)
class Surface:
    """A closed surface, its foremost point at z = 0.

    Parameters
    ----------
    mesh : Trimesh [m], triangles counterclockwise seen from outside
    digest : SHA-256 of the file
    """

    mesh: Trimesh
    digest: str

    @property
    def points(self) -> FloatArray:
        """(n, 3) [m] corners."""
        return np.array(self.mesh.vertices)

    @property
    def faces(self) -> np.ndarray:
        """(m, 3) corners of each triangle."""
        return np.array(self.mesh.faces)

    @property
    def volume(self) -> float:
        """[m3]"""
        return float(self.mesh.volume)

    @property
    def width(self) -> float:
        """[m] twice the largest distance from the axis."""
        return 2 * float(np.hypot(*self.points[:, :2].T).max())

    @property
    def length(self) -> float:
        """[m] along the axis."""
        return float(-self.points[:, 2].min())

    @property
    def sharp(self) -> bool:
        """Whether triangles meet at a convex edge by more than SHARP."""
        angles = self.mesh.face_adjacency_angles[self.mesh.face_adjacency_convex]
        return bool(np.any(angles > np.radians(SHARP)))

    def explain_axis(self, unit: str) -> str:
        """Explain that a body's axis misses it, with where it lies and the shift that helps."""
        (x0, y0, _), (x1, y1, _) = self.mesh.bounds / UNITS[unit]
        return (
            "its z axis, x = y = 0, must lie in the body: it is the projectile's axis; the body lies from x = "
            f"{x0:.4g} to {x1:.4g} and y = {y0:.4g} to {y1:.4g} {unit}: shift it by {-0.5 * (x0 + x1):.4g} and "
            f"{-0.5 * (y0 + y1):.4g} {unit}"
        )


def surface(path: FilePath, unit: str) -> Surface:
    """Read the surface in an STL file, ASCII or binary, whose lengths have a unit of UNITS.

    Raises
    ------
    InputError : one line: no file, no triangles, not closed, facing inwards, or of no projectile's
        size in this unit
    """
    try:
        digest = hashlib.sha256(files.read_bytes(path, "STL file")).hexdigest()
    except OSError as problem:
        raise InputError(
            f"cannot be read; must be an STL file ({problem.strerror})", file=path
        ) from None
    return _surface(str(path), unit, digest)


@lru_cache(maxsize=4)
def _surface(path, unit, digest):
    content = files.read_bytes(path, "STL file")
    mesh = _triangles(content)
    if not len(mesh.faces):
        raise InputError(f"{_why_empty(content)}; must be an STL file, ASCII or binary", file=path)
    if not np.all(np.isfinite(mesh.vertices)):
        raise InputError("has corners that are no finite numbers", file=path)
    # an STL file lists the corners of each triangle anew, rounded
    mesh.merge_vertices(digits_vertex=_SAME - int(np.floor(np.log10(mesh.extents.max()))))
    corners = np.sort(mesh.faces, axis=1)
    # some triangles have shrunk to a line
    mesh.update_faces(np.all(np.diff(corners, axis=1) > 0, axis=1))
    _check_closed(mesh, path)
    mesh.apply_scale(UNITS[unit])
    # the foremost point is where the fabric is at the start
    mesh.apply_translation((0, 0, -mesh.bounds[1, 2]))
    _check_one_body(mesh, path)
    body = Surface(mesh, digest)
    low, high = mesh.bounds[:, :2]
    if np.any(low >= 0) or np.any(high <= 0):
        raise InputError(body.explain_axis(unit), file=path)
    if not WIDTHS[0] <= max(body.width, body.length) or not body.width <= WIDTHS[1]:
        low, high = (1e3 * width for width in WIDTHS)
        wide = f"{1e3 * body.width:.4g} mm wide and {1e3 * body.length:.4g} mm long in {unit}"
        raise InputError(
            f"is {wide}; must be a body of {low:g} to {high:g} mm: see projectile.stl_unit",
            file=path,
        )
    return body


@explain_missing()
def _triangles(content):
    """The Trimesh of the bytes of a file; an empty one where they are not STL.

    A file is binary if it is long enough for the number of triangles in its head, whatever follows
    them. A text may begin with a byte order mark, be in capitals, and end with "end solid".
    """
    import trimesh

    # a binary file may begin with the word solid too: its length decides
    end = _HEAD + _FACET * int.from_bytes(content[_HEAD - 4 : _HEAD], "little")
    if _HEAD < end <= len(content):
        kind = "stl"
        content = content[:end]
    else:
        text = (
            content.decode("utf-8-sig", errors="replace").lower().replace("end solid", "endsolid")
        )
        kind = "stl_ascii"
        content = text.encode()
    try:
        return trimesh.load_mesh(io.BytesIO(content), file_type=kind, process=False)
    except Exception:
        # there are as many kinds of errors as kinds of broken files
        return trimesh.Trimesh()


def _why_empty(content):
    """Why no triangles are found in the bytes of a file, in words."""
    if not content:
        return "is empty"
    text = content[:1000].lower()
    if b"facet" in text and b"vertex" in text:
        return "is cut or damaged: it begins as an ASCII STL file, whose triangles cannot be read"
    stated = int.from_bytes(content[_HEAD - 4 : _HEAD], "little")
    there = (len(content) - _HEAD) // _FACET
    # a text has letters where a binary file has its number of triangles
    if 0 < there < stated < 1_000_000:
        return f"is cut: it states {stated:,} triangles and has {there:,}"
    return "holds no triangles"


def _check_closed(mesh, path):
    """Every edge has two triangles, which go along it both ways."""
    _, triangles = np.unique(mesh.edges_sorted, axis=0, return_counts=True)
    _, same_way = np.unique(mesh.edges, axis=0, return_counts=True)
    wrong = {
        "is not closed: {} edges have one triangle": triangles == 1,
        "is not the surface of a body: {} edges have more than two triangles": triangles > 2,
        "has normals that point both ways: {} edges between such triangles": same_way > 1,
    }
    for words, where in wrong.items():
        if where.any():
            raise InputError(
                f"{words.format(where.sum())}; must be a watertight surface, normals outwards",
                file=path,
            )


def _check_one_body(mesh, path):
    """One surface whose normals point outwards, and in it cavities, whose normals point inwards."""
    parts = mesh.split(only_watertight=False)
    # a surface that faces outwards encloses a positive volume, a cavity a negative one
    bodies = [part for part in parts if part.volume > 0]
    if len(bodies) > 1:
        volumes = " and ".join(f"{1e9 * part.volume:.4g}" for part in bodies)
        raise InputError(
            f"holds {len(bodies)} separate bodies, of {volumes} mm^3; must be one body", file=path
        )
    inwards = [part for part in parts if part.volume <= 0]
    if bodies:
        low, high = bodies[0].bounds
    else:
        low, high = np.zeros((2, 3))
    if any(np.any(part.bounds[0] < low) or np.any(part.bounds[1] > high) for part in inwards):
        raise InputError(
            "its triangles face inwards; must be a surface whose normals point outwards", file=path
        )


def data(given: dict[str, Any], path: FilePath, file: FilePath | None) -> dict[str, str]:
    """Compute {key: value} of the table [projectile] that follow from its STL file: diameter,
    length, and mass of a density.

    Raises
    ------
    InputError : as `surface`; a mass that the body cannot have in this unit, or no edge radius
    """
    body = surface(path, given["stl_unit"])
    known = {
        "mass": given.get("mass", "1 g"),
        "diameter": f"{body.width!r} m",
        "length": f"{body.length!r} m",
    }
    try:
        if "mass" in given:
            mass = si(given["mass"], "kg")
        else:
            mass = si(given["density"], "kg/m^3") * body.volume
    except InputError:
        # the schema reports it
        return known
    _check_density(given, mass, body, file)
    return known | {"mass": f"{mass!r} kg"}


def _check_density(given, mass, body, file):
    """Refuse a mean density that no solid has: a density that is wrong itself, else a mass, or a
    unit in which the body has another volume."""
    volume = body.volume
    mean = mass / volume
    (low, high) = DENSITIES
    if low <= mean <= high:
        return
    dense = f"{1e-3 * low:g} to {1e-3 * high:g} g/cm^3"
    if "density" in given:
        key = "density"
        allowed = f"from {dense}"
    else:
        key = "mass"
        masses = f"{1e3 * low * volume:.3g} to {1e3 * high * volume:.3g} g"
        allowed = f"from {masses}, of {dense} in the body's {1e9 * volume:.4g} mm^3"
        # the same mass in a body of another unit
        for unit in UNITS:
            larger = UNITS[unit] / UNITS[given["stl_unit"]]
            fits = WIDTHS[0] <= larger * body.width <= WIDTHS[1]
            if fits and low <= mean / larger**3 <= high:
                allowed += f"; or stl_unit {unit}"
    raise InputError(file=file, key=f"projectile.{key}", value=given[key], allowed=allowed)


def describe_stl(
    table: dict[str, Any], fields: Mapping[str, Any], file: FilePath | None
) -> dict[str, Any]:
    """Return the table of a scene with what the STL file of [projectile] says of it, as if it were
    written there; the whole panel unless another symmetry is given.

    Parameters
    ----------
    table : of the scene
    fields : of the schema of [projectile], whose descriptions say what is allowed
    file : of the scene, whose folder the path of the STL file counts from

    Raises
    ------
    InputError : a key that is missing or does not go with an STL file, or what `data` raises
    """
    given = table.get("projectile")
    if not isinstance(given, dict) or given.get("shape") != "stl":
        return table
    missing = []
    for key in ("stl", "stl_unit", "edge_radius"):
        if key not in given:
            allowed = fields[key].description
            line = InputError("is missing", file=file, key=f"projectile.{key}", allowed=allowed)
            missing.append(line)
    if missing:
        raise together(missing)
    for key, fits in (
        ("stl", isinstance(given["stl"], str)),
        ("stl_unit", given["stl_unit"] in [*UNITS]),
    ):
        if not fits:
            raise InputError(
                file=file,
                key=f"projectile.{key}",
                value=given[key],
                allowed=fields[key].description,
            )
    for key in ("diameter", "length"):
        if key in given:
            allowed = "left out: the STL file has it"
            raise InputError(file=file, key=f"projectile.{key}", value=given[key], allowed=allowed)
    if ("mass" in given) == ("density" in given):
        raise InputError(
            "give exactly one of projectile.mass and projectile.density",
            file=file,
            key="projectile",
        )
    measured = data(given, Path("." if file is None else Path(file).parent, given["stl"]), file)
    panel = table.get("panel")
    # a body of any shape has no plane of symmetry that could be relied on
    whole = {}
    if isinstance(panel, dict):
        whole = {"panel": {"symmetry": "whole"} | panel}
    return table | whole | {"projectile": given | measured}


def check_mass(shot: Any) -> None:
    """Check that a body of the diameter and length of a projectile can have its mass; `data` does
    so for an STL file.

    Parameters
    ----------
    shot : table [projectile], in SI

    Raises
    ------
    InputError : a mean density outside DENSITIES, of any length of LENGTHS where none is given
    """
    known = SHAPES[shot.shape]
    least = known.least_volume
    size = "diameter and length"
    lengths = [shot.length, shot.length]
    if not known.edged:
        size = "diameter"
        lengths = [2 / 3 * shot.diameter, 2 / 3 * shot.diameter]
    elif shot.length is None:
        size = f"diameter, {LENGTHS[0]:g} to {LENGTHS[1]:g} times as long"
        lengths = [ratio * shot.diameter for ratio in LENGTHS]
    section = np.pi / 4 * shot.diameter**2
    low = DENSITIES[0] * section * lengths[0] * least
    high = DENSITIES[1] * section * lengths[1]
    if not low <= shot.mass <= high:
        allowed = f"from {1e3 * low:.3g} to {1e3 * high:.3g} g, for a body of this {size}, of "
        allowed += " to ".join(f"{1e-3 * density:g}" for density in DENSITIES) + " g/cm^3"
        raise InputError(key="projectile.mass", allowed=allowed)


def solid(path: FilePath, unit: str, edge_radius: float) -> solid_body.Solid:
    """Read the body in an STL file, its convex edges rounded to the edge radius [m] where they are
    sharp.

    Raises
    ------
    InputError : as `surface`; an edge radius too large or too small for the body, or an axis
        outside of it
    """
    return _solid(str(path), surface(path, unit).digest, unit, edge_radius)


@lru_cache(maxsize=4)
def _solid(path, digest, unit, edge_radius):
    body = _surface(path, unit, digest)
    h = edge_radius / SAMPLES
    # samples are as fine as the edge radius asks; a fine radius on a large body fills the memory
    size = np.prod(np.array([body.width, body.width, body.length]) / h)
    if size > MOST_SAMPLES:
        least = 1e3 * edge_radius * (size / MOST_SAMPLES) ** (1 / 3)
        raise InputError(
            key="edge_radius", value=edge_radius, allowed=f"at least {least:.2g} mm for this body"
        )
    axes = solid_body.Solid.axes(body.points, h)
    distances = _distances(body, axes, h, edge_radius, path)
    middle = distances[axes[0].size // 2, axes[1].size // 2]
    # the axis passes beside the body, or through a hole
    if not middle.min() < 0:
        raise InputError(body.explain_axis(unit), file=path)
    return solid_body.Solid(
        f"{digest} {unit} {edge_radius!r}", h, body.points, body.faces, distances
    )


@explain_missing()
def _distances(body, axes, h, rho, path):
    """(i, j, k) [m] signed distance of the body, opened where it has sharp edges; exact where it is
    below 1.2 rho.

    Further away, where a search for the nearest triangle takes long, it is interpolated between
    samples COARSE h apart.
    """
    import pyvista
    from scipy import ndimage

    def distance(places, skin):
        return np.array(
            pyvista.PolyData(places).compute_implicit_distance(skin)["implicit_distance"]
        )

    def places(axes):
        return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)

    skin: Any = pyvista.wrap(body.mesh)
    wide = [np.linspace(axis[0], axis[-1], axis.size // COARSE + 2) for axis in axes]
    at = places(wide)
    d = distance(at.reshape(-1, 3), skin).reshape(at.shape[:3])
    d = ndimage.zoom(d, [axis.size / coarse.size for axis, coarse in zip(axes, wide)], order=1)
    at = places(axes)
    near = np.abs(d) < 2 * rho
    d[near] = distance(at[near], skin)
    clipped = np.clip(d, -1.2 * rho, 1.2 * rho)
    steps = [np.abs(np.diff(clipped, axis=axis)).max() for axis in range(3)]
    # a distance cannot change by more than the way between two samples
    if max(steps) > 1.05 * h:
        raise InputError(
            "its distance jumps; must be a surface without slivers that does not intersect itself",
            file=path,
        )
    # opening: shrink the body by the radius, and grow it again; convex edges come out round
    if body.sharp:
        grid: Any = pyvista.ImageData(
            dimensions=d.shape, spacing=(h, h, h), origin=[axis[0] for axis in axes]
        )
        core: Any = grid.contour([-rho], scalars=d.ravel(order="F"))
        if not core.n_cells:
            raise InputError(
                key="edge_radius", value=rho, allowed=f"below {-1e3 * d.min():.3g} mm for this body"
            )
        shell = near & (d > -rho)
        d[shell] = np.abs(distance(at[shell], core)) - rho
    return d
