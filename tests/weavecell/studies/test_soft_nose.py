"""The rule for rigid noses that a metal would not have stood: it speaks of soft ones, and is silent of hard ones."""

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pytest

from fabrics import catalogue, metals
from shellfabric.impact.setup import ImpactSetup
from shellfabric.projectile.projectile import Projectile
from weavecell.studies.rigidity import SoftNose, check_shot, metal_of

NINE = {"radius": 4.5e-3, "edge_radius": 0.3e-3}
OGIVE = {"shape": "ogive", "length": 15e-3, "nose_length": 9e-3}


@dataclass
class Shot:
    """What the rule reads of a result: a push of `pressure` [Pa] on the nose for 60 of 100 us."""

    projectile: Projectile
    pressure: float
    outcome: str = "stopped"

    @property
    def setup(self):
        coarse = {"opening": 0.0508, "elements_per_crossover": 1, "symmetry": "half"}
        return ImpactSetup(catalogue.load("S-720"), 270.0, projectile=self.projectile, **coarse)

    @property
    def step_history(self):
        t = np.arange(1, 1001) * 1e-7
        force = -self.pressure * np.pi * self.projectile.radius**2 * ((t > 2e-5) & (t < 8e-5))
        return np.column_stack([t, 0 * t, 0 * t, force])


def nose(density=None, **changes):
    """A nose of 9 mm; of a mean density [kg/m3] if it has a length."""
    given = NINE | changes
    shot = Projectile(mass=8e-3, **given)
    if density is None:
        return shot
    if shot.shape == "ogive":
        volume = shot.drawing.drawn_mass / shot.drawing.core.density
    else:
        r = shot.radius
        lost = {"hemisphere": r / 3, "flat": 0.0, "sphere": 2 * r / 3}[shot.shape]
        volume = np.pi * r**2 * ((shot.length or 2 * r) - lost)
    return Projectile(mass=density * volume, **given)


# lead yields at 24 MPa times 1 + 0.1 ln(1 + 270 / 0.009)
LEAD_FLOWS = 24e6 * (1 + 0.1 * np.log(30001))


@pytest.mark.parametrize(
    "shape",
    [
        OGIVE,
        {"shape": "hemisphere", "length": 13e-3},
        {"shape": "flat", "length": 12e-3},
        {"shape": "ogive", "length": 16e-3, "nose_length": 7e-3, "tip_diameter": 4e-3},
    ],
)
def test_a_stopped_bullet_is_not_rigid(shape):
    soft = nose(10300.0, **shape)
    said = str(check_shot(Shot(soft, 1.1 * LEAD_FLOWS)))
    assert "a rigid nose is not enough;" in said
    assert 'body = "metal"' in said
    assert f"lead flows at {1e-6 * LEAD_FLOWS:.0f} MPa" in said
    assert check_shot(Shot(soft, 0.9 * LEAD_FLOWS)) is None
    assert check_shot(Shot(soft, 10 * LEAD_FLOWS, outcome="perforated")) is None


def test_an_oblique_bullet_is_not_told_to_be_of_metal_which_is_refused():
    said = str(check_shot(Shot(nose(10300.0, obliquity=0.3, **OGIVE), 1.1 * LEAD_FLOWS)))
    assert said.endswith("a rigid nose is not enough")


def test_a_round_nose_without_a_length_may_be_a_bullet():
    said = str(check_shot(Shot(nose(shape="hemisphere"), 340e6)))
    assert "if it is a bullet of lead" in said


@pytest.mark.parametrize("shape", [OGIVE, {"shape": "sphere"}])
def test_steel_is_judged_by_its_own_flow_stress(shape):
    hard = nose(7850.0, **shape)
    assert metal_of(hard) == ("42CrMo4", True)
    assert check_shot(Shot(hard, 340e6)) is None
    found = check_shot(Shot(hard, 1.2 * metals.load("42CrMo4").yield_stress))
    assert isinstance(found, SoftNose)
    assert 0.8e9 < found.flow_stress < 0.9e9


@pytest.mark.parametrize(
    "shot",
    [
        nose(17000.0, **OGIVE),  # of no metal that is known
        nose(1200.0, shape="sphere"),
        Projectile(shape="cone", half_angle=0.6, tip_radius=1e-3, mass=8e-3, length=15e-3, **NINE),
        Projectile(
            shape="ogive", length=15e-3, nose_length=9e-3, mass=8.3e-3, body="metal", **NINE
        ),
    ],
)
def test_nothing_is_said_of_others(shot):
    assert check_shot(Shot(shot, 2e9)) is None


def test_a_steel_cylinder_has_the_rule_of_the_bar():
    said = str(check_shot(Shot(Projectile(), 200e6)))
    assert "periods of the bar" in said


def test_a_short_blow_is_no_pressure():
    """As of an impact of plies one after the other: the mean over a wave's time across the nose."""
    shot = Shot(nose(10300.0, **OGIVE), 2 * LEAD_FLOWS)
    history = shot.step_history
    history[:, 3] *= np.abs(history[:, 0] - 5e-5) < 2e-7
    struck = SimpleNamespace(setup=shot.setup, outcome="stopped", step_history=history)
    assert check_shot(struck) is None


def test_each_rule_takes_the_mean_over_its_own_time():
    """A blow of half a period of the bar, which is a half of its height over a whole one."""
    bar = Projectile().steel_bar()
    shot = Shot(Projectile(), 200e6)
    t = np.arange(1, 4001) * bar.period / 400
    blow = 1000.0 * ((t > bar.period) & (t < 1.5 * bar.period))
    history = np.column_stack([t, 0 * t, 0 * t, -blow])
    found = check_shot(SimpleNamespace(setup=shot.setup, step_history=history, outcome="stopped"))
    assert found.period == pytest.approx(bar.period)
    assert found.force == pytest.approx(1000.0, rel=0.02)
    assert found.yield_force == pytest.approx(bar.yield_force)
    # the impulse over the mean of a whole period
    assert found.contact_time == pytest.approx(bar.period, rel=0.02)
