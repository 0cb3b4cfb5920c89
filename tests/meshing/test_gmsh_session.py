"""gmsh as a guest: silent, closed again, from any thread, and with no hand on the program's interrupts."""

import signal
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

import pytest

from meshing.session import gmsh_session


def test_interrupts_stay_with_the_program():
    """In a fresh process, whatever handler is set before the import is there after a session."""
    code = (
        "import signal\n"
        "mine = lambda *a: None\n"
        "signal.signal(signal.SIGINT, mine)\n"
        "from meshing.session import gmsh_session\n"
        "assert signal.getsignal(signal.SIGINT) is mine, 'import'\n"
        "with gmsh_session('mine'):\n"
        "    pass\n"
        "assert signal.getsignal(signal.SIGINT) is mine, 'session'\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=3000
    )
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
    def named(name):
        with gmsh_session(name) as gmsh:
            gmsh.model.addDiscreteEntity(0, 1)
            return gmsh.model.getCurrent(), gmsh.model.getEntities()

    names = [f"model {n}" for n in range(8)]
    with ThreadPoolExecutor(8) as threads:
        found = list(threads.map(named, names))
    assert found == [(name, [(0, 1)]) for name in names]
    assert capfd.readouterr() == ("", "")
