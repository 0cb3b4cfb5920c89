"""Look at a mesh, a panel or a pack: in a window, as a picture, or as a movie of a panel or pack.

A picture or movie of a panel or pack shows all of it, with the parts that symmetry leaves out, the projectile, a scale
of the tensions and the outcome. These need histories.h5 beside panel.pvd; without it the elements of the
file are drawn.
"""

from __future__ import annotations

import io
import os
import sys
import textwrap
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fabrics.checks import FloatArray
from fabrics.errors import InputError
from fabrics.files import replace_whole
from meshing.pictures_style import INK, STEEL, WARP, WEFT, plots, tension_map
from weavecell.report import pictures3d
from weavecell.report.pictures_painter import Camera
from weavecell.report.shot import chapters_shot, pictures_shot
from weavecell.results import json_file
from weavecell.results.impact import ImpactRecord
from weavecell.results.paraview import failed_yarns, read_series

if TYPE_CHECKING:
    pass

_ALLOWED = "a folder that holds panel.pvd or crossover.vtu, or a .pvd or .vtu file"
MOVIES = (".gif", ".mp4")
FRAME_TIME = 0.1  # [s] of a movie for each snapshot
LAST_FRAME_TIME = 1.5  # [s]
COLOURS = 96  # of a GIF
_TITLE = 70  # letters of a title that fit in one line, with the outcome


@dataclass(frozen=True)
class Panel:
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

    def strength(self, grid: Any) -> FloatArray:
        """(m, 2) [N] strength of warp and weft, of each element."""
        return self.record.strength[grid.cell_data["ply"] - 1]

    def body(self, z: float, t: float) -> FloatArray:
        """(a, b, 3) [m] surface of the projectile whose foremost point is at z at time t."""
        return self.record.projectile + np.append(self.record.nose_place(t), z - self.record.projectile[..., 2].max())

    def camera(self) -> Camera:
        """The view of all snapshots: from behind the panel, at an angle; lengths in mm."""
        nodes = 1e3 * self.record.rear[-1].nodes
        span = float(np.ptp(nodes[:, 0])) * (2 if self.record.mirror_x else 1)
        return Camera((0.55 * span, -1.4 * span, 0.95 * span), (0.0, 0.0, 0.02 * span), 0.37 * span)

    def caption(self, t: float) -> str:
        """Time and velocity of an instant."""
        velocity = np.interp(t, self.record.time, self.record.velocity)
        return f"{1e6 * t:.0f} µs after the strike, projectile at {round(float(velocity))} m/s"


def show(path: Path, screenshot: Path | None = None, movie: Path | None = None, cut: bool = False) -> None:
    """Open a window on `path`, or write a PNG to `screenshot`, or a GIF or MP4 to `movie`.

    Parameters
    ----------
    cut : whether picture and movie show the section through the impact point in place of the whole panel

    Raises
    ------
    InputError : there is nothing at `path` that can be shown or no series for a movie, a file is not named .png, .gif
        or .mp4, an MP4 is to be written without imageio, or there is no display for a window
    """
    if screenshot is not None and screenshot.suffix != ".png":
        raise InputError(key="--screenshot", value=str(screenshot), allowed="a file named *.png")
    if movie is not None and movie.suffix not in MOVIES:
        raise InputError(key="--movie", value=str(movie), allowed="a file named *.gif or *.mp4")
    file = find(path)
    panel = panel_of(path, file)
    if cut and (panel is None or (screenshot is None and movie is None)):
        allowed = "given with --screenshot or --movie, of a folder with panel.pvd and histories.h5"
        raise InputError(key="--cut", allowed=allowed)
    if movie is not None:
        if panel is None:
            raise InputError(
                key="PATH", value=str(path), allowed="a folder with panel.pvd and histories.h5, for --movie"
            )
        _write_movie(panel, movie, cut)
    if screenshot is not None:
        _write_screenshot(panel, file, screenshot, cut)
    elif movie is None:
        if sys.platform == "linux" and not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
            raise InputError("there is no display for a window: give --screenshot FILE.png or --movie FILE.gif")
        plotter = pictures3d.new_plotter(off_screen=False, size=(1400, 900))
        add(plotter, file, panel, summary_of(file))
        plotter.show(title=f"weavecell: {file}")


def find(path: Path) -> Path:
    """The .vtu file to show for a path: of a series the last one."""
    path = Path(path)
    if path.is_dir():
        for name in ("panel.pvd", "crossover.vtu"):
            if (path / name).exists():
                return find(path / name)
    elif path.suffix == ".pvd" and path.exists():
        series = read_series(path)
        if series:
            return series[-1][0]
    elif path.suffix == ".vtu" and path.exists():
        return path
    raise InputError(key="PATH", value=str(path), allowed=_ALLOWED)


