"""Rules that no linter holds: what kernels may be, where their machine code is kept, lengths, the budget of tokens.

`make lint` holds the others: which package imports what, types, style. A rule is a function of the folder that the
packages are in, and returns what breaks it: nothing in the checkout, and something where a violation is planted.
"""

import ast
import io
import re
import tokenize
import tomllib
from collections import Counter
from pathlib import Path

import pytest

from fabrics.base import kernel_cache
from fabrics.base.kernel_cache import digest, kernel_sources

ROOT = Path(__file__).parents[1]
PACKAGES = ("fabrics", "meshing", "unitcell3d", "shellfabric", "validation", "weavecell")
WITH_KERNELS = ("shellfabric", "unitcell3d", "validation/models")
# files that may use numba's own decorators
DECORATORS = (
    "shellfabric/jit/compile.py",
    "fabrics/base/kernel_cache.py",
)
OWN_DECORATORS = re.compile(r"\b(njit|vectorize|guvectorize|cfunc)\b")
NAMED_TUPLE = re.compile(r"^[^#\n]*(\bnamedtuple\(|\bNamedTuple\b\)?:)", re.MULTILINE)
MOST_TOKENS = 8000  # of a file
MOST_TOKENS_OF_A_FUNCTION = 1010
CODE_TOKENS = (tokenize.NAME, tokenize.OP, tokenize.NUMBER, tokenize.STRING)
DOCUMENTED = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)
COMPREHENSIONS = (ast.ListComp, ast.SetComp, ast.DictComp, ast.GeneratorExp)
HABITS = ("conditional_expressions", "tuple_assignments", "comprehensions")


def sources(root, packages=PACKAGES):
    """(name, file, text) of all Python files of the packages."""
    for path in sorted(path for package in packages for path in (root / package).rglob("*.py")):
        yield str(path.relative_to(root)), path, path.read_text("utf-8")


def kernels_that_are_not_plain(root):
    """Kernel files import decorators, `jit`, `state` and kernel files, at their head; no classes, no open files."""
    for name, path, text in sources(root):
        if not path.stem.endswith("_kernels"):
            continue
        tree = ast.parse(text)
        for module, member in own_imports(tree):
            place = root.joinpath(*module.split("."))
            file = place / f"{member}.py" if place.is_dir() else place.with_suffix(".py")
            if (
                not file.stem.endswith("_kernels")
                and file.stem not in ("kernel_cache", "state")
                and file.parent.name != "jit"
            ):
                yield f"{name} imports {file.stem}"
        if len(own_imports(tree)) > len(
            own_imports(ast.Module(tree.body, []), ast.iter_child_nodes)
        ):
            yield f"{name} imports inside a function, where the cache of kernels does not look"
        if any(isinstance(node, ast.ClassDef) for node in ast.walk(tree)) or "open(" in text:
            yield f"{name} holds a class or opens a file"


def own_imports(tree, nodes=ast.walk):
    """[(module, member)] of what a file imports from our packages."""
    found = []
    for node in nodes(tree):
        if isinstance(node, ast.ImportFrom):
            found += [("." * node.level + node.module, alias.name) for alias in node.names]
        elif isinstance(node, ast.Import):
            found += [(alias.name, "") for alias in node.names]
    return [
        (module, member) for module, member in found if module.partition(".")[0] in (*PACKAGES, "")
    ]


def kernels_outside_the_cache(root):
    """Kernels that numba alone would cache, and named tuples that no digest of the kernel cache covers."""
    kernels = [path for folder in WITH_KERNELS for path in (root / folder).rglob("*_kernels.py")]
    covered = {name for path in kernels for name, _ in kernel_sources(path, root)}
    for name, _, text in sources(root, ["fabrics", "meshing", *WITH_KERNELS]):
        if name not in DECORATORS and OWN_DECORATORS.search(text):
            yield f"{name} has decorators of numba's own"
        if name not in covered and NAMED_TUPLE.search(text):
            yield f"{name} defines a named tuple"


def too_long(root):
    """Files and functions that hold too many tokens."""
    for name, _, text in sources(root):
        tokens = measure(text)["tokens"]
        if tokens > MOST_TOKENS:
            yield f"{name} has {tokens} tokens"
        for node in ast.walk(ast.parse(text)):
            if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)):
                tokens = measure(ast.unparse(node))["tokens"]
                if tokens > MOST_TOKENS_OF_A_FUNCTION:
                    yield f"{name}: {node.name} has {tokens} tokens"


@pytest.mark.parametrize("rule", [kernels_that_are_not_plain, kernels_outside_the_cache, too_long])
def test_the_rule_is_kept(rule):
    assert len(list(sources(ROOT))) > 200
    assert list(rule(ROOT)) == []


def write(root, name, text):
    (root / name).parent.mkdir(parents=True, exist_ok=True)
    (root / name).write_text(text)
    kernel_cache._tuples.cache_clear()


