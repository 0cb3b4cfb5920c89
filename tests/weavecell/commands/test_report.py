"""The report of an impact: every chapter is there, nothing is fetched, no text lies on another, and what is said."""

import base64
import json
import re
import zlib
from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import weavecell
from fabrics import catalogue
from shellfabric.membrane.indicator import Indicator
from tests.weavecell.session_runs import fired
from weavecell.report import chapters, pictures
from weavecell.report.page import Embedded, Report, Section, Table
from weavecell.report.pictures_figure import plots
from weavecell.report.shot import chapters_shot, moving, pictures_shot, view
from weavecell.results import provenance, vtk
from weavecell.results.finding import Answer

OPEN = ("movers", "motion", "impact", "measures")  # chapters that are not folded


@pytest.fixture
def record():
    return fired("impact")


@pytest.fixture
def page(results):
    return (results("impact").folder / "report.html").read_text("utf-8")


def test_all_chapters_are_there_and_nothing_is_fetched(page):
    ids = re.findall(r'<[^>]* id="([^"]*)"', page)
    tags = re.findall(r"<([a-z]+)", page)
    links = re.findall(r'<[^>]* (?:src|href|srcset|data|action|poster)="([^"]*)"', page)
    assert ids == [
        "movers",
        "motion",
        "impact",
        "panel-mesh",
        "measures",
        "cell",
        "assumptions",
        "checks",
        "sources",
        "making",
        "words",
    ]
    # what is folded is below the rest
    assert [link for link in links if link.startswith("#")] == [
        f"#{key}" for key in ids if key in OPEN
    ]
    assert all(link.startswith(("data:image/", "#")) for link in links)
    assert tags.count("img") == 10
    assert "link" not in tags
    text = re.sub(r"data:image/[a-z+]+;base64,[A-Za-z0-9+/=]+", "", page)
    # sources are named by their addresses, which no link leads to
    for word in ("@import", "url(", "fetch("):
        assert word not in text
    assert page.index('<details class="folded">') > page.index('id="impact"')


def unmarked(page):
    """A page without the marks of explained words and of cells."""
    return re.sub(r"</?(abbr|span)[^>]*>", "", page)


def test_text_is_escaped_and_every_source_reported(page):
    page = unmarked(page)
    assert "a &lt;small&gt; &amp; thin panel" in page
    assert "<small>" not in page
    for key, entry in catalogue.load("S-720").sources.items():
        assert f'<td data-column="key">{key}</td>' in page
        assert f'<td data-column="value">{entry["value"]}</td>' in page


def test_the_outcome_is_one_line(record):
    said = chapters_shot.outcome
    through = replace(record, outcome="perforated", residual_velocity=50.0)
    assert said(through) == "perforates, 50 m/s left"
    held = replace(
        record,
        outcome="stopped",
        residual_velocity=0.0,
        plies=record.plies | {"cut_yarns": np.zeros((len(record.time), 1))},
        max_deflection=7.5e-3,
        peak_tension=np.array([[0.3, 0.98]]) * record.strength,
        checks=(Indicator("energy error", 0.1, 0.01),),
    )
    assert said(held) == "stops; the back face moves 7.5 mm"
    unstable = replace(record, outcome="unstable", failure_message="a node flies")
    assert said(unstable) == "UNSTABLE, and no result: a node flies"


def test_the_moving_panel_has_the_snapshots_of_the_run(results, record):
    """What the script of the page reads: places to a 65,535th of the box, tensions to a 200th of the strength."""
    instants = view.ViewedShot(
        record, vtk.read_series(results("impact").folder / "panel.pvd")
    ).instants()
    head = json.loads(moving.moving(record, instants))
    data = zlib.decompress(base64.b64decode(head["data"]))
    n = head["nodes"]
    m = head["elements"]
    count = head["instants"]
    sizes = np.cumsum(
        [12 * head["bodyVertices"], 16 * m, 6 * n * count, 2 * m * count, m * count, m]
    )
    _, quads, places, tension, failed, _ = np.split(np.frombuffer(data, np.uint8), sizes[:-1])
    assert len(data) == sizes[-1]
    assert count == len(instants)
    places = np.cumsum(places.view("<u2").reshape(count, n, 3), axis=0, dtype=np.uint16)
    for k, (grid, _) in enumerate(instants):
        at = np.array(head["origin"]) + places[k] * np.array(head["step"])
        assert_allclose(at, grid.points, atol=0.51 * max(head["step"]))
        share = tension.reshape(count, m, 2)[k, :, 0] / head["perUnit"]
        assert_allclose(share, grid["tension_warp_N"] / record.strength[0, 0], atol=2.6e-3)
        assert_array_equal(failed.reshape(count, m)[k], grid["failed_yarns"])
    assert_array_equal(quads.view("<u4").reshape(m, 4), instants[0][0].cells.reshape(-1, 5)[:, 1:])
    # one scale with the pictures, 0 to 100 % of the strength
    assert {head["ends"][name]["value"] for name in ("tension", "warp", "weft")} == {1.0}
    in_notebook = Embedded(moving.page(record, instants))._repr_html_()
    assert in_notebook.startswith('<iframe srcdoc="&lt;!doctype html&gt;')
    assert in_notebook.count('"') == 4  # those of the page within are escaped


