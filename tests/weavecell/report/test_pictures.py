"""Pictures of a report are compared as pictures with those that somebody has looked at.

After a wanted change: draw them again with `python -m tests.weavecell.report.test_pictures`, and look at them.
"""

from pathlib import Path

import numpy as np
import pytest
from matplotlib.testing.compare import compare_images

from weavecell.report import pictures

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
DRAWN = {"velocity": (pictures.velocity, RUNS), "cell": (pictures.cell, {"warp extension": CASE})}


def draw(name, folder):
    path = folder / f"{name}.png"
    path.write_bytes(pictures.render(*DRAWN[name], kind="png"))
    return str(path)


@pytest.mark.parametrize("name", DRAWN)
def test_a_picture_is_the_one_that_was_seen(name, tmp_path):
    """Up to 8 of 255 shades in the root mean square, which fonts of another version may take.

    A curve that is lost, points that are, and a scale of 5 % take 10 and more; a changed word takes 2.
    """
    assert compare_images(str(SEEN / f"{name}.png"), draw(name, tmp_path), tol=8) is None


if __name__ == "__main__":
    for each in DRAWN:
        draw(each, SEEN)
