"""The patch of 20 x 20 crossovers in 160,000 bricks, 42 us of impact, and the shell of the same size, weave and shot.

The thesis (Table 4-3: S-720, one ply, 25.4 mm, 42 us, 157,424 s on 3 processors) tells neither the strike velocity nor
how the patch is held. Here all yarn ends are held, the patch is whole, and it is struck at 60 m/s, at which no yarn of
a patch so small breaks in that time.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fabrics import catalogue
from fabrics.checks import FloatArray
from fabrics.errors import InputError
from fabrics.files import write_hdf5
from meshing import patch
from shellfabric.impact import simulation
from validation.models.solid.model import SolidPatch
from validation.models.solid.numerics import PatchNumerics
from validation.models.solid.solver import SAMPLES, SolidSolver

FORMAT = "weavecell solid patch 1"
SOURCE_SECONDS, SOURCE_PROCESSORS = 157_424, 3  # Table 4-3
UNITS = {"t": "s", "v": "m/s", "z": "m", "push": "N", "dt": "s", "failed_bars": "1"}
FORCES = ("warp_peak", "weft_peak", "warp_nose", "weft_nose")


@dataclass(frozen=True)
class Shell:
    """What the shell says of the same shot, one value an instant: times [s], velocity [m/s], place [m] of the
    projectile; tensions [N] of the two middle yarns under the nose, warp and weft (n, 2); at the instants `shots` [s]
    the profiles (m, k, 2) [m] along the middle warp, place and height."""

    t: np.ndarray
    v: np.ndarray
    z: np.ndarray
    nose: np.ndarray
    shots: np.ndarray
    profiles: np.ndarray


def march(
    name: str = "S-720", count: int = 20, size: Any = (5, 5, 2), velocity: float = 60.0, end_time: float = 42e-6, *,
    threads: int | None = None, numerics: Any = None,
) -> SolidSolver:  # fmt: skip
    """The march of a square patch, ready to run.

    Raises
    ------
    InputError : an odd number of yarns (the shot falls between two), or as SolidPatch and SolidSolver
    """
    if count % 2 or count < 4:
        raise InputError(key="count", value=count, allowed="even and at least 4")
    fabric = catalogue.load(name)
    mesh = patch.build(fabric, (count, count), size=tuple(size))
    numerics = PatchNumerics() if numerics is None else numerics
    return SolidSolver(SolidPatch(mesh, fabric, numerics=numerics), velocity, end_time, threads=threads)


def shell(march: Any) -> Shell:
    """The same shot on the shell: one element a crossover, the published compression law."""
    weave, count = march.patch.fabric.weave, march.patch.count[0]
    opening = tuple(2 * w * count * (1 + 1e-6) for w in weave.w)
    setup = simulation.ImpactSetup(
        march.patch.fabric, march.strike_velocity, projectile=march.patch.projectile, opening=opening,
        end_time=march.end_time, audit_interval=0.5e-6, snapshot_interval=1e-6,
    )  # fmt: skip
    found = simulation.run(setup)
    under = [np.arange(count // 2) * 2 * w + w < march.patch.projectile.radius for w in weave.w]
    nose = [(shot.tension[under[0], 0, 0].mean(), shot.tension[0, under[1], 1].mean()) for (shot,) in found.snapshots]
    nose = np.array(nose).reshape(-1, 2)  # type: ignore[assignment]
    times = [shot.t for (shot,) in found.snapshots]
    tensions = np.stack([np.interp(found.t, times, nose[:, k]) for k in (0, 1)], axis=1)  # type: ignore[call-overload]
    profiles = np.array([shot.nodes[:, 0][:, [0, 2]] for (shot,) in found.snapshots])
    return Shell(found.t, found.v, found.nose_position, tensions, np.array(times), profiles)


def clock(march: Any) -> float:
    """[s] of the march at which its nose reaches the middle plane of the cloth, where the shell's clock starts."""
    return float(np.interp(0.0, march.sample("z"), march.sample("t")))


