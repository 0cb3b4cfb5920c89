"""The study of one ply: curves of residual velocity, shots of captions, and the tables made of them."""

import numpy as np
import pytest

from validation.published import one_ply as study

FABRIC = "S-720"


@pytest.fixture(scope="module")
def curve():
    return study.curve(FABRIC)


@pytest.fixture(scope="module")
def shots():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(study, "CAPTIONS", {FABRIC: (92.5, 155.0)})
        return study.captions()


def test_residual_velocities_lie_on_the_curve_and_below_the_strike_velocity(curve):
    strike = np.array([shot.strike_velocity for shot in curve.shots])
    residual = np.array([shot.residual_velocity for shot in curve.shots])
    assert curve.fit.limit == curve.limit.velocity
    np.testing.assert_allclose(strike / curve.limit.velocity, study.MULTIPLES)
    assert (residual < strike).all()
    assert (np.diff(residual) > 0).all()


def test_shots_of_captions_have_their_histories(shots):
    stopped, perforated = shots
    assert (stopped.result.outcome, perforated.result.outcome) == (stopped.expected, perforated.expected)
    speed = {(front.kind, front.family): front.speed for front in stopped.fronts}
    for number, family in enumerate(("warp", "weft")):
        free = stopped.result.setup.fabric.weave.yarns[number].wave_speed
        assert speed["transverse", family] < speed["longitudinal", family] < free / np.sqrt(2)
    assert 0.5 < stopped.kinetic_over_internal < 4
