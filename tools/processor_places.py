"""Find the calls whose last bits depend on the processor: what numpy and scipy hand to BLAS or LAPACK.

    python tools/processor_places.py     print each place: file, function, calls

tools/processor_places.csv says of each place what it decides, and why that does no harm;
tests/test_processor_places.py compares the two. What needs no such line is made through `fabrics.base.sums`.
"""

from __future__ import annotations

import ast
from pathlib import Path

ROOT = Path(__file__).parents[1]
FOLDERS = ("fabrics", "meshing", "shellfabric", "unitcell3d", "weavecell/studies")
OWN = "fabrics/base/sums.py"
# of numpy; the methods of arrays too
PRODUCTS = {"dot", "vdot", "inner", "matmul", "tensordot", "polyfit"}
LIBRARIES = ("scipy.linalg", "scipy.sparse.linalg", "scipy.optimize", "scipy.interpolate")
# names of these libraries that have loops of their own
ALIKE = {
    "brentq",
    "bisect",
    "minimize_scalar",
    "BSpline",
    "PchipInterpolator",
    "RectBivariateSpline",
    "RegularGridInterpolator",
}


def call_of(node: ast.AST) -> str | None:
    """Return how a node is called in the table if its last bits depend on the processor, else None."""
    if isinstance(node, (ast.BinOp, ast.AugAssign)) and isinstance(node.op, ast.MatMult):
        return "@"
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
        owner = ast.unparse(node.func.value)
        name = node.func.attr
        if owner in ("np.linalg", "numpy.linalg"):
            # along an axis it is a sum of numpy's own
            along = any(keyword.arg == "axis" for keyword in node.keywords)
            return None if name == "norm" and along else f"linalg.{name}"
        if name in PRODUCTS and owner not in ("ufl", "sums"):
            return name
        if name == "einsum" and any(keyword.arg == "optimize" for keyword in node.keywords):
            return name
    return None


def library_names(tree: ast.AST) -> set[str]:
    """Return the names that a file imports from the libraries."""
    found = set()
    for node in ast.walk(tree):
        if not isinstance(node, ast.ImportFrom):
            continue
        for alias in node.names:
            whole = f"{node.module}.{alias.name}"
            if whole.startswith(LIBRARIES) and alias.name not in ALIKE:
                found.add(alias.asname or alias.name)
    return found


def places_of(text: str) -> dict[str, set[str]]:
    """Return {function: calls} of the source of a file; "" is the module itself."""
    tree = ast.parse(text)
    names = library_names(tree)
    found: dict[str, set[str]] = {}

    def visit(node: ast.AST, function: str) -> None:
        if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
            function = f"{function}.{node.name}".lstrip(".")
        call = call_of(node)
        if isinstance(node, ast.Name) and node.id in names:
            call = node.id
        if call:
            found.setdefault(function, set()).add(call)
        for child in ast.iter_child_nodes(node):
            visit(child, function)

    visit(tree, "")
    return found


def places(root: Path = ROOT) -> dict[tuple[str, str], set[str]]:
    """Return {(file, function): calls} of the folders in which something is decided."""
    found = {}
    for path in sorted(path for folder in FOLDERS for path in (root / folder).rglob("*.py")):
        name = path.relative_to(root).as_posix()
        if name == OWN:
            continue
        for function, calls in places_of(path.read_text("utf-8")).items():
            found[name, function] = calls
    return found


def main() -> None:
    """Print the places."""
    for (name, function), calls in places().items():
        print(f"| {name} | {function} | {', '.join(sorted(calls))} |")


if __name__ == "__main__":
    main()
