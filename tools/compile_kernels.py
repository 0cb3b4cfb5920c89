"""Compile the kernels of the usual runs, so that the first shot of a user does not wait for them.

    python tools/compile_kernels.py {ply,all} [--portable]

ply : what `make demo` and a first shot run, one ply on a graded mesh; half a minute on two cores
all : also packs, uniform meshes, the projectiles, edges that slip, resolved yarns, blocks, coupons
    and woven solids; two to three minutes

What is in the cache already is not compiled again; kernels that no source stands for are removed.
--portable compiles for all processors with the instructions of x86-64-v3, or of 64-bit ARM, which
find these kernels where they have none of their own: for an image or a wheel.
"""

from __future__ import annotations

import argparse
import os
import shutil
import sys
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT))

CYLINDER = {"mass": "3 g", "diameter": "5.5 mm", "edge_radius": "0.3 mm"}
BLOCK = {
    "modulus": "100 MPa",
    "size": ["60 mm", "60 mm", "30 mm"],
    "min_size": "3 mm",
    "growth": 1.5,
}
# short shots that call every kernel of their kind
SHOTS: dict[str, dict[str, Any]] = {
    # so wide that a membrane is left about its resolved yarns
    "a ply on a graded mesh": {"velocity": "250 m/s", "opening": "130 mm", "end_time": "60 us"},
    "a ply on a uniform mesh": {
        "velocity": "250 m/s",
        "end_time": "60 us",
        "elements_per_crossover": 1,
    },
    "a pack on a graded mesh": {"velocity": "300 m/s", "end_time": "30 us", "plies": 2},
    "a pack on a uniform mesh": {
        "velocity": "300 m/s",
        "end_time": "30 us",
        "plies": 2,
        "elements_per_crossover": 1,
    },
    "a bullet of metal": {
        "velocity": "300 m/s",
        "end_time": "8 us",
        "projectile": "9 mm FMJ 8.0 g",
    },
    "a bullet of metal on a uniform mesh": {
        "velocity": "300 m/s",
        "end_time": "8 us",
        "projectile": "9 mm FMJ 8.0 g",
        "elements_per_crossover": 1,
    },
    "a bullet of metal on a uniform pack": {
        "velocity": "300 m/s",
        "end_time": "4 us",
        "opening": "30 mm",
        "plies": 2,
        "projectile": "9 mm FMJ 8.0 g",
        "elements_per_crossover": 1,
    },
    "an oblique shot at pinned crossovers": {
        "velocity": "90 m/s",
        "end_time": "4 us",
        "crossovers": "pinned",
        "projectile": CYLINDER | {"obliquity": "30 deg"},
        "symmetry": "whole",
    },
    "an elastic bar": {
        "velocity": "155 m/s",
        "end_time": "4 us",
        "projectile": CYLINDER | {"body": "elastic_bar"},
    },
    "a fragment": {"velocity": "200 m/s", "end_time": "4 us", "projectile": "FSP 1.10 g"},
    "a nose from a file": {
        "velocity": "200 m/s",
        "end_time": "4 us",
        "projectile": {
            "shape": "stl",
            "stl": str(ROOT / "examples" / "cube.stl"),
            "stl_unit": "mm",
            "density": "7.85 g/cm^3",
            "edge_radius": "0.4 mm",
            "yaw": "45 deg",
        },
    },
    "edges that slip": {
        "velocity": "150 m/s",
        "end_time": "4 us",
        "boundary": {"warp": "clamped", "weft": {"clamp_force": "60 N"}},
    },
    "resolved yarns": {"velocity": "200 m/s", "end_time": "20 us", "crossovers": "yarns"},
    "plies that are turned": {
        "velocity": "300 m/s",
        "end_time": "4 us",
        "opening": "30 mm",
        "ply": [{}, {"name": "S-726", "angle": "30 deg"}],
    },
    "a pack at pinned crossovers": {
        "velocity": "300 m/s",
        "end_time": "30 us",
        "opening": "30 mm",
        "crossovers": "pinned",
        "ply": [{}, {"name": "S-726", "angle": "30 deg"}],
    },
    "a block behind a ply": {"velocity": "100 m/s", "end_time": "4 us", "backing": BLOCK},
    "a block behind a ply on a uniform mesh": {
        "velocity": "100 m/s",
        "end_time": "4 us",
        "backing": BLOCK,
        "elements_per_crossover": 1,
    },
}


def list_runs() -> Iterator[tuple[str, Callable[[], object]]]:
    """Yield what is compiled by name, and the run that compiles it; no woven solids without gmsh."""
    import weavecell as wc

    for name, shot in SHOTS.items():
        options = dict(shot)
        velocity, opening = options.pop("velocity"), options.pop("opening", "60 mm")
        yield name, partial(wc.impact, "S-720", velocity, opening=opening, **options)
    frame = partial(wc.coupon, "S-720", "picture_frame")
    yield "coupons", partial(frame, shear_angle="4 deg", crossovers=2, steps=1)


def main() -> None:
    """Fire the shots, and say what is compiled."""
    from fabrics.base.kernel_cache import COMMON, kernel_folder

    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("kinds", choices=["ply", "all"])
    parser.add_argument("--portable", action="store_true")
    chosen = parser.parse_args()
    if chosen.portable:
        # read by numba when it is imported
        os.environ |= {"NUMBA_CPU_NAME": COMMON[os.uname().machine], "NUMBA_CPU_FEATURES": ""}
    for name, run in list_runs():
        print(f"kernels: {name}", flush=True)
        run()
        if chosen.kinds == "ply":
            break
    for package in ("fabrics", "shellfabric"):
        of_today = {kernel_folder(file, ROOT) for file in (ROOT / package).rglob("*.py")}
        for folder in (ROOT / package / "__pycache__").glob("kernels-*"):
            if folder.name not in of_today:
                shutil.rmtree(folder)


if __name__ == "__main__":
    main()
