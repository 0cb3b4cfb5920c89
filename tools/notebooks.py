"""Run the notebooks of docs/tutorials and keep their outputs in them.

    python tools/notebooks.py [NAME ...]

A page of the site and of a forge shows the outputs that are kept here. Pictures get narrower and have few colours,
so that a notebook stays small in git. What a run logs, and what is left of its progress bars, is not kept.
"""

from __future__ import annotations

import io
import re
import sys
import tempfile
from base64 import b64decode, b64encode
from pathlib import Path

import nbclient
import nbformat
from PIL import Image

TUTORIALS = Path(__file__).parents[1] / "docs" / "tutorials"
WIDTH = 480  # [pixels] of a picture
COLOURS = 12
PICTURE = re.compile(r"(?<=data:image/png;base64,)[\w+/=]+")


def run(name: str) -> nbformat.NotebookNode:
    """Run the notebook `name` in an empty folder and return it with its outputs."""
    notebook = nbformat.read(TUTORIALS / f"{name}.ipynb", 4)
    with tempfile.TemporaryDirectory() as folder:
        resources = {"metadata": {"path": folder}}
        nbclient.NotebookClient(
            notebook, timeout=900, record_timing=False, resources=resources
        ).execute()
    notebook.metadata.pop("widgets", None)
    notebook.metadata.language_info = {"name": "python"}
    for cell in notebook.cells:
        if cell.cell_type == "code":
            cell.outputs = [output for output in cell.outputs if _is_kept(output)]
            for output in cell.outputs:
                _shrink(output.get("data", {}))
    return notebook


def _is_kept(output):
    if output.output_type == "stream":
        return output.name == "stdout"
    data = output.get("data", {})
    is_bar = "application/vnd.jupyter.widget-view+json" in data
    return not is_bar and any(data.values())


def _shrink(data):
    """Make the pictures of an output small, also those in its HTML."""
    if "image/png" in data:
        data["image/png"] = small(data["image/png"])
    if "text/html" in data:
        data["text/html"] = PICTURE.sub(lambda found: small(found[0]), data["text/html"])


def small(picture: str) -> str:
    """Shrink a PNG picture in base64 to at most WIDTH wide and COLOURS colours."""
    image = Image.open(io.BytesIO(b64decode(picture))).convert("RGB")
    image.thumbnail((WIDTH, 4 * WIDTH))
    file = io.BytesIO()
    image.quantize(COLOURS, dither=Image.Dither.NONE).save(file, "png", optimize=True)
    return b64encode(file.getvalue()).decode()


def main(names: list[str]) -> None:
    """Run the notebooks again and write them with small outputs."""
    for name in names or sorted(path.stem for path in TUTORIALS.glob("*.ipynb")):
        notebook = run(name)
        nbformat.write(notebook, TUTORIALS / f"{name}.ipynb")
        size = (TUTORIALS / f"{name}.ipynb").stat().st_size
        print(f"{name}: {1e-3 * size:.0f} kB")


if __name__ == "__main__":
    main(sys.argv[1:])
