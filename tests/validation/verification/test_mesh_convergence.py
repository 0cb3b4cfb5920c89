"""The convergence study: extrapolation in closed form, and the machinery on a small panel."""

import csv
import sys

import numpy as np
import pytest

from fabrics import catalogue
from fabrics.errors import InputError
from shellfabric.impact.single_ply import ImpactSetup
from validation.verification.mesh_convergence import __main__ as command
from validation.verification.mesh_convergence import rim, yarn
from validation.verification.mesh_convergence.study import quantity, study, velocities
from weavecell.analysis.richardson import extrapolate, observed_order

SIZES = (1.0, 1 / 2, 1 / 3)


@pytest.mark.parametrize("p", [0.6, 1.0, 1.5, 2.0])
@pytest.mark.parametrize("sizes", [SIZES, (1.0, 0.5, 0.25), (0.9, 0.4, 0.35)])
def test_exact_order(p, sizes):
    values = [120.0 - 7.0 * h**p for h in sizes]
    assert observed_order(sizes, values) == pytest.approx(p, rel=1e-9)
    found = extrapolate(sizes, values)
    assert found.limit == pytest.approx(120.0, rel=1e-10)
    assert (found.basis, found.remark, found.scatter) == ("Richardson", "", 0.0)


def test_finest_three_of_more():
    sizes = (1.0, 1 / 2, 1 / 3, 1 / 4)
    found = extrapolate(sizes, [0.0, *(120.0 - 7.0 * h for h in sizes[1:])])
    assert (found.limit, found.order) == pytest.approx((120.0, 1.0))


@pytest.mark.parametrize(
    ("values", "order", "told"),
    [
        ([114.0, 119.0, 118.5], None, "not monotone"),
        ([114.0, 116.0, 119.0], None, "steps do not shrink"),
        ([114.0, 116.0, 117.9], None, "steps do not shrink"),
        ([110.0, 119.0, 119.1], 6.3, "above the formal 2"),
        ([114.0, 116.0, 117.1], 0.16, "below 0.5"),
    ],
)
def test_irregular_values_are_told(values, order, told):
    """No order is claimed where there is none, and the limit comes from a fit with its scatter."""
    found = extrapolate(SIZES, values)
    assert told in found.remark
    assert found.basis in ("first order", "second order")
    assert found.scatter > 0
    assert found.order == (None if order is None else pytest.approx(order, abs=0.1))
    A = np.column_stack([np.ones(3), np.array(SIZES) ** (1 if found.basis == "first order" else 2)])
    assert found.limit == pytest.approx(np.linalg.solve(A.T @ A, A.T @ values)[0], rel=1e-12)


def test_changes_within_the_noise_are_none():
    found = extrapolate(SIZES, [118.0, 118.2, 118.1], noise=0.125)
    assert (found.limit, found.order, found.basis) == (118.1, None, "no change")
    assert extrapolate(SIZES, [118.0, 118.2, 118.1]).basis != "no change"


@pytest.mark.parametrize("bad", [((1.0, 0.5), (1, 2)), ((0.5, 1.0, 2.0), (1, 2, 3)), (SIZES, (1, np.nan, 2))])
def test_bad_meshes(bad):
    with pytest.raises(InputError):
        extrapolate(*bad)


def test_what_is_asked():
    """5 % at one element a crossover, 2 % at two."""
    assert quantity("S", "q", "N", (1, 2, 3), [120 - 6 * h for h in SIZES]).met is False  # 2.5 % at two
    found = quantity("S", "q", "N", (1, 2, 3), [120 - 6 * h**2 for h in SIZES])
    assert found.deviations == pytest.approx((-0.05, -0.0125, -0.05 / 9))
    assert quantity("S", "q", "N", (1, 2, 3), [120 - 5 * h**2 for h in SIZES]).met
    assert not quantity("S", "q", "N", (1, 2, 3), [120 - 7 * h**2 for h in SIZES]).met


def test_velocities_are_those_of_the_catalogue():
    assert set(velocities()) == {name for name in catalogue.list_names() if name.startswith("S-")}
    assert velocities()["S-720"] == 92.5


