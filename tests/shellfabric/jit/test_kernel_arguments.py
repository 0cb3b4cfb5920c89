"""Machine code in the cache is that of the named tuples as they are now: numba alone does not look at their fields."""

import ast
import json
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("numba")
ROOT = Path(__file__).parents[3]
ALIKE = {  # two fields of each that hold arrays of one type
    ("shellfabric.plies.arrays", "PackContact"): ("closest_a", "closest_b"),
    ("shellfabric.plies.arrays", "Stack"): ("projectile_position", "f_contact_nose"),
    ("shellfabric.projectile.contact", "Scratch"): ("box_low", "box_high"),
    ("shellfabric.panel.arrays", "State"): ("u", "v"),
}
PROBES = "\n\nfrom shellfabric.jit.compile import entry\n" + "".join(
    f"\n\n@entry()\ndef probe_{number}(given):\n    return given.{field}[0]\n"
    for number, (field, _) in enumerate(ALIKE.values())
)
READ = """
import importlib, json, sys
import numpy as np
from shellfabric.projectile import friction_kernels
assert friction_kernels.__file__.startswith(sys.argv[2]), friction_kernels.__file__
for number, (module, name) in enumerate(json.loads(sys.argv[1])):
    kind = getattr(importlib.import_module(module), name)
    given = kind(**{field: np.array([float(sum(map(ord, field)))]) for field in kind._fields})
    print(getattr(friction_kernels, f"probe_{number}")(given))
"""


def swap(path, name, pair):
    """Exchange two fields of a named tuple in a file."""
    text = path.read_text()
    [given] = (
        ast.get_source_segment(text, node.args[1])
        for node in ast.walk(ast.parse(text))
        if isinstance(node, ast.Call)
        and getattr(node.func, "id", "") == "namedtuple"
        and node.args[0].value == name
    )
    exchanged, count = re.subn(
        rf"\b({'|'.join(pair)})\b", lambda found: pair[found[0] == pair[0]], given
    )
    assert count == 2
    path.write_text(text.replace(given, exchanged))


def test_swapped_fields_reach_the_machine_code(tmp_path):
    """A kernel reads a field by its name; after two fields have changed places it reads the field of that name still.

    Machine code of the old order would read the other one.
    """
    for package in ("fabrics", "shellfabric", "validation/models"):
        shutil.copytree(
            ROOT / package, tmp_path / package, ignore=shutil.ignore_patterns("__pycache__")
        )
    (tmp_path / "validation" / "__init__.py").touch()
    with open(tmp_path / "shellfabric" / "projectile" / "friction_kernels.py", "a") as file:
        file.write(PROBES)
    variables = {"PYTHONPATH": str(tmp_path), "PATH": "/usr/bin", "PYTHONDONTWRITEBYTECODE": "1"}
    variables["NUMBA_CACHE_DIR"] = str(tmp_path / "kept")

    def read():
        command = [sys.executable, "-c", READ, json.dumps(list(ALIKE)), str(tmp_path)]
        done = subprocess.run(
            command, env=variables, cwd=tmp_path, check=True, capture_output=True, text=True
        )
        return [float(line) for line in done.stdout.split()]

    before = read()
    assert before == [sum(map(ord, field)) for field, _ in ALIKE.values()]
    assert read() == before  # from the cache
    for (module, name), pair in ALIKE.items():
        swap(tmp_path.joinpath(*module.split(".")).with_suffix(".py"), name, pair)
    assert read() == before
