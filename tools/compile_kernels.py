"""Compile the kernels of the usual runs, so that the first shot of a user does not wait for them.

One ply on a graded and on a uniform mesh, stopped and perforated, and a pack: about a minute on two
cores. Kernels that are in the cache already are not compiled again. Blocks, coupons and resolved
yarns are compiled when one is run.
"""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

# short shots that call every kernel of their kind
SHOTS = {
    "a ply on a graded mesh, perforated": {"velocity": "250 m/s", "end_time": "60 us"},
    "a ply on a uniform mesh, perforated": {
        "velocity": "250 m/s",
        "end_time": "60 us",
        "elements_per_crossover": 1,
    },
    "a pack": {"velocity": "300 m/s", "end_time": "30 us", "plies": 2},
}


def main() -> None:
    """Fire all shots, and say what they have compiled the kernels of."""
    import weavecell as wc

    for name, shot in SHOTS.items():
        options = dict(shot)
        wc.impact("S-720", options.pop("velocity"), opening="60 mm", **options)
        print(f"setup:   {name}", flush=True)


if __name__ == "__main__":
    main()
