"""Public functions and methods whose docstring does not begin with a verb, and long heads of modules.

    python tools/docstrings.py

A docstring says what the function does, in the imperative: "Compute", "Return", "Refuse", "Write".
Properties are nouns and are left out, and so are private and nested functions. A word of the list
that is a noun as well counts as a verb unless "of" or a comma follows it: "Number the nodes", but
not "Number of nodes".
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parents[1]
PACKAGES = ("fabrics", "meshing", "unitcell3d", "shellfabric", "validation", "weavecell", "tools")
WORDS = """
Accept Act Add Advance Allocate Allow Announce Append Apply Approach Arrange Assemble Audit Average
Balance Bisect Bore Bound Bring Broadcast Build Calculate Calibrate Call Cancel Change Check Choose
Classify Clear Close Collect Combine Compare Compile Compose Compress Compute Constrain Convert Copy
Correct Count Cut Decide Declare Decorate Define Delete Derive Describe Determine Diagonalise Digest
Divide Do Draw Drop Encode Enforce Ensure Estimate Evaluate Expand Explain Export Extract
Extrapolate Fill Filter Find Fire Fit Flag Follow Force Forecast Forget Format Free Gather Get Give
Go Grade Grow Guess Hand Hold Identify Import Indicate Initialise Integrate Interpolate Invert
Iterate Join Judge Keep Lay Let Limit Linearise List Load Look Lower Make March Mark Mask Measure
Merge Mesh Minimise Mirror Move Multiply Name Normalise Note Notify Number Open Order Pack Pair
Parse Perturb Place Plot Predict Prepare Prescribe Press Print Process Project Propose Provide Pull
Push Put Raise Read Record Reduce Refuse Register Relax Remove Rename Render Repeat Replace Resample
Reset Resolve Restore Return Rotate Round Run Sample Save Say Scale Scatter Scrape Search Select Set
Share Shear Shift Show Shrink Simulate Smooth Solve Sort Split Spread Stack Step Stop Store Stretch
Strike Subtract Sum Summarise Swap Tabulate Take Tell Test Thicken Thin Tie Time Transform Treat Try
Turn Undo Unpack Update Validate Wait Walk Warn Widen Wrap Write Yield
"""
VERBS = frozenset(WORDS.split())
# what a caller needs of a module; theory is in docs/theory-*.md, what one function does in its docstring
MOST_LINES = 12
Function = ast.FunctionDef | ast.AsyncFunctionDef


def public_functions(body: list[ast.stmt], name: str = "") -> Iterator[tuple[str, Function]]:
    """Yield (qualified name, syntax tree) of the public functions and methods of a module's body."""
    for node in body:
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            if not node.name.startswith("_") and not is_property(node):
                yield name + node.name, node
        elif isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
            yield from public_functions(node.body, f"{name}{node.name}.")
        elif isinstance(node, ast.If | ast.Try):
            yield from public_functions(node.body, name)


def is_property(function: Function) -> bool:
    """Tell whether a method is a property, or the setter of one."""
    for decorator in function.decorator_list:
        text = ast.unparse(decorator)
        if text.endswith(("property", ".setter")):
            return True
    return False


def begins_with_a_verb(docstring: str) -> bool:
    """Tell whether the first word of a docstring is a verb, and no noun."""
    words = docstring.split()
    if not words or words[0].rstrip(".:") not in VERBS:
        return False
    return words[1:2] != ["of"]


def without_verb(root: Path = ROOT) -> list[str]:
    """List the functions that have no docstring or one that begins otherwise: "file:line name"."""
    found = []
    for package in PACKAGES:
        for path in sorted((root / package).rglob("*.py")):
            tree = ast.parse(path.read_text("utf-8"))
            for name, function in public_functions(tree.body):
                if not begins_with_a_verb(ast.get_docstring(function) or ""):
                    found.append(f"{path.relative_to(root)}:{function.lineno} {name}")
    return found


def long_heads(root: Path = ROOT) -> dict[str, int]:
    """Count the lines of the docstrings of modules that are longer than `MOST_LINES`, by file."""
    found = {}
    for package in PACKAGES:
        for path in sorted((root / package).rglob("*.py")):
            head = ast.get_docstring(ast.parse(path.read_text("utf-8"))) or ""
            if len(head.splitlines()) > MOST_LINES:
                found[path.relative_to(root).as_posix()] = len(head.splitlines())
    return found


if __name__ == "__main__":
    print("\n".join(without_verb()))
    print("\n".join(f"{file}: {lines} lines" for file, lines in long_heads().items()))