def panel_of(path: Path, file: Path) -> Panel | None:
    """The shot at one ply or pack that a path belongs to; None where it is none, or has no histories.h5."""
    path = Path(path)
    folder = path if path.is_dir() else path.parent if path.suffix == ".pvd" else file.parent.parent
    if (folder / "panel.pvd").exists() and (folder / "histories.h5").exists():
        return Panel(ImpactRecord.read(folder / "histories.h5"), read_series(folder / "panel.pvd"))
    return None


def summary_of(file: Path) -> dict[str, Any]:
    """summary.json of the run whose folder a .vtu of a series lies in; empty where there is none."""
    path = file.parent.parent / "summary.json"
    return json_file.read_summary(path) if path.exists() else {}


def frame(panel: Panel, file: Path, t: float) -> np.ndarray:
    """(rows, columns, 3) the whole panel or pack and its projectile in one snapshot, seen from behind.

    Parameters
    ----------
    panel : Panel
    file : .vtu of the snapshot
    t : [s] its time
    """
    import pyvista

    grid: Any = pyvista.read(file)
    tension = np.column_stack([grid.cell_data["tension_warp_N"], grid.cell_data["tension_weft_N"]])
    share = (tension / panel.strength(grid)).max(axis=1)
    body = panel.body(float(grid.field_data["projectile_z_m"][0]), t)
    quads = grid.cells.reshape(-1, 5)[:, 1:]
    failed = np.asarray(grid.cell_data["failed_yarns"])
    return pictures3d.panel(grid.points, quads, share, failed, body, panel.mirrors, camera=panel.camera())


def compose(pyplot: Any, panel: Panel, image: np.ndarray, t: float) -> Any:
    """The figure of one snapshot: outcome, instant, panel, scale of tensions."""
    figure = pyplot.figure(figsize=(8.4, 5.4))
    axes = figure.add_axes((0.0, 0.14, 1.0, 0.74))
    axes.imshow(image, interpolation="antialiased")
    axes.axis("off")
    title = textwrap.shorten(panel.record.title, _TITLE, placeholder=" ...")
    figure.text(0.02, 0.95, f"{title}: {panel.record.outcome}", weight="bold", color=INK)
    figure.text(0.02, 0.905, panel.caption(t), color=INK)
    scale = pyplot.cm.ScalarMappable(pyplot.Normalize(0, 100), tension_map())
    bar = figure.colorbar(scale, cax=figure.add_axes((0.2, 0.115, 0.6, 0.022)), orientation="horizontal")
    bar.set_label("yarn tension, % of the strength, the higher of warp and weft (orange: one yarn failed)", fontsize=10)
    bar.outline.set_visible(False)
    return figure


def end(pyplot: Any, record: ImpactRecord) -> Any:
    """The figure of the last instant of a record, as `compose` has it, without the files of a run."""
    panel = Panel(record, [])
    shapes = record.final
    first = np.cumsum([0, *(len(shape.nodes) for shape in shapes)])
    share = [(shape.tension / each).max(axis=1) for shape, each in zip(shapes, record.strength)]
    failed = [failed_yarns(shape.failed) for shape in shapes]
    last = shapes[-1]
    image = pictures3d.panel(
        np.concatenate([shape.nodes for shape in shapes]),
        np.concatenate([each + start for each, start in zip(record.quads, first)]), np.concatenate(share),
        np.concatenate(failed), last.projectile_position + record.projectile, panel.mirrors, camera=panel.camera(),
    )  # fmt: skip
    with pyplot.rc_context({"figure.constrained_layout.use": False}):
        return compose(pyplot, panel, image, last.t)


def cut_figure(pyplot: Any, panel: Panel, number: int) -> Any:
    """The figure of a cut of the record, by its number, with heights up to the highest of all cuts."""
    record = panel.record
    row = chapters_shot.cut_view(record, record.cuts[number], panel.caption(record.cuts[number].t))
    top = max(map(pictures_shot.foremost, record.cuts))
    figure = pictures_shot.cuts(pyplot, [row], chapters_shot.CLOSE_UP, top)
    title = textwrap.shorten(record.title, _TITLE, placeholder=" ...")
    figure.suptitle(f"{title}: {record.outcome}", weight="bold", color=INK, x=0.02, y=0.995, ha="left", fontsize=11)
    figure.set_size_inches(10.4, 4.2)
    return figure


def frames(panel: Panel, dpi: int, cut: bool = False) -> Iterator[np.ndarray]:
    """(rows, columns, 3) composed pictures of all snapshots, in the order of time; of their cuts, if wanted."""
    with plots() as pyplot, pyplot.rc_context({"figure.constrained_layout.use": False}):
        drawn = (
            (cut_figure(pyplot, panel, number) for number in range(len(panel.record.cuts))) if cut
            else (compose(pyplot, panel, frame(panel, file, t), t) for file, t in panel.series)
        )  # fmt: skip
        for figure in drawn:
            content = io.BytesIO()
            figure.savefig(content, format="rgba", dpi=dpi)
            width, height = (round(side * dpi) for side in figure.get_size_inches())
            pyplot.close(figure)
            yield np.frombuffer(content.getvalue(), np.uint8).reshape(height, width, 4)[..., :3]


