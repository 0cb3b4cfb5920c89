"""Bad requests for a crossover: each refused in one clear line."""

from dataclasses import replace

import pytest

from fabrics import catalogue
from fabrics.errors import InputError
from meshing.crossover import build

HALF = "from 0 to below half a spacing, 0.000635 m"
WIDE = "above 0 and at most the spacing, 0.00127 m"
SIZES = (
    "coarse, medium, fine, auto, an edge length up to 0.000635 m, or three whole numbers, at least 2 along, 2 across "
    "and 1 through"
)


@pytest.mark.parametrize(
    ("choices", "message"),
    [
        ({"domain": "half"}, "domain = 'half': must be quarter or whole"),
        ({"overlap": "ignore"}, "overlap = 'ignore': must be solve or refuse"),
        ({"size": "huge"}, "size = 'huge': must be coarse or medium or fine or auto"),
        ({"size": (8, 6)}, f"size = (8, 6): must be {SIZES}"),
        ({"size": (8, 1, 2)}, f"size = (8, 1, 2): must be {SIZES}"),
        ({"size": (8, 6.5, 2)}, f"size = (8, 6.5, 2): must be {SIZES}"),
        ({"size": 8}, f"size = 8: must be {SIZES}"),
        ({"size": (float("inf"), 6, 2)}, f"size = (inf, 6, 2): must be {SIZES}"),
        ({"section": "round"}, "section = 'round': must be sine or ellipse"),
        ({"gap": -1e-5}, f"gap = -1e-05: must be {HALF}"),
        ({"gap": 7e-4}, f"gap = 0.0007: must be {HALF}"),
        ({"gap": float("nan")}, f"gap = nan: must be {HALF}"),
        ({"gap": "wide"}, f"gap = 'wide': must be {HALF}"),
        ({"width": (1.2e-3, 1.4e-3)}, f"weft width = 0.0014: must be {WIDE}"),
        ({"width": (0.0, 1.2e-3)}, f"warp width = 0.0: must be {WIDE}"),
        ({"width": 1.2e-3}, "width = 0.0012: must be two lengths, of warp and weft"),
        ({"width": (1.2e-3, 1.2e-3), "gap": 1e-5}, "gap = 1e-05: must be 0 where the widths are given"),
        ({"tip_thickness_ratio": 0.7}, "tip_thickness_ratio = 0.7: must be from 0.01 to 0.5"),
        ({"tip_thickness_ratio": 0.001}, "tip_thickness_ratio = 0.001: must be from 0.01 to 0.5"),
    ],
)
def test_bad_choices(choices, message):
    with pytest.raises(InputError) as caught:
        build(catalogue.load("S-720"), **choices)
    assert str(caught.value) == message


def test_a_fabric_without_solid_laws_has_no_yarn_area():
    with pytest.raises(InputError) as caught:
        build(replace(catalogue.load("S-720"), solid_laws=None))
    assert str(caught.value) == ("fabric S-720 has no solid laws: a 3D crossover needs Vf0 of warp and weft")


def test_negative_crimp_never_reaches_the_mesh():
    warp = catalogue.load("S-720").weave.warp
    with pytest.raises(InputError) as caught:
        replace(warp, crimp=-0.01)
    assert str(caught.value).startswith("crimp = -0.01: must be")
