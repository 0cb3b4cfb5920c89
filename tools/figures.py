"""Make the figures of README and docs from the code: python tools/figures.py [results/demo]  (make figures).

Takes the pictures of a demonstration that has been run into the given folder, and computes the others: coupons and
the pictures of README, of which chromium draws the report. `--only` makes some of them. They go to docs/figures/.
Charts of cost and maps of stability are drawn from the CSVs of their studies (`report_charts`); other figures of
reports are drawn by `make docs`.
"""

import argparse
import subprocess
import warnings
from pathlib import Path
from tempfile import TemporaryDirectory

import hero
import report_charts
from PIL import Image

import weavecell as wc
from fabrics.base.files import replace_whole, write
from weavecell.report import pictures_body, pictures_figure

FIGURES = Path(__file__).parents[1] / "docs" / "figures"
COUPONS = Path(__file__).parents[1] / "examples" / "coupons"
FROM_COUPONS = {
    "S-728-bias": ("coupon.png", "angles.svg"),
    "S-720-frame": ("stress.svg",),
    "S-726-pull-out": ("load.svg",),
    "S-720-warp": ("load.svg", "strains.svg"),
    "glass-biaxial": ("load.svg",),
}
FROM_DEMO = ("mesh.png", "fit.svg", "cell.svg")


def main(demo, only):
    """Make the figures that are named."""
    for name in only:
        MAKERS[name](demo)


def from_demo(demo):
    """Copy the pictures of the demo."""
    for name in FROM_DEMO:
        keep(demo / "pictures" / name, name)


def impact(_):
    """Make the picture at the head of README."""
    hero.main(hero.HERO)


def report(_):
    """Take a picture of the head of the report of a shot in a browser, and make the movie of the
    shot."""
    with TemporaryDirectory() as folder:
        wc.impact(COUPONS.parent / "S-720-perforates.toml", out=folder)
        movie = Path(folder) / "perforation.gif"
        wc.view(folder, movie=movie)
        # a movie never replaces a file
        write(FIGURES / movie.name, movie.read_bytes())
        words = ("--headless", "--no-sandbox", "--enable-unsafe-swiftshader", "--hide-scrollbars")
        shot = (
            "--window-size=1280,1130",
            "--virtual-time-budget=9000",
            f"--screenshot={folder}/report.png",
        )
        subprocess.run(
            ["chromium", *words, *shot, f"file://{folder}/report.html"],
            check=True,
            capture_output=True,
        )
        keep(Path(folder) / "report.png", "report.png")


def coupons(_):
    """Run examples of coupons, and keep some of their pictures."""
    with TemporaryDirectory() as folder:
        for name, pictures in FROM_COUPONS.items():
            wc.coupon(COUPONS / f"{name}.toml", out=Path(folder) / name)
            for picture in pictures:
                keep(Path(folder) / name / "pictures" / picture, f"coupon-{name}-{picture}")
        wc.biaxial("S-731", out=Path(folder) / "biaxial")
        keep(Path(folder) / "biaxial" / "pictures" / "cell.svg", "biaxial-S-731.svg")
        keep(Path(folder) / "biaxial" / "pictures" / "energy.png", "energy-S-731.png")
        tests = COUPONS.parent / "records" / "glass-biaxial.csv"
        wc.calibrate("glass-balanced", biaxial=tests, fitted=["k = 1"], out=Path(folder) / "fit")
        keep(Path(folder) / "fit" / "pictures" / "tests.svg", "biaxial-fit.svg")


def bullets(_):
    """Draw the bullets that have a name."""
    drawn = {}
    for name, row in wc.projectiles().iterrows():
        core, _, jacket = row["metal"].partition(" in ")
        with warnings.catch_warnings(action="ignore"):  # notes of what is assumed of the metals
            shot = wc.setup("S-720", "100 m/s", projectile={"name": name}).projectile
        if shot.turned is not None:
            drawn[name] = shot.turned, core, jacket
    with pictures_figure.plots() as pyplot, TemporaryDirectory() as folder:
        path = Path(folder) / "bullets.png"
        pictures_body.drawings(pyplot, drawn).savefig(path)
        keep(path, path.name)


def keep(source, name, folder=FIGURES):
    """Copy a picture to the figures."""
    write(folder / name, source.read_bytes())
    if name.endswith(".png"):
        shrink(folder / name)


def shrink(path, width=1000, most=4e5):
    """Make a picture small enough to be kept with the code: no wider than a page, 256 colours above `most` bytes."""
    with Image.open(path) as image, replace_whole(path) as beside:
        small = image.convert("RGB")
        small.thumbnail((width, 4 * width))
        small.save(beside, format="PNG", optimize=True)
        if beside.stat().st_size > most:
            small.quantize(256).save(beside, format="PNG", optimize=True)


def reports(_):
    """Draw the charts of cost against error, the costs of models, and the maps of stability."""
    report_charts.write(FIGURES)


MAKERS = {
    "demo": from_demo,
    "bullets": bullets,
    "coupons": coupons,
    "impact": impact,
    "report": report,
    "reports": reports,
}

if __name__ == "__main__":
    parser = argparse.ArgumentParser(
        prog="python tools/figures.py", description=__doc__.splitlines()[0]
    )
    parser.add_argument("demo", nargs="?", type=Path, default=Path("results/demo"))
    parser.add_argument("--only", nargs="+", choices=MAKERS, default=list(MAKERS))
    chosen = parser.parse_args()
    main(chosen.demo, chosen.only)
