"""A change in a kernel must reach the cached kernels that call it from another file; numba alone misses it."""

import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("numba")
ROOT = Path(__file__).parents[2]

INIT = {
    "plain": "from cloth import outer_kernels\n",
    "guarded": "from fabrics.kernel_cache import kernel_cache\n"
    "with kernel_cache(__file__):\n    from cloth import outer_kernels\n",
}
OUTER = """
from numba import njit
from cloth.inner_kernels import value

@njit(cache=True)
def twice():
    return 2 * value()
"""
INNER = "from numba import njit\n\n@njit(cache=True)\ndef value():\n    return {}\n"


@pytest.mark.parametrize(("kind", "after"), [("guarded", "4"), ("plain", "2")])
def test_a_changed_kernel_is_seen(tmp_path, kind, after):
    package = tmp_path / "cloth"
    package.mkdir()
    (package / "__init__.py").write_text(INIT[kind])
    (package / "outer_kernels.py").write_text(OUTER)

    def run(value):
        (package / "inner_kernels.py").write_text(INNER.format(value))
        command = [sys.executable, "-c", "import cloth; print(cloth.outer_kernels.twice())"]
        path = {"PYTHONPATH": f"{tmp_path}:{ROOT}", "PATH": "/usr/bin", "PYTHONDONTWRITEBYTECODE": "1"}
        return subprocess.run(command, env=path, check=True, capture_output=True, text=True).stdout.strip()

    assert run(1) == "2"
    assert run(2) == after
