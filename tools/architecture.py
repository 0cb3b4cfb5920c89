"""The page architecture.md and its diagram: layers and folders.

    python tools/architecture.py

This draws the diagram; `make pages` writes the page.

The folders are described by the first line of their `__init__.py`. The kernel files that the solver's own kernel
imports are listed below them.
"""

from __future__ import annotations

import ast
import sys
import textwrap
import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT))

from weavecell.report.pictures_figure import plots  # noqa: E402
from weavecell.report.pictures_style import FAINT, INK  # noqa: E402

CONTRACTS = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["tool"]["importlinter"][
    "contracts"
]
# {package: its folders from the lowest layer up}; packages themselves under "packages"
LAYERS = {
    contract.get("containers", ["packages"])[0]: [
        layer.split(" | ") for layer in reversed(contract["layers"])
    ]
    for contract in CONTRACTS
    if contract["type"] == "layers"
}
FIGURE = ROOT / "docs" / "figures" / "architecture.svg"
GAP, LINE = 2.0, 2.9  # between boxes, and from line to line
COLOURS = ("#e8eef7", "#d7e5f2", "#cfe3d8", "#f4e6cf", "#f0d9d5")


def purpose(folder):
    """Return the first line of the docstring of a package."""
    text = ast.get_docstring(ast.parse((folder / "__init__.py").read_text("utf-8"))) or ""
    return text.splitlines()[0] if text else ""


def folders(package):
    """Yield (name, purpose) of a package and of its sub-packages."""
    for folder in [
        ROOT / package,
        *sorted(path.parent for path in (ROOT / package).glob("*/__init__.py")),
    ]:
        yield str(folder.relative_to(ROOT)), purpose(folder)


def kernels(start="shellfabric/loop/loop.py"):
    """List the kernel files behind the step of one ply, in the order of their names.

    start : file that imports them, directly or not
    """
    found = set()
    waiting = [ROOT / start]
    while waiting:
        path = waiting.pop()
        for node in ast.parse(path.read_text("utf-8")).body:
            if isinstance(node, ast.ImportFrom):
                module = ROOT.joinpath(*node.module.split("."))
                named = [module / f"{alias.name}.py" for alias in node.names]
                new = {file for file in (module.with_suffix(".py"), *named) if is_kernel_file(file)}
                waiting += new - found
                found |= new
    return sorted(str(path.relative_to(ROOT)) for path in found)


def is_kernel_file(path):
    """Tell whether there is such a file of kernels."""
    return path.stem.endswith("_kernels") and path.is_file()


def diagram():
    """Write the diagram of the layers."""
    with plots() as pyplot:
        figure, axes = pyplot.subplots(figsize=(11, 9.4))
        shell, solid = (layer_rows(LAYERS[package]) for package in ("shellfabric", "unitcell3d"))
        inner = 6.5 + LINE * max(len(shell), len(solid))
        rows = [  # from the bottom: (height, [(title, rows, colour)])
            (
                8.0,
                [
                    (
                        "fabrics",
                        ["yarn, weave, laws, response surface, catalogue, units, errors, caches"],
                        COLOURS[0],
                    )
                ],
            ),
            (
                8.0,
                [
                    (
                        "meshing  (gmsh)",
                        ["weave geometry, hexahedra, decks for LS-DYNA, Abaqus, OpenRadioss"],
                        COLOURS[1],
                    )
                ],
            ),
            (
                inner,
                [
                    ("shellfabric  (numba, explicit)", shell, COLOURS[2]),
                    ("unitcell3d  (dolfinx, quasi-static)", solid, COLOURS[2]),
                ],
            ),
            (
                11.0,
                [
                    (
                        "weavecell",
                        [
                            "cli, api, decks, report, results",
                            "studies of many shots  |  scenes: input files",
                        ],
                        COLOURS[3],
                    )
                ],
            ),
            (
                8.0,
                [
                    (
                        "validation",
                        ["studies and their cases  |  published cases  |  claims  |  models"],
                        COLOURS[4],
                    )
                ],
            ),
        ]
        top = sum(height + GAP for height, _ in rows)
        axes.set(xlim=(0, 114), ylim=(0, top))
        axes.axis("off")
        y = 0.5
        for height, boxes in rows:
            width = (108 - 2 * (len(boxes) - 1)) / len(boxes)
            for place, (title, lines, colour) in enumerate(boxes):
                _box(axes, 1 + place * (width + 2), y, width, height, title, lines, colour)
            y += height + GAP
        axes.annotate(
            "",
            (111.8, 2),
            (111.8, top - 2),
            arrowprops={"arrowstyle": "->", "color": INK, "lw": 1.4},
        )
        axes.text(112.6, 0.5 * top, "imports", rotation=90, va="center", ha="left", fontsize=10)
        figure.savefig(FIGURE, metadata={"Date": None})


def layer_rows(layers, width=47):
    """Lay out the folders of a package in lines, the highest layer first; a layer that is too long
    goes on in the next line."""
    lines = []
    for layer in reversed(layers):
        lines += textwrap.wrap(" | ".join(sorted(layer)), width, subsequent_indent="    ")
    return lines


def _box(axes, x, y, width, height, title, lines, colour):
    """A box with a title and lines of text below it; the text has to stay inside."""
    from matplotlib.patches import FancyBboxPatch

    shape = FancyBboxPatch(
        (x, y), width, height, boxstyle="round,pad=0,rounding_size=1", fc=colour, ec=FAINT
    )
    axes.add_patch(shape)
    texts = [
        axes.text(x + 1.4, y + height - 1.2, title, va="top", ha="left", weight="bold", fontsize=12)
    ]
    for place, line in enumerate(lines):
        texts.append(
            axes.text(
                x + 1.4, y + height - 5.0 - LINE * place, line, va="top", ha="left", fontsize=10
            )
        )
    axes.figure.canvas.draw()
    outline = shape.get_window_extent()
    for each in texts:
        extent = each.get_window_extent()
        if extent.x1 > outline.x1 or extent.y0 < outline.y0:
            raise SystemExit(f"the text {each.get_text()!r} leaves its box")


def text():
    """Write the text of the page."""
    lines = [
        "# Architecture",
        "",
        "Made from the packages.",
        "",
        "![Layers of the packages and their folders](../../figures/architecture.svg)",
        "",
        "*Packages, and the folders of the two solvers from the highest layer down. Drawn by `tools/architecture.py`.*",
        "",
        "A package imports from the packages below it, and a folder of a solver from its own files and from lower "
        "folders.\n`lint-imports` holds this (`[tool.importlinter]` of pyproject.toml); `make lint` runs it.",
        "",
        "## Folders",
        "",
        "| folder | contents |",
        "| --- | --- |",
    ]
    for package in (package for layer in LAYERS["packages"] for package in layer):
        lines += [f"| `{name}` | {what} |" for name, what in folders(package)]
    lines += [
        "",
        "## Kernels of one ply",
        "",
        "Files behind `shellfabric/loop/loop.py`, which makes the steps:",
        "",
    ]
    lines += [f"- `{name}`" for name in kernels()]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    diagram()
