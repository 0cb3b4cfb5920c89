"""A file of numba's cache that was cut short is one that is not there: the kernel is compiled again."""

import subprocess
import sys

import numpy as np
import pytest

KERNEL = """
from fabrics.base.kernel_cache import kernel


@kernel()
def twice(x):
    return 2 * x + {}
"""
RUN = "from mine.kernels import twice; print(twice(21.0), sum(twice.stats.cache_misses.values()))"


def test_kernels_of_cut_files_are_compiled_again(tmp_path, fresh):
    package = tmp_path / "mine"
    package.mkdir()
    (package / "__init__.py").touch()
    (package / "kernels.py").write_text(KERNEL.format(0.5))

    def run():
        found = fresh.run(RUN, folder=tmp_path)
        assert found.err == ""
        return found.out

    assert run() == "42.5 1\n"
    assert run() == "42.5 0\n"
    files = sorted(package.rglob("*.nb[ic]"))
    assert [file.suffix for file in files] == [".nbc", ".nbi"]
    random = np.random.default_rng(7)
    for file in files:
        whole = file.read_bytes()
        for length in (0, random.integers(1, len(whole))):
            file.write_bytes(whole[:length])
            assert run() == "42.5 1\n"
    assert run() == "42.5 0\n"


SHARED = """
from fabrics.base.kernel_cache import kernel
from shellfabric.jit.compile import kernel as inner


def twice(x):
    return 2 * x + 0.5


called = inner()(twice)
plain = kernel()(twice)
rounded = kernel(error_model="numpy", fastmath={"contract", "arcp"})(twice)


@kernel()
def call(x):
    return called(x)
"""
TELL = """
import sys
from mine import kernels

for name in sys.argv[1:]:
    kernel = getattr(kernels, name)
    print(kernel(21.0), sum(kernel.stats.cache_misses.values()))
"""
# of any two each is the first once
ORDERS = [("call", "plain", "rounded"), ("rounded", "plain", "call")]


@pytest.mark.parametrize("order", ORDERS, ids="-".join)
def test_each_set_of_options_has_machine_code_of_its_own(tmp_path, monkeypatch, fresh, order):
    """A kernel of the solids had no way in from Python, and the crossover crashed on its code."""
    package = tmp_path / "mine"
    package.mkdir()
    (package / "__init__.py").touch()
    (package / "kernels.py").write_text(SHARED)
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)

    for name in order:
        assert fresh.run(TELL, name, folder=tmp_path).out == "42.5 1\n"
    # the text of a set of options follows the hash seed of the process, which no fork can change
    monkeypatch.setenv("PYTHONHASHSEED", "2")
    told = subprocess.check_output([sys.executable, "-c", TELL, *order], cwd=tmp_path, text=True)
    assert told == "42.5 0\n" * 3
