"""Pull-out of one yarn out of weaves of the same yarns and crimps."""

import pytest

from fabrics import catalogue
from fabrics.base.errors import InputError
from shellfabric.cell.model import CellModel
from shellfabric.coupon.pull_out import PullOut, follow

YARN = """
[{family}]
linear_density = "1500 denier"
fibre_density = "1.44 g/cm^3"
modulus = "70.5 GPa"
failure_strain = "3.6 %"
count = "{count} / inch"
crimp = "{crimp} %"
"""
LAW = """
[compression]
a = "0.08 mm"
b = "0.08 mm N^(1/3)"
"""


def test_a_yarn_is_drawn_hardest_out_of_plain_then_twill_then_satin(tmp_path):
    """The order that was measured on para-aramid (Majumdar and Laha 2016), by fewer changes of sides."""
    path = tmp_path / "own.toml"
    yarns = YARN.format(family="warp", count=35, crimp=2.2)
    yarns += YARN.format(family="weft", count=34, crimp=1.8)
    loads = []
    for weave in ("plain", "twill 2/2", "satin 5", "satin 8"):
        path.write_text(f'weave = "{weave}"\n{yarns}{LAW}')
        table = CellModel(catalogue.load(path), mean_crossing=True).table(41)
        coupon = PullOut(table, 20, pre_tension=5.0, mu=0.3, cohesion=0.05)
        loads.append(follow(coupon, 0.015, samples=40).peak)
    without = 20 * 0.05  # what the cohesion gives alone
    assert loads[0] > loads[1] > loads[2] > loads[3] > 1.02 * without


def table_of(path, weave, crimps):
    """The cell's table of a weave with the crimps [%] of warp and weft."""
    warp, weft = crimps
    yarns = YARN.format(family="warp", count=35, crimp=warp)
    yarns += YARN.format(family="weft", count=35, crimp=weft)
    path.write_text(f'weave = "{weave}"\n{yarns}{LAW}')
    return CellModel(catalogue.load(path), mean_crossing=True).table(21)


@pytest.mark.parametrize("weave, crimps", [("satin 5", (5, 5)), ("satin 8", (20, 10))])
def test_rounding_where_the_yarns_come_apart_is_no_tension(weave, crimps, tmp_path):
    """1e-12 N at the lowest stretch of the table were taken for a yarn that is nowhere slack."""
    table = table_of(tmp_path / "own.toml", weave, crimps)
    assert 0 < table.values["T1"][0].max() < 1e-10
    coupon = PullOut(table, 20, pre_tension=5.0, mu=0.3, cohesion=0.05)
    assert coupon.tensions[0] == 0
    assert follow(coupon, 0.015, samples=40).peak > 20 * 0.05


def test_a_crimp_by_which_the_yarn_is_nowhere_slack_is_refused_by_its_name(tmp_path):
    table = table_of(tmp_path / "own.toml", "satin 8", (31, 29))
    with pytest.raises(InputError, match="lie side by side") as refused:
        PullOut(table, 20, pre_tension=5.0, mu=0.3)
    assert refused.value.key == "warp.crimp"
    assert refused.value.value == pytest.approx(0.31)