@pytest.mark.parametrize(
    "rule, file, text",
    [
        (
            kernels_that_are_not_plain,
            "shellfabric/cloth/new_kernels.py",
            "from shellfabric.cell import model\n",
        ),
        (kernels_that_are_not_plain, "shellfabric/cloth/new_kernels.py", "class A:\n    pass\n"),
        (
            kernels_outside_the_cache,
            "unitcell3d/contact/new_kernels.py",
            "from numba import njit\n",
        ),
        (kernels_outside_the_cache, "meshing/new.py", "class Pair(NamedTuple):\n    a: int\n"),
        (
            too_long,
            "shellfabric/cell/new.py",
            "class A:\n    def f(self):\n" + "        pass\n" * 1100,
        ),
    ],
)
def test_the_rule_finds_a_violation(tmp_path, rule, file, text):
    write(tmp_path, "shellfabric/jit/simd.py", "")
    write(tmp_path, "shellfabric/cell/fast_kernels.py", "from shellfabric.jit import simd\n")
    write(tmp_path, "shellfabric/cell/model.py", "from shellfabric.cell import fast_kernels\n")
    assert list(rule(tmp_path)) == []
    write(tmp_path, file, text)
    problems = list(rule(tmp_path))
    assert problems
    assert all(Path(file).stem in problem for problem in problems)


@pytest.mark.parametrize("file", ["unitcell3d/contact/new.py", "validation/models/net/new.py"])
def test_a_named_tuple_changes_the_digest_of_kernels(tmp_path, file):
    write(tmp_path, "shellfabric/cell/fast_kernels.py", "")
    digests = []
    for text in (
        "Pair = namedtuple('Pair', 'a b')",
        "Pair = namedtuple('Pair', 'b a')",
        "Pair = namedtuple( 'Pair', 'b a')",
        "names = 'a b'\nPair = namedtuple('Pair', names)",
    ):
        write(tmp_path, file, f"from collections import namedtuple\n{text}\n")
        digests.append(
            digest(kernel_sources(tmp_path / "shellfabric/cell/fast_kernels.py", tmp_path))
        )
    assert digests[0] != digests[1] == digests[2] != digests[3]


def measure(text):
    """Count tokens, lines of code and habits of writing in the source of one file.

    Blank lines, comments and docstrings are no code, so that neither packing a line nor leaving out a comment pays.
    """
    nodes = list(ast.walk(ast.parse(text)))
    documented = set()
    for node in nodes:
        if isinstance(node, DOCUMENTED) and ast.get_docstring(node) is not None:
            documented.update(range(node.body[0].lineno, node.body[0].end_lineno + 1))
    count = Counter()
    for number, line in enumerate(text.splitlines(), 1):
        is_comment = line.lstrip().startswith("#")
        count["lines"] += bool(line.strip()) and not is_comment and number not in documented
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        count["tokens"] += token.type in CODE_TOKENS and token.start[0] not in documented
    for node in nodes:
        count["conditional_expressions"] += isinstance(node, ast.IfExp)
        count["comprehensions"] += isinstance(node, COMPREHENSIONS)
        if isinstance(node, ast.Assign) and isinstance(node.value, ast.Tuple):
            count["tuple_assignments"] += any(isinstance(to, ast.Tuple) for to in node.targets)
    return count


def measure_package(package):
    """(tokens, habits) of a package or of the tests; habits are counted per 1,000 lines of code."""
    count = Counter()
    for path in (ROOT / package).rglob("*.py"):
        count.update(measure(path.read_text("utf-8")))
    habits = {name: 1000 * count[name] / count["lines"] for name in HABITS}
    habits["tokens_a_line"] = count["tokens"] / count["lines"]
    return count["tokens"], habits


def test_no_two_files_of_tests_share_a_name():
    """A run of all tests would refuse the second."""
    names = [path.name for path in ROOT.glob("tests/**/test_*.py")]
    assert sorted(names) == sorted(set(names))


def test_tokens_and_habits_are_within_the_budget():
    """A change that needs more tokens of a package deletes others: the numbers of pyproject.toml only fall."""
    budget = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["tool"]["weavecell"]
    assert set(budget["most_tokens"]) == set(budget["most_habits"]) == {*PACKAGES, "tests"}
    exceeded = {}
    for package, most_tokens in budget["most_tokens"].items():
        tokens, habits = measure_package(package)
        if tokens > most_tokens:
            exceeded[package, "tokens"] = tokens
        for habit, most in budget["most_habits"][package].items():
            if habits[habit] > most:
                exceeded[package, habit] = round(habits[habit], 2)
    assert exceeded == {}


def test_a_measure_sees_each_habit_and_no_docstring():
    text = '''
"""Words."""
# a comment
a, b = 1, 2
c = [x if x else y for x in z]
'''
    expected = {
        "lines": 2,
        "tokens": 20,
        "conditional_expressions": 1,
        "comprehensions": 1,
        "tuple_assignments": 1,
    }
    assert measure(text) == expected
