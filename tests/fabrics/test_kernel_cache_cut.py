"""A file of numba's cache that was cut short is one that is not there: the kernel is compiled again."""

import subprocess
import sys

import numpy as np

KERNEL = """
from fabrics.base.kernel_cache import kernel


@kernel()
def twice(x):
    return 2 * x + {}
"""
RUN = "from mine.kernels import twice; print(twice(21.0), sum(twice.stats.cache_misses.values()))"


def test_kernels_of_cut_files_are_compiled_again(tmp_path, monkeypatch):
    package = tmp_path / "mine"
    package.mkdir()
    (package / "__init__.py").touch()
    (package / "kernels.py").write_text(KERNEL.format(0.5))
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)

    def run():
        found = subprocess.run(
            [sys.executable, "-c", RUN], cwd=tmp_path, capture_output=True, text=True, check=False
        )
        assert found.stderr == ""
        return found.stdout

    assert run() == "42.5 1\n"
    assert run() == "42.5 0\n"
    files = sorted(package.rglob("*.nb[ic]"))
    assert [file.suffix for file in files] == [".nbc", ".nbi"]
    random = np.random.default_rng(7)
    for file in files:
        whole = file.read_bytes()
        for length in (0, *random.integers(1, len(whole), size=3)):
            file.write_bytes(whole[:length])
            assert run() == "42.5 1\n"
    assert run() == "42.5 0\n"
