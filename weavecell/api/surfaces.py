"""The response surface of a fabric's crossover.

The folder of `weavecell surface`
    surface.h5      T1, T2, F_c, h1, h2 over (d1, d2) (`fabrics.surface`)
    surface.json    settings, estimated errors, comparison with the unit cell, times, provenance
    pictures/       surfaces, contours, slices beside the unit cell, what the interpolant misses
    report.html
    runs/           finished lines, while the run goes on: `--resume` begins with them
"""

from __future__ import annotations

from concurrent.futures import Executor
from dataclasses import dataclass, field
from math import sqrt
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fabrics.base.checks import FilePath
from fabrics.base.errors import InputError
from fabrics.base.executors import InProcess
from fabrics.base.run_cache import RunCache
from fabrics.fabric import Fabric
from weavecell.api import meshes, quantities
from weavecell.api.result import Result, figure
from weavecell.report import pictures_surface
from weavecell.results import json_file, out_folder, progress, provenance

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from fabrics.surface import ResponseSurface
    from unitcell3d.identify.response_surface import Sampled

__all__ = ["SurfaceResult", "surface"]

SHOWN = {
    "T1": (1.0, "N"),
    "T2": (1.0, "N"),
    "F_c": (1.0, "N"),
    "h1": (1e6, "µm"),
    "h2": (1e6, "µm"),
}


def surface(
    fabric: Fabric | FilePath,
    *,
    mesh: str | float | tuple[int, int, int] = "medium",
    d1: str | tuple[float, float] = "0 mm .. 0.03 mm",
    d2: str | tuple[float, float] = "0 mm .. 0.03 mm",
    points: int = 21,
    tolerance: float | None = None,
    friction: float = 0.0,
    jobs: int = 1,
    executor: str | Executor = "local",
    out: FilePath | None = None,
    resume: bool = False,
) -> SurfaceResult:
    """Sample the response surface of the 3D crossover: tensions, contact force and heights over (d1, d2).

    The folder then holds surface.h5, surface.json, pictures/ and report.html; while the run goes on, runs/. With
    friction the response depends on the path: the surface is that of stretching the weft first and the warp then. The
    fabric has the linear density of its data sheet. Needs dolfinx and PETSc.

    Parameters
    ----------
    fabric, mesh : as of `mesh`
    d1 : end displacements of the warp [m], per end, LOW .. HIGH
    d2 : end displacements of the weft [m], per end, LOW .. HIGH
    points : initial number of lines in each direction
    tolerance : refine until every line is interpolated from the others within this share of the largest force
    friction : as of `calibrate`
    jobs, executor, resume : as of `v50`
    out : folder of the results; in Python None writes nothing

    Returns
    -------
    SurfaceResult

    Raises
    ------
    InputError : a range, number of points or tolerance that is not allowed, or a fabric that cannot be meshed
    UnstableError : a line found no equilibrium

    Examples
    --------
    >>> sampled = wc.surface("S-720", mesh="coarse", points=5)  # doctest: +SKIP
    >>> wc.impact("S-720", "90 m/s", surface=sampled.surface)  # doctest: +SKIP
    """
    from unitcell3d.identify import response_surface

    fabric, stamp = meshes.of_3d(fabric), provenance.stamp("")
    spans = [_span(value, key) for value, key in ((d1, "d1"), (d2, "d2"))]
    size = meshes.size(mesh)
    with out_folder.held(
        out, resume, [(fabric, spans, points, tolerance, size, friction)]
    ) as folder:
        with progress.bar(f"Response surface of {fabric.name}") as advance:
            sampled = response_surface.sample(
                fabric,
                d1=spans[0],
                d2=spans[1],
                points=(points, points),
                tolerance=tolerance,
                size=size,
                friction=friction,
                folder=folder and folder / "runs",
                resume=resume,
                jobs=jobs,
                executor=InProcess() if executor == "local" and jobs == 1 else executor,
                on_progress=advance,
                provenance=f"weavecell {stamp['weavecell']}, commit {stamp['commit']}, {stamp['date']}",
            )
        settings = {
            "fabric": fabric.name,
            "mesh": mesh,
            "friction": friction,
            "d1_m": spans[0],
            "d2_m": spans[1],
        }
        settings |= {"lines": sampled.surface.T1.shape, "tolerance": tolerance}
        result = SurfaceResult(fabric, sampled, settings, _cell(fabric, sampled.surface))
        if folder is not None:
            result.save(folder)
            RunCache(folder / "runs").clear()
    return result


def _span(value, key):
    ends = value.split("..") if isinstance(value, str) else value
    if len(ends) != 2:
        raise InputError(key=key, value=value, allowed='two lengths, such as "0 mm .. 0.03 mm"')
    low, high = (
        quantities.number(end.strip() if isinstance(end, str) else end, "m", key) for end in ends
    )
    return low, high


def _cell(fabric, surface):
    """The shell's cell at the samples, {"T1", "T2", "F_c"}; {} for a fabric without a law."""
    from shellfabric.cell.model import CellModel

    if fabric.laws is None:
        return {}
    w1, w2 = fabric.weave.w
    state = CellModel(fabric).solve(1 + surface.d1[:, None] / w1, 1 + surface.d2[None, :] / w2)
    return {"T1": state["N1"], "T2": state["N2"], "F_c": state["F"]}


