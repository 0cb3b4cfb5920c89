"""The study of slipping edges: what it reads off a shot, and its page."""

from fabrics import catalogue
from shellfabric.impact.simulation import ImpactSetup, run
from shellfabric.panel.boundary import Grip
from validation.published.edge_slip import SLIPPED, of


def test_slip_follows_from_a_grip():
    """The weaker the clamp, the further yarns slip and the wider the zone; the energy goes into the grips."""
    fabric, found = catalogue.load("S-728").with_effective_density(), []
    for force in (15.0, 60.0):
        setup = ImpactSetup(fabric, 60.0, edge=Grip(force), opening=0.06, table_size=61, end_time=120e-6)
        found.append(of(f"{force:g} N", run(setup)))
    weak, strong = found
    assert weak.pulled("weft") > strong.pulled("weft") > SLIPPED
    assert weak.width("weft") >= strong.width("weft")
    assert weak.balance < 5e-3
    assert min(weak.gripped, strong.gripped) > 0
