"""The contact against an independent one: barriers of incremental potential contact on the same solid and bars."""

import pytest

pytest.importorskip("ipctk")

from ipc import BarrierModel

from meshing import crossover as mesher
from unitcell3d import cases
from unitcell3d.model import Numerics

END = 0.03e-3  # warp only, near failure


@pytest.mark.slow
def test_barrier_and_penalty_give_one_answer(s720):
    """Warp alone to 0.03 mm: tensions and contact force within 1 %.

    Both limits are taken close: a hard penalty (1e15 Pa/m, 0.1 um of penetration; the default of 1e14 leaves 1.3 um and
    lies 1.3 % lower in F_c), and a barrier of 0.5 um, its yarns moved apart by the distance that it keeps. Its facets
    are flat, off the smooth faces by order two in the mesh: F_c is 1.05 % off on the coarse mesh, here 0.6 %.
    """
    mesh = mesher.build(s720, size=(10, 8, 2))
    penalty = cases.biaxial(mesh, s720, (1, 0), reach=END, numerics=Numerics(penalty=1e15, toe=5e-8))
    barrier = BarrierModel(mesh, s720, reach=0.5e-6, apart=0.42e-6, stiffness=1e7)
    found = barrier.path((END, 0.0), 40)
    assert barrier.distance == pytest.approx(0.42e-6, rel=0.1)
    assert found == pytest.approx((penalty.T1[-1], penalty.T2[-1], penalty.F_c[-1]), rel=0.01)
