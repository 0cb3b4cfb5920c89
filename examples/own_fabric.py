"""A fabric from data-sheet values, with a law that is given: what its assumed laws leave open.

The law of one's own fabric comes from `wc.calibrate(fabric, mesh="coarse")`, which needs dolfinx; its range over the
assumed solid law is then part of it. Run from the folder of the project with: python examples/own_fabric.py
"""

import weavecell as wc
from fabrics.compression import CompressionLaw

fabric = wc.fabric("examples/fabrics/mine.toml")
law = CompressionLaw(4e-5, 5e-5)  # a [m], b [m N^(1/3)]
panel = {"law": law, "opening": "100 mm", "assumed_range": True}
shot = wc.shoot(fabric, "120 m/s", projectile={"mass": "1.1 g", "diameter": "5.5 mm"}, **panel)
print(shot, *shot.assumed, shot.range.words(), sep="\n")
