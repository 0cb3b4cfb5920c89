"""
Ballistic limit of a pack
=========================

Bisection with the Python interface: two plies of S-728 in an opening of 100 mm. ``weavecell critical-velocity`` and
``wc.critical_velocity`` search the limit of one ply. Run with ``python examples/pack_limit.py``.
"""

import weavecell as wc

fabric, plies = wc.fabric("S-728"), 2
low, high = 100.0, 400.0  # [m/s] a stop and a perforation
shots = []
while high - low > 10.0:
    velocity = 0.5 * (low + high)
    shots.append(wc.shoot(fabric, velocity, plies=plies, opening="100 mm", end_time="400 us"))
    print(shots[-1], flush=True)
    low, high = (velocity, high) if shots[-1].outcome == "stopped" else (low, velocity)
for end in (shot for shot in shots if shot.strike_velocity in (low, high)):  # a doubtful end gives no sound bracket
    print(f"{end.strike_velocity:.0f} m/s, {end.outcome}: checks {end.checks_text}")
print(f"{plies} plies of {fabric.name}: ballistic limit {low:.0f} to {high:.0f} m/s")

# %%
# Residual velocity of the shots of the bisection, and the pack at the end of the first one.

# sphinx_gallery_thumbnail_number = 2
figure = wc.SweepResult(tuple(shots)).plot()
pack = shots[0].plot_panel()
