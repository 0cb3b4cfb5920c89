"""A change in a kernel must reach the cached kernels that call it from another file, and no others."""

import ast
import functools
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("numba")
from fabrics.base import kernel_cache
from fabrics.base.kernel_cache import kernel_sources

ROOT = Path(__file__).parents[2]

IMPORTS = "from fabrics.base.kernel_cache import kernel\n"
OUTER = "from cloth.inner_kernels import value\n\n@kernel()\ndef twice():\n    return 2 * value()\n"
INNER = "\n@kernel()\ndef value():\n    return {}\n"
BESIDE = "\n@kernel()\ndef three():\n    return 3\n"
RUN = (
    "from cloth import beside_kernels, outer_kernels\n"
    "print(outer_kernels.twice(), beside_kernels.three(), beside_kernels.three.stats.cache_hits.total())"
)


def test_a_changed_kernel_empties_the_cache_of_those_that_call_it_alone(tmp_path, fresh):
    """numba's own cache knows of the file alone that a kernel stands in: 2 again."""
    package = tmp_path / "cloth"
    package.mkdir()
    (package / "__init__.py").touch()
    (package / "outer_kernels.py").write_text(IMPORTS + OUTER)
    (package / "beside_kernels.py").write_text(IMPORTS + BESIDE)

    def run(value):
        (package / "inner_kernels.py").write_text(IMPORTS + INNER.format(value))
        done = fresh.run(RUN, folder=tmp_path)
        assert done.code == 0, done.err
        return done.out.strip()

    assert run(1) == "2 3 0"
    assert run(2) == "4 3 1"


WORDS = '"""{}"""\nfrom fabrics.base.kernel_cache import kernel\n'
HEAD = WORDS + "from shellfabric.jit.compile import units\n\nunit = units({{}})\n"
UNIT = '\n@unit("number", x="number")\ndef square(x):\n    """{}"""\n    return {} * x * x\n'
CALLER = HEAD.format("") + (
    "from cloth.unit_kernels import FACTOR, square\n"
    '\n@unit("number", x="number")\ndef scaled_square(x):\n    return FACTOR * square(x)\n'
)
RUN_UNIT = (
    "from cloth import caller_kernels\n"
    "from shellfabric.jit.compile import UNITS\n"
    "print(caller_kernels.scaled_square(3.0), *(sum(unit.dispatcher.stats.cache_hits.values()) for unit in UNITS))"
)


@pytest.fixture
def unit_package(tmp_path, fresh):
    """A package whose units call each other: result and cache hits of (square, scaled_square)."""

    def run(folder, *, words="", factor="2.0", own="1.0", more=""):
        package = tmp_path / folder / "cloth"
        package.mkdir(parents=True, exist_ok=True)
        (package / "__init__.py").touch()
        unit = UNIT.format(words, own)
        (package / "unit_kernels.py").write_text(
            HEAD.format(words) + f"{more}FACTOR = {factor}\n" + unit
        )
        (package / "caller_kernels.py").write_text(CALLER)
        done = fresh.run(RUN_UNIT, folder=package.parent, cache=tmp_path / "cache")
        assert done.code == 0, done.err
        value, *hits = map(float, done.out.split())
        return value, hits

    return run


def test_what_a_unit_does_is_no_part_of_its_callers(unit_package):
    assert unit_package("here") == (18.0, [0, 0])
    assert unit_package("here", words="Other words.\n\nAnd more.") == (18.0, [1, 1])
    assert unit_package("there") == (18.0, [1, 1])  # another folder, another time
    assert unit_package("here", own="5.0") == (90.0, [0, 1])
    assert unit_package("here", factor="3.0") == (27.0, [0, 0])


def test_a_computed_constant_is_followed_with_what_it_is_made_of(unit_package):
    assert unit_package("here", more="WIDTH = 2\n", factor="WIDTH + 1") == (27.0, [0, 0])
    assert unit_package("here", more="WIDTH = 3\n", factor="WIDTH + 1") == (36.0, [0, 0])


@pytest.mark.parametrize(
    "file", sorted(ROOT.glob("shellfabric/**/*_kernels.py")), ids=lambda path: path.stem
)
def test_a_kernel_file_follows_each_line_of_code_that_its_machine_code_has(file):
    """All helpers that a file calls, directly or through others, are followed with their whole source,
    in both forms of import; a plain twin by the syntax tree."""
    followed = {name for name, _ in kernel_sources(file)}
    inside = {str(path.relative_to(ROOT)) for path in helpers_of(file)}
    assert inside - set(kernel_cache.NO_CODE) <= followed


WORDS_OF = {
    "shellfabric/panel_numbers.py": ("whether a yarn fails", "whether yarns fail"),
    "fabrics/base/schema.py": ("a mass", "some mass"),
}


@pytest.fixture(scope="module")
def packages(tmp_path_factory):
    """A copy of the packages with kernels, in which a text of a file may stand otherwise."""

    def copy(changes):
        root = tmp_path_factory.mktemp("packages")
        for package in ("fabrics", "shellfabric"):
            ignored = shutil.ignore_patterns("__pycache__", "*.toml", "*.csv")
            shutil.copytree(ROOT / package, root / package, ignore=ignored)
        for name, (old, new) in changes.items():
            text = (root / name).read_text("utf-8")
            assert old in text
            (root / name).write_text(text.replace(old, new), "utf-8")
        return root

    return copy


