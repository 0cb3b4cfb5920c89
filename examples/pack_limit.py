"""Ballistic limit of a pack by bisection with the Python interface. Run with: python examples/pack_limit.py"""

import weavecell as wc

fabric, plies = wc.fabric("S-728"), 2
low, high = 100.0, 400.0  # [m/s] a stop and a perforation
while high - low > 10.0:
    velocity = 0.5 * (low + high)
    shot = wc.shoot(fabric, velocity, plies=plies, opening="100 mm", end_time="400 us")
    print(shot, flush=True)
    low, high = (velocity, high) if shot.outcome == "stopped" else (low, velocity)
print(f"{plies} plies of {fabric.name}: ballistic limit {low:.0f} to {high:.0f} m/s")
