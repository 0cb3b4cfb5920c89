"""
Compression law from the 3D crossover
=====================================

The crossover of S-720 is solved in three dimensions (FEniCSx, of Debian) along three loading paths, and the compression
law is fitted to the results. It prints the coefficients and uses the law in a shot. Coarse mesh: 192 hexahedra; the
medium one is the default. About 30 s. Run with ``python examples/crossover_calibration.py``.
"""

import weavecell as wc

found = wc.calibrate("S-720", mesh="coarse")
law = found.law
print(f"a = {1e3 * law.a:.4f} mm, b = {1e3 * law.b:.4f} mm N^(1/3)")
shot = wc.impact("S-720", "170 m/s", law=found, opening="100 mm")
print(shot)

figure = found.plot()
figure.savefig("crossover-calibration.png", dpi=150)
