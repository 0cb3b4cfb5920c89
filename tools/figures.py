"""Make the figures of README and docs from the code: python tools/figures.py [results/demo]  (make figures).

Takes the pictures of a demonstration that has been run into the given folder, and computes the others. Everything goes
to docs/figures/.
"""

import sys
from pathlib import Path

from PIL import Image

from fabrics import catalogue
from fabrics.files import replace_whole, write_whole
from meshing import patch, pictures_patch
from validation.buet_gautier.curves import curves
from validation.buet_gautier.pictures import picture as biaxial_picture

FIGURES = Path(__file__).parents[1] / "docs" / "figures"
FROM_DEMO = ("mesh.png", "fit.svg", "cell.svg", "velocity.svg", "panel.png", "energies-1.svg", "energies-3.svg")


def main(demo):
    for name in FROM_DEMO:
        with write_whole(FIGURES / name, "wb") as file:
            file.write((demo / "pictures" / name).read_bytes())
    fabric = catalogue.load("S-720")
    pictures_patch.picture(patch.build(fabric, (4, 4), size=(8, 6, 2)), FIGURES / "weave.png")
    for name in ("glass-balanced", "glass-unbalanced"):
        weave = catalogue.load(name)
        biaxial_picture(weave, curves(weave), FIGURES / f"biaxial-{name}.png")
    for path in FIGURES.glob("*.png"):
        shrink(path)


def shrink(path, width=1000):
    """Make a picture small enough to be kept with the code: no wider than a page."""
    with Image.open(path) as image, replace_whole(path) as beside:
        small = image.convert("RGB")
        small.thumbnail((width, 4 * width))
        small.save(beside, optimize=True)


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "results/demo"))
