"""The response surface of a fabric's crossover, as it was sampled.

The folder of `weavecell surface`
    surface.h5      T1, T2, F_c, h1, h2 over (d1, d2) (`fabrics.surface`)
    surface.csv     the same as a table, one row a sample
    surface.json    settings, estimated errors, comparison with the unit cell, times, provenance
    pictures/       surfaces, contours, slices beside the unit cell, energy over both strains, what
                    the interpolant misses
    report.html
    runs/           finished lines, while the run goes on: `--resume` begins with them
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from math import sqrt
from typing import TYPE_CHECKING, Any

import numpy as np

from fabrics.base import files
from fabrics.base.counted import counted
from fabrics.base.frozen import explain_frozen
from fabrics.fabric import Fabric
from weavecell.answers.result import WrittenResult, figure
from weavecell.report import chapters, pictures_surface
from weavecell.results import json_file, provenance
from weavecell.results.finding import Answer
from weavecell.studies.energy_map import map_energy

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from fabrics.surface import ResponseSurface
    from shellfabric.membrane.indicator import Indicator
    from unitcell3d.identify.response_surface import Sampled
    from weavecell.studies.energy_map import EnergyMap

SHOWN = {
    "T1": (1.0, "N"),
    "T2": (1.0, "N"),
    "F_c": (1.0, "N"),
    "h1": (1e6, "µm"),
    "h2": (1e6, "µm"),
}


NAMES = ("surface.h5", "surface.csv", "surface.json", "pictures/*", "report.html")


@explain_frozen
@dataclass(frozen=True, repr=False)
class SurfaceResult(WrittenResult):
    """The response surface of the 3D crossover.

    Parameters
    ----------
    fabric : Fabric whose crossover it is
    sampled : `unitcell3d.identify.response_surface.Sampled`
    settings : what it was sampled with, as in surface.json
    cell : {"T1", "T2", "F_c": (n1, n2)} [N] of the shells' cell at the samples; {} of a fabric
        without a law

    Examples
    --------
    >>> sampled = wc.surface("S-720", mesh="coarse", points=5)  # doctest: +SKIP
    >>> sampled.surface.T1.shape  # doctest: +SKIP
    (5, 5)
    """

    kind = "surface"
    uses = ("crossover",)

    fabric: Fabric
    sampled: Sampled
    settings: dict[str, Any]
    cell: dict[str, Any] = field(default_factory=dict)

    @property
    def surface(self) -> ResponseSurface:
        """T1, T2, F_c, h1, h2 over (d1, d2), for `surface` of `setup`."""
        return self.sampled.surface

    @property
    def checks(self) -> tuple[Indicator, ...]:
        """As in `Result`: what the interpolant misses."""
        from weavecell.studies import crossover_checks

        return crossover_checks.of_surface(self.surface, self.sampled.errors)

    @property
    def answer(self) -> Answer:
        """What was found, with what is doubtful of it."""
        error = self.sampled.errors["T1"]
        samples = f"{self.surface.d1.size} × {self.surface.d2.size} samples"
        missed = f"T1 of left-out lines within {error.largest:.3g} N, {error.rms:.3g} N rms"
        return self._find_answer(f"{self.fabric.name}, response surface", f"{samples}, {missed}")

    @cached_property
    def energy_map(self) -> EnergyMap | None:
        """Energy over the strains of warp and weft, and where a yarn is past its strength; None of a
        surface that does not hold rest."""
        from shellfabric.cell.surface_cell import SurfaceCell

        if not all(axis[0] <= 0 for axis in (self.surface.d1, self.surface.d2)):
            return None
        return map_energy(SurfaceCell(self.fabric, self.surface))

    def _sampled_range(self):
        """{label: (strain_warp, strain_weft)} of the edge of the samples."""
        w1, w2 = self.fabric.weave.w
        warp = self.surface.d1[-1] / w1
        weft = self.surface.d2[-1] / w2
        return {"edge of the samples": (np.array([0, warp, warp]), np.array([weft, weft, 0]))}

    def _differences(self):
        """{quantity: rms [N] from the shells' cell}."""
        rms = {}
        for name, of_cell in self.cell.items():
            rms[name] = sqrt(((getattr(self.surface, name) - of_cell) ** 2).mean())
        return rms

    def summary(self) -> dict[str, Any]:
        """Return settings, errors of the lines that are left out, rms from the shells' cell, counts
        and times."""
        sampled = self.sampled
        errors = {}
        for name, error in sampled.errors.items():
            errors[name] = {"rms": error.rms, "largest": error.largest}
        return self.settings | {
            "error_of_left_out_lines": errors,
            "rms_from_the_shells_cell_N": self._differences() or None,
            "equilibria": sampled.solves,
            "tangents_factorised": sampled.iterations,
            "seconds": sampled.seconds,
            **self._what_is_assumed(),
        }

    def _what(self):
        return f"{self.fabric.name}, response surface"

    def _columns(self):
        surface = self.surface
        d1, d2 = np.meshgrid(surface.d1, surface.d2, indexing="ij")
        columns = {"d1_m": d1.ravel(), "d2_m": d2.ravel()}
        for name in ("T1", "T2", "F_c"):
            columns[f"{name}_N"] = getattr(surface, name).ravel()
        for name in ("h1", "h2"):
            columns[f"{name}_m"] = getattr(surface, name).ravel()
        return columns

    def plot(self) -> Figure:
        """Draw a matplotlib figure: the three forces over the (d1, d2) plane."""
        from unitcell3d.identify.interpolant import Interpolant

        return figure(pictures_surface.surfaces, Interpolant(self.surface))

    _written = NAMES

    def _write(self, folder):
        from weavecell.report import chapters, checks, page

        stamp = provenance.stamp("", self.fabric)
        self.surface.write(folder / "surface.h5")
        files.write(folder / "surface.csv", self.to_csv())
        json_file.write(
            folder / "surface.json", {**self.summary(), **self._answered(), "provenance": stamp}
        )
        section = self._section()
        page.write_pictures([section], folder / "pictures")
        lead = "Tensions, contact force and heights of one crossing over the end displacements of its two yarns."
        friction = self.settings["friction"]
        if friction:
            lead += f" Coulomb friction {friction:g}; the weft is stretched first, then the warp."
        seconds = self.sampled.seconds
        sections = (section, checks.section(self.checks))
        of_page = (lead, (self.fabric,), sections, stamp, seconds, self.answer)
        chapters.write(folder, *of_page)

    def _section(self):
        from pandas import DataFrame

        from weavecell.report.page import Section, Table

        surface = self.surface
        differences = self._differences()
        rows = []
        for name, error in self.sampled.errors.items():
            factor, unit = SHOWN[name]
            values = factor * getattr(surface, name)
            span = f"{values.min():.4g} to {values.max():.4g}"
            misses = (factor * error.rms, factor * error.largest)
            rows.append((f"{name} [{unit}]", span, *misses, differences.get(name, "-")))
        columns = [
            "quantity",
            "range",
            "left-out lines, rms",
            "left-out lines, largest",
            "rms from the shell's cell",
        ]
        samples = f"{surface.d1.size} × {counted(surface.d2.size, 'sample')}"
        lead = f"{samples}, {counted(self.sampled.solves, 'equilibrium')}."
        table = Table.from_frame(DataFrame(rows, columns=columns))
        figures = tuple(self._figures())
        return Section("surface", "Response surface", lead, figures, (table,))

    def _figures(self):
        from unitcell3d.identify.interpolant import Interpolant
        from weavecell.report.pictures import draw_figure

        interpolant = Interpolant(self.surface)
        yield draw_figure(
            "surfaces",
            "Forces over (d1, d2); white: samples.",
            pictures_surface.surfaces,
            interpolant,
            kind="png",
        )
        yield draw_figure(
            "contours",
            "Levels of the interpolated quantities.",
            pictures_surface.contours,
            interpolant,
            kind="png",
        )
        if self.cell:
            yield draw_figure(
                "slices",
                "Circles: 3D crossover. Lines: the shell's cell, whose yarns are sine curves with the published law.",
                pictures_surface.slices,
                self.surface,
                self.cell,
                "shell's cell, published law",
            )
        if self.energy_map is not None:
            more = (
                "It is of the potential whose forces are nearest to the sampled ones; the part of these that no "
                f"potential has is {100 * self.energy_map.residual:.2g} % (rms). Beyond the samples yarns go on alone."
            )
            yield chapters.energy(self.energy_map, self._sampled_range(), more)
        yield draw_figure(
            "missed",
            "Error of the interpolant on lines that were left out, an upper estimate; ticks: the lines.",
            pictures_surface.draw_misses,
            self.surface,
            self.sampled.errors,
        )

    def lines(self) -> list[str]:
        """Write the lines that are printed, without what is doubtful."""
        lines = [
            f"{'grid':<10}{self.surface.d1.size} x {self.surface.d2.size}, {self.settings['mesh']} mesh"
        ]
        for name, error in self.sampled.errors.items():
            factor, unit = SHOWN[name]
            rms = factor * error.rms
            largest = factor * error.largest
            lines.append(
                f"{name:<10}error on left-out lines {rms:.3g} {unit} rms, {largest:.3g} at most"
            )
        return lines
