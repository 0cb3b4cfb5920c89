"""Results of an earlier run: opened again from their folder, several in one picture, and looked at."""

from __future__ import annotations

import logging
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from fabrics.base.checks import FilePath
from fabrics.base.errors import InputError
from fabrics.base.extras import explain_missing
from weavecell.answers.result import Result, figure
from weavecell.answers.saved import SavedResult
from weavecell.answers.shot import ShotResult
from weavecell.api.entrance import public
from weavecell.api.target import read_target
from weavecell.results import finding

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@public
def load(folder: FilePath | Result, *, changed: bool = False) -> ShotResult | SavedResult:
    """Open the results of an earlier run, wherever their folder is now.

    The files are compared with the digests that were written with them. A scene that names files of
    your own, such as a fabric, is read with the copies that the folder keeps of them.

    Parameters
    ----------
    folder : that a command or function wrote, its `out`; or a result that was written, whose
        `folder` it is
    changed : take files that were changed since they were written, and say which; else they are
        refused

    Returns
    -------
    ShotResult of an impact: histories, cuts and the shapes at the end; the shapes of other instants
    are in panel.pvd. SavedResult of anything else

    Raises
    ------
    InputError : no such folder, none with results, or files that are missing, cut or changed

    Examples
    --------
    >>> _ = wc.impact("S-720", "150 m/s", opening="20 mm", end_time="10 us", out="yesterday")
    >>> wc.load("yesterday").outcome
    'in flight'
    """
    from weavecell.results import result_folder

    place = _folder_of(folder) if isinstance(folder, Result) else folder
    found = result_folder.open_folder(
        place, changed=changed, allowed="a folder of results, the out of a run"
    )
    if found.is_impact:
        if not found.has(result_folder.SCENE):
            return cast(ShotResult, found.read_impact(ShotResult))
        scene = str(found.folder / result_folder.SCENE)
        copies = found.changes_of_scene()
        target = read_target(scene, found.folder, "shot", changes=copies)
        return ShotResult.of_folder(found, target.nominal())
    kind = found.find_kind()
    if kind is not None:
        return SavedResult.read(found, kind)
    allowed = f"a folder with one of histories.h5, {', '.join(result_folder.KINDS)}"
    raise InputError(key="folder", value=str(folder), allowed=allowed)


def _folder_of(result: Result) -> Path:
    """Return the folder of a result.

    Raises
    ------
    InputError : it was not written
    """
    if result.folder is None:
        allowed = "a result that was written: with out=..., or by its method save"
        raise InputError(key="folder", value=type(result).__name__, allowed=allowed)
    return result.folder


def overlay(*results: Any) -> Figure:
    """Draw several results in one picture: shots by their velocity, deflection and contact force over
    time; limits and V50 by their shots.

    Parameters
    ----------
    *results : shots of `impact` or `load`; or results with strike and residual velocities

    Raises
    ------
    InputError : nothing, or results that have no picture in common

    Examples
    --------
    >>> shots = [wc.impact("S-720", v, opening="20 mm", end_time="10 us") for v in (100, 150)]
    >>> len(wc.overlay(*shots).axes)
    3
    """
    from weavecell.report import pictures_comparison as pictures

    draw: Callable[..., Any] = pictures.draw_shots
    if all(isinstance(result, ShotResult) for result in results) and results:
        return figure(draw, {_name_of(result, k): result for k, result in enumerate(results, 1)})
    for number, result in enumerate(results, 1):
        if not isinstance(result, Result):
            allowed = "a result, such as of impact, critical_velocity or load(folder)"
            raise InputError(key=f"results[{number - 1}]", value=result, allowed=allowed)
    tables = {}
    for number, result in enumerate(results, 1):
        table = result.to_dataframe()
        strike, residual = (table.get(f"{word}_velocity_m_s") for word in ("strike", "residual"))
        if strike is None or residual is None:
            allowed = (
                "shots, or results with strike and residual velocities, such as limits and V50"
            )
            raise InputError(
                key=f"results[{number - 1}]", value=type(result).__name__, allowed=allowed
            )
        tables[_name_of(result, number)] = strike, residual
    if not tables:
        raise InputError("is missing", key="results", allowed="one result or more")
    return figure(pictures.draw_residuals, tables)


def _name_of(result, number):
    """What a curve is called."""
    folder = getattr(result, "read_from", None)
    if isinstance(result, SavedResult):
        folder = result.folder
    title = Path(folder).name if folder else getattr(result, "title", type(result).__name__)
    return finding.tag(f"{number}: {title}", result.doubts)


@explain_missing()
@public
def view(
    file: FilePath,
    *,
    html: FilePath | None = None,
    screenshot: FilePath | None = None,
    movie: FilePath | None = None,
    cut: bool = False,
    beside: FilePath | None = None,
) -> None:
    """Look at a mesh or a result in a window, or write a picture, a movie or an interactive page of
    it.

    No file is written over one that exists. A picture or movie of a panel or pack shows all of it,
    its projectile, a scale of the tensions and the outcome; with cut its section along the warp
    through the impact point.

    Parameters
    ----------
    file : a folder of results, or a .vtu, .pvd or .msh file
    html : write a page, FILE.html, in which a browser shows the panel or pack from all sides at all
        snapshots
    screenshot : write a picture, FILE.png, instead of opening a window
    movie : write the snapshots of a panel or pack as a movie, FILE.gif or FILE.mp4 (which needs
        imageio)
    cut : the section through the impact point in place of the whole panel or pack
    beside : the folder of another shot: the page has both, A and B, with what differs, both in motion
        under one slider with one scale of colours, and both histories

    Raises
    ------
    InputError : there is nothing to be shown, or no two shots, a file with another ending or one that exists, or no
        display for a window

    Examples
    --------
    >>> wc.mesh("S-720", mesh="coarse", out="mesh") and wc.view("mesh", screenshot="mesh.png")  # doctest: +SKIP
    """
    from weavecell.report.shot.view import show

    picture, film, page = (
        None if path is None else Path(path) for path in (screenshot, movie, html)
    )
    show(Path(file), picture, film, page, cut, None if beside is None else Path(beside))
    for path in (film, page, picture):
        if path is not None:
            logging.getLogger("weavecell").info(f"written to {path}")
