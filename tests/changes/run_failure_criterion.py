"""Yarns under load from both families fail earlier: the projectile keeps more of its speed."""

import weavecell as wc

SCENE = {"opening": "60 mm", "end_time": "100 us"}
alone = wc.impact("S-720", "200 m/s", **SCENE)
both = wc.impact("S-720", "200 m/s", failure_interaction=0.5, **SCENE)
assert both.residual_velocity > alone.residual_velocity > 0
assert both.energy_error_max < 2e-3
