"""The biaxial response of a fabric's crossover, at ratios of strains, to the strength of a yarn.

The folder of `weavecell biaxial`
    biaxial.csv     strains, tensions, contact force and heights of the unit cell, one row a state
    <ratio>.h5      with --compare-3d: history of the 3D crossover along the same path
    biaxial.json    where each path ends, differences from the 3D crossover, provenance
    pictures/cell.svg
    report.html
"""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from math import isfinite, sqrt
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fabrics.base import files
from fabrics.base.checks import FilePath
from fabrics.base.errors import InputError
from fabrics.compression import CompressionLaw
from fabrics.fabric import Fabric
from fabrics.variants import with_linear_density
from weavecell.api import meshes, targets
from weavecell.api.result import Result, saved
from weavecell.results import json_file, out_folder, progress
from weavecell.scenes import build

if TYPE_CHECKING:
    from fabrics.base.record import Record
    from shellfabric.cell.model import CellModel
    from weavecell.studies.biaxial_path import CellPath

__all__ = ["BiaxialResult", "biaxial"]

STATES = 241
RATIOS = ("1:1", "1:0", "0:1")
COLUMNS = {
    "T1": "warp tension [N]",
    "T2": "weft tension [N]",
    "F": "contact force [N]",
    "h1": "warp height [m]",
    "h2": "weft height [m]",
    "W": "stored energy [J]",
}


