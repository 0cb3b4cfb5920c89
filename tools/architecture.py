"""Write docs/developers/architecture.md and its diagram: layers, folders, and the data flow of one shot.

    python tools/architecture.py [--scene examples/S-720-stops.toml]

The folders are described by the first line of their `__init__.py`. The data flow is that of a run of `weavecell
impact` on the scene: every call from a file of ours to another one is recorded (`sys.setprofile`), and the files stand
in the order in which they are first called. Compiled kernels do not appear in such a record; the kernel files that the
solver's own kernel imports are listed beside it.
"""

from __future__ import annotations

import argparse
import ast
import inspect
import sys
import tempfile
from collections import Counter
from pathlib import Path

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT))

from fabrics import source_code  # noqa: E402
from tests.test_architecture import FLOORS, LAYERS  # noqa: E402

PAGE, FIGURE = ROOT / "docs" / "developers" / "architecture.md", ROOT / "docs" / "figures" / "architecture.svg"
COLOURS = ("#e8eef7", "#d7e5f2", "#cfe3d8", "#f4e6cf", "#f0d9d5")


def purpose(folder):
    """First line of the docstring of a package."""
    text = ast.get_docstring(ast.parse((folder / "__init__.py").read_text("utf-8"))) or ""
    return text.splitlines()[0] if text else ""


def folders(package):
    """(name, purpose, files, lines) of a package's own files and of its sub-packages."""
    for folder in [ROOT / package, *sorted(path.parent for path in (ROOT / package).glob("*/__init__.py"))]:
        files = sorted(folder.glob("*.py"))
        lines = sum(len(file.read_text("utf-8").splitlines()) for file in files)
        yield str(folder.relative_to(ROOT)), purpose(folder), len(files), lines


def rank(name):
    """Place of a file among all layers, a larger one above."""
    package, folder = (*Path(name).parts, "")[:2]
    return FLOORS[package], next((place for place, each in enumerate(LAYERS.get(package, ())) if folder in each), -1)


class Record:
    """Calls between files of ours."""

    def __init__(self):
        self.calls, self.first = Counter(), {}

    def __call__(self, frame, event, _):
        if event != "call" or not frame.f_code.co_flags & inspect.CO_OPTIMIZED:  # bodies of modules and classes
            return
        callee = self.name(frame.f_code.co_filename)
        if callee is None:
            return
        self.first.setdefault(callee, len(self.first))
        before = frame.f_back
        while before is not None:
            caller = self.name(before.f_code.co_filename)
            if caller is not None:
                break
            before = before.f_back
        else:
            return
        if caller != callee:
            self.calls[caller, callee] += 1

    @staticmethod
    def name(file):
        """Path of a file of ours below the root, or None."""
        path = Path(file)
        return (
            str(path.relative_to(ROOT)) if path.is_relative_to(ROOT) and path.parts[len(ROOT.parts)] in FLOORS else None
        )


def flow(scene):
    """Run a scene and record it: Record."""
    from weavecell.commands import impact

    record = Record()
    with tempfile.TemporaryDirectory() as folder:
        sys.setprofile(record)
        try:
            impact.impact(ROOT / scene, Path(folder) / "out")
        finally:
            sys.setprofile(None)
    return record


def kernels():
    """Kernel files behind the step of one ply, in the order of their names."""
    start = ROOT / "shellfabric" / "__init__.py"
    files = source_code.closure(["shellfabric.panel.step_kernels"], ROOT, ("shellfabric",), ends=[start])
    return sorted(str(file.relative_to(ROOT)) for file in files if file.stem.endswith("_kernels"))


