"""The runner of studies: how a file is read, what it makes of cases, references, maps and charts; and all files."""

import inspect
import tomllib

import numpy as np
import pytest

from fabrics.base.errors import InputError, UnstableError
from tests.programs import printed
from validation import cases, csv_file, judges, runner, study
from validation.cases import impact
from validation.judges import STABLE
from validation.study import Study


def made_up(monkeypatch, tmp_path, function, text):
    """A study of a text whose cases a function computes."""
    monkeypatch.setattr(cases, "function", lambda name: function)
    monkeypatch.chdir(tmp_path)
    return Study("made-up", {"run": "made.up"} | tomllib.loads(text))


COMBINED = """
labels = ["published"]
base = { a = 1, table = { x = 1, y = 2 } }
each.mesh = { coarse = { n = 1 }, fine = { n = 2 } }
[[case]]
name = "{force} N"
each.force = [20, 40]
set = { clamp = "{force} N", raw = "{force}" }
[[case]]
name = "pairs"
each."table.x, published" = [[5, "stops"]]
"""


def test_cases_are_all_combinations_with_changes_of_the_keywords():
    rows = Study("made-up", tomllib.loads(COMBINED)).rows()
    assert [row.labels["name"] for row in rows] == 2 * ["20 N", "40 N"] + 2 * ["pairs"]
    table = {"x": 1, "y": 2}
    assert rows[2].keywords == {"a": 1, "table": table, "clamp": "20 N", "raw": 20, "n": 2}
    assert rows[4].keywords == {"a": 1, "table": {"x": 5, "y": 2}, "n": 1}
    assert rows[4].labels == {"name": "pairs", "mesh": "coarse", "table.x": 5, "published": "stops"}


def error_of_second_order(n, scale=1.0):
    if n == 7:
        raise UnstableError("seven")
    return {"value": 3 + scale / n**2, "history": np.arange(n)}


COMPARED = """
each.n = [1, 2, 4, 7]
reference.n = 4
quantities = { value = "value", "off [%]" = "100 * (value / ref.value - 1)", sum = "sum(history)" }
fits.line.value = "max(of('value'))"
expect = ["falls(of('off [%]'))", "max(of('sum')) > 6"]
"""


def test_a_study_is_computed_compared_written_and_taken_again(monkeypatch, tmp_path):
    this = made_up(monkeypatch, tmp_path, error_of_second_order, COMPARED)
    records = runner.run(this)
    assert records[0] == {
        "n": 1,
        "value": 4.0,
        "off [%]": pytest.approx(100 * (4 / 3.0625 - 1)),
        "sum": 0,
    }
    assert records[3] == {"n": 7, "value": None, "off [%]": None, "sum": None, "problem": "seven"}
    assert records[4] == {"n": "line", "value": 4.0}
    assert study.unmet(this, records) == ["max(of('sum')) > 6"]
    csv_file.write(tmp_path / "a.csv", records, "by hand", {"n": "elements"})
    made, rows = csv_file.read(tmp_path / "a.csv")
    assert made == "by hand"
    assert rows[0]["elements"] == "1"
    assert rows[0]["value"] == "4"
    assert rows[3]["problem"] == "seven"
    monkeypatch.setattr(cases, "function", lambda name: None)
    assert runner.run(this) == records


def valley(x, y):
    if x * y > 3:
        raise UnstableError("too much")
    return {"x": x}


MAPPED = """
each = { x = [0.1, 1.0, 2.0, 8.0], y = [1.0, 0.5] }
map = { x = "x", y = "y", stable = "x > 0.3", default = [1.0, 1.0], sides = ["above", "below"] }
quantities."x again" = "x"
"""


def test_a_map_finds_the_edges_about_its_default(monkeypatch, tmp_path):
    records = runner.run(made_up(monkeypatch, tmp_path, valley, MAPPED))
    outcomes = {(one["x"], one["y"]): one["outcome"] for one in records}
    assert outcomes[0.1, 1.0] == "wrong"
    assert outcomes[2.0, 1.0] == STABLE
    assert outcomes[8.0, 0.5] == "failed"
    above, below = records[-2:]
    assert above["outcome"] == "edge above: failed"
    assert below["outcome"] == "edge below: wrong"
    assert above["margin"] == pytest.approx(3.0, rel=0.05)
    assert below["margin"] == pytest.approx(1 / 0.3, rel=0.08)


