"""The five analytic noses, written as STL files and fired like any STL file, against themselves.

    python -m validation.verification.stl_noses [--page docs/reports/stl-noses.md]

Two tables: distance and normal between samples against the analytic ones, by the number of samples in an edge radius;
and shots with both at one ply of S-720, below and above its critical velocity. A last row has the flat nose from a file
with sharp edges, which are rounded as the file is read.
"""

from __future__ import annotations

import tempfile
from dataclasses import replace
from math import radians
from pathlib import Path
from typing import Any

import numpy as np

from fabrics.checks import FloatArray
from shellfabric.impact import simulation
from shellfabric.projectile.projectile import Projectile
from shellfabric.projectile.solid import Solid
from validation.marked_page import markdown, put
from validation.program import program
from weavecell.api import runs
from weavecell.results import provenance
from weavecell.scenes import stl_file

MASS, RADIUS, EDGE, LENGTH = 1.1e-3, 2.7e-3, 0.3e-3, 8e-3
NOSES = {
    "flat": Projectile(MASS, RADIUS, EDGE, length=LENGTH),
    "hemisphere": Projectile(MASS, RADIUS, EDGE, "hemisphere", length=LENGTH),
    "cone": Projectile(MASS, RADIUS, EDGE, "cone", length=LENGTH, half_angle=radians(35), tip_radius=0.5e-3),
    "sphere": Projectile(MASS, RADIUS, EDGE, "sphere"),
    "chisel": Projectile(MASS, RADIUS, EDGE, "chisel", length=LENGTH, flat_width=2.54e-3, flat_angle=radians(35)),
}
VELOCITIES = (80.0, 150.0)  # [m/s]
SAMPLES = (2, 3, 4)  # in an edge radius
SHARP = "flat, sharp in the file"
_MARKS = "<!-- table of {0} -->", "<!-- end of {0} -->"


def triangles(shot: Projectile, rise: int = 241, around: int = 145) -> tuple[FloatArray, np.ndarray]:
    """Corners (n, 3) [m] and triangles (m, 3) of the surface of a projectile; parameters as of its `surface`."""
    rings = shot.surface(rise=rise, around=around)[:, :-1]
    rings = rings[np.r_[True, np.abs(np.diff(rings, axis=0)).max(axis=(1, 2)) > 1e-9]]
    n, m = len(rings) - 2, rings.shape[1]
    here = np.arange(n * m).reshape(n, m)
    next_ = np.roll(here, -1, axis=1)
    faces = [
        np.stack([here[:-1], here[1:], next_[1:]], axis=-1).reshape(-1, 3),
        np.stack([here[:-1], next_[1:], next_[:-1]], axis=-1).reshape(-1, 3),
        np.stack([np.full(m, n * m), here[0], next_[0]], axis=-1),
        np.stack([np.full(m, n * m + 1), next_[-1], here[-1]], axis=-1),
    ]
    return np.vstack([rings[1:-1].reshape(-1, 3), rings[0, 0], rings[-1, 0]]), np.concatenate(faces)


def write(path: Path, points: FloatArray, faces: np.ndarray, binary: bool = True) -> Path:
    """Write a surface of triangles as an STL file in mm."""
    import pyvista

    pyvista.PolyData(1e3 * points, faces=np.insert(faces, 0, 3, axis=1).ravel()).save(path, binary=binary)
    return path


def sampled(shot: Projectile, samples: int) -> Projectile:
    """A projectile by samples of its analytic distance, some of them in an edge radius."""
    points, faces = triangles(shot, 61, 73)
    h = shot.edge_radius / samples
    axes = Solid.axes(points, h)
    d = np.array([[[shot.distance((x, y, z))[0] for z in axes[2]] for y in axes[1]] for x in axes[0]])
    solid = Solid(f"{shot.shape} {samples}", h, points, faces, d)
    rigid = {key: getattr(shot, key) for key in ("mass", "edge_radius", "obliquity", "azimuth", "yaw", "roll")}
    return Projectile(shape="stl", solid=solid, radius=solid.radius, length=solid.length, **rigid)


