"""What is refused of a mesh: each in one clear line. What the command line says of it: tests/refusals/options.toml."""

from dataclasses import replace

import pytest

from fabrics import catalogue
from fabrics.base.errors import InputError
from meshing import crossover, patch
from meshing.conforming import conform
from meshing.section import Section
from meshing.section_fit import fit_sections

S720 = catalogue.load("S-720")
NEGATIVE = S720.micrograph | {"weft": S720.micrograph["weft"] | {"crimp": -0.01}}
FLAT = S720.with_yarns(crimp=0.0).weave
HALF_FLAT = S720.with_yarns(crimp=(0.0, S720.weave.weft.crimp)).weave
THIN = S720.with_yarns(crimp=1e-3).weave
SPACINGS = [1.27e-3, 1.27e-3]
HALF = "from 0 to below half a spacing, 0.000635 m"
WIDE = "above 0 and at most the spacing, 0.00127 m"
SIZES = (
    "coarse, medium, fine, auto, an edge length up to 0.000635 m, or three whole numbers, at least 2 along, 2 across "
    "and 1 through"
)
COUNTS = "must be two whole numbers from 1, of warp and of weft yarns"


@pytest.mark.parametrize("build", [crossover.build, patch.build])
@pytest.mark.parametrize(
    ("choices", "message"),
    [
        ({"overlap": "ignore"}, "overlap = 'ignore': must be solve or refuse"),
        ({"size": (8, 1, 2)}, f"size = (8, 1, 2): must be {SIZES}"),
        ({"size": (8, 6.5, 2)}, f"size = (8, 6.5, 2): must be {SIZES}"),
        ({"size": (float("inf"), 6, 2)}, f"size = (inf, 6, 2): must be {SIZES}"),
        ({"section": "round"}, "section = 'round': must be sine or ellipse"),
        ({"gap": float("nan")}, f"gap = nan: must be {HALF}"),
        ({"gap": "wide"}, f"gap = 'wide': must be {HALF}"),
        ({"width": (1.2e-3, 1.4e-3)}, f"weft width = 0.0014: must be {WIDE}"),
        ({"width": (0.0, 1.2e-3)}, f"warp width = 0.0: must be {WIDE}"),
        ({"width": 1.2e-3}, "width = 0.0012: must be two lengths, of warp and weft"),
        (
            {"width": (1.2e-3, 1.2e-3), "gap": 1e-5},
            "gap = 1e-05: must be 0 where the widths are given",
        ),
        ({"tip_thickness_ratio": 0.7}, "tip_thickness_ratio = 0.7: must be from 0.01 to 0.5"),
        ({"crimp": "guessed"}, "crimp = 'guessed': must be hand or micrograph"),
        (
            {"micrograph": {}, "crimp": "micrograph"},
            "fabric S-720 has no micrographs of warp and weft: its crimp ...",
        ),
        (
            {"micrograph": NEGATIVE, "crimp": "micrograph"},
            "crimp = -0.01: must be a fraction from 0 to below 1 ...",
        ),
        (
            {"solid_laws": None},
            "fabric S-720 has no solid laws: a 3D crossover needs Vf0 of warp and weft",
        ),
        (
            {"section": "ellipse", "overlap": "refuse"},
            "the ellipse sections of warp and weft overlap by 40.5 um ...",
        ),
    ],
)
def test_bad_choices(build, choices, message):
    of_fabric = {key: choices[key] for key in choices.keys() & {"micrograph", "solid_laws"}}
    with pytest.raises(InputError) as caught:
        build(
            replace(S720, **of_fabric),
            **{key: choices[key] for key in choices.keys() - of_fabric.keys()},
        )
    refused(caught, message)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: crossover.build(S720, domain="half"), "domain = 'half': must be quarter or whole"),
        (lambda: patch.build(S720, (2, 1.5)), f"count = (2, 1.5): {COUNTS}"),
        (lambda: patch.build(S720, 3), f"count = 3: {COUNTS}"),
        (lambda: patch.build(S720, (2, float("nan"))), f"count = (2, nan): {COUNTS}"),
        (lambda: Section("sine", 0.0, 2e-4, 0.1), "width = 0.0: must be a positive number"),
        (
            lambda: Section("sine", 1e-3, -1e-4, 0.1),
            "thickness = -0.0001: must be a positive number",
        ),
        (
            lambda: Section("sine", 1e-3, 2e-4, 0.0),
            "tip_thickness_ratio = 0.0: must be a positive number",
        ),
        (
            lambda: fit_sections("sine", SPACINGS, [0.7, 0.62], FLAT, 0.1),
            "the sine sections of warp and weft ...",
        ),
        (
            lambda: conform([1e-3, 1e-3], [1e-7, 1e-7], HALF_FLAT, 0.075),
            "conforming sections need crimp in warp ...",
        ),
        (
            lambda: conform(SPACINGS, [1e-7, 1e-12], S720.weave, 0.075),
            "no conforming sections have the fibre ...",
        ),
        (
            lambda: fit_sections("conforming", SPACINGS, [0.7, 0.62], THIN, 0.075),
            "conforming sections leave ...",
        ),
    ],
)
def test_bad_values(make, message):
    with pytest.raises(InputError) as caught:
        make()
    refused(caught, message)


def refused(caught, message):
    text = str(caught.value)
    assert text.startswith(message[:-4]) if message.endswith(" ...") else text == message
    assert "\n" not in text
