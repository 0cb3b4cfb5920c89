"""Rules that no linter holds: what kernels may be, where their machine code is kept, lengths, types, the line budget.

Which package may import what is held by `lint-imports` (pyproject.toml). Each rule here is a function of the folder
that the packages are in and returns what breaks it. It is applied to the checkout, where it finds nothing, and to a
tree with a violation, which it finds.
"""

import ast
import re
import tomllib
from pathlib import Path

import pytest

from fabrics import kernel_cache, source_code
from fabrics.kernel_cache import kernel_sources

ROOT = Path(__file__).parents[1]
WITH_KERNELS = ("shellfabric", "unitcell3d", "validation/models")
DECORATORS = ("shellfabric/jit/compile.py",)  # the file there that may use numba's own decorators
OWN_DECORATORS = r"\b(njit|vectorize|guvectorize|cfunc)\b"
MOST_LINES, MOST_LINES_OF_A_FUNCTION = 600, 60
CALLED = ("__init__", "__call__", "__getitem__", "__setitem__", "__contains__", "__getattr__")


def sources(root, packages=source_code.PACKAGES):
    """{name: file} of all Python files of the packages, whatever folder they are in."""
    files = sorted(path for package in packages for path in (root / package).rglob("*.py"))
    return {str(path.relative_to(root)): path for path in files}


def kernels_that_are_not_plain(root):
    """Kernel files import decorators, `jit` and kernel files alone; they hold no classes and open no files."""
    problems = []
    for name, path in sources(root).items():
        if not path.stem.endswith("_kernels"):
            continue
        files = (source_code.file_of(module, root) for module in source_code.imports(path, root))
        problems += [
            f"{name} imports {file.stem}"
            for file in files
            if file is not None
            and file.name not in ("__init__.py", "kernel_cache.py")
            and not file.stem.endswith("_kernels")
            and file.parent != root / "shellfabric" / "jit"
        ]
        text = path.read_text("utf-8")
        if any(isinstance(node, ast.ClassDef) for node in ast.walk(ast.parse(text))) or "open(" in text:
            problems.append(f"{name} holds a class or opens a file")
    return problems


def kernels_outside_the_cache(root):
    """Kernels that numba alone would cache, and named tuples that no digest of the kernel cache covers."""
    folders = [root / folder for folder in WITH_KERNELS]
    kernels = [path for folder in folders for path in folder.rglob("*_kernels.py")]
    covered = {name for path in kernels for name, _ in kernel_sources(path, root)}
    problems = []
    for name, path in sources(root, ["fabrics", "meshing", *WITH_KERNELS]).items():
        text = path.read_text("utf-8")
        if name not in (*DECORATORS, "fabrics/kernel_cache.py") and re.search(OWN_DECORATORS, text):
            problems.append(f"{name} has decorators of numba's own")
        if name not in covered and re.search(r"^[^#\n]*(\bnamedtuple\(|\bNamedTuple\b\)?:)", text, flags=re.MULTILINE):
            problems.append(f"{name} defines a named tuple")
    return problems


def too_long(root):
    """Files, and functions without their docstring and decorators."""
    problems = []
    for name, path in sources(root).items():
        text = path.read_text("utf-8")
        if (count := len(text.splitlines())) > MOST_LINES:
            problems.append(f"{name} has {count} lines")
        for node in ast.walk(ast.parse(text)):
            if not isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)):
                continue
            docstring = node.body[0].end_lineno - node.body[0].lineno + 1 if ast.get_docstring(node) else 0
            if (count := node.end_lineno - node.lineno + 1 - docstring) > MOST_LINES_OF_A_FUNCTION:
                problems.append(f"{name}: {node.name} has {count} lines")
    return problems


def public_functions(body, owner=""):
    """(name, function) of all functions and methods that are not private, nested ones left out."""
    for node in body:
        if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
            yield from public_functions(node.body, f"{node.name}.")
        elif isinstance(node, ast.FunctionDef) and (not node.name.startswith("_") or node.name in CALLED):
            yield owner + node.name, node


def public_functions_without_types(root):
    """Parameters and results without annotation; of kernels and of `jit` numba finds the types itself."""
    problems = []
    for name, path in sources(root).items():
        if path.stem.endswith("_kernels") or name.startswith("shellfabric/jit/"):
            continue
        for function, node in public_functions(ast.parse(path.read_bytes()).body):
            arguments = node.args
            named = [*arguments.posonlyargs, *arguments.args, arguments.vararg, *arguments.kwonlyargs, arguments.kwarg]
            static = any(isinstance(mark, ast.Name) and mark.id == "staticmethod" for mark in node.decorator_list)
            first = 1 if "." in function and not static else 0
            bare = [argument.arg for argument in named[first:] if argument is not None and argument.annotation is None]
            if bare or node.returns is None:
                problems.append(f"{name}: {function} has no type for {', '.join(bare) or 'its result'}")
    return problems


