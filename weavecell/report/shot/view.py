"""Look at a mesh, a panel or a pack: in a window, as a picture, or a panel or pack as a movie or an
interactive page.

A picture or movie of a panel or pack shows all of it, with the parts that symmetry leaves out, the
projectile, a scale of the tensions and the outcome. These need histories.h5 beside panel.pvd;
without it the elements of the file are drawn.
"""

from __future__ import annotations

import logging
import os
import sys
import textwrap
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np

from fabrics.base import files
from fabrics.base.checks import FloatArray
from fabrics.base.door import option
from fabrics.base.errors import InputError
from fabrics.base.files import refuse_existing, replace_whole
from weavecell.report import page, pictures, pictures3d, pictures_mesh
from weavecell.report.pictures_figure import plots
from weavecell.report.pictures_style import CLAY, INK, RED, STEEL, WARP, WEFT, tension_map
from weavecell.report.shot import beside, chapters_shot, moving, pictures_shot
from weavecell.results import finding, vtk
from weavecell.results.impact import ImpactRecord
from weavecell.results.result_folder import HISTORIES, SERIES, open_folder

_ALLOWED = "a folder that holds panel.pvd or crossover.vtu, or a .pvd or .vtu file"
MOVIES = (".gif", ".mp4")
# [s] a movie shows each snapshot for so long
FRAME_TIME = 0.1
# [s] the last frame stays longer, for the reader
LAST_FRAME_TIME = 1.5
# colours of a GIF
COLOURS = 96
# letters of a title that fit into one line beside the outcome
_TITLE = 70
# [radii of the projectile] half the height of a picture of the yarns about it
_NEAR = 4.0
# [pixels]
_WINDOW = (1400, 900)


@dataclass(frozen=True)
class ViewedShot:
    """A shot at one ply or at a pack as it was written: its record, and the files of its snapshots.

    Parameters
    ----------
    record : ImpactRecord
    series : list of (path of a .vtu, time [s])
    """

    record: ImpactRecord
    series: list[tuple[Path, float]]

    @property
    def mirrors(self) -> tuple[bool, bool]:
        """Whether the modelled part is mirrored in x = 0 and in y = 0."""
        return self.record.mirror_x, self.record.mirror_y

    def body(self, grid: Any, t: float) -> FloatArray:
        """Compute the surface (a, b, 3) [m] of the projectile at time t, the instant of a grid."""
        surface = self.record.surface(t)
        height = grid.field_data["projectile_z_m"][0] - surface[..., 2].max()
        return surface + np.append(self.record.nose_place(t), height)

    def instants(self) -> list[tuple[Any, float]]:
        """Return (grid, time [s]) of each snapshot."""
        return [(vtk.read_grid(file), t) for file, t in self.series]

    def time_of(self, file: Path) -> float:
        """Return the time [s] of a snapshot."""
        return dict(self.series).get(file, self.record.rear[-1].time)

    def image(self, grid: Any, t: float, near: bool = False) -> np.ndarray:
        """Draw the whole panel or pack and its projectile in a snapshot, from the side where this
        is, before a block from behind: (rows, columns, 3).

        Parameters
        ----------
        near : whether what is about the nose alone is drawn
        """
        width = pictures3d.width(self.record.rear[-1].nodes, self.record.mirror_x)
        body = self.body(grid, t)
        half_height = 0.37 * width
        centre = (0.0, 0.0, 0.02 * width)
        # whole fabric that goes far is seen whole; what is torn off is left to fly out of the picture
        if not near and not self.record.cut_yarns[-1]:
            nodes = np.concatenate([shape.nodes for shape in self.record.rear])
            front = self.record.seen_from_front
            half_height = max(
                half_height, pictures3d.reach(nodes, self.mirrors, centre, front=front)
            )
        if near:
            half_height = min(half_height, _NEAR * 0.5 * float(np.ptp(body[..., 0])))
            centre = (*self.record.nose_place(t), float(body[..., 2].max()))
        return pictures3d.panel(
            grid,
            self.record.strength[grid["ply"] - 1],
            body,
            self.mirrors,
            half_height=half_height,
            centre=centre,
            front=self.record.seen_from_front,
            face=self.face(t),
            still=not self.series,
        )

    def face(self, t: float) -> FloatArray:
        """Return what is drawn of the face of a block at time t [s] (`pictures3d.open_faces`)."""
        width = pictures3d.width(self.record.rear[-1].nodes, self.record.mirror_x)
        faces = [self.record.face_at(0.0), self.record.face_at(t)]
        return pictures3d.open_faces(faces, self.mirrors, 0.55 * width)[-1]

    def headline(self) -> str:
        """Write title and outcome in one line."""
        title = textwrap.shorten(self.record.title, _TITLE, placeholder=" ...")
        return finding.tag(
            f"{title}: {self.record.outcome}", finding.list_doubts(self.record.checks)
        )

    def caption(self, t: float) -> str:
        """Write time and velocity of an instant."""
        return chapters_shot.instant(self.record, t)


