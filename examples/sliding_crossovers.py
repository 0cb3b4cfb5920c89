"""
Yarns that slide at crossovers
==============================

By default warp and weft are pinned to each other where they cross. With ``crossovers=CrossoverFriction(mu)`` the yarns
of one ply slide against friction. The coefficient mu was not measured for the fabrics of the thesis.
Run with ``python examples/sliding_crossovers.py``.
"""

import weavecell as wc
from shellfabric.sliding.model import CrossoverFriction

cases = {"pinned": None, "mu = 0.2": CrossoverFriction(0.2), "mu = 0.1": CrossoverFriction(0.1)}
shots = {name: wc.shoot("S-728", "110 m/s", crossovers=each) for name, each in cases.items()}
for name, shot in shots.items():
    print(f"{name}: {shot.outcome}, residual velocity {shot.residual_velocity:.1f} m/s")

# %%
# The panel at the end with pinned crossovers, and with a coefficient of friction of 0.1.

# sphinx_gallery_thumbnail_number = 2
figure = shots["pinned"].plot_panel()
sliding = shots["mu = 0.1"].plot_panel()
