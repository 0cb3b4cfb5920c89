"""Shots at given time steps: what the runs of a map of the step are told by."""

import numpy as np
import pytest

from fabrics.base.errors import UnstableError
from validation.cases import impact


@pytest.mark.parametrize("factors", [(1.0, 1.0, 1.0), (1.0, 0.7, 1.0)])
def test_a_shot_that_is_made_again_with_a_shorter_step_is_no_answer_of_its_step(
    monkeypatch, factors
):
    """Its result is right, of another step: the map of the time step had it stable beyond its edge."""
    left = iter(factors)
    fired = []

    def shot(*, unchecked, **keywords):
        step = unchecked["cfl"]
        fired.append(step)
        return {
            "step_factor": next(left),
            "peak": np.array([30.0 + step, 41.0 - step]),
            "v": np.array([92.5, 60.0 + step]),
        }

    monkeypatch.setattr(impact, "shot", shot)
    keywords = {"cfl": 1.4, "neighbours": 3}
    if min(factors) < 1:
        with pytest.raises(UnstableError, match=r"made again with 0\.7 of the time step"):
            impact.stepped(**keywords)
        return
    result = impact.stepped(**keywords)
    assert fired == pytest.approx([1.4, 1.386, 1.372])
    assert result["peak"] == pytest.approx([31.386, 39.614])
    assert result["v"] == pytest.approx([61.386])