def profile(march: Any) -> FloatArray:
    """(k, 2) [m] place and height of the axis between the two middle warps, along it."""
    mesh, x = march.patch.mesh, march.state.x
    half = march.patch.count[0] // 2
    _, across, through = (n // 2 for n in mesh.grids[0].shape)
    return np.mean([x[mesh.grids[yarn][:, across, through]] for yarn in (half - 1, half)], axis=0)[:, [0, 2]]


def node_strains(march: Any) -> FloatArray:
    """(n,) [-] mean strain of the whole fibres that meet at each node."""
    mesh, x = march.patch.mesh, march.state.x
    pairs = np.concatenate(mesh.bars)
    ends, rest = x[pairs], mesh.points[pairs]
    strain = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1) / np.linalg.norm(rest[:, 1] - rest[:, 0], axis=1) - 1
    whole = march.state.bar_intact
    total, number = np.zeros(len(x)), np.zeros(len(x))
    for end in (0, 1):
        np.add.at(total, pairs[whole, end], strain[whole])
        np.add.at(number, pairs[whole, end], 1)
    return total / np.maximum(number, 1)


def summary(march: Any, beside: Any = None, processor_seconds: float | None = None) -> list[tuple[str, str]]:
    """Lines of name and text: what was run, what it cost, what it says."""
    last = dict(zip(SAMPLES, march.samples[-1]))
    taken = march.strike_energy - last["kinetic_projectile"]
    balance = np.abs(march.sample("error")).max()
    late = clock(march)
    lines = [
        ("bricks, bars", f"{march.patch.bricks}, {march.state.bar_intact.size}"),
        ("steps", f"{march.steps} of {1e9 * march.sample('dt').min():.2f} to {1e9 * march.sample('dt').max():.2f} ns"),
        ("time of marching", f"{march.wall_time:.0f} s by the clock"),
        ("projectile", f"{last['v']:.3f} m/s, {1e3 * last['z']:.3f} mm"),
        ("energy taken", f"{1e3 * taken:.2f} mJ"),
        ("largest imbalance", f"{100 * balance / taken:.3g} % of it"),
        ("hourglass", f"{100 * last['hourglass'] / taken:.2g} % of it; viscous {100 * last['viscous'] / taken:.2g} %"),
        ("failed bars", f"{last['failed_bars']:.0f}"),
        ("peak tension", f"warp {last['warp_peak']:.1f}, weft {last['weft_peak']:.1f} N"),
        ("under the nose", f"warp {last['warp_nose']:.1f}, weft {last['weft_nose']:.1f} N"),
    ]
    if processor_seconds is not None:
        each = 1e9 * processor_seconds / march.steps / march.patch.bricks
        lines.insert(3, ("processor time", f"{processor_seconds:.0f} s, {each:.0f} ns a brick and step"))
    if beside is not None:
        # the nose meets the lowest yarns of the patch first, the shell with its middle plane
        then = last["t"] - late
        v, z, warp, weft = (np.interp(then, beside.t, c) for c in (beside.v, beside.z, *beside.nose.T))
        lines += [
            ("nose at middle plane", f"after {1e6 * late:.2f} us: the shell's clock starts there"),
            ("shell: projectile", f"{v:.3f} m/s, {1e3 * z:.3f} mm, at the same time from there"),
            ("shell: under the nose", f"warp {warp:.1f}, weft {weft:.1f} N"),
        ]
    return lines


def write(march: Any, beside: Any, path: Path) -> None:
    """Samples, places at the end, and the shell's histories, in one HDF5 file; every dataset has its unit."""
    with write_hdf5(path, FORMAT, fabric=march.patch.fabric.name) as file:
        file.attrs["strike_velocity"], file.attrs["wall_time"] = march.strike_velocity, march.wall_time
        file.attrs["bricks"], file.attrs["steps"] = march.patch.bricks, march.steps

        def put(name, values, unit):
            file[name] = values
            file[name].attrs["unit"] = unit

        for name in SAMPLES:
            put(f"histories/{name}", march.sample(name), "N" if name in FORCES else UNITS.get(name, "J"))
        put("end/places", march.state.x, "m")
        put("end/fibre_strain", node_strains(march), "1")
        put("end/hexes", march.patch.mesh.hexes, "1")
        for name, unit in (("t", "s"), ("v", "m/s"), ("z", "m"), ("nose", "N"), ("shots", "s"), ("profiles", "m")):
            put(f"shell/{name}", getattr(beside, name), unit)
