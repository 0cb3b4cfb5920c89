"""The rules of the house that a machine can hold: which package may import what."""

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
FLOORS = {"fabrics": 0, "meshing": 1, "unitcell3d": 2, "shellfabric": 2, "validation": 3, "weavecell": 4}
ONLY_IN = {
    "gmsh": ("meshing/",),
    "meshio": ("meshing/",),
    "dolfinx": ("unitcell3d/",),
    "petsc4py": ("unitcell3d/",),
    "numba": ("shellfabric/", "unitcell3d/", "fabrics/kernel_cache.py"),
}
PICTURES = {"pyvista", "matplotlib", "vtk"}
FILES = sorted(path for package in FLOORS for path in (ROOT / package).rglob("*.py"))


def imported(path):
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            yield from (name.name for name in node.names)
        elif isinstance(node, ast.ImportFrom) and node.level == 0:
            yield node.module


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(ROOT)))
def test_imports_run_downwards(path):
    name = str(path.relative_to(ROOT))
    package = name.split("/")[0]
    for module in imported(path):
        top = module.split(".")[0]
        if top in FLOORS and top != package:
            assert FLOORS[top] < FLOORS[package], f"{name} imports {module}"
        if top in ONLY_IN:
            assert name.startswith(ONLY_IN[top]), f"{name} imports {module}"
        if top in PICTURES and package in ("fabrics", "meshing", "unitcell3d", "shellfabric"):
            assert path.stem.startswith("pictures"), f"{name} imports {module}: pictures live in files of their own"
        if module.split(".")[-1].startswith("pictures") and package in ("unitcell3d", "shellfabric"):
            assert path.stem.startswith("pictures"), f"{name}: no solver imports a picture file"


def test_only_compat_knows_dolfinx_versions():
    for path in (ROOT / "unitcell3d").glob("*.py"):
        if path.name != "compat.py":
            assert "__version__" not in path.read_text(), path.name


def test_kernels_are_plain():
    """Kernel files hold no classes and open no files."""
    for path in FILES:
        if path.stem.endswith("_kernels"):
            tree = ast.parse(path.read_text())
            assert not [node for node in ast.walk(tree) if isinstance(node, ast.ClassDef)], path.name
            assert "open(" not in path.read_text(), path.name
