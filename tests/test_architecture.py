"""Rules that no linter holds: what kernels may be, and where their machine code is kept.

`make lint` holds the others: which package imports what, types, style. A rule is a function of the folder that the
packages are in, and returns what breaks it: nothing in the checkout, and something where a violation is planted.
"""

import ast
import re
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
# folders of weavecell that read results, and files in them that read what they have made or what is shipped
ABOVE_RESULTS = ("answers", "api", "cli", "decks", "report")
READ_THEIR_OWN = (
    "weavecell/report/shot/beside.py",
    "weavecell/report/chapters_discretisation.py",
)
OWN_DECORATORS = re.compile(r"\b(njit|vectorize|guvectorize|cfunc)\b")
NAMED_TUPLE = re.compile(r"^[^#\n]*(\bnamedtuple\(|\bNamedTuple\b\)?:)", re.MULTILINE)


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


def results_read_past_their_list(root):
    """JSON and tables of results are read by `open_folder` alone; `make lint` holds it of all files with a format."""
    readers = re.compile(r"\bjson\.loads?\(|\bread_csv\(")
    for name, _, text in sources(root, [f"weavecell/{above}" for above in ABOVE_RESULTS]):
        if name not in READ_THEIR_OWN and readers.search(text):
            yield f"{name} reads a file of results past `open_folder`"


# the reader of users' tables, and one that reads a table of this package
READ_OWN_TABLES = {"fabrics/base/tables.py", "weavecell/studies/model_choice.py"}


def tables_of_users_read_elsewhere(root):
    """One reader knows how instruments write a table: `fabrics.base.tables`."""
    for name, _, text in sources(root):
        own = name.startswith("validation/") or name in READ_OWN_TABLES
        if not own and re.search(r"\bcsv\.(reader|DictReader)\(", text):
            yield f"{name} reads a table past `fabrics.base.tables`"


RULES = (
    kernels_that_are_not_plain,
    kernels_outside_the_cache,
    results_read_past_their_list,
    tables_of_users_read_elsewhere,
)


@pytest.mark.parametrize("rule", RULES)
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
            "shellfabric/membrane/new_kernels.py",
            "from shellfabric.cell import model\n",
        ),
        (kernels_that_are_not_plain, "shellfabric/membrane/new_kernels.py", "class A:\n    pass\n"),
        (
            kernels_outside_the_cache,
            "unitcell3d/contact/new_kernels.py",
            "from numba import njit\n",
        ),
        (kernels_outside_the_cache, "meshing/new.py", "class Pair(NamedTuple):\n    a: int\n"),
        (results_read_past_their_list, "weavecell/api/new.py", "content = json.loads(text)\n"),
        (tables_of_users_read_elsewhere, "weavecell/studies/new.py", "csv.reader(file)\n"),
        (
            results_read_past_their_list,
            "weavecell/report/new.py",
            "shots = pandas.read_csv(file)\n",
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


def test_no_two_files_of_tests_share_a_name():
    """A run of all tests would refuse the second."""
    names = [path.name for path in ROOT.glob("tests/**/test_*.py")]
    assert sorted(names) == sorted(set(names))
