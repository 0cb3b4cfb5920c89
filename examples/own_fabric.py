"""
Own fabric from a data sheet
============================

From the values of ``examples/fabrics/mine.toml`` to the ballistic limit of one ply, with the range over the laws that
the data sheet does not give. The compression law is typed in; ``crossover_calibration.py`` computes one. It prints what
is assumed and the limit, and draws residual against strike velocity. About 10 s.
Run with ``python examples/own_fabric.py``.
"""

import sys
from pathlib import Path

import weavecell as wc
from fabrics.compression import CompressionLaw

fabric = wc.fabric(Path(sys.argv[0]).parent / "fabrics" / "mine.toml")
law = CompressionLaw(4e-5, 5e-5)  # a [m], b [m N^(1/3)]
found = wc.critical_velocity(
    fabric, law=law, opening="100 mm", projectile="FSP 1.10 g", assumed_range=True, residual_shots=6
)
print(*found.assumed, sep="\n")
print(found)
figure = found.plot()
figure.savefig("own-fabric.png", dpi=150)
