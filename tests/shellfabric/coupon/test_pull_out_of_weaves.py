"""Pull-out of one yarn out of weaves of the same yarns and crimps."""

from fabrics import catalogue
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
