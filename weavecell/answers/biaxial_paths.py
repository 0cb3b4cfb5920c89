"""The biaxial response of a fabric's crossover along its paths.

The folder of `weavecell biaxial`
    biaxial.csv     strains, tensions, contact force and heights of the unit cell, one row a state
    <ratio>.h5      with --compare-3d: history of the 3D crossover along the same path
    biaxial.json    where each path ends, differences from the 3D crossover, provenance
    pictures/       cell.svg, and energy.png: what is stored over both strains
    report.html
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property
from math import sqrt
from typing import TYPE_CHECKING, Any

import numpy as np

from fabrics.base import files
from fabrics.base.frozen import explain_frozen
from fabrics.fabric import Fabric
from weavecell.answers.result import WrittenResult, figure
from weavecell.report import installed, pictures_surface
from weavecell.results import json_file
from weavecell.results.finding import Answer, join_parts
from weavecell.studies.energy_map import map_energy

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from fabrics.base.record import Record
    from shellfabric.cell.model import CellModel
    from shellfabric.membrane.indicator import Indicator
    from weavecell.studies.biaxial_path import CellPath
    from weavecell.studies.energy_map import EnergyMap
COLUMNS = {
    "T1": "tension_warp_N",
    "T2": "tension_weft_N",
    "F": "contact_force_N",
    "h1": "height_warp_m",
    "h2": "height_weft_m",
    "W": "stored_energy_J",
}
NAMES = (
    "biaxial.csv",
    "biaxial.json",
    "pictures/cell.svg",
    "pictures/energy.png",
    "report.html",
)


def names_of(solved: Iterable[str]) -> tuple[str, ...]:
    """Return the names of the files, also of the 3D crossover along paths with these ratios."""
    return (*NAMES, *(f"{_stem(text)}.h5" for text in solved))


def _stem(ratio):
    # a colon is not allowed in names of files on all systems
    return ratio.replace(":", "-")


@explain_frozen
@dataclass(frozen=True, repr=False)
class BiaxialResult(WrittenResult):
    """Biaxial paths of a crossover to the strength of a yarn.

    Parameters
    ----------
    model : CellModel, with its fabric
    paths : {ratio: `weavecell.studies.biaxial_path.CellPath`}
    solved : {ratio: `fabrics.base.record.Record`} of the 3D crossover; {} if it was not asked for
    source : of the compression law: "published", or the name of a file
    size : of the mesh of the 3D crossover, or None
    seconds : [s] it took

    Examples
    --------
    >>> stretched = wc.biaxial("S-720", ratio=["1:0"])
    >>> stretched.paths["1:0"].tension.shape
    (241, 2)
    """

    kind = "biaxial"

    model: CellModel
    paths: dict[str, CellPath]
    solved: dict[str, Record]
    source: str
    size: Any = None
    seconds: float = 0.0

    @property
    def fabric(self) -> Fabric:
        """Fabric whose crossover it is."""
        return self.model.fabric

    @cached_property
    def checks(self) -> tuple[Indicator, ...]:
        """Quality checks: whether the law is known at the contact forces of the paths, and whether
        those of the 3D crossover went to their ends."""
        from shellfabric.membrane import quality
        from weavecell.studies import crossover_checks

        forces = np.concatenate([path.response["F"] for path in self.paths.values()])
        found = quality.of_forces(self.model, forces)
        return (*found, *crossover_checks.of_paths(self.solved.values()))

    @property
    def answer(self) -> Answer:
        """What was found, with what is doubtful of it."""
        ends = [
            f"strains {text} to {_pair(end['tension'], '.1f')} N ({end['failed']} at its strength)"
            for text, end in self.ends.items()
        ]
        subject, over = (
            f"{self.fabric.name}, biaxial response",
            ", ".join(self._list_assumed_laws()),
        )
        return self._find_answer(subject, join_parts(ends, "; "), over=over)

    @cached_property
    def energy_map(self) -> EnergyMap:
        """Energy over the strains of warp and weft, and where a yarn is past its strength."""
        return map_energy(self.model)

    def plot(self) -> Figure:
        """Draw a matplotlib figure: the energy over both strains, with the paths."""
        return figure(pictures_surface.energy_map, self.energy_map, self._strains())

    def _strains(self):
        """{label: (strain_warp, strain_weft)} of the paths."""
        return {f"strains {text}": tuple(path.strain.T) for text, path in self.paths.items()}

    @property
    def strain_at_largest_energy(self) -> tuple[float, float]:
        """Strains of warp and weft at the largest energy that the fabric stores without failure."""
        _, warp, weft = self.energy_map.most
        return warp, weft

    @property
    def ends(self) -> dict[str, dict[str, Any]]:
        """Where each path ends: the yarn that is first at its strength, strains, tensions [N] and
        contact force [N]; beside the 3D crossover the rms difference of the tensions [N]."""
        return {text: self._end(text) for text in self.paths}

    def _end(self, text):
        path = self.paths[text]
        history = self.solved.get(text)
        end = {
            "failed": path.failed,
            "strain": path.strain[-1],
            "tension": path.tension[-1],
            "contact_force": float(path.response["F"][-1]),
        }
        if history is not None:
            end["rms_from_3d"] = self._differences(history)
        return end

    def _differences(self, history):
        """[N] rms of the cell's tensions, warp and weft, from those of the 3D crossover at the same
        strains."""
        w1, w2 = self.fabric.weave.w
        cell = self.model.solve(1 + history["d1"] / w1, 1 + history["d2"] / w2)
        rms = []
        for name in ("T1", "T2"):
            rms.append(sqrt(((cell[name] - history[name]) ** 2).mean()))
        return rms

    def _what(self):
        return f"{self.fabric.name}, biaxial"

    def _columns(self):
        paths = self.paths.values()
        lengths = [len(path.strain) for path in paths]
        strains = np.concatenate([path.strain for path in paths])
        columns: dict[str, Any] = {
            "ratio": np.repeat(list(self.paths), lengths),
            "strain_warp": strains[:, 0],
            "strain_weft": strains[:, 1],
        }
        for key, name in COLUMNS.items():
            columns[name] = np.concatenate([path.response[key] for path in paths])
        return columns

    @property
    def _written(self):
        return names_of(self.solved)

    def _write(self, folder):
        from weavecell.report import chapters, checks, page
        from weavecell.results import provenance

        stamp = provenance.stamp("", self.fabric)
        files.write(folder / "biaxial.csv", self.to_csv())
        for text, history in self.solved.items():
            history.write(folder / f"{_stem(text)}.h5")
        content = self.summary() | checks.summary(self.checks) | self._answered()
        json_file.write(folder / "biaxial.json", content | {"provenance": stamp})
        if not installed.can_draw():
            return
        section = self._section()
        page.write_pictures([section], folder / "pictures")
        lead = (
            "One crossover, stretched in both directions at fixed ratios of strains until its first yarn is at its "
            "strength."
        )
        seconds = {"all": self.seconds}
        sections = (section, checks.section(self.checks))
        of_page = (lead, (self.fabric,), sections, stamp, seconds, self.answer)
        chapters.write(folder, *of_page)

    def _section(self):
        from weavecell.report import chapters
        from weavecell.report.page import Table

        w1, w2 = self.fabric.weave.w
        paths = {}
        for text, path in self.paths.items():
            strains = tuple(path.strain.T)
            history = self.solved.get(text)
            # the 3D tensions are drawn beside the cell's at their own strains
            if history is not None:
                strains = (history["d1"] / w1, history["d2"] / w2, history["T1"], history["T2"])
            paths[f"strains {text}"] = strains
        label = "law given"
        if self.source == "published":
            label = "published law"
        laws = {label: self.fabric.laws}
        drawn = chapters.cell(self.fabric, laws, paths=paths)
        figures = (*drawn.figures, chapters.energy(self.energy_map, self._strains()))
        table = Table.from_frame(self._ends(), "Where each path ends, warp / weft")
        return replace(drawn, figures=figures, tables=(table,))

    def _ends(self):
        """Where each path ends, as a DataFrame."""
        from pandas import DataFrame

        rows = []
        for text, end in self.ends.items():
            row = {
                "strains, warp : weft": text,
                "first at its strength": end["failed"],
                "strain [%]": _pair(100 * end["strain"], ".2f"),
                "tension [N]": _pair(end["tension"], ".1f"),
                "contact force [N]": end["contact_force"],
            }
            if self.solved:
                row["rms from 3D [N]"] = _pair(end["rms_from_3d"], ".2f")
            rows.append(row)
        return DataFrame(rows)

    def lines(self) -> list[str]:
        """Write the lines that are printed, without what is doubtful."""
        lines = []
        for text, end in self.ends.items():
            strains = _pair(100 * end["strain"], ".2f")
            tensions = _pair(end["tension"], ".1f")
            lines.append(
                f"{text:<8}{end['failed']} at its strength at strains {strains} %, tensions {tensions} N, "
                f"contact {end['contact_force']:.1f} N"
            )
        return lines + self._list_assumed_laws()


def _pair(values, form):
    return " / ".join(format(value, form) for value in values)