def errors(shot: Projectile, other: Projectile, count: int = 4000) -> tuple[FloatArray, FloatArray]:
    """(m,) differences of the distance over the edge radius, and [deg] of the normal, at places where contact acts: up
    to half an edge radius deep."""
    rng, end = np.random.default_rng(0), shot.length or 2 * shot.radius
    away = shot.radius + 0.05 * shot.edge_radius
    places = np.column_stack([rng.uniform(-away, away, (4 * count, 2)), rng.uniform(-end, 0, 4 * count)])
    shell = [(place, *shot.distance(place)) for place in places]
    shell = [one for one in shell if -0.5 * shot.edge_radius < one[1] < 0][:count]
    found = [(d, n, *other.distance(place)) for place, d, n in shell]
    turned = [np.degrees(np.arccos(np.clip(n @ m, -1, 1))) for _, n, _, m in found]
    return np.array([(e - d) / shot.edge_radius for d, _, e, _ in found]), np.array(turned)


def from_file(path: Path) -> dict[str, Any]:
    """The keyword `projectile` of the body in an STL file of this study."""
    return {
        "shape": "stl", "stl": str(path), "stl_unit": "mm", "mass": f"{MASS!r} kg", "edge_radius": f"{EDGE!r} m",
    }  # fmt: skip


def fire(shot: Projectile, projectile: dict[str, Any], velocity: float) -> tuple[FloatArray, FloatArray]:
    """The same shot with an analytic nose and with the body of a file.

    Returns
    -------
    rows : (2, 4) peak contact force [N], largest deflection [m], absorbed energy [J], residual velocity [m/s]
    energy_errors : (2,) largest over the strike energy
    """
    setup = runs.setup("S-720", velocity, projectile=projectile, opening="60 mm", end_time="100 us", symmetry="quarter")
    results = [simulation.run(replace(setup, projectile=one)) for one in (shot, setup.projectile)]
    rows = [
        (r.contact_force.max(), r.max_deflection, shot.energy(velocity) - shot.energy(r.residual_velocity),
         r.residual_velocity) for r in results
    ]  # fmt: skip
    return np.array(rows), np.array([result.energy_error_max for result in results])


def bodies(folder: Path) -> dict[str, tuple[Projectile, Path]]:
    """{name: (analytic projectile, its STL file)}."""
    found = {name: (shot, write(folder / f"{name}.stl", *triangles(shot))) for name, shot in NOSES.items()}
    sharp = triangles(replace(NOSES["flat"], edge_radius=1e-6), around=145)
    return found | {SHARP: (NOSES["flat"], write(folder / "sharp.stl", *sharp))}


def main(*, page: Path | None = None) -> None:
    fields = [["nose", *(f"{n} samples: distance, normal" for n in SAMPLES), "as read from the file"]]
    shots = [["nose", "velocity", "peak force", "deflection", "absorbed energy", "residual velocity", "energy error"]]
    with tempfile.TemporaryDirectory() as folder:
        for name, (shot, path) in bodies(Path(folder)).items():
            solid = stl_file.solid(path, "mm", EDGE)
            read = Projectile(MASS, solid.radius, EDGE, "stl", length=solid.length, solid=solid)
            several = [] if name == SHARP else [sampled(shot, n) for n in SAMPLES]
            cells = [_cell(*errors(shot, other)) for other in (*several, read)]
            fields.append([name, *([""] * (len(SAMPLES) + 1 - len(cells))), *cells])
            for velocity in VELOCITIES:
                rows, balance = fire(shot, from_file(path), velocity)
                off = [f"{100 * (b / a - 1):+.2f} %" for a, b in rows.T]
                worst = " / ".join(f"{100 * one:.3f}" for one in balance)
                shots.append([name, f"{velocity:g} m/s", *off, f"{worst} %"])
                print(shots[-1], flush=True)
    print(markdown(fields), markdown(shots), sep="\n")
    if page is not None:
        made = f"Made by `python -m validation.verification.stl_noses`, commit {provenance.stamp()['commit']}."
        for mark, table in (("samples", fields), ("shots", shots)):
            begin, end = (one.format(mark) for one in _MARKS)
            put(page, begin, end, f"\n\n{markdown(table)}\n{made}\n\n")


def _cell(distance, normal):
    """Root mean square and largest of each, as a text."""
    return (
        f"{100 * np.sqrt(np.mean(distance**2)):.2f} ({100 * np.abs(distance).max():.1f}) %, "
        f"{np.sqrt(np.mean(normal**2)):.1f} ({normal.max():.0f})°"
    )


if __name__ == "__main__":
    program(main)
