"""A message proposes only what the set-up takes: all messages, on set-ups that refuse one or the other."""

from dataclasses import replace
from math import pi
from string import Formatter

import pytest

from fabrics import catalogue
from fabrics.base.errors import InputError
from shellfabric.impact import proposals
from shellfabric.impact.setup import ImpactSetup
from shellfabric.membrane.quality import CHECKS, indicator
from shellfabric.projectile.projectile import Projectile
from shellfabric.yarns.model import YarnZone

BASE = ImpactSetup(
    catalogue.load("S-720"), 150.0, opening=0.0508, elements_per_crossover=1, symmetry="quarter"
)
BULLET = Projectile(
    mass=11340 * pi * 2.75e-3**2 * 8e-3,
    radius=2.75e-3,
    length=8e-3,
    edge_radius=0.2e-3,
    body="metal",
)
SETUPS = {
    "plain": BASE,
    "bullet": replace(BASE, projectile=BULLET),
    "oblique": replace(BASE, projectile=Projectile(obliquity=0.3), symmetry="half"),
    "yarns": replace(
        BASE, crossovers=YarnZone(), symmetry="whole", elements_per_crossover=None, opening=0.1
    ),
    "tiny panel": replace(BASE, opening=0.012),
    "free": replace(BASE, boundary="free"),
    "equilibrium": replace(BASE, cell_formulation="equilibrium"),
    "bent": replace(BASE, bending=1e-9),
    "pack": replace(BASE, plies=2),
}
MESSAGES = {
    text: [name for _, name, _, _ in Formatter().parse(text) if name]
    for text in (
        *(check.advice for check in CHECKS.values()),
        "use {body of metal}",
        "{resolved yarns}",
    )
}
REFUSED = {
    ("bullet", "resolved yarns"),
    ("yarns", "body of metal"),
    ("oblique", "body of metal"),
    ("tiny panel", "resolved yarns"),
}


def test_every_proposal_of_a_message_is_known_and_used():
    named = {name for names in MESSAGES.values() for name in names}
    assert named == set(proposals.PROPOSALS)
    for name, proposal in proposals.PROPOSALS.items():
        # as a user would write it: no message has the words beside the mechanism
        assert not any(proposal.words in text for text in MESSAGES), name


@pytest.mark.parametrize("kind", SETUPS)
def test_what_is_proposed_is_taken(kind):
    setup = SETUPS[kind]
    for text, names in MESSAGES.items():
        said = proposals.fill(text, setup)
        for name in names:
            proposal = proposals.PROPOSALS[name]
            if said:
                assert proposal.words in said
                changed = proposal.change(setup)
                changed.target(changed.plain_table())  # is not refused
                assert changed != setup
            if (kind, name) in REFUSED:
                assert said == ""


@pytest.mark.parametrize("kind, name", sorted(REFUSED))
def test_what_is_left_out_would_be_refused(kind, name):
    with pytest.raises(InputError):
        changed = proposals.PROPOSALS[name].change(SETUPS[kind])
        changed.target(changed.plain_table())


def test_a_doubtful_check_says_what_to_do_where_it_can_be_done():
    over = [indicator("face across symmetry", 0.9), indicator("deepest node of the dent", 1.9)]
    plain, deepest = proposals.with_remedies(over, SETUPS["plain"])
    assert str(plain).endswith('compare with symmetry = "whole")')
    assert str(deepest).endswith("smaller backing.min_size)")
    (of_whole,) = proposals.with_remedies(over[:1], SETUPS["yarns"])
    assert "symmetry =" not in str(of_whole)
    well = indicator("face across symmetry", 0.01)
    assert proposals.with_remedies([well], SETUPS["plain"]) == (well,)
