"""
Yarns that slide at crossovers
==============================

By default warp and weft are pinned to each other where they cross. With ``crossovers="sliding"`` the yarns slide
against friction. The coefficient mu was not measured for the fabrics of the thesis.
Run with ``python examples/sliding_crossovers.py``.
"""

import weavecell as wc

shots = {"pinned": wc.shoot("S-728", "110 m/s")}
for mu in (0.2, 0.1):
    shots[f"mu = {mu}"] = wc.shoot("S-728", "110 m/s", crossovers="sliding", crossover_friction=mu)
for name, shot in shots.items():
    print(f"{name}: {shot.outcome}, residual velocity {shot.residual_velocity:.1f} m/s")

# %%
# The panel at the end with pinned crossovers, and with a coefficient of friction of 0.1.

# sphinx_gallery_thumbnail_number = 2
figure = shots["pinned"].plot_panel()
sliding = shots["mu = 0.1"].plot_panel()