RULES = (kernels_that_are_not_plain, kernels_outside_the_cache, too_long, public_functions_without_types)


@pytest.mark.parametrize("rule", RULES)
def test_the_rule_is_kept(rule):
    assert len(sources(ROOT)) > 200
    assert rule(ROOT) == []


CLEAN = {
    "fabrics/yarn.py": "",
    "shellfabric/jit/simd.py": "",
    "shellfabric/cell/fast_kernels.py": "from shellfabric.jit import simd\n",
    "shellfabric/cell/deep/model.py": "from shellfabric.cell import fast_kernels\n",
}
HERE, KERNELS = "shellfabric/cell/deep/new.py", "shellfabric/cell/deep/new_kernels.py"
PLANTED = [
    (kernels_that_are_not_plain, KERNELS, "from fabrics import yarn\n"),
    (kernels_that_are_not_plain, "shellfabric/cloth/new_kernels.py", "from shellfabric.cell.deep import model\n"),
    (kernels_that_are_not_plain, KERNELS, "class A:\n    pass\n"),
    (kernels_that_are_not_plain, KERNELS, "open('a')\n"),
    (kernels_outside_the_cache, KERNELS, "from numba import njit\n"),
    (kernels_outside_the_cache, "unitcell3d/contact/new_kernels.py", "from numba import njit\n"),
    (kernels_outside_the_cache, "fabrics/deep/new.py", "Pair = namedtuple('Pair', 'a b')\n"),
    (kernels_outside_the_cache, "meshing/new.py", "class Pair(NamedTuple):\n    a: int\n"),
    (kernels_outside_the_cache, "validation/models/new.py", "import numba\n@numba.njit\ndef f():\n    pass\n"),
    (too_long, HERE, "#\n" * (MOST_LINES + 1)),
    (too_long, HERE, "class A:\n    def f(self):\n" + "        pass\n" * MOST_LINES_OF_A_FUNCTION),
    (public_functions_without_types, "meshing/deep/new.py", "def f(a, *, b: int) -> int:\n    return a + b\n"),
    (public_functions_without_types, "fabrics/new.py", "def f(a: int):\n    return a\n"),
]


@pytest.mark.parametrize(("rule", "file", "text"), PLANTED)
def test_the_rule_finds_a_violation(tmp_path, rule, file, text):
    for name, content in CLEAN.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(content)
    assert rule(tmp_path) == []
    (tmp_path / file).parent.mkdir(parents=True, exist_ok=True)
    (tmp_path / file).write_text(text)
    kernel_cache._tuples.cache_clear()
    problems = rule(tmp_path)
    assert problems
    assert all(Path(file).stem in problem for problem in problems)


@pytest.mark.parametrize("here", [HERE, "validation/models/net/new.py"])
def test_a_named_tuple_changes_the_digest(tmp_path, here):
    for name in (*CLEAN, here):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(CLEAN.get(name, ""))
    digests = []
    for text in (
        "Pair = namedtuple('Pair', 'a b')",
        "Pair = namedtuple('Pair', 'b a')",
        "Pair = namedtuple( 'Pair', 'b a')",
        "names = 'b a'\nPair = namedtuple('Pair', names)",
        "names = 'a b'\nPair = namedtuple('Pair', names)",
    ):
        (tmp_path / here).write_text(f"from collections import namedtuple\n{text}\n")
        kernel_cache._tuples.cache_clear()
        digests.append(source_code.digest(kernel_sources(tmp_path / "shellfabric/cell/fast_kernels.py", tmp_path)))
    assert digests[0] != digests[1] == digests[2] != digests[3] != digests[4]


def test_lines_of_python_are_within_the_budget():
    """A change that needs more lines of a package deletes others: the numbers in pyproject.toml only fall."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["tool"]["weavecell"]
    counts = {
        name: sum(len(path.read_bytes().splitlines()) for path in (ROOT / name).rglob("*.py"))
        for name in (*source_code.PACKAGES, "tests")
    }
    assert set(project["most_lines"]) == set(counts)
    assert {name: count for name, count in counts.items() if count > project["most_lines"][name]} == {}
