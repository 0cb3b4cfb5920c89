"""gmsh as a guest: silent, closed again, from any thread, and with no hand on the program's interrupts."""

import signal
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from meshing.box import transfinite_box
from meshing.session import gmsh_session


def test_the_box_is_a_full_grid_in_vtk_order():
    corners = transfinite_box(4, 3, 2)
    assert corners.shape == (24, 8, 3)
    assert not corners.flags.writeable
    assert len(np.unique(corners[:, 0], axis=0)) == 24
    edges = corners[:, [1, 3, 4]] - corners[:, :1]
    assert np.array_equal(edges, np.broadcast_to(np.eye(3), edges.shape))
    assert np.array_equal(corners[:, 6] - corners[:, 0], np.ones((24, 3)))


def test_interrupts_stay_with_the_program():
    """In a fresh process, whatever handler is set before the import is there after a session."""
    code = (
        "import signal\n"
        "mine = lambda *a: None\n"
        "signal.signal(signal.SIGINT, mine)\n"
        "from meshing.box import transfinite_box\n"
        "assert signal.getsignal(signal.SIGINT) is mine, 'import'\n"
        "transfinite_box(2, 2, 1)\n"
        "assert signal.getsignal(signal.SIGINT) is mine, 'session'\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr
    assert done.stdout == done.stderr == ""


def test_a_session_is_closed_when_its_work_fails():
    before = signal.getsignal(signal.SIGINT)
    with pytest.raises(ZeroDivisionError), gmsh_session("broken"):
        raise ZeroDivisionError
    assert signal.getsignal(signal.SIGINT) is before
    with gmsh_session("next") as gmsh:
        assert gmsh.model.getCurrent() == "next"
        assert gmsh.model.getEntities() == []


def test_threads_take_turns(capfd):
    transfinite_box.cache_clear()
    sizes = [(n, 2, 1) for n in range(2, 10)]
    with ThreadPoolExecutor(8) as threads:
        found = list(threads.map(lambda size: len(transfinite_box(*size)), sizes))
    assert found == [2 * n for n, _, _ in sizes]
    assert capfd.readouterr() == ("", "")
