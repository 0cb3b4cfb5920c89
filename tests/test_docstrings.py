"""References in docstrings and comments name what exists.

A reference stands in backticks. It is looked up in the syntax trees of the packages, without importing them:

- `module`, `folder.module`, `folder.module.name`, `module.Class.member`: each part is in the part before it.
- `Class.member`: a class of the packages has the member, or one of its bases has it.
- `value.member`, where `value` is no module and no class: some class or module of the packages has the member.
- `name`: it stands in the code of the same file, or a file of the packages defines it.
- `folder/file.py`, `page.md`: such a file is in the repository.
- `make target`: the Makefile has it.

What is no reference, such as an expression or a line of an input file, is left alone.
"""

import ast
import builtins
import inspect
import io
import keyword
import os
import re
import tokenize
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PACKAGES = ("fabrics", "meshing", "unitcell3d", "shellfabric", "validation", "weavecell")
IN_BACKTICKS = re.compile(r"`+([^`\n]+)`+")
COMMENT_WITH_REFERENCE = re.compile(r"#[^\n]*`")
RESULTS = Path("results")  # what is computed here is no part of the repository
DOTTED = re.compile(r"[A-Za-z_]\w*(\.[A-Za-z_]\w*)*(\(\))?")
SOURCE_FILE = re.compile(r"[\w./-]+\.(py|md|toml|csv|sh|ipynb)")
# files that users write and runs make
USERS_FILES = (
    ".toml",
    ".csv",
    ".json",
    ".h5",
    ".vtu",
    ".png",
    ".html",
    ".k",
    ".inp",
    ".geo",
    ".msh",
)
# "`SHAPES` of `shellfabric/projectile/shapes.py`"
NAME_OF_FILE = re.compile(
    r"`(\w+)`\s+(?:of|in)\s+`((?:fabrics|meshing|unitcell3d|shellfabric|validation|weavecell)/[\w/]+\.py)`"
)
MAKE = re.compile(r"make ([a-z-]+)")
DEFINITIONS = (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)


class Index:
    """Names that the packages define, found in their syntax trees."""

    def __init__(self, root):
        self.root = root
        self.trees = {}  # path: tree
        self.modules = {}  # dotted name of a module or folder: names in it
        self.defined = {}  # dotted name of a module: names that it defines, without imports
        self.classes = {}  # name of a class: [(its members, names of its bases)]
        self.members = set()  # names that any class, module or table defines
        self.libraries = set()  # names that come from other libraries
        self.files = set()  # paths of the repository's files
        for package in PACKAGES:
            for path in sorted((root / package).rglob("*.py")):
                self._add_module(path)
            for path in sorted((root / package).rglob("*.toml")):
                text = path.read_text("utf-8")
                self.members |= set(re.findall(r"^([A-Za-z_]\w*) *=", text, re.MULTILINE))
                for table in re.findall(r"^\[+([^]]+)\]", text, re.MULTILINE):
                    self.members |= set(table.split("."))
        for path in (root / "tests", root / "tools", root / "benchmarks"):
            for file in path.rglob("*.py"):
                self._add_name(file.relative_to(root).with_suffix("").parts, {"*"})
        for folder, folders, files in os.walk(root):
            place = Path(folder).relative_to(root)
            folders[:] = [
                name
                for name in folders
                if name[0] != "." and name != "node_modules" and place / name != RESULTS
            ]
            self.files |= {(place / name).as_posix() for name in folders + files}
        makefile = root / "Makefile"
        text = makefile.read_text("utf-8") if makefile.exists() else ""
        self.targets = set(re.findall(r"^([a-z-]+):", text, re.MULTILINE))

    def _add_module(self, path):
        tree = ast.parse(path.read_text("utf-8"))
        self.trees[path] = tree
        parts = path.relative_to(self.root).with_suffix("").parts
        if parts[-1] == "__init__":
            parts = parts[:-1]
        names = assigned(tree)
        self._add_name(parts, names)
        own = [node for node in tree.body if not isinstance(node, (ast.Import, ast.ImportFrom))]
        self.defined[".".join(parts)] = assigned(ast.Module(own, []))
        self.members |= names
        for node in ast.walk(tree):
            if isinstance(node, (ast.Import, ast.ImportFrom)):
                self._add_libraries(node)
            elif isinstance(node, ast.ClassDef):
                members = assigned(node) | attributes_of_self(node)
                bases = [ast.unparse(base).split(".")[-1] for base in node.bases]
                self.classes.setdefault(node.name, []).append((members, bases))
                self.members |= members | {node.name}
            elif isinstance(node, DEFINITIONS):
                self.members.add(node.name)
            elif isinstance(node, ast.Dict):
                self.members |= {key.value for key in node.keys if isinstance(key, ast.Constant)}

    def _add_libraries(self, node):
        module = getattr(node, "module", None)
        for alias in node.names:
            root = (module or alias.name).split(".")[0]
            if root not in PACKAGES:
                self.libraries |= {root, (alias.asname or alias.name).split(".")[0]}

    def _add_name(self, parts, names):
        self.modules.setdefault(".".join(parts), set()).update(names)
        if len(parts) > 1:
            self.modules.setdefault(".".join(parts[:-1]), set()).add(parts[-1])
            self._add_name(parts[:-1], set())

    @cache  # noqa: B019
    def modules_called(self, name):
        """Modules whose dotted name is `name`, or ends with it."""
        return [full for full in self.modules if f".{full}".endswith(f".{name}")]

    def class_has(self, name, member):
        """Tell whether a class has a member, itself or by a base of the packages."""
        for members, bases in self.classes.get(name, ()):
            if member in members or "__getattr__" in members:
                return True
            for base in bases:
                if base in self.classes and self.class_has(base, member):
                    return True
                if base not in self.classes and base not in ("object", "Protocol", "ABC"):
                    return True  # a class of another library: its members are not known here
        return False


