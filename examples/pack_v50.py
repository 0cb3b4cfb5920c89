"""
V50 of a pack
=============

Two plies of S-728 against the 1.10 g fragment simulator. The yarns of each panel differ in strength; shots about the
limit give the probability of perforation. It prints V50 with its 95 % interval and draws the curve. Coarse: an opening
of 50 mm, one element per crossover (its limits are some per cent off) and 20 shots (200 are usual). About 30 s.
Run with ``python examples/pack_v50.py``.
"""

import weavecell as wc

pack = wc.setup(
    "S-728", "140 m/s", plies=2, opening="50 mm", elements_per_crossover=1, projectile="FSP 1.10 g", end_time="300 us"
)
found = wc.v50(pack, shots=20)
low, high = found.interval
print(f"2 plies of S-728: V50 {found.v50:.0f} m/s, 95 % interval {low:.0f} to {high:.0f} m/s")
print(f"quality checks: {found.checks_text}")

figure = found.plot()
figure.savefig("pack-v50.png", dpi=150)
