"""The pencilling study: its cases are those of Table 6-2, a small one runs, a table and pictures come of it."""

from dataclasses import replace

import pytest

from shellfabric.backing.block import Backing
from shellfabric.panel.model import Numerics
from validation.published.pencilling.__main__ import name_of
from validation.published.pencilling.study import CASES, march


def test_cases_are_those_of_the_table():
    assert [(c.plies, 96 * c.modulus, 1e3 * c.mass) for c in CASES.values()] == [
        (1, 480, 1155), (1, 96, 1155), (1, 480, 231), (1, 96, 231), (4, 96, 1155)
    ]  # fmt: skip
    assert CASES[1].mass == pytest.approx(5 * 0.231)  # [kg/m2] of one ply, as Table 6-2 has it
    assert name_of(5) == "5: 4 plies, 96 GPa, 1155 g/m²"


def test_a_target_has_the_mass_and_modulus_of_its_case():
    small = Backing(size=(0.06, 0.06, 0.03), min_size=3e-3, refined_depth=6e-3, growth=1.5)
    for case in (CASES[1], CASES[5]):
        run = march(case, block=small, elements=1, opening=0.05)
        weaves = [ply.weave for ply in run.pack.plies]
        assert len(weaves) == case.plies
        assert sum(weave.areal_density for weave in weaves) == pytest.approx(case.mass, rel=1e-9)
        # E A of a yarn is that of S-728 times the factor, whatever the mass
        assert weaves[0].warp.EA == pytest.approx(case.modulus * 96e9 * 1.7039e-4 / 1440, rel=1e-3)
        assert not run.pack.plies[0].failure
        # stiff yarns that snap taut take half the usual step; that of the contact may be shorter
        ply = run.pack.plies[0]
        assert ply.time_step == pytest.approx(0.5 * replace(ply, numerics=Numerics()).time_step, rel=1e-12)
        assert run.const.dt == run.pack.time_step <= ply.time_step