def assigned(node):
    """Collect the names that the body of a module or a class defines, imports included."""
    names = set()
    for child in node.body:
        names |= names_of_statement(child)
    return names


def names_of_statement(node):
    """Collect the names that one statement defines; those of `if`, `try`, `with` and loops too."""
    if isinstance(node, DEFINITIONS):
        return {node.name}
    if isinstance(node, (ast.Import, ast.ImportFrom)):
        return {(alias.asname or alias.name).split(".")[0] for alias in node.names}
    if isinstance(node, (ast.Assign, ast.AnnAssign, ast.AugAssign)):
        targets = node.targets if isinstance(node, ast.Assign) else [node.target]
        return {
            part.id for target in targets for part in ast.walk(target) if isinstance(part, ast.Name)
        }
    names = set()
    for block in ("body", "orelse", "finalbody"):
        for child in getattr(node, block, ()):
            names |= names_of_statement(child)
    for handler in getattr(node, "handlers", ()):
        names |= assigned(handler)
    return names


def attributes_of_self(node):
    """Collect the names that methods of a class assign to `self`."""
    return {
        part.attr
        for part in ast.walk(node)
        if isinstance(part, ast.Attribute)
        and isinstance(part.ctx, ast.Store)
        and isinstance(part.value, ast.Name)
        and part.value.id == "self"
    }


def names_in_code(tree):
    """Collect every name of a file's code: variables, arguments, attributes, keywords, short strings."""
    names = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Name):
            names.add(node.id)
        elif isinstance(node, (ast.arg, ast.keyword)):
            names.add(node.arg)
        elif isinstance(node, ast.Attribute):
            names.add(node.attr)
        elif isinstance(node, DEFINITIONS):
            names.add(node.name)
        elif isinstance(node, ast.alias):
            names.update((node.asname or node.name).split("."))
        elif isinstance(node, ast.Constant) and is_short_text(node.value):
            names.update(re.findall(r"[A-Za-z_]\w*", node.value))
    return names


def is_short_text(value):
    """Tell whether a constant is a text that may be a name or two: a key, a column, a choice."""
    return isinstance(value, str) and len(value) < 40 and "`" not in value