@dataclass(frozen=True, repr=False)
class SurfaceResult(Result):
    """The response surface of the 3D crossover.

    Parameters
    ----------
    fabric : Fabric whose crossover it is
    sampled : `unitcell3d.identify.response_surface.Sampled`
    settings : what it was sampled with, as in surface.json
    cell : {"T1", "T2", "F_c": (n1, n2)} [N] of the shells' cell at the samples; {} of a fabric without a law

    Examples
    --------
    >>> sampled = wc.surface("S-720", mesh="coarse", points=5)  # doctest: +SKIP
    >>> sampled.surface.T1.shape  # doctest: +SKIP
    (5, 5)
    """

    fabric: Fabric
    sampled: Sampled
    settings: dict[str, Any]
    cell: dict[str, Any] = field(default_factory=dict)

    @property
    def surface(self) -> ResponseSurface:
        """T1, T2, F_c, h1, h2 over (d1, d2), for `surface` of `setup`."""
        return self.sampled.surface

    def _differences(self):
        """{quantity: rms [N] from the shells' cell}."""
        return {
            name: sqrt(((getattr(self.surface, name) - of) ** 2).mean())
            for name, of in self.cell.items()
        }

    def summary(self) -> dict[str, Any]:
        """Settings, errors of the lines that are left out, rms from the shells' cell, counts and times."""
        sampled = self.sampled
        return self.settings | {
            "error_of_left_out_lines": {
                q: {"rms": e.rms, "largest": e.largest} for q, e in sampled.errors.items()
            },
            "rms_from_the_shells_cell_N": self._differences() or None,
            "equilibria": sampled.solves,
            "tangents_factorised": sampled.iterations,
            "seconds": sampled.seconds,
            **self._what_is_assumed(),
        }

    def _columns(self):
        import numpy as np

        surface = self.surface
        d1, d2 = np.meshgrid(surface.d1, surface.d2, indexing="ij")
        values = {
            f"{name}_{'N' if unit == 'N' else 'm'}": getattr(surface, name)
            for name, (_, unit) in SHOWN.items()
        }
        return {
            name: column.ravel() for name, column in ({"d1_m": d1, "d2_m": d2} | values).items()
        }

    def plot(self) -> Figure:
        """A matplotlib figure: the three forces over the (d1, d2) plane."""
        from unitcell3d.identify.interpolant import Interpolant

        return figure(pictures_surface.surfaces, Interpolant(self.surface))

    def save(self, out: FilePath) -> None:
        """Write the files that stand at the top of this module to a folder, but runs/."""
        from weavecell.report import chapters, page

        out, stamp, friction = (
            Path(out),
            provenance.stamp("", self.fabric),
            self.settings["friction"],
        )
        self.surface.write(out / "surface.h5")
        json_file.write(out / "surface.json", self.summary() | {"provenance": stamp})
        section = self._section()
        page.write_pictures([section], out / "pictures")
        title = f"{self.fabric.name}: response surface of the 3D crossover"
        lead = "Tensions, contact force and heights of one crossing over the end displacements of its two yarns."
        if friction:
            lead += f" Coulomb friction {friction:g}; the weft is stretched first, then the warp."
        report = chapters.report(
            title, lead, (self.fabric,), (), (section,), stamp, self.sampled.seconds
        )
        page.write(report, out / "report.html")

    def _section(self):
        from pandas import DataFrame

        from unitcell3d.identify.interpolant import Interpolant
        from weavecell.report import pictures
        from weavecell.report.page import Figure, Section, Table

        surface, errors, differences = self.surface, self.sampled.errors, self._differences()
        interpolant = Interpolant(surface)
        rows = []
        for name, error in errors.items():
            factor, unit = SHOWN[name]
            values = factor * getattr(surface, name)
            span, rms = f"{values.min():.4g} to {values.max():.4g}", differences.get(name, "-")
            rows.append((f"{name} [{unit}]", span, factor * error.rms, factor * error.largest, rms))
        columns = (
            "quantity",
            "range",
            "left-out lines, rms",
            "left-out lines, largest",
            "rms from the shell's cell",
        )
        pictured = {
            "surfaces": (
                pictures_surface.surfaces,
                (interpolant,),
                "Forces over (d1, d2); white: samples.",
            ),
            "contours": (
                pictures_surface.contours,
                (interpolant,),
                "Levels of the interpolated quantities.",
            ),
            "slices": (
                pictures_surface.slices,
                (surface, self.cell, "shell's cell, published law"),
                "Circles: 3D crossover. Lines: the shell's cell, whose yarns are sine curves with the published law.",
            ),
            "missed": (
                pictures_surface.missed,
                (surface, errors),
                "What the interpolant misses on a line that is left out, an upper estimate of its error; ticks: the "
                "lines.",
            ),
        }
        if not self.cell:
            del pictured["slices"]
        figures = []
        for name, (draw, arguments, caption) in pictured.items():
            kind = "png" if name in ("surfaces", "contours") else "svg"
            figures.append(
                Figure(pictures.render(draw, *arguments, kind=kind), kind, caption, name)
            )
        lead = f"{surface.d1.size} × {surface.d2.size} samples, {self.sampled.solves} equilibria."
        table = Table.of(DataFrame(rows, columns=columns))
        return Section("surface", "Response surface", lead, tuple(figures), (table,))

    def __str__(self) -> str:
        lines = [
            f"{'grid':<10}{self.surface.d1.size} x {self.surface.d2.size}, {self.settings['mesh']} mesh"
        ]
        for name, error in self.sampled.errors.items():
            factor, unit = SHOWN[name]
            rms, largest = factor * error.rms, factor * error.largest
            lines.append(
                f"{name:<10}left-out lines missed by {rms:.3g} {unit} rms, {largest:.3g} at most"
            )
        return "\n".join(lines)
