"""Pictures whose margins are set by hand: no text leaves the figure or lies on another one, with the widest numbers."""

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from test_report import small_record

from fabrics import catalogue
from meshing.pictures_style import plots
from weavecell.report import chapters, pictures
from weavecell.report.shot import chapters_shot


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
            if not (axes.axison and axis.get_visible()):
                continue
            low, high = sorted(axis.get_view_interval())
            found += [axis.label, *(tick.label1 for tick in axis.get_major_ticks() if low <= tick.get_loc() <= high)]
    return [(t.get_text(), t.get_window_extent()) for t in found if t.get_visible() and t.get_text()]


def assert_readable(figure):
    found, (width, height) = texts(figure), figure.bbox.size
    for text, box in found:
        assert min(box.x0, box.y0, width - box.x1, height - box.y1) > -1, text
    for (one, a), (other, b) in combinations(found, 2):
        across, up = min(a.x1, b.x1) - max(a.x0, b.x0), min(a.y1, b.y1) - max(a.y0, b.y0)
        assert min(across, up) < 2, (one, other)


@pytest.fixture
def drawn(monkeypatch):
    """What `pictures.render` is asked for is looked at; its names are kept."""
    found = []

    def render(draw, *arguments, kind="svg"):
        with plots() as pyplot:
            assert_readable(draw(pyplot, *arguments))
        found.append(draw.__name__)
        return b""

    monkeypatch.setattr(pictures, "render", render)
    return found


def record_of(title, scale):
    """A made-up record with numbers `scale` times as large, and every energy that there is."""
    plain = small_record()
    energies = {name: scale * plain.energies["yarn_strain"] / 20 for name, *_ in pictures.ENERGIES}
    changes = {name: scale * getattr(plain, name) for name in ("velocity", "deflection", "contact_force")}
    changes["energies"] = energies | {"error": scale * plain.energies["error"]}
    changes["plies"] = {name: 100 * scale * force for name, force in plain.plies.items()}
    return replace(plain, title=title, **changes)


@pytest.mark.parametrize("scale", [1e-3, 1.0, 20.0])
@pytest.mark.parametrize("count", [1, 2, 4])
def test_pictures_of_impacts(drawn, count, scale):
    chapters_shot.chapter([record_of(f"{168 + k} m/s, published law", scale) for k in range(count)])
    assert drawn == ["histories", "cuts", "panels", "energies", "reactions"]


def test_picture_of_the_cell(drawn):
    fabric = catalogue.load("S-720")
    chapters.cell(fabric, {"fitted law": fabric.laws, "published law": fabric.laws})
    assert drawn == ["cell"]


def test_what_is_not_readable_is_found():
    with plots() as pyplot:
        figure, axes = pyplot.subplots(layout="none")
        assert_readable(figure)
        figure.subplots_adjust(left=0.01)
        with pytest.raises(AssertionError, match=r"0\.0"):
            assert_readable(figure)
        figure.subplots_adjust(left=0.2)
        axes.text(0.5, 0.5, "one")
        axes.text(0.5, 0.51, "other")
        with pytest.raises(AssertionError, match="other"):
            assert_readable(figure)


def test_margins_and_gaps_are_in_inches():
    with plots() as pyplot:
        figure, grid = pyplot.subplots(2, 3, figsize=(9, 6), height_ratios=(2, 1), layout="none")
        pictures.place(figure, 1.0, 0.5, 0.8, 0.4, across=0.25, down=0.6)
        box = [[axes.get_position() for axes in row] for row in grid]
    assert 9 * box[0][0].x0 == pytest.approx(1.0)
    assert 9 * (1 - box[0][2].x1) == pytest.approx(0.5)
    assert 6 * box[1][0].y0 == pytest.approx(0.8)
    assert 6 * (1 - box[0][0].y1) == pytest.approx(0.4)
    assert 9 * (box[0][1].x0 - box[0][0].x1) == pytest.approx(0.25)
    assert 6 * (box[0][0].y0 - box[1][0].y1) == pytest.approx(0.6)
    assert np.isclose(box[0][0].height, 2 * box[1][0].height)
