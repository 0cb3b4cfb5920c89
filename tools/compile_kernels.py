"""Compile the kernels of the usual runs, so that the first shot of a user does not wait for them.

    python tools/compile_kernels.py [--portable]

One ply on a graded and on a uniform mesh, a pack, a bullet of metal and resolved yarns, perforated:
about a minute on two cores. Kernels that are in the cache already are not compiled again, those that
no source stands for any more are removed. Blocks and coupons are compiled when one is run.

--portable compiles for all processors with the instructions of x86-64-v3, or of 64-bit ARM, which
find these kernels where they have none of their own: for an image or a wheel.
"""

from __future__ import annotations

import os
import shutil
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT))

# short shots that call every kernel of their kind
SHOTS = {
    "a ply on a graded mesh": {"velocity": "250 m/s", "end_time": "60 us"},
    "a ply on a uniform mesh": {
        "velocity": "250 m/s",
        "end_time": "60 us",
        "elements_per_crossover": 1,
    },
    "a pack": {"velocity": "300 m/s", "end_time": "30 us", "plies": 2},
    "a bullet of metal": {
        "velocity": "300 m/s",
        "end_time": "8 us",
        "projectile": "9 mm FMJ 8.0 g",
    },
    "resolved yarns": {"velocity": "200 m/s", "end_time": "20 us", "crossovers": "yarns"},
}


def main() -> None:
    """Fire all shots, and say what they have compiled the kernels of."""
    from fabrics.base.kernel_cache import COMMON, kernel_folder

    if "--portable" in sys.argv[1:]:
        # read by numba when it is imported
        os.environ |= {"NUMBA_CPU_NAME": COMMON[os.uname().machine], "NUMBA_CPU_FEATURES": ""}
    import weavecell as wc

    for name, shot in SHOTS.items():
        options = dict(shot)
        wc.impact("S-720", options.pop("velocity"), opening="60 mm", **options)
        print(f"setup:   {name}", flush=True)
    for package in ("fabrics", "shellfabric"):
        of_today = {kernel_folder(file, ROOT) for file in (ROOT / package).rglob("*.py")}
        for folder in (ROOT / package / "__pycache__").glob("kernels-*"):
            if folder.name not in of_today:
                shutil.rmtree(folder)


if __name__ == "__main__":
    main()
