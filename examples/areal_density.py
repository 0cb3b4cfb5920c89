"""
Ballistic limit against areal density
=====================================

One, two and three plies of two fabrics against the 1.10 g fragment simulator: the design curve of a pack. It prints the
areal densities and the brackets of the limits, and draws them. Coarse: an opening of 60 mm, one element per crossover
and brackets of up to 15 m/s. About 30 s. Run with ``python examples/areal_density.py``.
"""

import matplotlib.pyplot as plt

import weavecell as wc

panel = {"opening": "60 mm", "projectile": "FSP 1.10 g", "elements_per_crossover": 1, "end_time": "300 us"}
figure, axes = plt.subplots(figsize=(7.2, 4.4), layout="constrained")
for name in ("S-726", "S-728"):
    density = [1e3 * plies * wc.fabric(name).weave.areal_density for plies in (1, 2, 3)]  # [g/m^2]
    middle, half = [], []
    for plies in (1, 2, 3):
        pack = wc.setup(name, "150 m/s", plies=plies, **panel)
        low, high = wc.critical_velocity(pack, tolerance="15 m/s", scan=False, residual_shots=0).bracket
        print(f"{plies} x {name}, {density[plies - 1]:.0f} g/m2: limit {low:.0f} to {high:.0f} m/s")
        middle, half = [*middle, (low + high) / 2], [*half, (high - low) / 2]
    axes.errorbar(density, middle, half, fmt="o-", capsize=4, label=f"{name}, brackets of the bisection")
axes.set(xlabel="areal density [g/m²]", ylabel="ballistic limit [m/s]", xlim=(0, None), ylim=(0, None))
axes.legend()
figure.savefig("areal-density.png", dpi=150)