def names_in_displays(text):
    """Collect the names in indented lines of a docstring: equations and code that it shows."""
    displays = re.findall(r"^ {4,}.*$", text, re.MULTILINE)
    return set(
        re.findall(r"[A-Za-z_]\w*", " ".join(re.sub("`[^`]*`", "", one) for one in displays))
    )


def texts(path, tree):
    """Yield (line, text) of each docstring, comment and text in a file."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and "`" in node.value:
            yield node.lineno, node.value
    whole = path.read_text("utf-8")
    # to read a file token by token takes ten times as long as to parse it
    if not COMMENT_WITH_REFERENCE.search(whole):
        return
    for token in tokenize.generate_tokens(io.StringIO(whole).readline):
        if token.type == tokenize.COMMENT:
            yield token.start[0], token.string


def exists(index, reference, code):
    """Tell whether a reference names something; `code` has the names of its own file's code."""
    target = MAKE.fullmatch(reference)
    if target:
        return target[1] in index.targets
    if SOURCE_FILE.fullmatch(reference) and not DOTTED.fullmatch(reference):
        return file_exists(index, reference)
    if not DOTTED.fullmatch(reference):
        return True
    if reference.endswith((".py", ".md", ".ipynb")):
        return file_exists(index, reference)
    if reference.endswith(USERS_FILES):
        return True
    parts = reference.removesuffix("()").split(".")
    if len(parts) == 1:
        return (
            parts[0] in code
            or parts[0] in index.members
            or bool(index.modules_called(parts[0]))
            or hasattr(builtins, parts[0])
            or keyword.iskeyword(parts[0])
        )
    return dotted_exists(index, parts)


def file_exists(index, name):
    """Tell whether a file of the repository has this path, or a path that ends with it."""
    name = name.removeprefix("./")
    if "/" in name and not (index.root / name.split("/")[0]).exists() and not name.endswith(".py"):
        return True  # a file of the user's
    return any(f"/{one}".endswith(f"/{name}") for one in index.files)


def dotted_exists(index, parts):
    """Tell whether `module.name`, `Class.member` or `value.member` names something."""
    for length in range(len(parts), 0, -1):
        found = index.modules_called(".".join(parts[:length]))
        if not found:
            continue
        rest = parts[length:]
        if not rest:
            return True
        for module in found:
            names = index.modules[module]
            if "*" in names or rest[0] in names:
                return len(rest) == 1 or rest[0] not in index.classes or index.class_has(*rest[:2])
        if length > 1 or parts[0].endswith("_kernels") or parts[0] in PACKAGES:
            return False
    if parts[0] in index.classes:
        return index.class_has(parts[0], parts[1])
    if parts[0] in index.libraries or hasattr(builtins, parts[0]):
        return True
    return all(part in index.members for part in parts[1:])


def dead_references(index):
    """Yield "file:line `reference`" of each reference of the packages that names nothing."""
    root = index.root
    for path, tree in index.trees.items():
        code = names_in_code(tree)
        for line, text in texts(path, tree):
            shown = names_in_displays(text)
            for reference in IN_BACKTICKS.findall(text):
                if not exists(index, reference, code | shown):
                    yield f"{path.relative_to(root)}:{line} `{reference}`"


def pages(root):
    """Yield (path, text) of README, CONTRIBUTING and the pages of the documentation."""
    for path in (root / "README.md", root / "CONTRIBUTING.md", *sorted(root.glob("docs/**/*.md"))):
        if path.exists() and "generated" not in path.parts:
            yield path, path.read_text("utf-8")


