"""A change in a kernel must reach the cached kernels that call it from another file, and no others."""

import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("numba")
ROOT = Path(__file__).parents[2]

IMPORTS = "from fabrics.base.kernel_cache import kernel\n"
OUTER = "from cloth.inner_kernels import value\n\n@kernel()\ndef twice():\n    return 2 * value()\n"
INNER = "\n@kernel()\ndef value():\n    return {}\n"
BESIDE = "\n@kernel()\ndef three():\n    return 3\n"
RUN = (
    "from cloth import beside_kernels, outer_kernels\n"
    "print(outer_kernels.twice(), beside_kernels.three(), beside_kernels.three.stats.cache_hits.total())"
)


def test_a_changed_kernel_empties_the_cache_of_those_that_call_it_alone(tmp_path):
    """numba's own cache knows of the file alone that a kernel stands in: 2 again."""
    package = tmp_path / "cloth"
    package.mkdir()
    (package / "__init__.py").touch()
    (package / "outer_kernels.py").write_text(IMPORTS + OUTER)
    (package / "beside_kernels.py").write_text(IMPORTS + BESIDE)

    def run(value):
        (package / "inner_kernels.py").write_text(IMPORTS + INNER.format(value))
        command = [sys.executable, "-c", RUN]
        path = {
            "PYTHONPATH": f"{tmp_path}:{ROOT}",
            "PATH": "/usr/bin",
            "PYTHONDONTWRITEBYTECODE": "1",
        }
        return subprocess.run(
            command, env=path, check=True, capture_output=True, text=True
        ).stdout.strip()

    assert run(1) == "2 3 0"
    assert run(2) == "4 3 1"
