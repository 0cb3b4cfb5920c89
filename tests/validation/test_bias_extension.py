"""The bias extension test: its cloths, its command and picture on a small coupon; at full size the claims."""

import sys

import pytest

from validation.bias_extension import __main__ as command
from validation.bias_extension import cases

SMALL = {"length": 0.0570, "width": 0.0296, "elongation": 0.004, "steps": 2, "table_size": 61}


def test_the_cloth_is_balanced():
    fabric, _, trellis = cases.cloth("locking")
    warp, weft = fabric.weave.yarns
    assert warp == weft
    assert warp.crimp == pytest.approx(0.0135)
    assert trellis
    assert not cases.cloth("none")[2]
    soft, straight = (cases.cloth(name)[0] for name in ("soft", "straight"))
    assert soft.shear.G2 == soft.shear.G1 == fabric.shear.G1
    assert straight.shear.G1 * straight.weave.thickness == pytest.approx(fabric.shear.G1 * fabric.weave.thickness)


def test_the_command_writes_table_and_picture(tmp_path, monkeypatch, capsys):
    full = cases.run
    monkeypatch.setattr(command, "run", lambda name, steps: full(name, **SMALL))
    monkeypatch.setattr(sys, "argv", ["bias_extension", "--out", str(tmp_path)])
    command.main()
    lines = (tmp_path / "zones.csv").read_text().splitlines()
    assert lines[0].split(",")[:2] == ["cloth", "elongation mm"]
    assert {line.split(",")[0] for line in lines[1:]} == set(cases.CLOTHS)
    assert (tmp_path / "coupons.png").stat().st_size > 30_000
    assert "the shear has run into bands" in capsys.readouterr().out


@pytest.mark.slow
def test_claims_at_full_size():
    """bias-zones, bias-zone-average, bias-angle-value where yarns do not stretch; bias-symmetry; Figure 4-27."""
    straight = cases.run("straight", steps=10)
    A, B, C = straight.means()
    assert A - B > 3
    assert B - C > 3
    assert abs(B - 0.5 * (A + C)) < 1.5
    assert pytest.approx(72.0, abs=2) == C
    assert pytest.approx(81.0, abs=2) == B
    locking = cases.run("locking", steps=20)
    assert locking.concentration() < 1.5
    assert cases.asymmetry(locking.result) < 1e-6
    A, B, C = locking.means(9)  # 5 mm in all
    assert abs(B - 0.5 * (A + C)) < 1.5
    # crimped, locking cloth stretches along its yarns, so that it shears less than the closed form
    assert C > locking.inextensible(9)
    unlocked = cases.run("none")
    assert unlocked.concentration() > 3
    assert unlocked.problem
