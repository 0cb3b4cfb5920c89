"""The modelled part of a panel where no symmetry is asked for."""

import pytest

import weavecell as wc
from fabrics.base.errors import InputError
from shellfabric.loop.pack_solver import PackSolver

OFF = "5 mm"


FSP = {"name": "FSP 1.10 g"}
TILTED = FSP | {"obliquity": "20 deg"}
ALONG_WEFT = {"azimuth": "90 deg"}
SLIPS = {"clamp_force": "30 N"}
HELD = {"clamp_force": "45 N"}


@pytest.mark.parametrize(
    ("part", "keys"),
    [
        ("quarter", {}),
        ("quarter", {"projectile": FSP}),
        ("half", {"projectile": TILTED | ALONG_WEFT}),
        ("other half", {"projectile": TILTED}),
        ("other half", {"projectile": FSP | {"yaw": "3 deg"}}),
        ("whole", {"projectile": TILTED | {"azimuth": "30 deg"}}),
        ("whole", {"projectile": FSP | {"roll": "30 deg"}}),
        ("other half", {"impact_point": [OFF, "0 mm"]}),
        ("half", {"impact_point": ["0 mm", OFF]}),
        ("whole", {"impact_point": [OFF, OFF]}),
        ("whole", {"impact_point": [OFF, "0 mm"], "projectile": TILTED | ALONG_WEFT}),
        ("whole", {"weave_angle": "20 deg"}),
        ("whole", {"crossovers": "yarns"}),
        ("other half", {"boundary": {"warp": ["free", "clamped"], "weft": "free"}}),
        ("half", {"boundary": {"warp": SLIPS, "weft": [SLIPS, HELD]}}),
        ("whole", {"boundary": {"warp": [SLIPS, HELD], "weft": ["clamped", "free"]}}),
        ("quarter", {"boundary": {"warp": [SLIPS, SLIPS], "weft": "clamped"}}),
        ("quarter", {"backing": "gelatine 10 %", "boundary": {"warp": SLIPS, "weft": "free"}}),
        ("whole", {"backing": "gelatine 10 %", "impact_point": ["0 mm", OFF]}),
        (
            "whole",
            {"backing": "gelatine 10 %", "boundary": {"warp": [HELD, SLIPS], "weft": "free"}},
        ),
    ],
)
@pytest.mark.filterwarnings("ignore::UserWarning")
def test_the_smallest_part_that_stands_for_the_whole_is_computed(part, keys):
    setup = wc.setup("S-728", "90 m/s", opening="60 mm", **keys)
    assert setup.symmetry == part
    # it refuses a part that the shot, its edges or its block do not have
    PackSolver(setup.target(setup.table()), setup.strike_velocity, setup.end_time)


@pytest.mark.filterwarnings("ignore::UserWarning")
def test_a_part_that_is_asked_for_is_not_overruled():
    assert wc.setup("S-728", "90 m/s", symmetry="whole").symmetry == "whole"
    yawed = FSP | {"yaw": "3 deg"}
    with pytest.raises(InputError, match="symmetry"):
        setup = wc.setup("S-728", "90 m/s", symmetry="quarter", projectile=yawed)
        setup.panel(setup.table())
