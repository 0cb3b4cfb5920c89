"""The rules of the architecture that a machine can hold: which package may import what, and what kernels may be.

Each rule is a function of the folder that the packages are in, and returns what breaks it. It is applied to the
checkout, where it finds nothing, and to a small tree with a violation deep in a sub-package, which it finds.
"""

import ast
import graphlib
import re
import tomllib
from collections import Counter
from pathlib import Path

import pytest

from fabrics import kernel_cache, source_code
from fabrics.kernel_cache import kernel_sources

ROOT = Path(__file__).parents[1]
FLOORS = {"fabrics": 0, "meshing": 1, "unitcell3d": 2, "shellfabric": 2, "weavecell": 3, "validation": 4}
# inside a package, lowest first: a file imports from its own folder and from lower ones
LAYERS = {
    "shellfabric": (
        {"jit"}, {"driver"}, {"cell"}, {"cloth"}, {"projectile"}, {"backing"}, {"panel"}, {"sliding"},
        {"plies", "output"}, {"solver"}, {"impact", "coupon"},
    ),
    "unitcell3d": (
        {"assembly", "material"}, {"contact"}, {"model"}, {"solver"}, {"cases"}, {"identify"},
    ),
    "weavecell": ({"analysis", "scenes"}, {"results"}, {"report"}, {"commands"}, {"api", "cli"}),
}  # fmt: skip
UPWARDS = {"weavecell/commands/validation.py": "validation"}  # the one file that may import from a higher package
ONLY_IN = {
    "gmsh": ("meshing/",),
    "meshio": ("meshing/",),
    "pytexgen": ("meshing/texgen/worker.py",),
    "dolfinx": ("unitcell3d/",),
    "petsc4py": ("unitcell3d/",),
    "numba": ("shellfabric/", "unitcell3d/", "validation/models/", "fabrics/kernel_cache.py"),
}
PICTURES = {"pyvista", "matplotlib", "vtk"}
WITH_KERNELS = ("shellfabric", "unitcell3d")
DECORATORS = "shellfabric/jit/compile.py"  # the one file there that may use numba's own decorators
MODELS = "validation/models"  # which has kernels too
OWN_DECORATORS = r"\b(njit|vectorize|guvectorize|cfunc)\b"
MOST_FILES = 25  # in a folder
MOST_LINES, MOST_LINES_OF_A_FUNCTION, MOST_ARGUMENTS_OF_A_KERNEL = 600, 60, 12
MOST_LINES_OF_A_MODULE_DOCSTRING = 25  # derivations stand on the pages of theory
TYPED = tuple(FLOORS)  # mypy checks them (pyproject.toml)
CALLED = ("__init__", "__call__", "__getitem__", "__setitem__", "__contains__", "__getattr__")
# of numba, what files may use whose functions are not compiled: anything else could make machine code unseen
DRIVES = {"set_num_threads", "get_num_threads", "config"}
# import modules by computed names, or know that others do
BY_NAME = (
    "fabrics/lazy.py",  # public names of packages
    "fabrics/source_code.py",
    "fabrics/executors.py",  # of the user's own, and other libraries
    "shellfabric/jit/compile_in_child.py",
    "weavecell/cli/app.py",  # the commands
)  # fmt: skip


def sources(root, packages=FLOORS):
    """{name: file} of all Python files of the packages, whatever folder they are in."""
    found = sorted(path for package in packages for path in (root / package).rglob("*.py"))
    return {str(path.relative_to(root)): path for path in found}


def pictures(dotted):
    """Whether a module, or a folder that it is in, is one of pictures."""
    return any(part.startswith("pictures") for part in dotted.split("."))


def packages_without_a_floor(root):
    listed = {path.parent.name for path in root.glob("*/__init__.py")} - {"tests"}
    return [f"{name}/ has no place in FLOORS" for name in sorted(listed - set(FLOORS))]


