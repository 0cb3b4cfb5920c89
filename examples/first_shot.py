"""
One shot, and a sweep of strike velocities
==========================================

One ply of S-720, 203 mm square and clamped, and a flat cylinder of 3 g and 5.5 mm.
Run with ``python examples/first_shot.py``.
"""

import weavecell as wc

# %%
# A fabric of the catalogue with its published compression law, and one shot.

fabric = wc.fabric("S-720")
shot = wc.shoot(fabric, "92.5 m/s", projectile={"mass": "3 g", "diameter": "5.5 mm", "edge_radius": "0.3 mm"})
print(shot)  # with the quality checks: "ok", or what is noted or doubtful
figure = shot.plot()

# %%
# The panel at the end, seen from behind, and files for ParaView. Where pandas is installed, ``shot.to_dataframe()`` has
# the histories.

# sphinx_gallery_thumbnail_number = 2
panel = shot.plot_panel()
shot.to_vtk("first-shot")
print(f"deflection at most {1e3 * shot.summary()['max_deflection_m']:.1f} mm")

# %%
# Several strike velocities. ``jobs=2`` would use two processes.

velocities = (140.0, 150.0, 170.0, 200.0, 250.0)
shots = wc.sweep([wc.setup(fabric, velocity) for velocity in velocities])
for one in shots:
    print(f"{one.strike_velocity:g} m/s: {one.outcome}, residual velocity {one.residual_velocity:.1f} m/s")
sweep_figure = shots.plot()
