"""Make the figures of README and docs from the code: python tools/figures.py [results/demo]  (make figures).

Takes the pictures of a demonstration that has been run into the given folder, and computes the others. Everything goes
to docs/figures/. Those of the study of convergence, which takes long, come from `python -m
validation.verification.mesh_convergence`.
"""

import sys
from contextlib import suppress
from pathlib import Path
from tempfile import TemporaryDirectory

from PIL import Image

from fabrics import catalogue
from fabrics.errors import UnstableError
from fabrics.files import replace_whole, write_whole
from validation.published.biaxial_glass import model_comparison, options
from validation.published.biaxial_glass import pictures as biaxial_pictures
from weavecell.commands import biaxial, coupon

FIGURES = Path(__file__).parents[1] / "docs" / "figures"
COUPONS = Path(__file__).parents[1] / "examples" / "coupons"
FROM_COUPONS = {
    "S-728-bias": ("coupon.png", "angles.svg"), "S-728-no-trellis": ("coupon.png",), "S-720-frame": ("stress.svg",),
    "S-726-pull-out": ("load.svg",),
    "S-720-warp": ("load.svg", "strains.svg"), "glass-biaxial": ("load.svg",),
}  # fmt: skip
FROM_DEMO = ("mesh.png", "fit.svg", "cell.svg")


def main(demo):
    for name in FROM_DEMO:
        keep(demo / "pictures" / name, name)
    for name in ("glass-balanced", "glass-unbalanced"):
        weave = catalogue.load(name)
        biaxial_pictures.options(weave, options.same_constants(weave), FIGURES / f"biaxial-options-{name}.png")
        biaxial_pictures.sides(weave, model_comparison.compare(weave)[0], FIGURES / f"biaxial-sides-{name}.png")
    coupons()
    for path in FIGURES.glob("*.png"):
        shrink(path)


def coupons():
    """Run the examples of coupons, one of them an instability, and keep some of their pictures."""
    with TemporaryDirectory() as folder:
        for name, pictures in FROM_COUPONS.items():
            with suppress(UnstableError):
                coupon.coupon(COUPONS / f"{name}.toml", Path(folder) / name)
            for picture in pictures:
                keep(Path(folder) / name / "pictures" / picture, f"coupon-{name}-{picture}")
        biaxial.biaxial_command("S-731", Path(folder) / "biaxial", ratios=("1:1", "1:0", "0:1"))
        keep(Path(folder) / "biaxial" / "pictures" / "cell.svg", "biaxial-S-731.svg")


def keep(source, name):
    """Copy a picture to the figures."""
    with write_whole(FIGURES / name, "wb") as file:
        file.write(source.read_bytes())


def shrink(path, width=1000):
    """Make a picture small enough to be kept with the code: no wider than a page."""
    with Image.open(path) as image, replace_whole(path) as beside:
        small = image.convert("RGB")
        small.thumbnail((width, 4 * width))
        small.save(beside, optimize=True)


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "results/demo"))