def imports_that_run_upwards(root):
    found = []
    for name, path in sources(root).items():
        package, own = name.split("/")[0], source_code.name_of(path, root)
        for module in source_code.imports(path, root):
            top = module.split(".")[0]
            if top in FLOORS and top != package and FLOORS[top] >= FLOORS[package] and UPWARDS.get(name) != top:
                found.append(f"{name} imports {module}")
            if top in ONLY_IN and not name.startswith(ONLY_IN[top]):
                found.append(f"{name} imports {module}")
            if top in PICTURES and package in ("fabrics", "meshing", "unitcell3d", "shellfabric") and not pictures(own):
                found.append(f"{name} imports {module}: pictures live in files of their own")
            if package in WITH_KERNELS and top == package and pictures(module) and not pictures(own):
                found.append(f"{name} imports {module}: no solver imports a picture file")
    return found


def layer(name):
    """(package, folder, its place in LAYERS) of a file or a module, by the parts of its name; None outside LAYERS."""
    package, folder = (*name, "", "")[:2]
    for place, folders in enumerate(LAYERS.get(package, ())):
        if folder in folders:
            return package, folder, place
    return None


def imports_against_the_layers(root):
    found = []
    for name, path in sources(root, LAYERS).items():
        own = layer(Path(name).parts)
        if own is None:
            if name.count("/") > 1:
                found.append(f"{name} is in a folder that has no place in LAYERS")
            elif not name.endswith(("/__init__.py", "/__main__.py")):
                found.append(f"{name} is in no folder of its package")
            continue
        for module in source_code.imports(path, root):
            other = layer(module.split("."))
            if other and other[0] == own[0] and other[1] != own[1] and other[2] >= own[2]:
                found.append(f"{name} imports {module} of a higher layer")
    return found


def analyses_that_import_the_rest_of_weavecell(root):
    return [
        f"{name} imports {module}"
        for name, path in sources(root, ["weavecell"]).items()
        if name.startswith("weavecell/analysis/")
        for module in source_code.imports(path, root)
        if module.startswith("weavecell.") and not module.startswith("weavecell.analysis")
    ]


def kernels_that_import_other_files(root):
    """Kernel files import decorators, `jit` and other kernel files alone, and modules from nothing else of ours."""
    found = []
    for name, path in sources(root).items():
        for module in source_code.imports(path, root) if path.stem.endswith("_kernels") else ():
            file = source_code.file_of(module, root)
            if file is None or file.name in ("__init__.py", "kernel_cache.py") or file.stem.endswith("_kernels"):
                continue
            if file.parent != root / "shellfabric" / "jit":
                found.append(f"{name} imports {module}")
    return found


def solvers_beside_the_driver(root):
    """One time-integration driver: explicit solvers derive from its ExplicitSolver, and it alone calls hooks."""
    found = []
    for name, path in sources(root, ["shellfabric", "validation"]).items():
        if name.startswith("shellfabric/driver/"):
            continue
        text = path.read_text("utf-8")
        found += [
            f"{name} has the solver {own} of its own"
            for own in re.findall(r"^class (\w*Solver)\b(?!\(\w*Solver\))", text, flags=re.MULTILINE)
        ]
        if re.search(r"^\s*for hook in\b", text, flags=re.MULTILINE):
            found.append(f"{name} calls hooks")
    return found


def folders_with_too_many_files(root):
    folders = Counter(str(path.parent.relative_to(root)) for path in sources(root, [*FLOORS, "tests"]).values())
    return [f"{folder} holds {count} files" for folder, count in folders.items() if count > MOST_FILES]


def files_too_long(root):
    counts = {name: len(path.read_text("utf-8").splitlines()) for name, path in sources(root).items()}
    return [f"{name} has {count} lines" for name, count in counts.items() if count > MOST_LINES]


def functions_too_long(root):
    """Functions with their docstrings; decorators do not count."""
    return [
        f"{name}: {node.name} has {node.end_lineno - node.lineno + 1} lines"
        for name, path in sources(root).items()
        for node in ast.walk(ast.parse(path.read_bytes()))
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef))
        and node.end_lineno - node.lineno >= MOST_LINES_OF_A_FUNCTION
    ]


