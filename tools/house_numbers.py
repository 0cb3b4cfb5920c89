"""Report how well the code can be read, as numbers with the places behind them. Fails nothing.

    python tools/house_numbers.py

Each function of MEASURES returns the places of one measure; the number is how many there are.
"""

from __future__ import annotations

import ast
import re
import sys
from collections import Counter
from pathlib import Path

ROOT = Path(__file__).parents[1]
sys.path[:0] = [str(ROOT), str(ROOT / "tools")]

from docstrings import without_verb  # noqa: E402
from kernel_arrays import tables  # noqa: E402

CONSTANT = re.compile(r"[A-Z][A-Z_0-9]+")
# lengths of what has a value for each family of yarns, for each axis, for each of eight lanes or corners
VECTOR = {"2", "3", "8"}


def unlike() -> set[str]:
    """Return the names of the fields of kernel tables that hold numbers which are not alike.

    Such a field has a length that is neither of axes nor of families, or several units. A name that
    other tables have for what is alike is left out.
    """
    found = set()
    alike = set()
    for table in tables():
        for name, field in table.fields.items():
            lengths = set(re.findall(r"(?<![+-] )\b\d+\b", field.shape))
            if lengths - VECTOR or "," in field.unit:
                found.add(name)
            else:
                alike.add(name)
    return found - alike


def is_fixed(index: ast.expr) -> bool:
    """Tell whether an index is a digit or a constant, or one of several is; k + 1 is neither."""
    if isinstance(index, ast.Constant):
        return isinstance(index.value, int)
    if isinstance(index, ast.Attribute):
        return bool(CONSTANT.fullmatch(index.attr))
    if isinstance(index, ast.Name):
        return bool(CONSTANT.fullmatch(index.id))
    if isinstance(index, ast.BinOp):
        return is_fixed(index.left) and is_fixed(index.right)
    if isinstance(index, ast.Tuple):
        return any(is_fixed(part) for part in index.elts)
    return False


def indexed_rows(path: Path) -> list[ast.Subscript]:
    """Return the places of a file that index such a field of a row by a digit or a constant.

    In kernels a variable that has the name of such a field counts as one.
    """
    fields = unlike()
    found = []
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if not isinstance(node, ast.Subscript) or not is_fixed(node.slice):
            continue
        array = node.value
        if isinstance(array, ast.Attribute):
            name = array.attr
        elif isinstance(array, ast.Name) and path.name.endswith("_kernels.py"):
            name = array.id
        else:
            continue
        if name in fields and name != "shape":
            found.append(node)
    return found


def numbers_by_slot() -> list[str]:
    """Return the places of shellfabric that read or set a number of a row by its slot."""
    found = []
    for path in sorted((ROOT / "shellfabric").rglob("*.py")):
        for node in sorted(indexed_rows(path), key=lambda node: node.lineno):
            found.append(f"{path.relative_to(ROOT)}:{node.lineno}: {ast.unparse(node)}")
    return found


PREPOSITIONS = {
    "of",
    "at",
    "by",
    "in",
    "on",
    "over",
    "about",
    "above",
    "below",
    "behind",
    "beside",
    "after",
    "before",
    "ahead",
    "around",
    "along",
    "across",
    "within",
    "between",
    "against",
    "under",
    "alone",
    "apart",
    "away",
    "off",
    "worst",
    "asked",
}
PARTICIPLES = {
    "made",
    "held",
    "kept",
    "shown",
    "drawn",
    "built",
    "given",
    "found",
    "known",
    "struck",
    "written",
    "done",
    "bent",
    "taken",
    "told",
    "seen",
    "met",
    "chosen",
    "broken",
    "torn",
    "grown",
}
VERBS_IN_ED = {"embed", "exceed", "feed", "need", "proceed", "seed", "shed", "speed"}


def is_preposition_or_participle(name: str) -> bool:
    """Tell whether the first word of a name is a preposition or a participle."""
    word = name.lstrip("_").partition("_")[0]
    if word in PREPOSITIONS or word in PARTICIPLES:
        return True
    return word.endswith("ed") and word not in VERBS_IN_ED and len(word) > 3