def dead_references_of_pages(index):
    """Yield "file:line `reference`" of each file, and each name of a file, that is not there.

    Pages quote keys, columns and commands in backticks too. Looked up are dotted names that begin
    with a package, files of the packages, and names written as "`NAME` of `folder/file.py`".
    """
    root = index.root
    for path, text in pages(root):
        for found in IN_BACKTICKS.finditer(text):
            reference = found[1]
            ours = reference.split(".")[0].split("/")[0] in PACKAGES
            dotted = DOTTED.fullmatch(reference) and "." in reference
            source = SOURCE_FILE.fullmatch(reference) and reference.endswith(".py")
            if ours and (dotted or source) and not exists(index, reference, set()):
                yield place_on_page(root, path, text, found, reference)
        for found in NAME_OF_FILE.finditer(text):
            name, file = found.groups()
            module = ".".join(Path(file).with_suffix("").parts)
            if name not in index.defined.get(module, ()):
                yield place_on_page(root, path, text, found, f"{name} of {file}")


def place_on_page(root, path, text, found, reference):
    """Write "file:line `reference`" for a match on a page."""
    line = text.count("\n", 0, found.start()) + 1
    return f"{path.relative_to(root)}:{line} `{reference}`"


@pytest.fixture(scope="module")
def house():
    """Return the Index of this repository."""
    return Index(ROOT)


def test_references_name_what_exists(house):
    assert sorted(dead_references(house)) == []


def test_pages_name_files_and_functions_that_exist(house):
    assert sorted(dead_references_of_pages(house)) == []


@pytest.fixture(scope="module")
def small_house(tmp_path_factory):
    """Write a package with a module, a class, a kernel file, a folder and a Makefile."""
    root = tmp_path_factory.mktemp("house")
    folder = root / "shellfabric" / "membrane"
    folder.mkdir(parents=True)
    (root / "Makefile").write_text("lint:\n\ttrue\n")
    (root / "shellfabric" / "__init__.py").write_text("")
    (folder / "__init__.py").write_text("")
    (folder / "yarn_kernels.py").write_text(
        "import numpy as np\n\ndef pull_yarns(u):\n    return u\n"
    )
    (folder / "panel.py").write_text(
        "class Base:\n    width: float\n\n"
        "class Panel(Base):\n    def mesh(self):\n        self.sides = 2\n\n"
        "class Grid:\n    kept: int\n"
    )
    (root / "docs").mkdir()
    return root


ALIVE = [
    "pull_yarns", "yarn_kernels", "membrane.yarn_kernels", "yarn_kernels.pull_yarns",
    "shellfabric.membrane.panel.Panel",
    "Panel.mesh", "Panel.width", "Panel.sides", "panel.Panel.mesh", "state.sides", "np.linalg.solve", "mesh()",
    "membrane/panel.py", "make lint", "x * y + 1", "local", "print", "not", "folder/of/a/user.toml",
]  # fmt: skip
DEAD = [
    "pull_yarn", "yarns_kernels", "membrane.grid", "yarn_kernels.difference", "shellfabric.membrane.panel.Plate",
    "Panel.meshed", "Grid.width", "Base.sides", "panel.Panel.kept", "state.counter", "lapack.solve", "meshes()",
    "membrane/plates.py", "make nothing", "shellfabric.loop", "panel.model.Numerics", "shellfabric/gone.toml",
]  # fmt: skip


@pytest.mark.parametrize("written", ["docstring", "comment", "message"])
@pytest.mark.parametrize(
    ("reference", "dead"), [(one, 0) for one in ALIVE] + [(one, 1) for one in DEAD]
)
def test_planted_references_are_found_if_they_name_nothing(small_house, reference, dead, written):
    text = f"as `{reference}` has it"
    lines = {
        "docstring": f'"""Solve\n{text}."""\nlocal = 1\n',
        "comment": f"local = 1  # {text}\n",
        "message": f'local = 1\nraise ValueError("{text}")\n',
    }
    (small_house / "shellfabric" / "planted.py").write_text(lines[written])
    found = list(dead_references(Index(small_house)))
    assert len(found) == dead
    if dead:
        assert found[0].startswith("shellfabric/planted.py:")
        assert found[0].endswith(f"`{reference}`")


