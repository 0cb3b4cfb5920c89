"""
A fabric from data-sheet values
===============================

What the file ``examples/fabrics/mine.toml`` does not state is assumed by fibre family; the result has the range of the
residual velocity over these assumptions. The compression law is given here. ``wc.calibrate(fabric, mesh="coarse")``
computes it from the 3D crossover, which needs dolfinx; its range over the assumed solid law is then part of the range.
Run with ``python examples/own_fabric.py``.
"""

import sys
from pathlib import Path

import weavecell as wc
from fabrics.compression import CompressionLaw

fabric = wc.fabric(Path(sys.argv[0]).parent / "fabrics" / "mine.toml")
law = CompressionLaw(4e-5, 5e-5)  # a [m], b [m N^(1/3)]
projectile = {"mass": "1.1 g", "diameter": "5.5 mm", "edge_radius": "0.3 mm"}
panel = {"law": law, "opening": "100 mm", "projectile": projectile}

# %%
# A shot that stops, and one that perforates, with the range over the assumed trellis law.

for velocity in ("120 m/s", "220 m/s"):
    shot = wc.shoot(fabric, velocity, assumed_range=True, **panel)
    print(shot, *shot.assumed, shot.range.words(), sep="\n")

# %%
# The ballistic limit by bisection, with the shots above it and the Lambert-Jonas curve.

limit = wc.critical_velocity(fabric, **panel)
print(limit)
figure = limit.plot()