def biaxial(
    fabric: Fabric | FilePath,
    *,
    ratio: list[str] | None = None,
    compare_3d: str | float | tuple[int, int, int] | None = None,
    law: FilePath | CompressionLaw | None = None,
    out: FilePath | None = None,
) -> BiaxialResult:
    """Stretch a crossover at fixed ratios of strains to the strength of a yarn: 1:1, 1:0 and 0:1 if none is given.

    The folder then holds biaxial.csv, biaxial.json, pictures/ and report.html. A whole specimen: `weavecell coupon`.

    Parameters
    ----------
    fabric : as of `mesh`; a named one has the linear densities of `weavecell.fabric`
    ratio : warp strain to weft strain, WARP:WEFT, may be given again; in Python a list. 0 holds a yarn
    compare_3d : solve the 3D crossover too, with this mesh, as of `mesh`, and compare; needs dolfinx
    law : compression law of `weavecell calibrate` (law.json), in place of the fabric's; in Python also a CompressionLaw
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
    from weavecell.studies.biaxial_path import to_strength

    wanted = {text: _ratio(text) for text in ratio or RATIOS}
    named = not isinstance(fabric, Fabric)
    fabric = targets.as_fabric(fabric) if compare_3d is None else meshes.of_3d(fabric)
    if named and compare_3d is not None:
        fabric = with_linear_density(fabric, "effective")
    source = "published"
    if law is not None:
        source = law.provenance if isinstance(law, CompressionLaw) else str(law)
        fabric = replace(fabric, laws=build.laws_of(fabric, law))
    elif fabric.laws is None:
        allowed = f"given, a law.json of `weavecell calibrate`: fabric {fabric.name} has no compression law"
        raise InputError(key="law", allowed=allowed)
    model, began = CellModel(fabric), time.perf_counter()
    with out_folder.held(out) as folder:
        paths = {text: to_strength(model, pair, STATES) for text, pair in wanted.items()}
        solved = {} if compare_3d is None else _crossovers(fabric, paths, meshes.size(compare_3d))
        seconds = time.perf_counter() - began
        return saved(BiaxialResult(model, paths, solved, source, compare_3d, seconds), folder)


def _ratio(text):
    """(warp, weft) from "2:1"."""
    bad = InputError(
        key="ratio",
        value=text,
        allowed='two numbers of at least 0, one of them above, such as "2:1"',
    )
    try:
        ratio = tuple(float(part) for part in text.split(":"))
    except ValueError:
        raise bad from None
    if len(ratio) != 2 or not all(map(isfinite, ratio)) or not min(ratio) >= 0 < max(ratio):
        raise bad
    return ratio


def _crossovers(fabric, paths, size):
    """{ratio: Record} of the 3D crossover along the same paths."""
    from meshing import crossover
    from unitcell3d.cases import biaxial_and_platens

    built, solved, (w1, w2) = crossover.build(fabric, size=size), {}, fabric.weave.w
    with progress.bar(f"3D crossover of {fabric.name}") as advance:
        for number, (text, path) in enumerate(paths.items()):
            advance(number / len(paths), text)
            solved[text] = biaxial_and_platens.biaxial(
                built, fabric, (path.ratio[0] * w1, path.ratio[1] * w2)
            )
    return solved


@dataclass(frozen=True, repr=False)
class BiaxialResult(Result):
    """Biaxial paths of a crossover to the strength of a yarn.

    Parameters
    ----------
    model : CellModel, with its fabric
    paths : {ratio: `weavecell.studies.biaxial_path.CellPath`}
    solved : {ratio: `fabrics.base.record.Record`} of the 3D crossover; {} where it was not asked for
    source : of the compression law: "published", or the name of a file
    size : of the mesh of the 3D crossover, or None
    seconds : [s] it took

    Examples
    --------
    >>> stretched = wc.biaxial("S-720", ratio=["1:0"])
    >>> stretched.paths["1:0"].tension.shape
    (241, 2)
    """

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

    def summary(self) -> dict[str, Any]:
        """Settings, and of each path the yarn that is first at its strength, strains, tensions and contact force there;
        beside the 3D crossover the rms difference of the tensions [N]."""
        settings = {
            "fabric": self.fabric.name,
            "form": self.model.form,
            "law": self.source,
        }
        return settings | {
            "mesh": self.size,
            "paths": {text: self._end(text) for text in self.paths},
            **self._what_is_assumed(),
        }

    def _end(self, text):
        path, history = self.paths[text], self.solved.get(text)
        end = {
            "failed": path.failed,
            "strain": path.strain[-1],
            "tension": path.tension[-1],
            "contact_force": float(path.response["F"][-1]),
        }
        if history is None:
            return end
        w1, w2 = self.fabric.weave.w
        cell = self.model.solve(1 + history["d1"] / w1, 1 + history["d2"] / w2)
        pairs = ((cell["T1"], history["T1"]), (cell["T2"], history["T2"]))
        return end | {"rms_from_3d": [sqrt(((own - other) ** 2).mean()) for own, other in pairs]}

    def _columns(self):
        paths = self.paths.values()
        columns: dict[str, Any] = {
            "ratio": np.repeat(list(self.paths), [len(path.strain) for path in paths])
        }
        strains = np.concatenate([path.strain for path in paths])
        columns |= {"warp strain [-]": strains[:, 0], "weft strain [-]": strains[:, 1]}
        return columns | {
            name: np.concatenate([path.response[key] for path in paths])
            for key, name in COLUMNS.items()
        }

    def save(self, out: FilePath) -> None:
        """Write the files that stand at the top of this module to a folder."""
        from weavecell.report import chapters, page
        from weavecell.results import provenance

        out, fabric = Path(out), self.fabric
        stamp = provenance.stamp("", fabric)
        files.write(
            out / "biaxial.csv", self.to_dataframe().to_csv(index=False, float_format="%.8g")
        )
        for text, history in self.solved.items():
            history.write(out / f"{text.replace(':', '-')}.h5")
        json_file.write(out / "biaxial.json", self.summary() | {"provenance": stamp})
        section = self._section()
        page.write_pictures([section], out / "pictures")
        title, card = (
            f"{fabric.name}: biaxial response",
            chapters.law_card(self.model.used_laws[0], source=self.source),
        )
        lead = "One crossover, stretched in both directions at fixed ratios of strains to the strength of its first "
        report = chapters.report(
            title, lead + "yarn.", (fabric,), (card,), (section,), stamp, {"all": self.seconds}
        )
        page.write(report, out / "report.html")

    def _section(self):
        from pandas import DataFrame

        from weavecell.report import chapters
        from weavecell.report.page import Table

        strains, (w1, w2) = {}, self.fabric.weave.w
        for text, path in self.paths.items():
            history = self.solved.get(text)
            strains[f"strains {text}"] = tuple(path.strain.T)
            if history is not None:
                strains[f"strains {text}"] = (
                    history["d1"] / w1,
                    history["d2"] / w2,
                    history["T1"],
                    history["T2"],
                )
        label = "published law" if self.source == "published" else "law given"
        drawn = chapters.cell(self.fabric, {label: self.fabric.laws}, paths=strains)
        ends = {text: self._end(text) for text in self.paths}
        table = {
            "strains, warp : weft": list(ends),
            "first at its strength": [end["failed"] for end in ends.values()],
            "strain [%]": [_pair(100 * end["strain"], ".2f") for end in ends.values()],
            "tension [N]": [_pair(end["tension"], ".1f") for end in ends.values()],
            "contact force [N]": [end["contact_force"] for end in ends.values()],
        }
        if self.solved:
            table["rms from 3D [N]"] = [_pair(end["rms_from_3d"], ".2f") for end in ends.values()]
        return replace(
            drawn, tables=(Table.of(DataFrame(table), "Where each path ends, warp / weft"),)
        )

    def __str__(self) -> str:
        lines = []
        for text in self.paths:
            end = self._end(text)
            strains, tensions = _pair(100 * end["strain"], ".2f"), _pair(end["tension"], ".1f")
            lines.append(
                f"{text:<8}{end['failed']} at its strength at strains {strains} %, tensions {tensions} N, "
                f"contact {end['contact_force']:.1f} N"
            )
        return "\n".join(lines + self._assumed_laws())


def _pair(values, form):
    return " / ".join(format(value, form) for value in values)
