"""The key `table_size` of [panel] reaches the shot: a coarse table gives another deflection, nearly the same."""

import weavecell as wc

SCENE = {"opening": "60 mm", "end_time": "30 us", "crossovers": "pinned"}
usual = wc.impact("S-720", "90 m/s", **SCENE)
coarse = wc.impact("S-720", "90 m/s", table_size=21, **SCENE)
difference = abs(coarse.max_deflection / usual.max_deflection - 1)
assert 0 < difference < 0.02, difference
