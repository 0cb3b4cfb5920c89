"""
Ballistic limit of a pack
=========================

Two plies of S-728 in an opening of 100 mm: a bisection between stop and perforation, without the scan about it and
without residual velocities, which ``wc.critical_velocity`` adds by default. Of an input file
``weavecell critical-velocity FILE`` computes the same. Run with ``python examples/pack_limit.py``.
"""

import weavecell as wc

panel = {"plies": 2, "opening": "100 mm"}
found = wc.critical_velocity("S-728", tolerance="10 m/s", scan=False, residual_shots=0, **panel)
low, high = found.bracket
print(found.to_dataframe())
print(f"checks of the bracket: {found.bracket_checks}")  # a doubtful end gives no sound bracket
print(f"2 plies of S-728: ballistic limit {low:.0f} to {high:.0f} m/s")

# %%
# Residual velocity of the shots, and the pack at the end of the slowest perforation.

# sphinx_gallery_thumbnail_number = 2
figure = found.plot()
pack = wc.shoot("S-728", high, end_time="400 us", **panel).plot_panel()
