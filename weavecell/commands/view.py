"""A mesh, a panel or a pack in a window, as a picture, or as a movie (`report.shot.view`)."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from weavecell.commands.options import example
from weavecell.report.shot import view as report_view


@example("weavecell view results/S-720-stops --screenshot panel.png")
def view(
    path: Annotated[
        Path, typer.Argument(metavar="PATH", help="A folder of results, or a .vtu, .pvd or .msh file.", exists=False)
    ],
    screenshot: Annotated[
        Path | None, typer.Option(help="Write a picture instead of opening a window.", metavar="FILE.png")
    ] = None,
    movie: Annotated[
        Path | None,
        typer.Option(
            help="Write the snapshots of a panel or pack as a movie (MP4 needs imageio).", metavar="FILE.gif|mp4"
        ),
    ] = None,
    cut: Annotated[
        bool, typer.Option("--cut", help="The section through the impact point in place of the whole panel or pack.")
    ] = False,
) -> None:
    """Look at a mesh or a result in a window, or write a picture or a movie of it.

    A picture or movie of a panel or pack shows all of it, its projectile, a scale of the tensions and the outcome; with
    --cut its section along the warp through the impact point.
    """
    report_view.show(path, screenshot, movie, cut)
    for file in (movie, screenshot):
        if file is not None:
            print(f"written to {file}")