def module_docstrings_too_long(root):
    docstrings = {name: ast.get_docstring(ast.parse(path.read_bytes())) for name, path in sources(root).items()}
    return [
        f"{name}: its docstring has {len(text.splitlines())} lines"
        for name, text in docstrings.items()
        if text and len(text.splitlines()) > MOST_LINES_OF_A_MODULE_DOCSTRING
    ]


def kernels_with_too_many_arguments(root):
    """Positional arguments of the functions of kernel files; arrays that belong together are passed as tuples."""
    return [
        f"{name}: {node.name} has {len(node.args.posonlyargs) + len(node.args.args)} positional arguments"
        for name, path in sources(root).items()
        if path.stem.endswith("_kernels")
        for node in ast.walk(ast.parse(path.read_bytes()))
        if isinstance(node, ast.FunctionDef)
        and len(node.args.posonlyargs) + len(node.args.args) > MOST_ARGUMENTS_OF_A_KERNEL
    ]


def imports_by_computed_names(root):
    return [
        f"{name} imports by a computed name, past the other rules"
        for name, path in sources(root).items()
        if name not in BY_NAME and re.search(r"\b(import_module|resolve_name)\b|__import__", path.read_text("utf-8"))
    ]


def circles(root):
    """Circles of imports among files; those inside functions count, those for annotations alone (TYPE_CHECKING) do not.

    A package's __init__.py is not on the way to it.
    """
    files = {source_code.name_of(path, root): path for path in sources(root).values()}
    graph = {name: set(modules_imported(path, root, files)) - {name} for name, path in files.items()}
    try:
        graphlib.TopologicalSorter(graph).prepare()
    except graphlib.CycleError as problem:
        return [" -> ".join(reversed(problem.args[1]))]
    return []