@pytest.mark.parametrize(
    ("docstring", "verb"),
    [
        ("Compute the force [N].", True),
        ("Number the nodes.", True),
        ("Solve.", True),
        ("Number of nodes.", False),
        ("The force [N].", False),
        ("[N] of the nose.", False),
        ("Number, from 1, of the yarn.", False),
        ("`load` of eight points.", False),
        ("", False),
    ],
)
def test_first_words_that_are_verbs_are_told_from_nouns(tool, docstring, verb):
    assert tool("docstrings").begins_with_a_verb(docstring) is verb


def test_public_functions_without_a_verb_are_reported_properties_and_private_ones_are_not(
    tool, tmp_path
):
    folder = tmp_path / "fabrics"
    folder.mkdir()
    (folder / "membrane.py").write_text(
        'def force(u):\n    """The force."""\n\n'
        'def _inner(u):\n    """The same."""\n\n'
        "class Yarn:\n"
        '    @property\n    def mass(self):\n        """[kg]"""\n\n'
        '    def stress(self):\n        """Compute the stress."""\n\n'
        "    def strain(self):\n        return 0\n"
    )
    found = tool("docstrings").without_verb(tmp_path)
    assert found == ["fabrics/membrane.py:1 force", "fabrics/membrane.py:15 Yarn.strain"]


# heads of modules that are longer than 12 lines, whose theory is still to move: no new ones
LONG_HEADS = """
fabrics/base/tables.py
fabrics/data_sheet.py
unitcell3d/assembly/constraints.py
unitcell3d/model/periodic_cell.py
weavecell/runs/go_no_go.py
weavecell/runs/plies.py
weavecell/scenes/fabric_file.py
"""


def test_heads_of_modules_have_twelve_lines_at_most(tool):
    assert set(tool("docstrings").long_heads()) <= set(LONG_HEADS.split())


def test_a_long_head_is_counted(tool, tmp_path):
    (tmp_path / "fabrics").mkdir()
    (tmp_path / "fabrics" / "short.py").write_text('"""' + "line\n" * 12 + '"""\n')
    (tmp_path / "fabrics" / "long.py").write_text('"""' + "line\n" * 13 + '"""\n')
    assert tool("docstrings").long_heads(tmp_path) == {"fabrics/long.py": 13}


@pytest.mark.parametrize(
    ("text", "dead"),
    [
        ("`pull_yarns` of `shellfabric/membrane/yarn_kernels.py`", 0),
        ("`push_yarns` of `shellfabric/membrane/yarn_kernels.py`", 1),
        ("`Panel` in\n  `shellfabric/membrane/panel.py`", 0),
        ("`Plate` in\n  `shellfabric/membrane/panel.py`", 1),
        ("`shellfabric/membrane/gone.py`", 1),
        ("`shellfabric.membrane.panel.Panel.mesh` and `shellfabric.state`", 1),
        ("`projectile.shape` of an input file, `my.toml`, `panel --mesh`", 0),
    ],
)
def test_planted_references_of_pages_are_found_if_they_name_nothing(small_house, text, dead):
    (small_house / "CONTRIBUTING.md").write_text(f"# Add\n\n- {text}\n")
    assert len(list(dead_references_of_pages(Index(small_house)))) == dead


def test_docstrings_of_public_functions_explain_their_parameters_and_no_others(tool):
    """As numpydoc asks for when the site is built: `*results` has its star."""
    python_page = tool("python_page")
    found, expected = {}, {}
    for name, function in python_page.functions().items():
        stars = {inspect.Parameter.VAR_POSITIONAL: "*", inspect.Parameter.VAR_KEYWORD: "**"}
        parameters = inspect.signature(function).parameters.values()
        expected[name] = [stars.get(one.kind, "") + one.name for one in parameters]
        found[name] = python_page.documented(function)
    assert found == expected
    assert "**options" in found["impact"]
    assert "impact" in python_page.passing_on()


def test_the_python_page_leaves_no_public_function_out(tool, monkeypatch):
    python_page = tool("python_page")
    assert "## Others" not in python_page.page()
    shots = [name for name in python_page.SECTIONS["Shots"] if name != "impact"]
    monkeypatch.setitem(python_page.SECTIONS, "Shots", tuple(shots))
    assert "## Others\n\n### impact\n" in python_page.page()
