"""The modelled part of a panel where no symmetry is asked for."""

import pytest

import weavecell as wc
from fabrics.base.errors import InputError

OFF = "5 mm"


@pytest.mark.parametrize(
    ("part", "keys"),
    [
        ("quarter", {}),
        ("quarter", {"projectile": "FSP 1.10 g"}),
        ("half", {"projectile": "FSP 1.10 g", "obliquity": "20 deg", "azimuth": "90 deg"}),
        ("other half", {"obliquity": "20 deg"}),
        ("other half", {"yaw": "3 deg", "projectile": "FSP 1.10 g"}),
        ("whole", {"obliquity": "20 deg", "azimuth": "30 deg"}),
        ("whole", {"projectile": "FSP 1.10 g", "roll": "30 deg"}),
        ("other half", {"impact_point": [OFF, "0 mm"]}),
        ("half", {"impact_point": ["0 mm", OFF]}),
        ("whole", {"impact_point": [OFF, OFF]}),
        ("whole", {"impact_point": [OFF, "0 mm"], "obliquity": "20 deg", "azimuth": "90 deg"}),
        ("whole", {"weave_angle": "20 deg"}),
        ("whole", {"crossovers": "yarns"}),
    ],
)
@pytest.mark.filterwarnings("ignore::UserWarning")
def test_the_smallest_part_that_stands_for_the_whole_is_computed(part, keys):
    setup = wc.setup("S-728", "90 m/s", opening="60 mm", **keys)
    assert setup.symmetry == part
    setup.panel(setup.table())  # which refuses a part that the shot does not have


@pytest.mark.filterwarnings("ignore::UserWarning")
def test_a_part_that_is_asked_for_is_not_overruled():
    assert wc.setup("S-728", "90 m/s", symmetry="whole").symmetry == "whole"
    setup = wc.setup("S-728", "90 m/s", symmetry="quarter", yaw="3 deg", projectile="FSP 1.10 g")
    with pytest.raises(InputError, match="symmetry = 'quarter'"):
        setup.panel(setup.table())