def show(
    path: Path,
    screenshot: Path | None,
    movie: Path | None,
    html: Path | None,
    cut: bool = False,
    other: Path | None = None,
) -> None:
    """Open a window on `path`, or write a PNG to `screenshot`, a GIF or MP4 to `movie`, a page to
    `html`.

    Parameters
    ----------
    cut : whether picture and movie show the section through the impact point in place of the whole
        panel
    other : folder of another shot that the page has beside it

    Raises
    ------
    InputError : there is nothing at `path` that can be shown or no series for a movie or a page, a
        file is not named .png, .gif, .mp4 or .html or exists already, an MP4 is to be written without imageio, or
        there is no display for a window
    """
    # a wrong name is refused before anything is drawn
    endings = {
        "screenshot": (screenshot, (".png",)),
        "movie": (movie, MOVIES),
        "html": (html, (".html",)),
    }
    for name, (written, kinds) in endings.items():
        if written is not None and written.suffix not in kinds:
            names = " or ".join(f"*{kind}" for kind in kinds)
            raise InputError(
                key=option(name, ""), value=str(written), allowed=f"a file named {names}"
            )
        if written is not None:
            refuse_existing(written)
    if other is not None:
        if html is None or screenshot is not None or movie is not None or cut:
            allowed = f"given with {option('html', '')} alone"
            raise InputError(key=option("beside", ""), value=str(other), allowed=allowed)
        shots = (_shot_at(path, "PATH"), _shot_at(other, option("beside", "")))
        records = [shot.record for shot in shots]
        page.write(beside.build(records, [shot.instants() for shot in shots]), html)
        return
    file = find(path)
    shot = read_shot(path, file)
    if cut and (shot is None or (screenshot is None and movie is None)):
        ways = f"{option('screenshot', '')} or {option('movie', '')}"
        allowed = f"given with {ways}, of a folder with panel.pvd and histories.h5"
        raise InputError(key=option("cut", ""), allowed=allowed)
    if shot is None:
        if movie is not None or html is not None:
            ways = f"{option('movie', '')} and {option('html', '')}"
            allowed = f"a folder with panel.pvd and histories.h5, for {ways}"
            raise InputError(key="PATH", value=str(path), allowed=allowed)
        _show_elements(file, None, screenshot)
        return
    if movie is not None:
        _write_movie(shot, movie, cut)
    if html is not None:
        page.write(moving.page(shot.record, shot.instants()), html)
    if screenshot is not None:
        with plots() as pyplot, replace_whole(screenshot) as picture:
            if cut:
                last = cut_figure(pyplot, shot, -1)
            else:
                last = snapshot(pyplot, shot, file)
            last.savefig(picture, format="png", dpi=170)
    if movie is html is screenshot is None:
        _show_elements(file, shot, None)


