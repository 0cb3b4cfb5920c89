"""The study of one ply: curves of residual velocity, shots of captions, and the tables made of them."""

from pathlib import Path

import numpy as np
import pytest

from validation.published import one_ply as study
from weavecell.report.pictures import render

FABRIC = "S-720"
ROOT = Path(__file__).parents[3]


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


def test_tables_and_pictures(curve, shots, monkeypatch):
    (_, row) = study.limit_table([curve])
    assert row[0] == FABRIC
    assert "**" not in row[3]
    assert len(study.residual_table([curve])) == 1 + len(study.MULTIPLES)
    assert [row[3].split(",")[0] for row in study.caption_table(shots)[1:]] == ["stops", "perforates"]
    assert len(study.wave_table(shots)) == 2
    for draw, content in ((study.draw_residual, [curve]), (study.velocities, shots), (study.draw_fronts, shots),
                          (study.energies, shots)):  # fmt: skip
        assert render(draw, content, kind="png").startswith(b"\x89PNG")


def test_the_page_shows_every_picture(shots):
    from matplotlib import pyplot

    page = (ROOT / "docs" / "reports" / "one-ply.md").read_text("utf-8")
    for name in ("residual", "limits", "velocities", "energies", "profiles", "fronts", "reactions"):
        assert f"figures/validation-{name}.png" in page
        assert (ROOT / "docs" / "reports" / "figures" / f"validation-{name}.png").exists()
    figure = study.energies(pyplot, shots)
    for axes, shot in zip(figure.axes, shots):
        top = max(part.get_datalim(axes.transData).y1 for part in axes.collections)
        assert top == pytest.approx(100, abs=1), shot.fabric  # the parts add up to the strike energy
    pyplot.close(figure)


def test_a_critical_velocity_outside_the_captions_is_bold(curve, monkeypatch):
    monkeypatch.setitem(study.CAPTIONS, FABRIC, (10.0, 20.0))
    assert study.limit_table([curve])[1][3].startswith("**")