def diagram():
    """Write the diagram of the layers."""
    from matplotlib import pyplot
    from matplotlib.patches import FancyBboxPatch

    figure, axes = pyplot.subplots(figsize=(11, 8.2))
    axes.set(xlim=(0, 114), ylim=(0, 82))
    axes.axis("off")

    def box(x, y, w, h, title, rows, colour):
        axes.add_patch(FancyBboxPatch((x, y), w, h, boxstyle="round,pad=0.2,rounding_size=1", fc=colour, ec="#556"))
        axes.text(x + 1.2, y + h - 1.0, title, va="top", ha="left", weight="bold", fontsize=11)
        apart = min(3.1, (h - 5.0) / len(rows))
        for place, row in enumerate(rows):
            axes.text(x + 1.2, y + h - 4.6 - apart * place, row, va="top", ha="left", fontsize=8.6)

    box(
        1,
        72,
        108,
        9,
        "validation",
        ["published cases   |   verification: convergence, stability, cost against accuracy   |   claims ledger"],
        COLOURS[4],
    )
    box(
        1,
        57,
        108,
        13,
        "weavecell",
        [
            "cli  →  commands  →  report, results, scenes",
            "analysis: model choice by accuracy, uncertainty, biaxial tests, displacement records",
        ],
        COLOURS[3],
    )
    inner = [" | ".join(sorted(each)) for each in reversed(LAYERS["shellfabric"])]
    inner3d = [" | ".join(sorted(each)) for each in reversed(LAYERS["unitcell3d"])]
    box(1, 19, 53, 36, "shellfabric  (numba, explicit)", inner, COLOURS[2])
    box(56, 19, 53, 36, "unitcell3d  (dolfinx / PETSc, quasi-static)", inner3d, COLOURS[2])
    box(
        1,
        10,
        108,
        7.5,
        "meshing  (gmsh)",
        ["weave geometry → hexahedra → .msh, .vtu, LS-DYNA, Abaqus, OpenRadioss"],
        COLOURS[1],
    )
    box(
        1,
        1,
        108,
        7.5,
        "fabrics",
        ["yarn, weave, laws, response surface, catalogue, units, errors, result and kernel caches"],
        COLOURS[0],
    )
    axes.annotate("", (111.8, 2), (111.8, 80), arrowprops={"arrowstyle": "->", "color": "#334", "lw": 1.4})
    axes.text(112.4, 41, "imports", rotation=90, va="center", ha="left", fontsize=8, color="#334")
    figure.savefig(FIGURE, bbox_inches="tight", metadata={"Date": None})
    pyplot.close(figure)


def text(scene, record):
    """The page."""
    files = sorted(record.first, key=record.first.get)
    up = {pair: n for pair, n in record.calls.items() if rank(pair[1]) > rank(pair[0])}
    lines = [
        "# Architecture",
        "",
        "Written by `python tools/architecture.py`; not to be edited by hand.",
        "",
        "![Layers of the packages](../figures/architecture.svg)",
        "",
        "A package imports from the packages below it, and a folder of a solver from its own files and from lower "
        "folders.\n`tests/test_architecture.py` holds this: each of its rules is applied to the checkout, and to a "
        "tree with a planted\nviolation, which it must find.",
        "",
        "## Folders",
        "",
        "| folder | contents | files | lines |",
        "| --- | --- | ---: | ---: |",
    ]
    for package in sorted(FLOORS, key=FLOORS.get):
        lines += [f"| `{name}` | {what} | {count} | {size} |" for name, what, count, size in folders(package)]
    lines += [
        "",
        "## Data flow of one shot",
        "",
        f"`weavecell impact {scene}` calls functions of {len(files)} files, in this order of their first call.\n"
        f"{len(up)} pairs of files call from a lower layer to a higher one: a hook or a callback that was handed "
        "down, or a method of a\nderived class, since imports run downwards only.",
        "",
        "| file | called first by |",
        "| --- | --- |",
    ]
    callers = {}
    for caller, callee in record.calls:
        callers.setdefault(callee, caller)
    lines += [f"| `{file}` | {f'`{callers[file]}`' if file in callers else ''} |" for file in files]
    lines += ["", "Calls to a higher layer:", ""]
    lines += [f"- `{a}` → `{b}`" for a, b in sorted(up)] or ["none"]
    lines += ["", "Kernel files behind `shellfabric/panel/step_kernels.py`, which makes the steps of one ply:", ""]
    lines += [", ".join(f"`{name}`" for name in kernels()) + "."]
    return "\n".join(lines) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scene", default="examples/S-720-stops.toml")
    scene = parser.parse_args().scene
    diagram()
    PAGE.write_text(text(scene, flow(scene)), "utf-8")


if __name__ == "__main__":
    main()
