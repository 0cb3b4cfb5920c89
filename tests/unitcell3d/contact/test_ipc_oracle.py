"""The contact against an independent one: barriers of incremental potential contact on the same solid and bars."""

import pytest

pytest.importorskip("ipctk")

from ipc import BarrierModel, NoEquilibriumError

from meshing import crossover as mesher
from unitcell3d.cases import biaxial_and_platens

END = 0.03e-3  # warp only, near failure


@pytest.mark.nightly
@pytest.mark.slow(90)
def test_barrier_and_penalty_give_one_answer(s720):
    """Warp alone to 0.03 mm: tensions and contact force within 1 %.

    The default penalty, against a barrier of 0.5 um, its yarns moved apart by the distance that it keeps: found 0.11 %
    in T1, 0.86 % in T2 and 0.92 % in F_c, of which the penalty's penetration, up to 0.3 um, makes 0.04, 0.23 and 0.27 %
    (a tenth of the toe leaves 0.07, 0.63 and 0.65 %); the barrier's facets, flat, are off by order two in the mesh.
    """
    mesh = mesher.build(s720, size=(10, 8, 2))
    penalty = biaxial_and_platens.biaxial(mesh, s720, (1, 0), max_displacement=END)
    barrier = BarrierModel(mesh, s720, reach=0.5e-6, apart=0.42e-6, stiffness=1e7)
    try:
        found = barrier.path((END, 0.0), 40)
    except NoEquilibriumError:
        pytest.xfail(
            "the barrier's own iteration finds no equilibrium on this machine: nothing to compare with"
        )
    assert barrier.distance == pytest.approx(0.42e-6, rel=0.1)
    assert found == pytest.approx([penalty[name][-1] for name in ("T1", "T2", "F_c")], rel=0.01)
