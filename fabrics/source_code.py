"""Which of our source files a piece of the program consists of: the closure of its imports, and a digest of them.

Imports are read from the syntax of the files, without running them; those inside functions count. Compiled kernels
(`kernel_cache`) and kept results (`run_cache`) are named after such a digest, so that neither outlives the code that
made it.
"""

from __future__ import annotations

import ast
import hashlib
import re
from collections.abc import Container, Iterable, Iterator
from pathlib import Path

PACKAGES = ("fabrics", "meshing", "unitcell3d", "shellfabric", "validation", "weavecell")
ROOT = Path(__file__).parents[1]
DATA = (".toml", ".json", ".csv")
_READS = ("resources.files(", "__file__")  # how a module finds data that lie in its package
_NAMED = re.compile(r'resources\.files\("([\w.]+)"\)')


def file_of(module: str, root: Path = ROOT) -> Path | None:
    """File of a module by its dotted name, or None where it is none of the folder `root`."""
    path = root.joinpath(*module.split("."))
    for file in (path / "__init__.py", path.with_suffix(".py")):
        if file.is_file():
            return file
    return None


def name_of(file: Path, root: Path = ROOT) -> str:
    """Dotted name of the module in a file."""
    parts = file.relative_to(root).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def imports(file: Path, root: Path = ROOT, lazy: bool = True) -> Iterator[str]:
    """Dotted names that a file imports; of `from a import b` both a and a.b.

    A relative import is given by its full name. A module that imports by computed names (`importlib.import_module`)
    counts as importing all modules of its own package.

    Parameters
    ----------
    lazy : whether imports inside functions count
    """
    for node in _nodes(ast.parse(file.read_bytes()), lazy):
        if isinstance(node, ast.Import):
            yield from (name.name for name in node.names)
        elif isinstance(node, ast.ImportFrom):
            start = file.parents[node.level - 1].relative_to(root).parts if node.level else ()
            module = ".".join([*start, *([node.module] if node.module else [])])
            yield module
            yield from (f"{module}.{name.name}" for name in node.names)
            if lazy and module == "importlib" and any(name.name == "import_module" for name in node.names):
                yield from (name_of(each, root) for each in sorted(file.parent.rglob("*.py")))


def _nodes(node, lazy):
    for child in ast.iter_child_nodes(node):
        if lazy or not isinstance(child, (ast.FunctionDef, ast.AsyncFunctionDef)):
            yield child
            yield from _nodes(child, lazy)


def closure(
    modules: Iterable[str], root: Path = ROOT, packages: Container[str] = PACKAGES, ends: Container[Path] = ()
) -> list[Path]:
    """Files of the modules and of all that they import from `packages`, directly or not, sorted.

    The `__init__.py` of every package on the way counts, since importing a module runs it. Of the files `ends` the
    imports are not followed.

    Raises
    ------
    ModuleNotFoundError : one of `modules` is not in the folder `root`
    """
    for module in modules:
        if file_of(module, root) is None:
            raise ModuleNotFoundError(f"no module {module!r} in {root}", name=module)
    found, waiting = set(), list(modules)
    while waiting:
        parts = waiting.pop().split(".")
        if parts[0] not in packages:
            continue
        for n in range(1, len(parts) + 1):
            file = file_of(".".join(parts[:n]), root)
            if file is not None and file not in found:
                found.add(file)
                waiting += [] if file in ends else imports(file, root)
    return sorted(found)


def data_of(files: Iterable[Path], root: Path = ROOT) -> list[Path]:
    """Data files (*.toml, *.json, *.csv) that files can read from packages, sorted.

    All of a package's folder (without its sub-folders) count where one of the files of this package, or of another by
    `resources.files("package")`, reads data from it.
    """
    folders = set()
    for file in files:
        text = file.read_text("utf-8")
        if any(way in text for way in _READS):
            folders.add(file.parent)
            folders |= {root.joinpath(*name.split(".")) for name in _NAMED.findall(text)}
    return sorted({path for folder in folders for path in folder.glob("*") if path.suffix in DATA})


def named_tuples(file: Path) -> bytes:
    """Definitions of the named tuples of a file, as bytes without the layout of the text; empty if there are none.

    A definition with fields that are not literals depends on the rest of the file: then it is the whole file.
    """
    content = file.read_bytes()
    if b"amedtuple" not in content and b"NamedTuple" not in content:
        return b""
    found = []
    for node in ast.walk(ast.parse(content)):
        if isinstance(node, ast.ImportFrom) and any(_named(name.name) and name.asname for name in node.names):
            return content
        if isinstance(node, ast.ClassDef) and any(_named(_last(base)) for base in node.bases):
            found.append(ast.dump(node))
        elif isinstance(node, ast.Call) and _named(_last(node.func)):
            if not all(_literal(part) for part in (*node.args, *(word.value for word in node.keywords))):
                return content
            found.append(ast.dump(node))
    return "\n".join(found).encode()


def _named(name):
    return name in ("namedtuple", "NamedTuple")


def _last(node):
    return node.attr if isinstance(node, ast.Attribute) else getattr(node, "id", None)


def _literal(node):
    try:
        ast.literal_eval(node)
    except ValueError:
        return False
    return True


def digest(parts: Iterable[tuple[str, bytes]]) -> str:
    """Hexadecimal SHA-256 of pairs (name, bytes)."""
    found = hashlib.sha256()
    for name, content in parts:
        found.update(f"{name}\0{len(content)}\0".encode() + content)
    return found.hexdigest()
