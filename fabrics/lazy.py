"""Imports that wait for their first use: public names of a package, and modules of a command.

Help and completion must not wait for numpy, a solver or a plotter. Imports stay where readers and tools look for them.
"""

from __future__ import annotations

import importlib
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from importlib.util import LazyLoader
from pathlib import Path
from typing import Any


def public(package: str, file: str) -> tuple[Callable[[str], Any], Callable[[], list[str]]]:
    """(__getattr__, __dir__) of a package, whose stub `__init__.pyi` says which module each public name is from.

    The stub, which type checkers read too, has `from a.b import C` for each name; `__all__` are these. They are for
    callers alone: no module of ours takes them from the package, so that no digest of code follows them.

    Parameters
    ----------
    package, file : __name__ and __file__ of the package
    """

    @cache
    def places():
        import ast

        tree = ast.parse(Path(file).with_suffix(".pyi").read_text("utf-8"))
        lines = [line for line in tree.body if isinstance(line, ast.ImportFrom)]
        return {one.asname or one.name: (line.module, one.name) for line in lines for one in line.names}

    def get(name):
        if name == "__all__":
            return sorted(places())
        if name not in places():
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        module, own = places()[name]
        return getattr(importlib.import_module(module), own)

    return get, lambda: sorted({*vars(sys.modules[package]), *places()})


@contextmanager
def imports() -> Iterator[None]:
    """Within it, `import a.b` and `from a import b` give a module that is loaded when an attribute of it is first used.

    For modules alone: a function or class that is imported by its name loads its module at once.
    """
    finder = _Lazy()
    sys.meta_path.insert(0, finder)
    try:
        yield
    finally:
        sys.meta_path.remove(finder)


class _Lazy:
    """Finds what the other finders find, and puts off its execution."""

    def find_spec(self, name, path, target=None):
        for finder in sys.meta_path:
            spec = None if isinstance(finder, _Lazy) else finder.find_spec(name, path, target)
            if spec is not None:
                if hasattr(spec.loader, "exec_module"):
                    spec.loader = LazyLoader(spec.loader)
                return spec
        return None
