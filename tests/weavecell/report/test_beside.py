"""The page of two shots: what it says differs by what the two records have, and both are drawn alike."""

import json
import re
from dataclasses import replace

import numpy as np
import pytest

from fabrics.base.errors import InputError
from shellfabric.membrane import quality
from tests.weavecell.session_runs import fired
from weavecell.report.page import render
from weavecell.report.shot import beside, chapters_shot, moving
from weavecell.report.shot.view import show


@pytest.fixture(scope="module")
def shots():
    """Two records, and the instants of each: the second is slower, weaker, and ends earlier."""
    one = fired("impact")
    times = one.time
    other = replace(
        one,
        title="the <other>",
        outcome="stopped",
        residual_velocity=0.0,
        velocity=one.velocity - 20,
        deflection=0.7 * one.deflection,
        max_deflection=0.7 * one.max_deflection,
        strength=0.5 * one.strength,
    )
    instants = moving.collect_instants(one, one.instants)
    assert len(instants) > 2
    assert times[-1] > 0
    return (one, other), (instants, instants[:-1])


@pytest.fixture(scope="module")
def html(shots):
    return render(beside.build(*shots))


def test_the_first_line_says_what_differs(shots):
    (one, other), _ = shots
    said = beside.difference((one, other))
    assert said.startswith(f"A {one.outcome}, B stopped: ")
    more = 1e3 * (other.max_deflection - one.max_deflection)
    first, second = (f"{1e3 * each.max_deflection:.3g} mm" for each in (one, other))
    assert f"deflection of the back face {first} and {second} ({more:+.3g} mm)" in said
    assert "peak contact force" not in said  # it is the same
    assert beside.difference((one, one)) == f"Both {one.outcome}, with the same results."
    doubted = replace(one, checks=(quality.indicator("projectile hourglass", 0.42),))
    assert beside.difference((one, doubted)).endswith(
        "results. B is doubtful: projectile hourglass 0.420 (limit 0.01; a finer drawing of the projectile)."
    )


def test_rows_have_both_values_and_their_difference(shots):
    records, _ = shots
    table = beside.results(records)
    assert table.columns == ("result", *beside.names(records), "B − A")
    rows = {row[0]: row[1:] for row in table.rows}
    assert rows["outcome"] == (records[0].outcome, "stopped", "")
    values = [1e3 * record.max_deflection for record in records]
    shown = rows["deflection of the back face [mm]"]
    wanted = (*values, values[1] - values[0])
    assert [float(text) for text in shown] == pytest.approx(wanted, rel=1e-3)
    assert len(beside.every_result(records).rows) > 2 * len(rows)


def test_both_panels_have_one_scale_and_their_own_instants(shots, html):
    records, instants = shots
    heads = [json.loads(text) for text in re.findall(r'application/json">(.*?)</script>', html)]
    assert len(heads) == 2
    alone = [json.loads(moving.moving(*pair)) for pair in zip(records, instants)]
    for name in alone[0]["ends"]:
        most = max(head["ends"][name]["value"] for head in alone)
        assert [head["ends"][name]["value"] for head in heads] == [most, most]
        assert heads[0]["ends"][name]["text"] == heads[1]["ends"][name]["text"]
    # the second ends earlier, less deep: its scale is that of the first
    assert alone[1]["ends"]["deflection"]["value"] < alone[0]["ends"]["deflection"]["value"]
    for key in ("width", "depth", "elevation"):
        assert heads[0][key] == heads[1][key]
    for head, of_it in zip(heads, instants):
        assert head["times"] == [t for _, t in of_it]
        assert len(head["captions"]) == len(head["times"]) == head["instants"]
        assert np.all(np.diff(head["times"]) > 0)


def test_the_page_is_whole_and_fetches_nothing(html):
    assert "the &lt;other&gt;" in html
    assert "<other>" not in html
    text = re.sub(r"data:image/[a-z+]+;base64,[A-Za-z0-9+/=]+", "", html)
    for word in ("http:", "https:", "@import", "url(", 'src="/', "<link"):
        assert word not in text
    assert html.count("<canvas>") == 2
    assert html.count("async function view3d(") == html.count("function together(") == 1
    ids = re.findall(r'<section id="([^"]*)"', html)
    assert ids[:4] == ["results", "motion", "histories", "all"]
    for tag in ("div", "section", "table", "tr", "td", "details", "script", "figure"):
        assert len(re.findall(rf"<{tag}[ >]", html)) == html.count(f"</{tag}>"), tag


def test_what_is_no_shot_is_refused(tmp_path, results):
    whole = results("impact").folder
    page = tmp_path / "two.html"
    (tmp_path / "empty").mkdir()
    for pair in ((whole, tmp_path / "empty"), (tmp_path / "empty", whole), (whole, page)):
        with pytest.raises(InputError, match="a folder of a shot"):
            show(pair[0], None, None, page, other=pair[1])
        assert not page.exists()
    with pytest.raises(InputError, match="html"):
        show(whole, None, None, None, other=whole)
    page.write_text("mine")
    with pytest.raises(InputError):
        show(whole, None, None, page, other=whole)
    assert page.read_text() == "mine"


@pytest.mark.parametrize("count, drawn", [(1, False), (2, False), (3, True)])
def test_a_cone_of_less_than_three_instants_is_no_curve(shots, count, drawn):
    """A shot from Python without snapshots has one cut, at its end."""
    (one, _), _ = shots
    known = [cut for cut, radius in zip(one.cuts, one.cone_radius) if np.isfinite(radius)]
    # two of them, the last once more
    known.append(known[-1])
    assert len(known) >= 3
    record = replace(one, cuts=tuple(known[:count]), measured=())
    names = {figure.name for figure in chapters_shot.chapter(record).figures}
    assert ("cone" in names) == drawn