def texts(figure):
    """[(text, its extent in pixels)] of all that is written in a figure."""
    figure.canvas.draw()
    found = [*figure.texts, *(text for legend in figure.legends for text in legend.get_texts())]
    for axes in figure.axes:
        if not axes.get_visible():
            continue
        found += [*axes.texts, axes.title, axes._left_title, axes._right_title]
        found += axes.get_legend().get_texts() if axes.get_legend() else []
        for axis in (axes.xaxis, axes.yaxis):
            if axes.axison and axis.get_visible():
                low, high = sorted(axis.get_view_interval())
                ticks = axis.get_major_ticks()
                found += [
                    axis.label,
                    *(tick.label1 for tick in ticks if low <= tick.get_loc() <= high),
                ]
    return [
        (t.get_text(), t.get_window_extent()) for t in found if t.get_visible() and t.get_text()
    ]


@pytest.mark.parametrize("scale", [1e-3, 20.0])
def test_no_text_of_a_picture_leaves_it_or_lies_on_another(record, monkeypatch, scale):
    """Pictures of a shot, and of the cell, with the narrowest and the widest numbers."""
    names = []

    def render(draw, *arguments, kind="svg"):
        names.append(draw.__name__)
        with plots() as pyplot:
            figure = draw(pyplot, *arguments)
            found = texts(figure)
            width, height = figure.bbox.size
        for text, box in found:
            assert min(box.x0, box.y0, width - box.x1, height - box.y1) > -1, text
        for (one, a), (other, b) in combinations(found, 2):
            across = min(a.x1, b.x1) - max(a.x0, b.x0)
            up = min(a.y1, b.y1) - max(a.y0, b.y0)
            assert min(across, up) < 2, (one, other)
        return b""

    monkeypatch.setattr(pictures, "render", render)
    changes = {
        name: scale * getattr(record, name) for name in ("velocity", "deflection", "contact_force")
    }
    for name in ("energies", "plies"):
        changes[name] = {key: scale * values for key, values in getattr(record, name).items()}
    chapters_shot.chapter(replace(record, **changes))
    fabric = catalogue.load("S-720")
    chapters.cell(fabric, {"fitted law": fabric.laws, "published law": fabric.laws})
    assert names == ["histories", "energies", "cuts", "cell"]


def test_pictures_repeat_to_the_byte(record):
    runs = {"a": (record.time, record.velocity)}
    assert pictures.render(pictures.velocity, runs) == pictures.render(pictures.velocity, runs)


def test_stamp_tells_versions_and_no_paths(monkeypatch):
    monkeypatch.setenv("OMP_NUM_THREADS", "1")
    stamp = provenance.stamp("a scene")
    assert stamp.pop("sources") == []
    assert stamp["weavecell"] == weavecell.__version__
    assert stamp["scene"] == "a scene"
    assert f"numpy {np.__version__}" in stamp["packages"]
    assert "matplotlib" in stamp["packages"]
    assert stamp["threads"].startswith("OMP_NUM_THREADS 1")
    assert not [value for key, value in stamp.items() if value.startswith("/") or " /" in value]


def test_parts_of_the_energy_picture_add_up():
    """The equilibrium form's forces do other work than the yarns store; the picture shows the work."""
    stored = {
        "yarn_strain": np.array([0.0, 3.5, 4.0]),
        "formulation_residual": np.array([0.0, -0.5, -0.5]),
    }
    energies = stored | {
        "kinetic_projectile": np.array([10.0, 6.0, 4.0]),
        "viscous": np.array([0.0, 1.0, 2.5]),
    }
    drawn = pictures_shot.parts(energies, recoil=1.5)
    assert drawn["recoil_of_cut_yarns"] == pytest.approx([0.0, 0.0, 1.5])
    named = ("kinetic_projectile", "yarn_strain", "viscous", "recoil_of_cut_yarns")
    assert sum(drawn[name] for name in named) == pytest.approx([10.0, 10.0, 10.0])
    assert energies["yarn_strain"][1] == 3.5


def test_a_cut_shows_an_oblique_projectile_where_it_is(record):
    aside = np.array([2e-3, 0.0, 0.0])
    shape = replace(
        record.final[0], projectile_position=record.final[0].projectile_position + aside
    )
    oblique = replace(record, half_energy=(shape,), final=(shape,))
    straight = replace(record, half_energy=record.final)
    views = [chapters_shot.cut_view(each, each.cuts[-1], "") for each in (straight, oblique)]
    assert_allclose(
        views[1].projectile - views[0].projectile, [[2e-3, 0.0]] * len(views[0].projectile)
    )


def test_a_designer_finds_ten_results(page):
    """By short names; the others are in summary.json."""
    _, _, rest = unmarked(page).partition("<caption>Results</caption>")
    shown = rest.partition("</table>")[0]
    rows = re.findall(r"<tr>\s*<td[^>]*>(.*?)</td>\s*<td[^>]*>(.*?)</td>", shown)
    assert 5 <= len(rows) <= 11
    assert all(len(label) <= 48 for label, _ in rows)


def test_on_a_phone_shots_are_a_table_and_texts_are_lists():
    """Shots with their numbers stay rows, of small letters; sources of many texts are lists of their own cells."""
    numbers = ("strike velocity [m/s]", "residual velocity [m/s]", "end time [µs]")
    shots = Table((*numbers, "outcome"), 5 * (("100", "0", "9", "stopped"),), numeric=numbers)
    of_texts = ("key", "value", "status", "source")
    texts = Table(of_texts, 5 * (("a", "1", "measured", "thesis"),))
    few = replace(shots, rows=shots.rows[:2])
    section = Section("s", "S", tables=(shots, texts, few))
    page = Embedded(Report(Answer("t", "90 m/s"), "", (section,))).html
    assert re.findall(r'<table class="(\w+)', page) == ["tight", "stacked", "tight"]