CHARTED = """
base.n = 1
quantities.value = "value"
[each.method]
1 = {}
3 = { n = 3 }
"3, dear" = { n = 3, scale = 1.01 }
fails = { n = 7 }
[cost]
warm.n = 1
groups.value = ["value"]
meshes = [[0.5, { n = 2 }], [0.25, { n = 4 }], [0.125, { n = 8 }]]
"""


def test_a_chart_knows_errors_costs_and_what_none_beats(monkeypatch, tmp_path):
    def timed(n, scale=1.0):
        return error_of_second_order(n, scale) | {"cpu_s": 0.7 * n}

    records = runner.run(made_up(monkeypatch, tmp_path, timed, CHARTED))
    assert records[-1]["value"] == pytest.approx(3.0)
    assert [one["error of value [%]"] for one in records[:2]] == pytest.approx([100 / 3, 100 / 27])
    assert [one["Pareto-optimal in"] for one in records[:4]] == ["value; ", "value; ", "", ""]
    assert np.isnan(records[3]["error of value [%]"])


def test_a_warm_run_that_is_refused_ends_the_study_and_is_no_problem_of_a_case(
    monkeypatch, tmp_path
):
    def run(n, scale=1.0):
        if n == 1:
            raise InputError(key="n", value=n, allowed="above 1")
        if n == 3:
            raise UnstableError("no equilibrium")
        return {"value": 2.0, "cpu_s": 0.7}

    monkeypatch.setattr(cases, "function", lambda name: run)
    assert runner.solve("made.up", {"n": 3}, {"n": 3})["problem"] == "no equilibrium"
    assert runner.solve("made.up", {"n": 1})["problem"]
    assert runner.solve("made.up", {"n": 2}, {"n": 2})["value"] == 2.0
    with pytest.raises(InputError, match=r"cost\.warm.*is refused.*above 1"):
        runner.solve("made.up", {"n": 2}, {"n": 1})


def test_what_none_beats_in_time_and_error():
    assert judges.non_dominated([1, 2, 3, 4], [4.0, 4.0, 2.0, 1.99], 0.1) == [0, 2]
    assert judges.non_dominated([1, 2, np.nan], [np.nan, 2, 1]) == [1]


def test_there_is_no_other_study(capsys):
    with pytest.raises(InputError, match=r"moon.*all, or of "):
        study.load("moon")
    assert runner.main(["pull-out-load"], quick=True) == 0
    assert "pull-out-load: 2 rows" in capsys.readouterr().out


@pytest.mark.parametrize("name", study.all_names())
def test_every_study_can_be_run(name):
    """Nothing is computed: its function takes the keywords of its cases, and the set-ups of shots can be made."""
    if 'run = "solid.' in (study.FOLDER / f"{name}.toml").read_text():
        pytest.importorskip("dolfinx")
    this = study.load(name)
    function = cases.function(this.content["run"])
    rows = this.rows()
    assert this.content["question"].endswith("?")
    assert all(row.quantities for row in rows)
    own = {"search", "unfailing", *inspect.signature(function).parameters}
    for row in rows[:: max(1, len(rows) // 12)]:
        for keywords in filter(None, (row.keywords, row.reference)):
            inspect.signature(function).bind(**keywords)
            if function in (
                impact.shot,
                impact.limit,
                impact.first_failure,
                impact.means,
                impact.stepped,
            ):
                impact.setup(
                    **{
                        key: value
                        for key, value in keywords.items()
                        if key not in own - {"velocity"}
                    }
                )


def test_what_is_taken_from_kept_results_needs_no_run_before_it():
    text = "import numpy as np; from validation.study import evaluated; evaluated('x.any()', {'x': np.zeros(2)})"
    printed(text)


@pytest.mark.nightly
@pytest.mark.slow(20)
@pytest.mark.parametrize(
    "name", [name for name in study.all_names() if "quick" in study.load(name).content]
)
def test_every_quick_study_runs(name, tmp_path):
    """Each `--quick` writes rows: a study that nobody has run since its functions changed is found."""
    assert runner.main([name], quick=True, out=tmp_path) == 0
    assert (tmp_path / f"{name}.csv").read_text().count("\n") > 2