def _shot_at(path, key):
    """The ViewedShot of a folder; InputError, which names the option, without one."""
    shot = None
    if (path / "panel.pvd").exists():
        shot = read_shot(path, path)
    if shot is None:
        allowed = (
            "a folder of a shot, with panel.pvd and histories.h5; V50 and limits are compared by "
            "`weavecell compare`"
        )
        raise InputError(key=key, value=str(path), allowed=allowed)
    return shot


def _show_elements(file, shot, screenshot):
    """Show the elements of a file in a window, or write a picture of them."""
    # the message says what to do in place of a window
    display = os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    if screenshot is None and sys.platform == "linux" and not display:
        files = {"html": "FILE.html", "screenshot": "FILE.png", "movie": "FILE.gif"}
        html, still, film = (f"{option(name, '')} {file}" for name, file in files.items())
        raise InputError(f"there is no display for a window: give {html}, {still} or {film}")
    scene = pictures_mesh.plotter(_WINDOW, "three lights", off_screen=screenshot is not None)
    add(scene, file, shot)
    if screenshot is not None:
        pictures_mesh.save(scene, screenshot)
    else:
        scene.show(title=f"weavecell: {file}")


def find(path: Path) -> Path:
    """Find the .vtu file to show for a path: of a series the last one.

    Raises
    ------
    InputError : there is none, or a file of the folder was changed since it was written
    """
    path = Path(path)
    if path.is_dir():
        open_folder(path, *SERIES)
        for name in ("panel.pvd", "crossover.vtu"):
            if (path / name).exists():
                return find(path / name)
    elif path.suffix == ".pvd" and path.exists():
        series = vtk.read_series(path)
        if series:
            return series[-1][0]
    elif path.suffix == ".vtu" and path.exists():
        return path
    raise InputError(key="PATH", value=str(path), allowed=_ALLOWED)


def read_shot(path: Path, file: Path) -> ViewedShot | None:
    """Find the shot at one ply or pack that a path belongs to; None if it is none, or has no
    histories.h5."""
    path = Path(path)
    folder = file.parent.parent
    if path.is_dir():
        folder = path
    elif path.suffix == ".pvd":
        folder = path.parent
    series = folder / "panel.pvd"
    if not (folder / HISTORIES).exists() or not series.exists():
        return None
    found = open_folder(folder, *SERIES)
    return ViewedShot(found.read_impact(), vtk.read_series(series))


def snapshot(pyplot: Any, shot: ViewedShot, file: Path) -> Any:
    """Draw one .vtu of a series."""
    return compose(pyplot, shot, vtk.read_grid(file), shot.time_of(file))


def end(pyplot: Any, record: ImpactRecord, near: bool = False) -> Any:
    """Draw the last instant of a record, without the files of a run; what is about the nose alone
    if wanted."""
    grid = vtk.panel(record.final, record.quads)
    return compose(pyplot, ViewedShot(record, []), grid, record.final[-1].time, near)


def end_near(pyplot: Any, record: ImpactRecord) -> Any:
    """Draw what is about the nose at the last instant."""
    return end(pyplot, record, True)


def half_way(pyplot: Any, record: ImpactRecord) -> Any:
    """Draw what is about the nose when the projectile had lost half of the energy that it lost."""
    grid = vtk.panel(record.half_energy, record.quads)
    return compose(pyplot, ViewedShot(record, []), grid, record.half_energy[-1].time, near=True)


def still(record: ImpactRecord) -> tuple[page.Figure, ...]:
    """Draw the last instant of a record for a report; nothing, with a warning, on a machine that
    cannot draw it."""
    if not pictures_mesh.can_draw():
        logging.getLogger("weavecell").warning(
            "the report has no picture of the panel: no OpenGL library was found, install libegl1"
        )
        return ()
    caption = "The panel at the end of the run, to scale, from the side where the projectile is."
    if record.backing is not None:
        caption = (
            "The panel at the end of the run, to scale, from behind. Brown: half of the face of the "
            "block, so that the fabric is seen before the other half."
        )
    figures = [pictures.draw_figure("panel", caption, end, record, kind="png")]
    # one of the two, since a picture in space takes half a second: where a nose went through, what
    # it did is seen before
    if any(shape.resolved.size for shape in record.final):
        name, draw, when = "yarns-at-the-end", end_near, "at the end of the run"
        if record.outcome == "perforated" and record.half_energy[0].time < record.final[0].time:
            when = "when the projectile had lost half of the energy that it loses"
            name, draw = "yarns", half_way
        caption = (
            f"The resolved yarns about the nose, {when}. Each is an ellipse of its width at rest and half of the "
            "ply's thickness; pieces that have failed are left out."
        )
        figures.append(pictures.draw_figure(name, caption, draw, record, kind="png", wide=False))
    return tuple(figures)


