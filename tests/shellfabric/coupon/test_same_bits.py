"""A coupon is the same to the last bit for every BLAS kernel: slack yarns turn one bit into another shape."""

import os
import subprocess
import sys

STRIP = """
import hashlib

from fabrics import catalogue
from shellfabric.cell.model import CellModel
from shellfabric.coupon import quasistatic

table = CellModel(catalogue.load("S-720"), cell_formulation="variational").table(61)
strip = quasistatic.uniaxial(table, length=0.016, width=0.007, strain=0.06, steps=12)
digest = hashlib.sha256()
for state in strip.states:
    digest.update(state.x.tobytes() + state.reaction.tobytes() + state.history.tobytes())
print(int(strip.unloaded.sum()), len(strip.states), digest.hexdigest())
"""


def run(**settings):
    """What a process with these settings prints: unloaded states, all states, digest of their bits."""
    plain = {name: value for name, value in os.environ.items() if name != "OPENBLAS_CORETYPE"}
    done = subprocess.run(
        [sys.executable, "-c", STRIP],
        env=plain | settings,
        capture_output=True,
        text=True,
        check=True,
    )
    return done.stdout.split()


def test_a_coupon_is_the_same_to_the_bit_on_another_processor():
    native = run()
    unloaded, states, _ = native
    assert 0 < int(unloaded) < int(states)
    assert run(OPENBLAS_CORETYPE="Nehalem", NPY_DISABLE_CPU_FEATURES="AVX2 FMA3") == native
