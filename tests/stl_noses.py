"""The five analytic noses as STL files and as samples of their distance, and shots with both at one ply of S-720."""

from dataclasses import replace
from math import radians

import numpy as np

from fabrics.base.kernel_cache import kernel
from shellfabric.impact.run import run_impact
from shellfabric.projectile import sdf_kernels
from shellfabric.projectile.projectile import Projectile
from shellfabric.projectile.solid import Solid
from weavecell.api import runs

MASS = 1.1e-3
RADIUS = 2.7e-3
EDGE = 0.3e-3
LENGTH = 8e-3
NOSES = {
    "flat": Projectile(MASS, RADIUS, EDGE, length=LENGTH),
    "hemisphere": Projectile(MASS, RADIUS, EDGE, "hemisphere", length=LENGTH),
    "cone": Projectile(
        MASS, RADIUS, EDGE, "cone", length=LENGTH, half_angle=radians(35), tip_radius=0.5e-3
    ),
    "sphere": Projectile(MASS, RADIUS, EDGE, "sphere"),
    "chisel": Projectile(
        MASS, RADIUS, EDGE, "chisel", length=LENGTH, flat_width=2.54e-3, flat_angle=radians(35)
    ),
}
VELOCITIES = (80.0, 150.0)  # [m/s]
DEFLECTION = 1  # of a row of `fire`


def triangles(shot, rise=241, around=145):
    """Corners (n, 3) [m] and triangles (m, 3) of the surface of a projectile; parameters as of its `surface`."""
    rings = shot.surface(rise=rise, around=around)[:, :-1]
    rings = rings[np.r_[True, abs(np.diff(rings, axis=0)).max(axis=(1, 2)) > 1e-9]]
    n = len(rings) - 2
    m = rings.shape[1]
    here = np.arange(n * m).reshape(n, m)
    next_ = np.roll(here, -1, axis=1)
    faces = [
        np.stack([here[:-1], here[1:], next_[1:]], axis=-1).reshape(-1, 3),
        np.stack([here[:-1], next_[1:], next_[:-1]], axis=-1).reshape(-1, 3),
        np.stack([np.full(m, n * m), here[0], next_[0]], axis=-1),
        np.stack([np.full(m, n * m + 1), next_[-1], here[-1]], axis=-1),
    ]
    return np.vstack([rings[1:-1].reshape(-1, 3), rings[0, 0], rings[-1, 0]]), np.concatenate(faces)


def write(path, points, faces, binary=True):
    """Write a surface of triangles as an STL file in mm."""
    import pyvista

    pyvista.PolyData(1e3 * points, faces=np.insert(faces, 0, 3, axis=1).ravel()).save(
        path, binary=binary
    )
    return path


@kernel()
def fill_distances(nose, places, depths, normals):
    """Compute the signed distances [m] of places (n, 3) in the frame of a nose, and the normals (n, 3) there."""
    for k in range(places.shape[0]):
        depth, normal = sdf_kernels.distance(nose, (places[k, 0], places[k, 1], places[k, 2]))
        depths[k] = depth
        normals[k, 0], normals[k, 1], normals[k, 2] = normal


def distances(shot, places):
    """Compute the signed distances (n,) [m] of a projectile and the normals (n, 3) at places (n, 3), as its
    `distance` does one by one."""
    depths = np.empty(len(places))
    normals = np.empty((len(places), 3))
    fill_distances(shot.nose, np.ascontiguousarray(places @ shot.frame.T), depths, normals)
    return depths, normals @ shot.frame


def sampled(shot, samples):
    """A projectile by samples of its analytic distance, some of them in an edge radius."""
    points, faces = triangles(shot, 61, 73)
    h = shot.edge_radius / samples
    axes = Solid.axes(points, h)
    places = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    depths, _ = distances(shot, places.reshape(-1, 3))
    d = depths.reshape(places.shape[:3])
    solid = Solid(f"{shot.shape} {samples}", h, points, faces, d)
    rigid = {
        key: getattr(shot, key)
        for key in ("mass", "edge_radius", "obliquity", "azimuth", "yaw", "roll")
    }
    return Projectile(shape="stl", solid=solid, radius=solid.radius, length=solid.length, **rigid)


def errors(shot, other, count=4000):
    """(m,) differences of the distance over the edge radius, and [deg] of the normal, at places where contact acts: up
    to half an edge radius deep."""
    rng = np.random.default_rng(0)
    end = shot.length or 2 * shot.radius
    away = shot.radius + 0.05 * shot.edge_radius
    places = np.column_stack(
        [rng.uniform(-away, away, (4 * count, 2)), rng.uniform(-end, 0, 4 * count)]
    )
    depths, normals = distances(shot, places)
    shell = np.flatnonzero((depths > -0.5 * shot.edge_radius) & (depths < 0))[:count]
    found, turned = distances(other, places[shell])
    cosine = np.einsum("ij,ij->i", normals[shell], turned)
    off = (found - depths[shell]) / shot.edge_radius
    return off, np.degrees(np.arccos(np.clip(cosine, -1, 1)))


def from_file(path):
    """The keyword `projectile` of the body in an STL file of these noses."""
    return {
        "shape": "stl",
        "stl": str(path),
        "stl_unit": "mm",
        "mass": f"{MASS!r} kg",
        "edge_radius": f"{EDGE!r} m",
        "friction": 0,
    }


def fire(shot, projectile, velocity):
    """The same shot with an analytic nose and with the body of a file.

    Returns
    -------
    rows : (2, 4) peak contact force [N], largest deflection [m], absorbed energy [J], residual velocity [m/s]
    energy_errors : (2,) largest over the strike energy
    """
    setup = runs.setup(
        "S-720",
        velocity,
        projectile=projectile,
        opening="60 mm",
        end_time="100 us",
        symmetry="quarter",
    )
    results = [run_impact(replace(setup, projectile=one)) for one in (shot, setup.projectile)]
    rows = [
        (
            r.contact_force.max(),
            r.max_deflection,
            shot.energy(velocity) - shot.energy(r.residual_velocity),
            r.residual_velocity,
        )
        for r in results
    ]
    return np.array(rows), np.array([result.energy_error_max for result in results])