def modules_imported(path, root, files):
    """Modules of `files` that one imports; `from package import module` is that module, not the package's own file."""
    tree = ast.parse(path.read_bytes())
    tests = [node for node in ast.walk(tree) if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"]
    unused = {id(node) for test in tests for node in test.body}
    for node in ast.walk(tree):
        if id(node) in unused:
            continue
        if isinstance(node, ast.Import):
            yield from (name.name for name in node.names if name.name in files)
        elif isinstance(node, ast.ImportFrom):
            start = path.parents[node.level - 1].relative_to(root).parts if node.level else ()
            module = ".".join([*start, *([node.module] if node.module else [])])
            for name in node.names:
                wanted = [each for each in (f"{module}.{name.name}", module) if each in files]
                yield from wanted[:1]


def colours_of_their_own(root):
    """Pictures take the palette, and with it the colours of warp and weft, from one file."""
    style = root / "meshing" / "pictures_style.py"
    text = style.read_text("utf-8") if style.exists() else ""
    palette = re.findall(r'^[A-Z]+ = "(#[0-9A-F]{6})"', text, re.MULTILINE)
    return [
        f"{name} has a colour of the palette, {colour}, as a number"
        for name, path in sources(root).items()
        for colour in palette
        if path != style and colour in path.read_text("utf-8")
    ]


def versions_of_dolfinx_outside_compat(root):
    return [
        f"{name} looks at a version; unitcell3d/assembly/compat.py alone does"
        for name, path in sources(root, ["unitcell3d"]).items()
        if name != "unitcell3d/assembly/compat.py" and "__version__" in path.read_text("utf-8")
    ]


def kernels_that_are_not_plain(root):
    """Kernel files hold no classes and open no files."""
    found = []
    for name, path in sources(root).items():
        if path.stem.endswith("_kernels"):
            text = path.read_text("utf-8")
            if any(isinstance(node, ast.ClassDef) for node in ast.walk(ast.parse(text))):
                found.append(f"{name} holds a class")
            if "open(" in text:
                found.append(f"{name} opens a file")
    return found


def kernel_arguments_outside_the_cache(root):
    """Named tuples, and whatever else is compiled, that the digest of the kernel cache does not cover."""
    found = []
    kernels = [path for folder in (*WITH_KERNELS, MODELS) for path in (root / folder).rglob("*_kernels.py")]
    covered = {name for path in kernels for name, _ in kernel_sources(path, root)}
    for name, path in sources(root, ["fabrics", "meshing", *WITH_KERNELS, MODELS]).items():
        text = path.read_text("utf-8")
        if name in covered or name == "fabrics/kernel_cache.py":
            continue
        if re.search(r"\bnamedtuple\(|\bNamedTuple\(|^class .*\bNamedTuple\b", text, flags=re.MULTILINE):
            found.append(f"{name} defines a named tuple")
        else:
            used = set(re.findall(r"\bnumba\.(\w+)", re.sub(r'""".*?"""', "", text, flags=re.DOTALL))) - DRIVES
            if used and re.search(r"^\s*import numba", text, flags=re.MULTILINE):
                found.append(f"{name} uses numba.{min(used)}")
    return found


def kernels_outside_the_cache(root):
    """A kernel with a decorator of numba's own would be cached by numba alone."""
    return [
        f"{name} has decorators of numba's own"
        for name, path in sources(root, [*WITH_KERNELS, MODELS]).items()
        if name != DECORATORS and re.search(OWN_DECORATORS, path.read_text("utf-8"), flags=re.MULTILINE)
    ]


def public_functions(body, owner=""):
    """(name, function) of all functions and methods that are not private, nested ones left out."""
    for node in body:
        if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
            yield from public_functions(node.body, f"{node.name}.")
        elif isinstance(node, ast.FunctionDef) and (not node.name.startswith("_") or node.name in CALLED):
            yield owner + node.name, node


def public_functions_without_types(root):
    """Parameters and results without annotation; of kernels and of `jit` numba finds the types itself."""
    found = []
    for name, path in sources(root, TYPED).items():
        if path.stem.endswith("_kernels") or name.startswith("shellfabric/jit/"):
            continue
        for function, node in public_functions(ast.parse(path.read_bytes()).body):
            arguments = node.args
            named = [*arguments.posonlyargs, *arguments.args, arguments.vararg, *arguments.kwonlyargs, arguments.kwarg]
            static = any(isinstance(each, ast.Name) and each.id == "staticmethod" for each in node.decorator_list)
            first = 1 if "." in function and not static else 0
            bare = [each.arg for each in named[first:] if each is not None and each.annotation is None]
            if bare or node.returns is None:
                found.append(f"{name}: {function} has no type for {', '.join(bare) or 'its result'}")
    return found


def same_test_names(root):
    """pytest imports test files by their names alone, and fails to collect the second of one name."""
    found = {}
    for path in sorted((root / "tests").rglob("test_*.py")):
        found.setdefault(path.name, []).append(path.relative_to(root).as_posix())
    return [" and ".join(paths) for paths in found.values() if len(paths) > 1]


RULES = {
    rule.__name__: rule
    for rule in (
        packages_without_a_floor, imports_that_run_upwards, imports_against_the_layers,
        analyses_that_import_the_rest_of_weavecell, kernels_that_import_other_files, folders_with_too_many_files,
        files_too_long, functions_too_long, module_docstrings_too_long, kernels_with_too_many_arguments,
        imports_by_computed_names, circles,
        colours_of_their_own, solvers_beside_the_driver, versions_of_dolfinx_outside_compat,
        kernels_that_are_not_plain, kernel_arguments_outside_the_cache, kernels_outside_the_cache,
        public_functions_without_types, same_test_names,
    )
}  # fmt: skip


@pytest.mark.parametrize("rule", RULES)
def test_the_rule_is_kept(rule):
    assert RULES[rule](ROOT) == []


def test_all_packages_are_built_and_searched():
    include = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["tool"]["setuptools"]["packages"]["find"]
    assert {pattern.rstrip("*") for pattern in include["include"]} == set(FLOORS) == set(source_code.PACKAGES)
    assert len(sources(ROOT)) > 300


CLEAN = {
    "fabrics/__init__.py": "",
    "fabrics/yarn.py": "",
    "meshing/__init__.py": "",
    "meshing/pictures_style.py": 'BLUE = "#0072B2"\n',
    "unitcell3d/__init__.py": "",
    "validation/__init__.py": "",
    "weavecell/__init__.py": "",
    "shellfabric/__init__.py": "",
    "shellfabric/panel/model.py": "from shellfabric.cell import fast_kernels\n",
    "shellfabric/jit/simd.py": "",
    "shellfabric/cell/__init__.py": "",
    "shellfabric/cell/fast_kernels.py": "from shellfabric.jit import simd\n",
    "shellfabric/cell/deep/__init__.py": "",
    "tests/meshing/test_new.py": "",
}
HERE = "shellfabric/cell/deep/new.py"
PLANTED = [
    ("packages_without_a_floor", "analysis/__init__.py", ""),
    ("imports_that_run_upwards", HERE, "import weavecell.commands.impact\n"),
    ("imports_that_run_upwards", HERE, "from ....validation import ledger\n"),
    ("imports_that_run_upwards", HERE, "def f():\n    from unitcell3d import cell\n"),
    ("imports_that_run_upwards", HERE, "import gmsh\n"),
    ("imports_that_run_upwards", "validation/cases/deep.py", "from numba import njit\n"),
    ("imports_that_run_upwards", HERE, "from matplotlib import pyplot\n"),
    ("imports_that_run_upwards", HERE, "from . import pictures_cell\n"),
    ("imports_that_run_upwards", "weavecell/commands/new.py", "from validation.commands import claims\n"),
    ("imports_against_the_layers", HERE, "from shellfabric.panel import model\n"),
    ("imports_against_the_layers", "shellfabric/coupon/new.py", "from shellfabric.impact.new import x\n"),
    ("imports_against_the_layers", "unitcell3d/contact/new.py", "def f():\n    import unitcell3d.solver.newton\n"),
    ("imports_against_the_layers", "shellfabric/elsewhere/new.py", ""),
    ("imports_against_the_layers", "shellfabric/new.py", ""),
    ("imports_against_the_layers", "weavecell/report/new.py", "from weavecell.commands import mesh\n"),
    (
        "analyses_that_import_the_rest_of_weavecell", "weavecell/analysis/deep/new.py",
        "from weavecell.scenes import impact\n",
    ),
    ("kernels_that_import_other_files", "shellfabric/cell/deep/new_kernels.py", "from fabrics import yarn\n"),
    ("kernels_that_import_other_files", "shellfabric/cloth/new_kernels.py", "from shellfabric.panel import model\n"),
    ("kernels_that_import_other_files", "validation/models/net/new_kernels.py", "from fabrics import yarn\n"),
    ("solvers_beside_the_driver", HERE, "class NewSolver:\n    pass\n"),
    ("solvers_beside_the_driver", "validation/models/net/new.py", "class NewSolver:\n    pass\n"),
    ("solvers_beside_the_driver", HERE, "def run(hooks):\n    for hook in hooks:\n        hook()\n"),
    ("files_too_long", HERE, "#\n" * (MOST_LINES + 1)),
    ("module_docstrings_too_long", HERE, '"""A\n' + "B\n" * MOST_LINES_OF_A_MODULE_DOCSTRING + '"""\n'),
    ("functions_too_long", HERE, "class A:\n    def f(self):\n" + "        pass\n" * MOST_LINES_OF_A_FUNCTION),
    (
        "kernels_with_too_many_arguments", "shellfabric/cell/deep/new_kernels.py",
        f"def f({', '.join(f'a{n}' for n in range(MOST_ARGUMENTS_OF_A_KERNEL + 1))}):\n    pass\n",
    ),
    ("imports_by_computed_names", HERE, "import importlib\nimportlib.import_module('weavecell')\n"),
    ("colours_of_their_own", "validation/cases/pictures.py", 'WARP, WEFT = "#D55E00", "#0072B2"\n'),
    ("circles", HERE, "from shellfabric.panel import model\ndef f():\n    from shellfabric.cell.deep import other\n"),
    ("versions_of_dolfinx_outside_compat", "unitcell3d/solver/new.py", "import dolfinx\ndolfinx.__version__\n"),
    ("versions_of_dolfinx_outside_compat", "unitcell3d/solver/compat.py", "import dolfinx\ndolfinx.__version__\n"),
    ("kernels_that_are_not_plain", "shellfabric/cell/deep/new_kernels.py", "class A:\n    pass\n"),
    ("kernels_that_are_not_plain", "shellfabric/cell/deep/new_kernels.py", "open('a')\n"),
    ("kernel_arguments_outside_the_cache", "fabrics/deep/new.py", "Pair = namedtuple('Pair', 'a b')\n"),
    ("kernel_arguments_outside_the_cache", "meshing/new.py", "class Pair(NamedTuple):\n    a: int\n"),
    ("kernel_arguments_outside_the_cache", f"{MODELS}/new.py", "import numba\n@numba.njit\ndef f():\n    pass\n"),
    ("kernel_arguments_outside_the_cache", HERE, "import numba\n@numba.njit\ndef f():\n    pass\n"),
    ("kernels_outside_the_cache", "shellfabric/cell/deep/new_kernels.py", "from numba import njit\n"),
    ("kernels_outside_the_cache", "validation/models/new_kernels.py", "from numba import njit\n"),
    ("kernels_outside_the_cache", "unitcell3d/contact/new_kernels.py", "from numba import njit\n"),
    ("same_test_names", "tests/fabrics/test_new.py", ""),
    ("public_functions_without_types", "meshing/deep/new.py", "def f(a, *, b: int) -> int:\n    return a + b\n"),
    ("public_functions_without_types", "fabrics/new.py", "def f(a: int):\n    return a\n"),
    (
        "public_functions_without_types", "unitcell3d/new.py",
        "class A:\n    def __init__(self, a) -> None:\n        pass\n",
    ),
]  # fmt: skip


@pytest.mark.parametrize(("rule", "file", "text"), PLANTED)
def test_the_rule_finds_a_violation(tmp_path, rule, file, text):
    tree = CLEAN | {"shellfabric/cell/deep/other.py": "from shellfabric.cell.deep import new\n"}
    for name, content in tree.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(content)
    assert RULES[rule](tmp_path) == []
    (tmp_path / file).parent.mkdir(parents=True, exist_ok=True)
    (tmp_path / file).write_text(text)
    problems = RULES[rule](tmp_path)
    assert problems
    assert all(Path(file).stem in problem or Path(file).parent.name in problem for problem in problems)


def test_packages_with_types_are_those_of_mypy():
    assert set(TYPED) == set(tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["tool"]["mypy"]["packages"])


def test_a_crowded_folder_is_found(tmp_path):
    for number in range(MOST_FILES + 1):
        path = tmp_path / "weavecell" / "cli" / f"file{number}.py"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.touch()
    assert folders_with_too_many_files(tmp_path) == [f"weavecell/cli holds {MOST_FILES + 1} files"]


@pytest.mark.parametrize("here", [HERE, f"{MODELS}/net/new.py"])
def test_a_named_tuple_in_a_sub_package_changes_the_digest(tmp_path, here):
    for name, content in CLEAN.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(content)
    file, kernel, found = tmp_path / here, tmp_path / "shellfabric/cell/fast_kernels.py", []
    file.parent.mkdir(parents=True, exist_ok=True)
    for text in (
        "Pair = namedtuple('Pair', 'a b')",
        "Pair = namedtuple('Pair', 'b a')",
        "Pair = namedtuple( 'Pair', 'b a')",
        "names = 'b a'\nPair = namedtuple('Pair', names)",
        "names = 'a b'\nPair = namedtuple('Pair', names)",
    ):
        file.write_text(f"from collections import namedtuple\n{text}\n")
        kernel_cache._tuples.cache_clear()
        found.append(source_code.digest(kernel_sources(kernel, tmp_path)))
    assert found[0] != found[1] == found[2] != found[3] != found[4]
