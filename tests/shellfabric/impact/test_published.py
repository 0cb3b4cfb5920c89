"""The twelve single-ply outcomes in the captions of thesis Figures 5-4 to 5-15, with nothing fitted to them.

With the default mesh and a rigid projectile 11 of the twelve hold for the variational form, and all for the
equilibrium form.
"""

import pytest

from fabrics import catalogue
from shellfabric.impact.run import run_impact
from shellfabric.impact.setup import ImpactSetup

CAPTIONS = {  # fabric: [m/s] at which the thesis's simulation of one ply stops and is perforated
    "S-720": (92.5, 155.0),
    "S-726": (96.0, 174.0),
    "S-727": (40.0, 158.0),
    "S-728": (76.0, 170.0),
    "S-731": (116.0, 132.0),
    "S-745": (110.0, 215.0),
}
EARLY = pytest.mark.xfail(
    strict=True, reason="is perforated at 116 m/s, with 23 m/s left; the thesis's stops"
)
SLOW = pytest.mark.slow(25)


@pytest.mark.parametrize(
    "form, name",
    [
        pytest.param(
            form, name, marks=[SLOW, EARLY] if (form, name) == ("variational", "S-731") else SLOW
        )
        for form in ("variational", "equilibrium")
        for name in CAPTIONS
    ]
    + [("variational", "S-720")],
)
def test_the_slower_shot_is_stopped_and_the_faster_one_perforates(form, name):
    fabric = catalogue.load(name).with_effective_density()
    for strike_velocity, expected in zip(CAPTIONS[name], ("stopped", "perforated")):
        result = run_impact(ImpactSetup(fabric, strike_velocity, cell_formulation=form))
        assert result.outcome == expected, strike_velocity
        assert result.energy_error_max < (5e-3 if form == "variational" else 1e-2)
