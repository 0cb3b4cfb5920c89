"""The Python interface: what `import weavecell` offers.

`__init__.pyi` lists the public names. A module is loaded when one of its names is first used: a list
of fabrics waits for no solver.
"""

import ast
from importlib import import_module
from pathlib import Path
from typing import Any


def _read_public():
    """{public name: module that holds it}."""
    stub = ast.parse(Path(__file__).with_suffix(".pyi").read_text("utf-8"))
    holders = {}
    for node in stub.body:
        if isinstance(node, ast.ImportFrom):
            holders |= {entry.name: node.module for entry in node.names}
    return holders


_HOLDERS = _read_public()


def __getattr__(name: str) -> Any:
    """Return a public name; its module is loaded for it."""
    if name not in _HOLDERS:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    if _HOLDERS[name] == __name__:
        return import_module(f"{__name__}.{name}")
    value = getattr(import_module(_HOLDERS[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(_HOLDERS)


def read_docstring(name: str) -> str:
    """Read the docstring of a public function from the source of its module, which is not loaded."""
    *_, module = _HOLDERS[name].rpartition(".")
    source = Path(__file__).with_name(f"{module}.py").read_text("utf-8")
    for node in ast.parse(source).body:
        if isinstance(node, ast.FunctionDef) and node.name == name:
            return ast.get_docstring(node) or ""
    raise LookupError(f"{name} is no function of {_HOLDERS[name]}")
