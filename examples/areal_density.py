"""
Ballistic limit against areal density
=====================================

One, two and four plies of S-728 against the 1.10 g fragment simulator: the design curve of a pack. It prints the areal
densities, the brackets of the limits and whether they rest on a doubtful shot, and draws them. Coarse: an opening of
80 mm, one element per crossover and brackets of up to 15 m/s. About 15 s.
Run with ``python examples/areal_density.py``.
"""

import matplotlib.pyplot as plt

import weavecell as wc

panel = {
    "opening": "80 mm",
    "projectile": "FSP 1.10 g",
    "elements_per_crossover": 1,
    "end_time": "300 us",
}
density, middle, half = [], [], []
for plies in (1, 2, 4):
    pack = wc.setup("S-728", "150 m/s", plies=plies, **panel)
    found = wc.critical_velocity(
        pack, tolerance="15 m/s", scan=False, residual_shots=0, v50_shots=0
    )
    low, high = found.bracket
    density.append(1e3 * plies * pack.fabric.weave.areal_density)  # [g/m^2]
    middle.append((low + high) / 2)
    half.append((high - low) / 2)
    print(
        f"{plies} x S-728, {density[-1]:.0f} g/m2: limit {low:.0f} to {high:.0f} m/s, {found.bracket_checks}"
    )

figure, axes = plt.subplots(figsize=(7.2, 4.4), layout="constrained")
axes.errorbar(density, middle, half, fmt="o-", capsize=4, label="S-728, brackets of the bisection")
axes.set(
    xlabel="areal density [g/m²]", ylabel="ballistic limit [m/s]", xlim=(0, None), ylim=(0, None)
)
axes.legend()
figure.savefig("areal-density.png", dpi=150)
