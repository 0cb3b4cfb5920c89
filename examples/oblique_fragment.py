"""
Oblique fragment simulator
==========================

The 1.10 g fragment simulator strikes one ply of S-720 at 0 to 30 degrees to the normal. An oblique shot needs the whole
panel. It prints outcome and residual velocity along the normal of the panel, and draws the panel of the last shot from
behind. Coarse: an opening of 80 mm. About 12 s. Run with ``python examples/oblique_fragment.py``.
"""

import weavecell as wc

for angle in (0, 15, 30):
    projectile = {"name": "FSP 1.10 g", "obliquity": f"{angle} deg"}
    shot = wc.impact(
        "S-720",
        "200 m/s",
        projectile=projectile,
        opening="80 mm",
        symmetry="whole",
        end_time="150 us",
    )
    print(
        f"{angle} degrees: {shot.outcome}, {shot.residual_velocity:.0f} m/s, checks {shot.checks_text}"
    )

figure = shot.plot_panel()
figure.savefig("oblique-fragment.png", dpi=150)