def test_study_and_its_command(tmp_path, monkeypatch, capsys):
    """On a panel of 25 mm: values rise to what they are, the table holds them, and a picture is drawn."""
    fabric = catalogue.load("S-720").with_effective_density()
    small = ImpactSetup(fabric, 20.0, opening=0.0254, table_size=101)
    seen = []
    points = []
    report = lambda n, shot: seen.append((n, shot))  # noqa: E731
    found = study(fabric, 20.0, setup=small, tolerance=2.0, keep=points.append, report=report)
    kept = {str(one.elements): one for one in points}
    command.write_points(dict(reversed(kept.items())), tmp_path / "points.json")
    assert command.read_points(tmp_path / "points.json") == kept
    again = study(fabric, 20.0, setup=small, known=points, report=lambda *_: pytest.fail("run again"))
    assert again == found
    assert [entry.name for entry in found] == ["critical velocity", "peak warp tension", "peak weft tension"]
    for n, value in zip((1, 2, 3), found[0].values):
        shots = [shot for number, shot in seen if number == n]
        stops = max(shot.strike_velocity for shot in shots if not shot.perforated)
        assert 0 < value - stops <= 1.0
        assert stops < min(shot.strike_velocity for shot in shots if shot.perforated)
    for k in (0, 1):
        peaks = [shot.peak_tension[k] for _, shot in seen if shot.strike_velocity == 20.0]
        assert found[1 + k].values == tuple(peaks)
    with pytest.raises(InputError, match="perforated"):
        study(fabric, 200.0, setup=small, tolerance=2.0)
    with pytest.raises(InputError, match="at least three"):
        study(fabric, 20.0, setup=small, elements=(1, 2))

    page = tmp_path / "docs" / "c.md"
    page.parent.mkdir()
    page.write_text(f"before\n{command.MARKS[0]}\nold\n{command.MARKS[1]}\nafter\n")
    monkeypatch.setattr(command, "study", lambda *_, **__: found)
    monkeypatch.setattr(sys, "argv", ["", "S-720", "--out", str(tmp_path), "--page", str(page)])
    command.main()
    rows = list(csv.DictReader((tmp_path / "convergence.csv").open(encoding="utf-8")))
    assert [row["quantity"] for row in rows] == [entry.name for entry in found]
    assert float(rows[0]["limit"]) == pytest.approx(found[0].extrapolation.limit, abs=1e-4)
    assert (tmp_path / "convergence.png").read_bytes().startswith(b"\x89PNG")
    assert (tmp_path / "docs" / "figures" / "convergence.png").read_bytes().startswith(b"\x89PNG")
    text = page.read_text()
    assert text.startswith("before\n")
    assert text.endswith("after\n")
    assert "old" not in text
    assert f"| S-720 | critical velocity, m/s | {found[0].values[0]:.1f} |" in text
    assert "critical velocity" in capsys.readouterr().out
    page.write_text("no marks")
    with pytest.raises(InputError, match="marks"):
        command.main()
    monkeypatch.setattr(sys, "argv", ["", "S-720", "--out", str(tmp_path / "new"), "--resume"])
    with pytest.raises(InputError, match="no points to resume from"):
        command.main()
    monkeypatch.setattr(sys, "argv", ["", "S-999"])
    with pytest.raises(InputError, match="S-999"):
        command.main()


@pytest.mark.parametrize("n", [1, 2, 3])
def test_a_yarn_is_the_mean_of_its_lines(n):
    """What the page says of the yarn that fails first: its lines' mean, weighted by 1 - |y| over their spacing."""
    found = yarn.across(
        catalogue.load("S-726").with_effective_density(), 150.0, 12e-6, 2, n, opening=0.0407, table_size=61
    )
    weights = (1 - np.abs(np.arange(1 - n, n)) / n) / n
    lines = found.tension[n + 1 : 3 * n]
    assert found.yarn == pytest.approx(float(np.dot(weights, lines)), rel=1e-12)
    assert found.middle == found.tension[found.place == 2]
    assert found.yarn > 1.0
    assert 2 < found.edge[0] < found.edge[1] < 3


def test_a_rim_holds_a_yarn_back():
    """By the closed form, on straight elements far longer than it is round; by a tenth of that on the spline."""
    assert rim.closed(rim.bilinear) == pytest.approx(rim.THETA**2 / 2, rel=0.02)
    assert rim.closed(rim.smooth) == pytest.approx(rim.THETA**2 / 4 * 12**-0.5 * 2 / 3, rel=0.01)
    assert rim.solved(rim.bilinear, 1.5) == pytest.approx(rim.closed(rim.bilinear), rel=0.05)
    assert rim.solved(rim.smooth, 0.5) == pytest.approx(rim.closed(rim.smooth), rel=0.4)
