"""The drag of the air takes energy from the ply and stands in the balance; without air the part is not
made, and resolved yarns refuse the number."""

import numpy as np
import pytest

import weavecell as wc
from fabrics.base.errors import InputError

SCENE = {"opening": "60 mm", "end_time": "60 us"}
usual = wc.impact("S-720", "155 m/s", **SCENE)
none = wc.impact("S-720", "155 m/s", air_density="0 kg/m^3", **SCENE)
dense = wc.impact("S-720", "155 m/s", air_density="100 kg/m^3", **SCENE)
assert np.array_equal(usual.velocity, none.velocity)
assert "air_drag" not in usual.energies
assert dense.energies["air_drag"][-1] > 0.01 * dense.strike_energy
assert dense.energy_error_max < 2e-3
with pytest.raises(InputError, match="air_density"):
    wc.setup("S-726", "155 m/s", crossovers="yarns", air_density="1.2 kg/m^3", **SCENE).panel()
