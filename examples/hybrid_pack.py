"""
Hybrid pack: order of the plies
===============================

Two plies of S-728 and two of S-720, the latter turned by 90 degrees: which fabric belongs in front? Both orders are
shot at with the 1.10 g fragment simulator. It prints outcome and deflection of the back face and draws the velocity.
Coarse: an opening of 60 mm. About 10 s. Run with ``python examples/hybrid_pack.py``.
"""

import matplotlib.pyplot as plt

import weavecell as wc

first = {"name": "S-728", "count": 2}
second = {"name": "S-720", "count": 2, "angle": "90 deg"}
orders = {"S-728 in front": [first, second], "S-720 in front": [second, first]}

figure, axes = plt.subplots(figsize=(7.2, 4.4), layout="constrained")
for name, plies in orders.items():
    shot = wc.impact(
        None, "300 m/s", ply=plies, opening="60 mm", projectile="FSP 1.10 g", end_time="200 us"
    )
    print(
        f"{name}: {shot.outcome}, residual velocity {shot.residual_velocity:.0f} m/s, checks {shot.checks_text}"
    )
    print(f"  deflection at most {1e3 * shot.deflection.max():.1f} mm")
    axes.plot(1e6 * shot.time, shot.velocity, label=f"{name}: {shot.outcome}")
axes.set(xlabel="time [µs]", ylabel="velocity of the projectile [m/s]", ylim=(0, None))
axes.legend()
figure.savefig("hybrid-pack.png", dpi=150)
