"""A guard on the memory of a test process and a report of what quick tests cost; the command line, tools and folders
of a session as fixtures.

What makes a process grow are results held by fixtures, caches without a bound, and code compiled in it.
"""

import fcntl
import importlib
import os
import shlex
import shutil
import sys
from pathlib import Path

import pytest

os.environ["WEAVECELL_CACHE_DIR"] = ""  # no table is kept in the folders of who runs the tests
# `importorskip("dolfinx")` is not the way in which it is loaded beside VTK: see unitcell3d/assembly/__init__.py
sys.setdlopenflags = lambda flags: None
# what a test writes need not outlive the machine's power
os.fsync = lambda descriptor: None

LIMIT = 2600  # [MiB] resident, of one process at its peak, which compiles its kernels
STATUS = Path("/proc/self/status")
_growth = {}
CAP = 1.3  # [CPU s] of a quick test with what it sets up; machines differ by 2.5, so a dearer one is told, not failed
COST = "CPU s"  # name of the property of a report that has it
_costs = {}


def peak():
    """[MiB] largest resident memory of this process so far; 0 where the system does not say.

    Not getrusage's, which a process takes over from the one that started it.
    """
    if not STATUS.exists():
        return 0.0
    found = [line.split() for line in STATUS.read_text().splitlines() if line.startswith("VmHWM:")]
    return float(found[0][1]) / 1024 if found else 0.0


def spent():
    """[s] CPU time of this process and of those it started, as far as they have ended."""
    return sum(os.times()[:4])


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup(item):
    """Note when a test begins, in CPU time."""
    item.began = spent()


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_teardown(item):
    """Note by how much a test, with what it set up, has raised the peak, and what it has cost."""
    _growth[item.nodeid] = peak() - sum(_growth.values())
    item.user_properties.append((COST, spent() - item.began))


def pytest_runtest_logreport(report):
    """Gather what the quick tests of all processes cost."""
    if report.when == "teardown" and not {"slow", "nightly", "printed"} & set(report.keywords):
        _costs[report.nodeid] = dict(report.user_properties)[COST]


def pytest_terminal_summary(terminalreporter):
    """Name the quick tests above the cap, the dearest first."""
    dear = sorted((name for name in _costs if _costs[name] > CAP), key=_costs.get, reverse=True)
    if dear:
        terminalreporter.section(
            f"{len(dear)} of {len(_costs)} quick tests take more than {CAP} CPU s, "
            f"{sum(map(_costs.get, dear)):.0f} of {sum(_costs.values()):.0f} CPU s"
        )
    for name in dear:
        terminalreporter.line(f"{_costs[name]:5.1f} s  {name}")


@pytest.fixture(scope="session", autouse=True)
def memory():
    """Fails the last test of a process that has grown past the limit, and names the tests that took it there."""
    yield
    most = sorted(_growth, key=_growth.get, reverse=True)[:10]
    told = "\n".join(f"  {_growth[name]:5.0f} MiB  {name}" for name in most)
    assert peak() < LIMIT, (
        f"this process grew to {peak():.0f} MiB, above {LIMIT}; most of it in\n{told}"
    )


@pytest.fixture(scope="session")
def fabric():
    """S-720 as it was shot at."""
    from fabrics import catalogue

    return catalogue.load("S-720").with_effective_density()


@pytest.fixture(scope="session")
def shared(tmp_path_factory):
    """A function that gives a folder of the session, filled by make(folder) in the first process that asks for it."""
    base = tmp_path_factory.getbasetemp()
    if "PYTEST_XDIST_WORKER" in os.environ:
        base = base.parent

    def folder(name, make):
        place = base / name
        with open(base / f"{name}.lock", "w") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            if not (base / f"{name}.made").exists():
                shutil.rmtree(place, ignore_errors=True)
                place.mkdir()
                make(place)
                (base / f"{name}.made").touch()
        return place

    return folder


@pytest.fixture(scope="session")
def fresh():
    """Processes that have numba loaded, and nothing of a test (`tests.fresh_processes`)."""
    from tests.fresh_processes import FreshProcesses

    processes = FreshProcesses()
    yield processes
    processes.close()


@pytest.fixture
def command(capsys, tmp_path, monkeypatch):
    """Run `weavecell LINE` in this process and an empty folder, as a shell would; returns (exit code, stdout, stderr).

    The line may also be given word by word.
    """
    from weavecell.cli import app

    monkeypatch.chdir(tmp_path)

    def run(*words):
        if len(words) == 1:
            words = shlex.split(words[0])
        with pytest.raises(SystemExit) as leaving:
            app.main([str(word) for word in words])
        out, err = capsys.readouterr()
        return leaving.value.code, out, err

    return run


@pytest.fixture
def succeed(command):
    """Run a line as `command` does, which has to end well; returns what it prints."""

    def run(*words):
        code, out, err = command(*words)
        assert code == 0, err
        return out

    return run


@pytest.fixture
def tool(monkeypatch):
    """Import a module of tools/ by its name."""
    monkeypatch.syspath_prepend(str(Path(__file__).parents[1] / "tools"))
    loaded = []

    def load(name):
        loaded.append(name)
        return importlib.import_module(name)

    yield load
    for name in loaded:
        sys.modules.pop(name, None)


def pytest_ignore_collect(collection_path, config):
    """Leave out files that do not name the mark that is asked for: to load them all takes 40 CPU s a process."""
    mark = config.getoption("markexpr").partition(" ")[0]
    if mark not in ("slow", "nightly", "printed") or not collection_path.match("test_*.py"):
        return None
    # None asks the next plugin
    return mark not in collection_path.read_text("utf-8") or None


def pytest_collection_modifyitems(items):
    """Slow tests that know what they cost, `slow(seconds)`, come first, the longest before the others.

    Then two processes that take the next test as they get free end at about the same time.
    """
    items.sort(
        key=lambda item: (
            -max((mark.args[0] for mark in item.iter_markers("slow") if mark.args), default=0)
        )
    )