def compose(pyplot: Any, shot: ViewedShot, grid: Any, t: float, near: bool = False) -> Any:
    """Compose the figure of the grid of one instant: outcome, instant, panel, or what is about the
    nose alone, and scale of tensions."""
    # a still is read on a phone too
    figure = pyplot.figure(figsize=(8.4, 5.4) if shot.series else (5.6, 3.9), layout="none")
    # places by hand: a layout that matplotlib chooses would move from frame to frame
    axes = figure.add_axes((0.0, 0.14, 1.0, 0.74))
    axes.imshow(shot.image(grid, t, near), interpolation="antialiased")
    axes.axis("off")
    # of a page, which says it
    if shot.series:
        figure.text(0.02, 0.95, shot.headline(), weight="bold", color=INK)
    figure.text(0.02, 0.905, shot.caption(t), color=INK)
    scale = pyplot.cm.ScalarMappable(pyplot.Normalize(0, 100), tension_map())
    bar = figure.colorbar(
        scale, cax=figure.add_axes((0.2, 0.13, 0.6, 0.022)), orientation="horizontal"
    )
    words = "yarn tension, % of the strength (orange: failed)"
    if shot.series:
        words = (
            "yarn tension, % of the strength, the higher of warp and weft (orange: one yarn failed)"
        )
    bar.set_label(words, fontsize=10)
    bar.outline.set_visible(False)
    return figure


def cut_figure(pyplot: Any, shot: ViewedShot, number: int) -> Any:
    """Draw a cut of the record, by its number, with heights up to the highest of all cuts."""
    row, top = _cut_row(shot, number)
    figure = pictures_shot.cuts(pyplot, [row], chapters_shot.CLOSE_UP, top)
    figure.suptitle(
        shot.headline(), weight="bold", color=INK, x=0.02, y=0.995, ha="left", fontsize=11
    )
    figure.set_size_inches(10.4, 4.2)
    return figure


def _cut_row(shot, number):
    """(what `pictures_shot.cuts` draws of a cut, the highest point [m] of all cuts): one height, so
    that a movie does not jump."""
    record = shot.record
    cut = record.cuts[number]
    row = chapters_shot.cut_view(record, cut, shot.caption(cut.time))
    return row, max(map(pictures_shot.foremost, record.cuts))


def frames(shot: ViewedShot, dpi: int, cut: bool = False, step: int = 1) -> Iterator[np.ndarray]:
    """Yield composed pictures (rows, columns, 3) of all snapshots, in the order of time; if wanted
    of every step-th cut."""
    with plots() as pyplot:
        for figure in _figures(pyplot, shot, cut, step):
            figure.set_dpi(dpi)
            figure.canvas.draw()
            yield np.array(figure.canvas.buffer_rgba())[..., :3]


def _figures(pyplot, shot, cut, step):
    if not cut:
        for file, _ in shot.series:
            yield snapshot(pyplot, shot, file)
        return
    count = len(shot.record.cuts)
    # counted from the end, so that the last snapshot is shown
    first, *others = range((count - 1) % step, count, step)
    figure = cut_figure(pyplot, shot, first)
    yield figure
    for number in others:
        row, top = _cut_row(shot, number)
        pictures_shot.fill_cut(*figure.axes, row, chapters_shot.CLOSE_UP, top)
        yield figure


