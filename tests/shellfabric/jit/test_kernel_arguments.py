"""Machine code in the cache is that of the named tuples as they are now: numba alone does not look at their fields."""

import ast
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from fabrics.kernel_cache import kernel_sources

numba = pytest.importorskip("numba")
ROOT = Path(__file__).parents[3]
FOLDER, MODELS = ROOT / "shellfabric", ROOT / "validation" / "models"
KERNELS = FOLDER / "projectile" / "friction_kernels.py"
# two fields of each that hold arrays of one type, of everything that kernels are called with
LIKE = {
    ("plies.arrays", "Pair"): ("normal", "last_depth"),
    ("plies.arrays", "TornContact"): ("box_low", "box_high"),
    ("plies.arrays", "Stack"): ("projectile_position", "f_contact_nose"),
    ("projectile.contact", "Scratch"): ("box_low", "box_high"),
    ("validation.models.cable.model", "State"): ("u", "v"),
    ("validation.models.cable.model", "Constants"): ("x0", "y0"),
    ("panel.arrays", "State"): ("u", "v"),
    ("panel.arrays", "Constants"): ("S01", "EA1"),
    ("panel.arrays", "Work"): ("stretch1", "stretch2"),
}
PROBE = """

@entry()
def probe_{file}_{name}(given):
    return given.{field}[0]
"""
READ = """
import importlib, json, sys
import numpy as np
from shellfabric.projectile import friction_kernels
assert friction_kernels.__file__.startswith(sys.argv[2]), friction_kernels.__file__
found = {}
for file, name in json.loads(sys.argv[1]):
    kind = getattr(importlib.import_module(file), name)
    given = kind(**{field: np.array([float(sum(map(ord, field)))]) for field in kind._fields})
    found[f"{file}.{name}"] = getattr(friction_kernels, f"probe_{file.replace('.', '_')}_{name}")(given)
print(json.dumps(found))
"""


def fields_of(text, name):
    """(the expression that lists the fields of a named tuple as it is in the text, the fields)"""
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "namedtuple" and node.args[0].value == name:
            return ast.get_source_segment(text, node.args[1]), node.args[1].value.split()
    raise AssertionError(name)


def whole(module):
    """Dotted name of a module of shellfabric or of the models."""
    return module if module.startswith("validation.") else f"shellfabric.{module}"


def source(root, module):
    """File of such a module."""
    return root.joinpath(*whole(module).split(".")).with_suffix(".py")


def swap(path, name, pair):
    """Exchange two fields of a named tuple in a file."""
    text = path.read_text()
    written, fields = fields_of(text, name)
    exchanged = [dict(zip(pair, pair[::-1])).get(field, field) for field in fields]
    assert sorted(exchanged) == sorted(fields) != exchanged != fields
    path.write_text(text.replace(written, repr(" ".join(exchanged))))


def test_swapped_fields_reach_the_machine_code(tmp_path):
    """A kernel reads a field by its name; after two fields have changed places it reads the field of that name still.

    Machine code of the old order would read the other one.
    """
    for package in ("fabrics", "shellfabric", "validation/models"):
        shutil.copytree(ROOT / package, tmp_path / package, ignore=shutil.ignore_patterns("__pycache__"))
    (tmp_path / "validation" / "__init__.py").touch()
    with open(tmp_path / "shellfabric" / "projectile" / "friction_kernels.py", "a") as file:
        file.write("\n\nfrom shellfabric.jit.compile import entry\n")
        for (module, name), pair in LIKE.items():
            file.write(PROBE.format(file=whole(module).replace(".", "_"), name=name, field=pair[0]))

    def read():
        asked = re.sub("'", '"', str([[whole(file), name] for file, name in LIKE]))
        path = {"PYTHONPATH": str(tmp_path), "PATH": "/usr/bin", "PYTHONDONTWRITEBYTECODE": "1"}
        path["NUMBA_CACHE_DIR"] = str(tmp_path / "kept")
        command = [sys.executable, "-c", READ, asked, str(tmp_path)]
        return ast.literal_eval(
            subprocess.run(command, env=path, cwd=tmp_path, check=True, capture_output=True, text=True).stdout
        )

    before = read()
    assert before == {f"{whole(f)}.{n}": float(sum(map(ord, pair[0]))) for (f, n), pair in LIKE.items()}
    assert read() == before  # from the cache
    for (file, name), pair in LIKE.items():
        swap(source(tmp_path, file), name, pair)
    assert read() == before


@pytest.mark.parametrize(("file", "name"), LIKE)
def test_the_digest_covers_the_named_tuple(file, name):
    """Of each alone, which the test above, where all change at once, does not show."""
    covered = dict(kernel_sources(KERNELS))
    assert f"{name!r}" in covered[str(source(Path(), file))].decode()


def test_the_digest_is_narrow():
    """Kernels that a file does not import do not count; of what prepares arrays the named tuples alone do."""
    covered = dict(kernel_sources(FOLDER / "plies" / "contact_kernels.py"))
    assert "shellfabric/plies/point_kernels.py" in covered
    assert not [name for name in covered if name.startswith("shellfabric/sliding/") and name.endswith("_kernels.py")]
    assert len(covered["shellfabric/panel/arrays.py"]) < 3000
    assert not {"shellfabric/cell/model.py", "shellfabric/solver/step_kernels.py"} & set(covered)


def test_every_kernel_is_compiled_into_the_cache():
    """A kernel that is decorated outside of `kernel_cache` would be cached by numba alone."""
    paths = [path for folder in (FOLDER, MODELS) for path in sorted(folder.rglob("*_kernels.py"))]
    files = [path.relative_to(ROOT).with_suffix("") for path in paths]
    code = (
        "import importlib, sys\nfrom numba.core.registry import CPUDispatcher\n"
        "for name in sys.argv[1:]:\n    for one in vars(importlib.import_module(name)).values():\n"
        "        if isinstance(one, CPUDispatcher):\n            print(one._cache.cache_path)\n"
    )
    command = [sys.executable, "-c", code, *(".".join(file.parts) for file in files)]
    done = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True)
    found = done.stdout.split()
    assert len(found) > 200
    assert all("kernels-" in path for path in found)


def test_the_package_imports_no_kernel():
    """Nor numba: a command that needs neither starts without them."""
    code = (
        "import shellfabric, sys; print(*(name for name in sys.modules if name.startswith(('numba', 'shellfabric'))))"
    )
    command = [sys.executable, "-c", code, "numba", "shellfabric"]
    done = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True)
    assert done.stdout.split() == ["shellfabric"]


def test_named_tuples_of_called_kernels_are_covered(small):
    """Those that kernels have in fact been compiled for, in this process."""
    from numba.core import types
    from numba.core.registry import CPUDispatcher

    from shellfabric.solver.pack_solver import PackSolver

    PackSolver(small(), 50.0, 2e-6).run()
    covered, seen = dict(kernel_sources(KERNELS)), set()
    for name, module in list(sys.modules.items()):
        if not name.startswith("shellfabric"):
            continue
        for one in vars(module).values():
            if isinstance(one, CPUDispatcher):
                given = [getattr(t, "inner", t) for kinds in one.signatures for t in kinds]
                seen |= {t.instance_class for t in given if isinstance(t, types.BaseNamedTuple)}
    assert {"Constants", "State"} <= {kind.__name__ for kind in seen}
    for kind in seen:
        file = kind.__module__.replace(".", "/") + ".py"
        assert kind.__name__.encode() in covered.get(file, b""), kind
