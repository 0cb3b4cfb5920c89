"""Charts of cost against error and maps of stability: of the CSVs as they are, with the front and the default right."""

import numpy as np
import pytest


@pytest.fixture
def charts(tool):
    return tool("report_charts")


def test_pictures_are_of_the_files_as_they_are(charts):
    """Else: python tools/figures.py --only reports"""
    for name in (*charts.COSTS, *charts.MODELS, *charts.SCENES, *charts.MAPS):
        assert charts.digest_in(charts.FIGURES / f"{name}.png") == charts.digest_of(name), name


def test_every_study_of_cost_and_every_map_has_its_chart(charts):
    studies = {path.stem for path in charts.STUDIES.glob("*.toml")}
    assert {name for name in studies if name.startswith("cost-")} <= set(charts.COSTS)
    assert {name for name in studies if name.startswith("stability-")} == set(charts.MAPS)


def test_models_stand_at_the_times_of_their_runs(charts):
    """Marks are at the CPU time of the row and of Table 4-3 over crossovers and us, models in the order of the file."""
    (name,) = charts.MODELS
    axes = charts.draw(name).axes[0]
    own, theirs = (line for line in axes.lines if line.get_label()[0] != "_")
    names = dict(zip(axes.get_yticks(), (text.get_text() for text in axes.get_yticklabels())))
    shown = {names[y]: x for x, y in own.get_xydata()}
    for row in charts.read(name)[1]:
        label = charts.OF_MODELS.get((row["model"], row["crossings"]), [None])[0]
        if label is None:
            continue
        area = int(row["crossings"]) ** 2
        # no run ends before its time
        expected = float(row["CPU time [s]"]) / (area * 1e6 * float(row["time [s]"]))
        assert shown.pop(label) == pytest.approx(expected, rel=1e-3)
    assert not shown
    assert {names[y]: x for x, y in theirs.get_xydata()} == pytest.approx(
        {
            "cable net, 203 mm": 1243 / 6241 / 250,
            "panel, 203 mm": 1932 / 6241 / 250,
            "woven solids, 25.4 mm": 3 * 157424 / 400 / 42,
        }
    )


def test_models_of_scenes_stand_at_what_they_leave_off(charts):
    (name,) = charts.SCENES
    axes = charts.draw(name).axes[0]
    names = {y: text.get_text() for y, text in zip(axes.get_yticks(), axes.get_yticklabels())}
    shown = {}
    for line in axes.lines:
        for x, y in line.get_xydata():
            shown[names[y], line.get_label()] = x
    rows = {row["scene"]: row for row in charts.read(name)[1]}
    assert len(rows) == 10
    for (scene, model), x in shown.items():
        assert x == float(rows[scene][f"off, {model} [%]"])
    given = sum(
        bool(row[f"off, {model} [%]"]) and model != row["richest"]
        for row in rows.values()
        for model in charts.OF_SCENES
    )
    assert len(shown) == given


@pytest.mark.parametrize("seed", range(10))
def test_no_method_beats_one_of_the_front_and_one_beats_each_other(charts, seed):
    """Also where costs or errors are equal."""
    rng = np.random.default_rng(seed)
    values = rng.integers(1, 12, (25, 2)) / 4
    points = [charts.Point(cost, error, f"{n}") for n, (cost, error) in enumerate(values)]
    best = charts.front(points)

    def beaten(point):
        return any(
            other.cost <= point.cost
            and other.error <= point.error
            and (other.cost, other.error) != (point.cost, point.error)
            for other in points
        )

    assert best == sorted(best, key=lambda point: point.cost)
    assert not any(map(beaten, best))
    kept = {(point.cost, point.error) for point in best}
    assert all(beaten(point) for point in points if (point.cost, point.error) not in kept)


def test_a_default_is_marked_wherever_there_is_one(charts):
    for name in charts.COSTS:
        own = charts.DEFAULTS.get(name, charts.DEFAULT)
        for column in charts.errors_of(name):
            points, _ = charts.points_of(name, column)
            marked = [point.name for point in points if point.name == own]
            assert len(marked) == (0 if name == "cost-struck-yarn" else 1), (name, column)
    for name in charts.MAPS:
        x, y, default = charts.map_of(name)
        if default is not None:
            rows = charts.read(name)[1]
            at = [row for row in rows if row[y] == str(default[1])]
            assert any(float(row[x]) == default[0] for row in at), name
