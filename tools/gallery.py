"""Settings of sphinx-gallery: the scripts of examples/ as pages, with output and figures of a run by `make docs`.

A script runs again when its text has changed. `make docs-again` runs all, after a change of the code.
"""

from __future__ import annotations

import shutil
from pathlib import Path

ROOT = Path(__file__).parents[1]
_SHOWN: set[int] = set()  # figures of the script that runs


def copy(folder):
    """Copy examples/ beside the pages: the scripts write files to where they are."""
    for path in folder.glob("*.py"):
        if not (ROOT / "examples" / path.name).exists():
            path.unlink()
    shutil.copytree(
        ROOT / "examples", folder, dirs_exist_ok=True, ignore=shutil.ignore_patterns("__pycache__")
    )


def figures(block, block_vars, gallery_conf):
    """Scrape images: the matplotlib figures among the variables that a block has made, since plot()
    closes its own."""
    from matplotlib.figure import Figure
    from sphinx_gallery.scrapers import figure_rst

    paths = []
    for each in list(block_vars["example_globals"].values()):
        if isinstance(each, Figure) and id(each) not in _SHOWN:
            _SHOWN.add(id(each))
            paths.append(next(block_vars["image_path_iterator"]))
            each.savefig(paths[-1], format="png", dpi=100)
    return figure_rst(paths, gallery_conf["src_dir"])


def forget(gallery_conf, name):
    """Forget figures between two scripts: those that are gone may hand on their identity."""
    _SHOWN.clear()


def settings(source, target):
    """Return sphinx_gallery_conf."""
    return {
        "examples_dirs": source,
        "gallery_dirs": target,
        "filename_pattern": r"\.py$",
        "ignore_pattern": r"demo\.py$",  # `make demo`, with processes of its own
        "image_scrapers": ("gallery.figures",),
        "reset_modules": ("gallery.forget",),
        "within_subsection_order": "FileNameSortKey",
        "only_warn_on_example_error": False,
        "abort_on_example_error": True,
        "download_all_examples": False,
        "remove_config_comments": True,
        "show_signature": False,
        "min_reported_time": 1e9,
        "write_computation_times": False,
    }
