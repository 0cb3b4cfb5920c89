"""Which of our source files a piece of the program consists of: the closure of its imports, and a digest of them.

Imports are read from the syntax of the files, without running them; those inside functions count. Compiled kernels
(`kernel_cache`) and kept results (`run_cache`) are named after such a digest, so that neither outlives the code that
made it.

Parsing all files that a solver consists of takes far longer than reading them. What the syntax of a file says is kept
in one JSON file beside the byte code of this package, under the digest of the content that it was found in, so that it
cannot be out of date. Where that file cannot be read or written, everything is parsed.
"""

from __future__ import annotations

import ast
import atexit
import hashlib
import json
import os
import re
import sys
import tempfile
from collections.abc import Callable, Container, Iterable, Iterator
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any

PACKAGES = ("fabrics", "meshing", "unitcell3d", "shellfabric", "validation", "weavecell")
ROOT = Path(__file__).parents[1]
DATA = (".toml", ".json", ".csv")
_VERSION = 1  # of what is kept of parsed files; a change of `_statements` or `_tuple_definitions` counts it up
_MOST = 4000  # results that are kept
_FILE = Path(__file__).parent / "__pycache__" / f"parsed-sources-{_VERSION}-{sys.implementation.cache_tag}.json"
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
    for always, level, module, names in _parsed("imports", file.read_bytes(), _statements):
        if not (lazy or always):
            continue
        if names is None:
            yield module
            continue
        start = file.parents[level - 1].relative_to(root).parts if level else ()
        whole = ".".join([*start, *([module] if module else [])])
        yield whole
        yield from (f"{whole}.{name}" for name in names)
        if lazy and whole == "importlib" and "import_module" in names:
            yield from (name_of(each, root) for each in sorted(file.parent.rglob("*.py")))


def _statements(tree):
    """[(whether it is outside of functions, level, module, names imported from it or None)] of the imports."""
    found: list = []

    def walk(node, always):
        for child in ast.iter_child_nodes(node):
            if isinstance(child, ast.Import):
                found.extend([always, 0, name.name, None] for name in child.names)
            elif isinstance(child, ast.ImportFrom):
                found.append([always, child.level, child.module, [name.name for name in child.names]])
            elif not isinstance(child, ast.expr):
                walk(child, always and not isinstance(child, (ast.FunctionDef, ast.AsyncFunctionDef)))

    walk(tree, True)
    return found


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
    known: dict[str, Path | None] = {}  # files by module, which are looked up once each
    while waiting:
        parts = waiting.pop().split(".")
        if parts[0] not in packages:
            continue
        for n in range(1, len(parts) + 1):
            module = ".".join(parts[:n])
            if module not in known:
                known[module] = file_of(module, root)
                if (file := known[module]) is not None:
                    found.add(file)
                    waiting += [] if file in ends else imports(file, root)
            if (file := known[module]) is not None and file.name != "__init__.py":
                break  # what follows is in the file
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
    found = _parsed("named tuples", content, _tuple_definitions)
    return content if found is None else found.encode()


def _tuple_definitions(tree):
    """The definitions of named tuples as text; None where the rest of the file may matter."""
    found = []
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and any(_named(name.name) and name.asname for name in node.names):
            return None
        if isinstance(node, ast.ClassDef) and any(_named(_last(base)) for base in node.bases):
            found.append(ast.dump(node))
        elif isinstance(node, ast.Call) and _named(_last(node.func)):
            if not all(_literal(part) for part in (*node.args, *(word.value for word in node.keywords))):
                return None
            found.append(ast.dump(node))
    return "\n".join(found)


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


@cache
def _kept() -> dict[str, Any]:
    """{digest: result}, which this process adds to and writes when it ends."""
    atexit.register(_write, *_state())
    with suppress(OSError, ValueError):
        found = json.loads(_FILE.read_text("utf-8"))
        if isinstance(found, dict):
            return found
    return {}


@cache
def _state() -> tuple[set[str], set[str]]:
    """Digests of the results that this process has used, and of those that it has added."""
    return set(), set()


def _parsed(kind: str, content: bytes, find: Callable[[ast.AST], Any]) -> Any:
    """find(syntax tree of a file's content), or what it has found before.

    Parameters
    ----------
    kind : names the function
    content : of the file
    find : its result is made of lists, texts, numbers and None
    """
    digest = hashlib.sha256(kind.encode() + b"\0" + content).hexdigest()[:32]
    kept, (used, added) = _kept(), _state()
    used.add(digest)
    if digest not in kept:
        kept[digest] = find(ast.parse(content))
        added.add(digest)
    return kept[digest]


def _write(used, added):
    """Write the file, whole or not at all; the results used last are those that are kept where there are too many."""
    if not added or sys.dont_write_bytecode:
        return
    kept = _kept()
    if len(kept) > _MOST:
        kept = {digest: kept[digest] for digest in used}
    with suppress(OSError):
        _FILE.parent.mkdir(exist_ok=True)
        handle, name = tempfile.mkstemp(dir=_FILE.parent, prefix=".parsed-")
        try:
            with os.fdopen(handle, "w", encoding="utf-8") as file:
                json.dump(kept, file)
            os.replace(name, _FILE)
        except OSError:
            os.unlink(name)