def add(scene: Any, file: Path, shot: ViewedShot | None) -> None:
    """Add the elements of a file to a plotter; of a panel or pack the mirrored parts and the
    projectile too.

    Parameters
    ----------
    scene : pyvista.Plotter
    file : .vtu
    shot : ViewedShot, of a shot at one ply or a pack, or None
    """
    import pyvista

    grid: Any = vtk.read_grid(file)
    text = file.name
    if "tension_warp_N" in grid.cell_data:
        mirrors = (False, False)
        # a panel at rest has no tension to scale by
        top = max(grid["tension_warp_N"].max(), grid["tension_weft_N"].max(), 1e-9)
        text += f"\nyarn tension, the higher of warp and weft: 0 (light) to {top:.0f} N (dark)"
        if shot is not None:
            mirrors = shot.mirrors
            t = shot.time_of(file)
            text = f"{shot.headline()}\n{shot.caption(t)}\n{text}"
            body = np.moveaxis(shot.body(grid, t), -1, 0)
            scene.add_mesh(pyvista.StructuredGrid(*body), color=STEEL)
            face = shot.face(t)
            if face.size:
                scene.add_mesh(pyvista.StructuredGrid(*np.moveaxis(face, -1, 0)), color=CLAY)
        fabric = pictures3d.colour_grid(grid, np.array([top, top]), mirrors)
        scene.add_mesh(fabric, scalars="colour", rgb=True)
    else:
        scalars = None
        if "yarn" in grid.cell_data:
            scalars = "yarn"
        scene.add_mesh(
            grid,
            scalars=scalars,
            cmap=[WARP, WEFT],
            show_edges=True,
            edge_color=INK,
            show_scalar_bar=False,
        )
    scene.camera_position = "iso"
    scene.add_axes(color=INK)
    scene.add_text(text, position="upper_left", font_size=11, color=INK)


def _write_movie(shot, movie, cut):
    if movie.suffix == ".mp4":
        try:
            import imageio.v2 as imageio
        except ModuleNotFoundError:
            allowed = "*.gif, or *.mp4 with the Python package imageio[ffmpeg]"
            raise InputError(key=option("movie", ""), value=str(movie), allowed=allowed) from None
        with (
            replace_whole(movie) as written,
            imageio.get_writer(written, fps=round(1 / FRAME_TIME)) as writer,
        ):
            for image in frames(shot, 120, cut):
                # H.264 takes even numbers of pixels alone
                writer.append_data(image[: image.shape[0] // 2 * 2, : image.shape[1] // 2 * 2])
        return
    files.write(movie, gif(frames(shot, 76, cut)))


def gif(images: Iterable[np.ndarray]) -> bytes:
    """Make a GIF of pictures (rows, columns, 3), which repeats and stays at the last."""
    from matplotlib.colors import to_rgb
    from PIL import Image

    stills = [Image.fromarray(image) for image in images]
    # one palette for all, that of the middle picture: colours do not flicker
    middle = stills[len(stills) // 2].quantize(COLOURS)
    palette = np.array(middle.getpalette()).reshape(-1, 3)
    # white paper must not become grey
    palette[palette.min(axis=1) > 245] = 255
    # failed yarns, in light and shade, are too few pixels for a palette by frequency
    torn = np.outer((255, 215, 175), to_rgb(RED)).astype(palette.dtype)
    palette = np.concatenate([palette[: 256 - len(torn)], torn])
    common = Image.new("P", (1, 1))
    common.putpalette(palette.ravel().tolist())
    reduced = [image.quantize(palette=common, dither=Image.Dither.NONE) for image in stills]
    times = [round(1e3 * FRAME_TIME)] * len(reduced)
    times[-1] = round(1e3 * LAST_FRAME_TIME)
    content = BytesIO()
    reduced[0].save(
        content,
        format="GIF",
        save_all=True,
        append_images=reduced[1:],
        duration=times,
        loop=0,
        optimize=True,
    )
    return content.getvalue()
