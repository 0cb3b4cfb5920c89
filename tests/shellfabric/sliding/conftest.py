"""A sliding panel that the tests of this folder share."""

import pytest

from shellfabric.panel.numerics import Numerics
from shellfabric.sliding.model import CrossoverFriction, SlidingPanel


@pytest.fixture(scope="session")
def sliding(tables):
    """Make a panel of 24 x 24 crossovers as a whole with sliding crossovers."""

    def make(mu=0.2, cohesion=0.0, table=None, side=0.03048, **changes):
        chosen = {
            "friction": CrossoverFriction(mu, cohesion),
            "numerics": Numerics(threads=1),
        } | changes
        return SlidingPanel(table or tables["variational"], (side, side), **chosen)

    return make
