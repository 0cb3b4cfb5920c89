"""Packages that not every installation has: what to install where one is missing.

The metadata of weavecell (pyproject.toml) tell which extra brings a package; the packages of the 3D
part come from the system.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from importlib import metadata, util

from fabrics.base.errors import WeavecellError

_OF_3D_PART = ("dolfinx", "petsc4py", "mpi4py", "ufl", "basix", "gmsh", "meshio")
_3D_PART = (
    "the 3D part needs: apt install python3-dolfinx python3-petsc4py python3-gmsh python3-meshio "
    "(Debian), or conda-forge's fenics-dolfinx, python-gmsh, meshio"
)
# packages that are imported under another name than they are installed
_INSTALLED_AS = {"vtkmodules": "vtk"}
_ENTRY = re.compile(r"([\w-]+).*;\s*extra\s*==\s*['\"](\w+)['\"]")


class MissingPackage(WeavecellError, ModuleNotFoundError):
    """A package that is not installed, with what to install.

    Parameters
    ----------
    package : as it is imported
    """

    def __init__(self, package: str) -> None:
        line = f"this needs the Python package {package}, which is not installed"
        if to_install := how_to_install(package):
            line += f"; {to_install}"
        super().__init__(line)
        self.package = package
        self.name = package

    # exceptions come back from worker processes pickled
    def __reduce__(self) -> tuple[type, tuple[str]]:
        return MissingPackage, (self.package,)


@cache
def _extras():
    """{package in lower case: the first extra of weavecell that brings it}."""
    found: dict[str, str] = {}
    try:
        entries = metadata.requires("weavecell") or []
    except metadata.PackageNotFoundError:
        # run from its folder, without being installed
        return found
    for entry in entries:
        if row := _ENTRY.match(entry):
            found.setdefault(row[1].lower(), row[2])
    return found


def how_to_install(package: str) -> str:
    """Return the command that installs a missing package; "" if weavecell needs none of its name."""
    top = package.partition(".")[0]
    if top in _OF_3D_PART:
        return _3D_PART
    extra = _extras().get(_INSTALLED_AS.get(top, top).lower())
    if extra is None:
        return ""
    return f'pip install "weavecell[{extra}]"'


def find_missing(*packages: str) -> str | None:
    """Return the first of some packages that is not installed; None if all are."""
    for package in packages:
        try:
            there = util.find_spec(package) is not None
        except ValueError:
            # a module without a spec is none that was installed
            there = False
        if not there:
            return package
    return None


@contextmanager
def explain_missing() -> Iterator[None]:
    """Name what to install where an import in this block, or in the function that this decorates,
    finds no package.

    Raises
    ------
    MissingPackage
    """
    try:
        yield
    except MissingPackage:
        raise
    except ModuleNotFoundError as problem:
        raise MissingPackage(problem.name or str(problem)) from None