def add(plotter: Any, file: Path, panel: Panel | None = None, summary: Mapping[str, Any] | None = None) -> None:
    """Add the elements of a file to a plotter; of a panel or pack the mirrored parts and the projectile too.

    Parameters
    ----------
    plotter : of pyvista
    file : .vtu
    panel : Panel, of a shot at one ply or a pack
    summary : of summary.json; its outcome is written beside the picture
    """
    import pyvista

    grid: Any = pyvista.read(file)
    grid.points *= 1e3
    text = f"{file.name}, lengths in mm"
    if "tension_warp_N" in grid.cell_data:
        tension = np.maximum(grid.cell_data["tension_warp_N"], grid.cell_data["tension_weft_N"])
        grid.cell_data["tension [N]"] = tension
        part = grid.extract_cells(np.flatnonzero(np.asarray(grid.cell_data["failed_yarns"]) < 2))
        # VTK's scale of colours ends a process that has loaded dolfinx 0.5.2 too (std::bad_alloc): there in words
        bar = "dolfinx" not in sys.modules
        known = summary or {}
        for each in mirrored(part, (bool(known.get("mirror_x")), bool(known.get("mirror_y")))):
            plotter.add_mesh(each, scalars="tension [N]", cmap=tension_map(), clim=(0, tension.max()),
                             show_scalar_bar=bar)  # fmt: skip
        text += f"\nyarn tension, the higher of warp and weft: 0 (light) to {tension.max():.0f} N (dark)"
        if panel is not None:
            t = dict(panel.series).get(file, panel.record.rear[-1].t)
            body = 1e3 * panel.body(float(grid.field_data["projectile_z_m"][0]), t)
            plotter.add_mesh(pyvista.StructuredGrid(*np.moveaxis(body, -1, 0)), color=STEEL)
            text = f"{panel.caption(t)}\n{text}"
        if "outcome" in known:
            text = f"{known['title']}: {known['outcome']}\n{text}"
    else:
        plotter.add_mesh(
            grid, scalars="yarn" if "yarn" in grid.cell_data else None, cmap=[WARP, WEFT], show_edges=True,
            edge_color=INK, show_scalar_bar=False,
        )  # fmt: skip
    plotter.camera_position = "iso"
    plotter.add_axes(color=INK)
    plotter.add_text(text, position="upper_left", font_size=11, color=INK)


def mirrored(grid: Any, mirrors: tuple[bool, bool]) -> list[Any]:
    """A grid with its images in the planes x = 0 and y = 0."""
    found = [grid]
    for normal, wanted in zip(((1, 0, 0), (0, 1, 0)), mirrors):
        if wanted:
            found += [each.reflect(normal, point=(0, 0, 0)) for each in found]
    return found


def _write_screenshot(panel, file, screenshot, cut):
    if panel is not None:
        t = dict(panel.series).get(file, panel.record.rear[-1].t)
        with plots() as pyplot, pyplot.rc_context({"figure.constrained_layout.use": False}):
            last = cut_figure(pyplot, panel, -1) if cut else compose(pyplot, panel, frame(panel, file, t), t)
            with replace_whole(screenshot) as beside:
                last.savefig(beside, format="png", dpi=170)
        return
    plotter = pictures3d.new_plotter(off_screen=True, size=(1400, 900))
    add(plotter, file, None, summary_of(file))
    with replace_whole(screenshot) as beside:
        plotter.screenshot(beside)
    plotter.close()


def _write_movie(panel, movie, cut):
    if movie.suffix == ".mp4":
        try:
            import imageio.v2 as imageio
        except ModuleNotFoundError:
            raise InputError(
                key="--movie", value=str(movie), allowed="*.gif, or *.mp4 with the Python package imageio[ffmpeg]"
            ) from None
        with replace_whole(movie) as beside, imageio.get_writer(beside, fps=round(1 / FRAME_TIME)) as writer:
            for image in frames(panel, 120, cut):
                writer.append_data(image[: image.shape[0] // 2 * 2, : image.shape[1] // 2 * 2])
        return
    from PIL import Image

    pictures = [Image.fromarray(image) for image in frames(panel, 76, cut)]
    middle = pictures[len(pictures) // 2].quantize(COLOURS)  # one palette for all: colours do not flicker
    reduced = [picture.quantize(palette=middle, dither=Image.Dither.NONE) for picture in pictures]
    times = [round(1e3 * FRAME_TIME)] * (len(reduced) - 1) + [round(1e3 * LAST_FRAME_TIME)]
    with replace_whole(movie) as beside:
        reduced[0].save(
            beside, format="GIF", save_all=True, append_images=reduced[1:], duration=times, loop=0, optimize=True
        )
