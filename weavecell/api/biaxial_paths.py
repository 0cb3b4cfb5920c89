"""The biaxial response of a fabric's crossover, at ratios of strains, to the strength of a yarn.

The folder of `weavecell biaxial`
    biaxial.csv     strains, tensions, contact force and heights of the unit cell, one row a state
    <ratio>.h5      with --compare-3d: history of the 3D crossover along the same path
    biaxial.json    where each path ends, differences from the 3D crossover, provenance
    pictures/       cell.svg, and energy.png: what is stored over both strains
    report.html
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from math import isfinite, sqrt
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fabrics.base import files
from fabrics.base.checks import FilePath
from fabrics.base.errors import InputError
from fabrics.base.frozen import explain_frozen
from fabrics.compression import CompressionLaw
from fabrics.fabric import Fabric
from fabrics.variants import with_linear_density
from weavecell.answers.result import Result, figure
from weavecell.api import meshes
from weavecell.api.command import Plan, Running, command
from weavecell.api.run_size import WorkSize
from weavecell.api.target import resolve_fabric
from weavecell.report import installed, pictures_surface
from weavecell.results import json_file, out_folder, progress
from weavecell.results.finding import Answer, join_parts
from weavecell.scenes import build
from weavecell.studies.energy_map import map_energy

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from fabrics.base.record import Record
    from shellfabric.cell.model import CellModel
    from shellfabric.membrane.indicator import Indicator
    from weavecell.studies.biaxial_path import CellPath
    from weavecell.studies.energy_map import EnergyMap

STATES = 241
RATIOS = ("1:1", "1:0", "0:1")
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


@dataclass(frozen=True)
class BiaxialPlan(Plan["BiaxialResult"]):
    """Paths of a crossover that are about to be followed.

    Parameters
    ----------
    model : CellModel, with its fabric
    ratios : {text: (warp, weft)} of each path
    source : of the compression law, in words
    mesh : of the 3D crossover as it was given; None without one
    size : the same as `meshing` takes it
    """

    runs = ""

    model: CellModel
    ratios: dict[str, tuple[float, float]]
    source: str
    mesh: Any
    size: Any

    @property
    def files(self) -> tuple[str, ...]:  # type: ignore[override]
        """The names of the files, also of the 3D crossover along the paths."""
        if self.mesh is None:
            return NAMES
        return _names(self.ratios)

    def forecast(self) -> WorkSize:
        """Count paths and states, and hexahedra of the 3D crossover."""
        title = f"{self.model.fabric.name}, biaxial"
        amounts = {"path": len(self.ratios), "state": len(self.ratios) * STATES}
        if self.mesh is None:
            return WorkSize(title, amounts)
        from meshing import crossover

        return meshes.size_of_mesh(
            title, crossover.build(self.model.fabric, size=self.size), **amounts
        )

    def run(self, running: Running) -> BiaxialResult:
        """Follow the paths, in 3D too if it is asked for."""
        from weavecell.studies.biaxial_path import to_strength

        paths = {text: to_strength(self.model, pair, STATES) for text, pair in self.ratios.items()}
        solved = {}
        if self.mesh is not None:
            solved = _crossovers(self.model.fabric, paths, self.size)
        result = BiaxialResult(self.model, paths, solved, self.source, self.mesh, running.wall_time)
        return running.save(result)


@command(BiaxialPlan)
def biaxial(
    fabric: Fabric | FilePath,
    *,
    ratio: list[str] | None = None,
    compare_3d: str | float | tuple[int, int, int] | None = None,
    law: FilePath | CompressionLaw | None = None,
    check: bool = False,
    out: FilePath | None = None,
) -> BiaxialPlan:
    """Stretch a crossover at fixed ratios of strains to the strength of a yarn: 1:1, 1:0 and 0:1 if
    none is given.

    The folder then holds biaxial.csv, biaxial.json, pictures/ and report.html. A whole specimen:
    `weavecell coupon`.

    Parameters
    ----------
    fabric : name of the catalogue, or path of a fabric file; in Python also a Fabric. A named one
        has the linear densities of `weavecell.fabric`
    ratio : warp strain to weft strain, WARP:WEFT, may be given again; in Python a list. 0 holds a
        yarn
    compare_3d : also solve the 3D crossover on this mesh, such as coarse, and compare; needs
        dolfinx
    law : compression law of `weavecell calibrate` (law.json), in place of the fabric's; in Python
        also a CompressionLaw
    check : compute nothing and write nothing: count paths, states and hexahedra
    out : folder of the results; in Python None writes nothing

    Returns
    -------
    BiaxialResult

    Raises
    ------
    InputError : an option that is not allowed, or a fabric without a law

    Examples
    --------
    >>> stretched = wc.biaxial("S-720", ratio=["1:1"])
    >>> end = stretched.summary()["paths"]["1:1"]
    >>> end["failed"], [round(float(strain), 4) for strain in end["strain"]]  # [-]
    ('weft', [0.0375, 0.0375])
    """
    from shellfabric.cell.model import CellModel

    wanted = {text: _ratio(text) for text in ratio or RATIOS}
    named = not isinstance(fabric, Fabric)
    if compare_3d is None:
        fabric = resolve_fabric(fabric)
    else:
        fabric = meshes.resolve_fabric_for_3d(fabric)
    # the 3D crossover is compared at the linear density that shots have
    if named and compare_3d is not None:
        fabric = with_linear_density(fabric, "effective")
    source = "published"
    if isinstance(law, CompressionLaw):
        source = law.provenance
    elif law is not None:
        source = str(law)
    if law is not None:
        fabric = replace(fabric, laws=build.laws_of(fabric, law))
    elif fabric.laws is None:
        allowed = f"given, a law.json of `weavecell calibrate`: fabric {fabric.name} has no compression law"
        raise InputError(key="law", allowed=allowed)
    size = None
    if compare_3d is not None:
        size = meshes.size(compare_3d, "compare_3d")
    return BiaxialPlan(CellModel(fabric), wanted, source, compare_3d, size)


def _names(solved):
    """The names of the files, also of the 3D crossover along paths with these ratios."""
    return (*NAMES, *(f"{_stem(text)}.h5" for text in solved))


def _stem(ratio):
    # a colon is not allowed in names of files on all systems
    return ratio.replace(":", "-")


def _ratio(text):
    """(warp, weft) from "2:1"."""
    try:
        ratio = tuple(float(part) for part in text.split(":"))
    except ValueError:
        ratio = ()
    # a path with neither yarn stretched leads nowhere
    if len(ratio) != 2 or not all(map(isfinite, ratio)) or not min(ratio) >= 0 < max(ratio):
        allowed = 'two numbers of at least 0, one of them above, such as "2:1"'
        raise InputError(key="ratio", value=text, allowed=allowed)
    return ratio


def _crossovers(fabric, paths, size):
    """{ratio: Record} of the 3D crossover along the same paths."""
    from meshing import crossover
    from unitcell3d.cases import biaxial_and_platens

    built = crossover.build(fabric, size=size)
    w1, w2 = fabric.weave.w
    solved = {}
    with progress.bar(f"3D crossover of {fabric.name}") as advance:
        for number, (text, path) in enumerate(paths.items()):
            advance(number / len(paths), text)
            # the 3D crossover is moved by lengths, half a cell at each end
            strain1, strain2 = path.ratio
            solved[text] = biaxial_and_platens.biaxial(built, fabric, (strain1 * w1, strain2 * w2))
    return solved


@explain_frozen
@dataclass(frozen=True, repr=False)
class BiaxialResult(Result):
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

    def save(self, out: FilePath) -> None:
        """Write the files that stand at the top of this module to a folder."""
        with out_folder.hold(out, _names(self.solved)):
            self._write(Path(out))

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