def functions_without_verb() -> list[str]:
    """Return the functions, properties left out, called by a preposition or a participle."""
    found = []
    for package in ("fabrics", "meshing", "unitcell3d", "shellfabric", "weavecell", "validation"):
        for path in sorted((ROOT / package).rglob("*.py")):
            for node in ast.walk(ast.parse(path.read_text("utf-8"))):
                if not isinstance(node, ast.FunctionDef) or not is_preposition_or_participle(
                    node.name
                ):
                    continue
                if any("property" in ast.unparse(mark) for mark in node.decorator_list):
                    continue
                found.append(f"{path.relative_to(ROOT)}:{node.lineno}: {node.name}")
    return found


def kernel_modules() -> dict[str, ast.Module]:
    """Return {name: syntax tree} of the modules of shellfabric, `jit` left out: its functions are
    operations of the language that kernels are written in."""
    found = {}
    for path in (ROOT / "shellfabric").rglob("*.py"):
        name = ".".join(path.relative_to(ROOT).with_suffix("").parts)
        if not name.startswith("shellfabric.jit"):
            found[name] = ast.parse(path.read_text("utf-8"))
    return found


def calls_of_a_step() -> list[tuple[str, str]]:
    """Return the pairs (caller, called) of functions that a step of `loop.advance` can reach, by the
    text of the code."""
    modules = kernel_modules()
    functions = {}
    names: dict[str, dict[str, str]] = {}
    for module, tree in modules.items():
        names[module] = {}
        for node in tree.body:
            if isinstance(node, ast.FunctionDef):
                functions[f"{module}.{node.name}"] = module, node
                names[module][node.name] = f"{module}.{node.name}"
            if isinstance(node, ast.ImportFrom) and node.module:
                for alias in node.names:
                    names[module][alias.asname or alias.name] = f"{node.module}.{alias.name}"
    waiting = ["shellfabric.loop.loop.advance"]
    seen = set()
    found = []
    while waiting:
        caller = waiting.pop()
        if caller in seen:
            continue
        seen.add(caller)
        module, node = functions[caller]
        for called in sorted(called_names(node, names[module]) & functions.keys()):
            found.append((caller, called))
            waiting.append(called)
    return found


def called_names(function: ast.FunctionDef, names: dict[str, str]) -> set[str]:
    """Return the full names of what a function names, from what its module calls them."""
    found = set()
    for node in ast.walk(function):
        if isinstance(node, ast.Name):
            found.add(names.get(node.id, ""))
        elif isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            found.add(f"{names.get(node.value.id, '')}.{node.attr}")
    return found


def calls_inside_their_folder() -> list[str]:
    """Return the calls of a step whose caller and called stand in one folder."""
    return [place for place, leaves in places_of_calls() if not leaves]


def calls_out_of_their_folder() -> list[str]:
    """Return the calls of a step that lead into another folder."""
    return [place for place, leaves in places_of_calls() if leaves]


def places_of_calls() -> list[tuple[str, bool]]:
    """Return (file: caller calls called, whether the called stands in another folder)."""
    found = []
    for caller, called in calls_of_a_step():
        file = caller.rpartition(".")[0].replace(".", "/") + ".py"
        leaves = caller.split(".")[1] != called.split(".")[1]
        found.append((f"{file}: {caller.rpartition('.')[2]} calls {called}", leaves))
    return found


MEASURES = {
    "functions called by a preposition or a participle": functions_without_verb,
    "places that index an array of a row by a constant or a digit": numbers_by_slot,
    "calls of a step that lead out of their folder": calls_out_of_their_folder,
    "calls of a step inside their folder": calls_inside_their_folder,
    "public functions whose docstring does not begin with a verb": without_verb,
}


def main() -> None:
    """Print each number, and its places by file."""
    for title, measure in MEASURES.items():
        places = measure()
        print(f"{len(places):5d}  {title}")
        files = Counter(place.split(":")[0] for place in places)
        for name, count in files.most_common():
            print(f"       {count:4d}  {name}")
        for place in places:
            print(f"             {place}")


if __name__ == "__main__":
    main()