def test_what_is_said_of_a_number_is_no_part_of_kernels(packages):
    """Its meaning, limits and example are for users; kernels know its name by the type of its row."""
    roots = packages({}), packages(WORDS_OF)
    files = ("membrane/failure_kernels.py", "yarns/chain_kernels.py", "loop/ply_kernels.py")
    for file in files:
        plain, changed = (
            kernel_cache.kernel_folder(root / "shellfabric" / file, root) for root in roots
        )
        assert plain == changed, file


def helpers_of(file):
    """Files of the helpers and computed constants that a kernel file takes from others, by Python's
    own parser."""
    waiting = [file]
    found = set()
    while waiting:
        path = waiting.pop()
        if path in found or not path.is_file():
            continue
        found.add(path)
        tree = tree_of(path)
        modules = {}
        for node in tree.body:
            if not isinstance(node, ast.ImportFrom) or not node.module.startswith("shellfabric"):
                continue
            place = ROOT.joinpath(*node.module.split("."))
            for alias in node.names:
                if (place / f"{alias.name}.py").is_file():
                    modules[alias.asname or alias.name] = place / f"{alias.name}.py"
                elif is_inside(place.with_suffix(".py"), alias.name):
                    waiting.append(place.with_suffix(".py"))
        for node in ast.walk(tree):
            if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
                place = modules.get(node.value.id)
                if place and is_inside(place, node.attr):
                    waiting.append(place)
    return found


@functools.cache
def tree_of(path):
    return ast.parse(path.read_text("utf-8"))


@functools.cache
def is_inside(path, name):
    """Whether the code of a name of a file becomes part of the machine code that uses it."""
    for node in tree_of(path).body:
        if isinstance(node, ast.FunctionDef) and node.name == name:
            return not any("unit" in ast.unparse(each) for each in node.decorator_list)
        if isinstance(node, ast.Assign) and name in map(ast.unparse, node.targets):
            return not isinstance(node.value, (ast.Constant, ast.Call))
    return True


HOST = ("x86_64-pc-linux-gnu", "here", "+avx512f")
UNIFORM, GRADED = ((kind, HOST, ("code", "cells")) for kind in ("uniform", "graded"))


@pytest.fixture
def files(tmp_path, monkeypatch):
    """Make numba's files of one kernel in a folder, as another process would, on a processor whose
    common one is given."""

    def make(common=""):
        monkeypatch.setattr(kernel_cache, "_common_processor", lambda: common)
        kernel_cache._files.cache_clear()
        return kernel_cache._files()(str(tmp_path), "kernel", "stamp")

    yield make
    kernel_cache._files.cache_clear()


def test_two_processes_that_compile_for_other_types_keep_their_code(files, tmp_path):
    """Each has read the index before the other wrote it: numba gives both files one name."""
    made = [files() for _ in range(2)]
    made[0].save(UNIFORM, "code of uniform")
    (tmp_path / "kernel.nbi").unlink()
    made[1].save(GRADED, "code of graded")
    graded = made[1].load(GRADED)
    made[0].save(UNIFORM, "code of uniform")
    assert graded == made[0].load(GRADED) == "code of graded"
    assert made[1].load(UNIFORM) == "code of uniform"
    assert len(list(tmp_path.glob("*.nbc"))) == 2


def test_code_for_all_processors_is_found_where_there_is_none_for_this_one(files):
    """Only on a processor that runs it, only of the same types and code; its own code goes before."""
    types, (triple, _, _), code = UNIFORM
    files().save((types, (triple, "x86-64-v3", ""), code), "common")
    old, new = files(), files("x86-64-v3")
    assert old.load(UNIFORM) is None
    assert new.load(UNIFORM) == "common"
    for other in (GRADED, (types, HOST, ("changed", "cells")), (types, ("arm", "a", ""), code)):
        assert new.load(other) is None
    new.save(UNIFORM, "own")
    assert new.load(UNIFORM) == "own"


@pytest.mark.parametrize("lacks", [None, "avx2", "fma"])
def test_an_old_processor_takes_no_code_for_newer_ones(monkeypatch, lacks):
    features = {name: name != lacks for name in (*kernel_cache.OF_V3, "avx512f")}
    monkeypatch.setattr("llvmlite.binding.get_host_cpu_features", lambda: features)
    monkeypatch.setattr(kernel_cache.platform, "machine", lambda: "x86_64")
    assert kernel_cache._common_processor() == ("" if lacks else "x86-64-v3")
    monkeypatch.setattr(kernel_cache.platform, "machine", lambda: "riscv64")
    assert kernel_cache._common_processor() == ""


@pytest.mark.parametrize("chosen", [None, "active"])
def test_threads_of_kernels_sleep_while_they_wait_unless_the_user_says_otherwise(chosen):
    """Those of libgomp spin by default: a block took twice the CPU time beside other runs."""
    code = "import os, fabrics.base.kernel_cache; print(os.environ['OMP_WAIT_POLICY'])"
    environment = {"PYTHONPATH": str(ROOT), "PATH": "/usr/bin"}
    environment |= {"OMP_WAIT_POLICY": chosen} if chosen else {}
    found = subprocess.run(
        [sys.executable, "-c", code], env=environment, check=True, capture_output=True, text=True
    ).stdout.strip()
    assert found == (chosen or "passive")
