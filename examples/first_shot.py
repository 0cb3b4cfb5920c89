"""
First shot, and a sweep of strike velocities
============================================

One ply of S-720, 203 mm square and clamped, and the flat cylinder of 3 g and 5.5 mm. It prints one shot that stops and
five faster ones, writes files for ParaView (``first-shot/panel.pvd``), and draws residual against strike velocity and
the panel. About 10 s. Run with ``python examples/first_shot.py``.
"""

import weavecell as wc

shot = wc.impact("S-720", "92.5 m/s", projectile={"mass": "3 g", "diameter": "5.5 mm", "edge_radius": "0.3 mm"})
print(shot)  # with the quality checks: "ok", or what is noted or doubtful
print(f"deflection at most {1e3 * shot.deflection.max():.1f} mm, {shot.time[-1] * 1e6:.0f} µs")
shot.to_vtk("first-shot")
panel = shot.plot_panel()

# %%
# Several strike velocities; ``wc.sweep(..., jobs=2)`` uses two processes. ``to_dataframe()`` gives tables.

shots = wc.sweep([wc.setup("S-720", velocity) for velocity in (140.0, 150.0, 170.0, 200.0, 250.0)])
for one in shots:
    print(f"{one.strike_velocity:g} m/s: {one.outcome}, residual velocity {one.residual_velocity:.1f} m/s")
figure = shots.plot()
figure.savefig("first-shot.png", dpi=150)
