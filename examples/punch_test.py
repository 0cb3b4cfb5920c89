"""
Punch test for the failure length
=================================

One ply of S-728 struck by flat cylinders of two edge radii, for three failure lengths. Where the ratio of the limits
changes with the length by more than tests scatter, a measured ratio tells the length of the fabric. In this opening it
does not: four times the length changes the ratio by 4 %. It prints limits and ratios, and draws them. Opening 50 mm,
elements of a quarter of a crossover at the nose, brackets of 1 m/s. About 35 s.
Run with ``python examples/punch_test.py``.
"""

from dataclasses import replace
from math import inf

import matplotlib.pyplot as plt

import weavecell as wc

lengths, radii = (0.375, 0.75, 1.5), (0.2, 2.0)  # [mm]
fabric = wc.fabric("S-728")
limits = {radius: [] for radius in radii}
for length in lengths:
    own = replace(fabric, failure_length=1e-3 * length)
    for radius in radii:
        punch = {"mass": "3 g", "diameter": "5.5 mm", "edge_radius": f"{radius} mm"}
        panel = wc.setup(
            own, "100 m/s", opening="50 mm", projectile=punch, grading=[[4, 0.25], [inf, 1]]
        )
        limits[radius].append(
            wc.critical_velocity(
                panel, tolerance="1 m/s", scan=False, residual_shots=0
            ).critical_velocity
        )
    sharp, blunt = (limits[radius][-1] for radius in radii)
    print(
        f"failure length {length} mm: limit {sharp:.1f} m/s of the sharp, {blunt:.1f} m/s of the blunt edge",
        end="",
    )
    print(f", ratio {blunt / sharp:.3f}")

figure, (left, right) = plt.subplots(1, 2, figsize=(9, 4), layout="constrained")
for radius in radii:
    left.plot(lengths, limits[radius], "o-", label=f"edge radius {radius} mm")
left.set(xlabel="failure length [mm]", ylabel="critical velocity [m/s]", xscale="log")
left.legend()
right.plot(lengths, [blunt / sharp for sharp, blunt in zip(*limits.values())], "o-", color="0.3")
right.set(
    xlabel="failure length [mm]", ylabel="limit of the blunt over the sharp edge", xscale="log"
)
figure.savefig("punch-test.png", dpi=150)
