"""Pictures of a report are compared as pictures with those that somebody has looked at.

After a wanted change: draw them again with `python -m tests.weavecell.report.test_pictures`, and look at them.
"""

import re
from pathlib import Path

import numpy as np
import pytest
from matplotlib.testing.compare import compare_images
from PIL import Image

from fabrics import catalogue
from weavecell.report import pictures, pictures3d, pictures_figure
from weavecell.results import finding, vtk

SEEN = Path(__file__).with_name("pictures")
T = np.linspace(0, 60e-6, 61)
RUNS = {"stopped": (T, 100 - T / 0.6e-6), "perforated": (T, 155 - 30 * np.sin(2e4 * T))}
STRAIN = np.linspace(0, 0.03, 31)
CASE = {
    "strain": STRAIN,
    "curves": {
        "fitted law": (7e3 * STRAIN, 2e3 * STRAIN),
        "published law": (6e3 * STRAIN, 1500 * STRAIN),
    },
    "points": (STRAIN[::6], 6.5e3 * STRAIN[::6], 1e3 * STRAIN[::6]),
}


def curve(picture, *given):
    return lambda path: path.write_bytes(pictures.render(picture, *given, kind="png"))


def mesh(picture, count=None, **choices):
    """A picture of a mesh of S-731, of a patch of yarns or of one crossover, in a quarter of its size."""

    def draw(path):
        from meshing import crossover, patch
        from weavecell.report import pictures_mesh, pictures_patch, pictures_quality

        drawers = {"mesh": pictures_mesh, "patch": pictures_patch, "quality": pictures_quality}
        fabric = catalogue.load("S-731")
        if count is None:
            made = crossover.build(fabric, size=(5, 4, 2), section="sine", **choices)
        else:
            made = patch.build(fabric, count, size=(4, 3, 1))
        drawers[picture].picture(made, path)
        with Image.open(path) as image:
            image.convert("RGB").reduce(4).save(path)

    return draw


def panel(path):
    """Squares of a panel of which one half is drawn: a slack one behind a taut one, and one that has failed."""
    places = np.array([[0.01, -0.005, 0.0], [0.012, -0.005, 0.004], [0.03, 0.02, 0.0]])
    halves = np.array([0.01, 0.005, 0.008])
    square = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
    corners = places[:, None] + halves[:, None, None] * square
    grid = vtk.grid(corners.reshape(-1, 3), np.arange(12).reshape(3, 4))
    grid.cell_data["tension_warp_N"] = [0.0, 1.0, 1.0]
    grid.cell_data["tension_weft_N"] = np.zeros(3)
    grid.cell_data["failed_yarns"] = [0, 0, 2]
    far = np.full((2, 2, 3), -1.0)
    image = pictures3d.panel(grid, np.ones(2), far, (True, False), 0.03)
    Image.fromarray(image).reduce(4).save(path)


DRAWN = {
    "velocity": curve(pictures.velocity, RUNS),
    "cell": curve(pictures.cell, {"warp extension": CASE}),
    "panel": panel,
    "quarter": mesh("mesh"),
    "whole": mesh("mesh", domain="whole"),
    "patch": mesh("patch", (2, 3)),
    "quality": mesh("quality", (2, 2)),
}


def draw(name, folder):
    path = folder / f"{name}.png"
    DRAWN[name](path)
    return str(path)


@pytest.mark.parametrize("name", DRAWN)
def test_a_picture_is_the_one_that_was_seen(name, tmp_path):
    """Up to 8 of 255 shades in the root mean square, which fonts of another version may take.

    A curve that is lost, points that are, a scale of 5 % and a yarn that is not drawn take 10 and more; a changed word
    takes 2.
    """
    if name not in ("velocity", "cell"):
        pytest.importorskip("gmsh")
        pytest.importorskip("pyvista")
    assert compare_images(str(SEEN / f"{name}.png"), draw(name, tmp_path), tol=8) is None


def test_doubts_stand_above_the_title_and_the_title_above_the_panels():
    """The engine of layouts would have the title of two panels at the very top, over the doubts."""

    def pair(pyplot):
        made, panels = pyplot.subplots(1, 2, figsize=(9.0, 3.4))
        for axes in panels:
            axes.set(title="a panel", xlabel="strain [%]")
        made.suptitle("canvas: biaxial tests of a file with a long name")
        return made

    with finding.showing(["widest interval", "error of prediction"]):
        made = pictures_figure.drawn(pair)
    made.canvas.draw()
    title, doubts = made.texts
    assert doubts.get_text().startswith("DOUBTFUL: widest interval")
    above, below = (text.get_window_extent() for text in (doubts, title))
    # the title is the last of its lines
    assert title.get_text().count("\n") == 1
    assert above.y0 > below.y0 + 0.5 * below.height
    assert below.y0 > max(axes.get_tightbbox().y1 for axes in made.axes)


def test_texts_of_a_drawing_are_texts_that_any_reader_has_a_font_for():
    """No outlines of letters: they are four tenths of a picture, and cannot be searched."""
    drawn = pictures.render(pictures.velocity, RUNS).decode()
    texts = re.findall(r"<text style=\"([^\"]*)\"[^>]*>([^<]*)</text>", drawn)
    assert {"stopped", "perforated"} <= {words for _, words in texts}
    families = {re.search(r"'DejaVu Sans', 'Verdana'.*sans-serif", style) for style, _ in texts}
    assert None not in families
    assert "DejaVuSans-" not in drawn


if __name__ == "__main__":
    for each in DRAWN:
        draw(each, SEEN)
