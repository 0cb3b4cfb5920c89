"""What a case of the 3D crossover came to."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from fabrics.base import files
from fabrics.base.frozen import explain_frozen
from fabrics.base.record import Record
from fabrics.fabric import Fabric
from weavecell.answers.result import WrittenResult, figure
from weavecell.report import crossover_cases, pictures_crossover
from weavecell.results import json_file

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from shellfabric.membrane.indicator import Indicator

NAMES = ("case.h5", "case.csv", "case.json", "pictures/curve.svg", "pictures/deformed.png")


class Case(NamedTuple):
    """What a case comes to, and its picture."""

    summary: Callable[[Fabric, Record], dict[str, Any]]
    curve: Callable[..., Any]


CASES = {
    "yarn": Case(crossover_cases.yarn, pictures_crossover.yarn),
    "platens": Case(crossover_cases.stack, pictures_crossover.stack),
    "biaxial": Case(crossover_cases.tensions, pictures_crossover.tensions),
    "path": Case(crossover_cases.tensions, pictures_crossover.tensions),
    "shear": Case(crossover_cases.shear, pictures_crossover.shear),
    "pull-out": Case(crossover_cases.pull_out, pictures_crossover.pull_out),
}


@explain_frozen
@dataclass(frozen=True, repr=False)
class CrossoverResult(WrittenResult):
    """A case of the 3D crossover.

    Parameters
    ----------
    fabric : Fabric whose crossover it is
    case : "yarn", "platens", "biaxial", "path", "shear" or "pull-out"
    mesh : `meshing.crossover.Crossover` or `meshing.patch.Patch`
    record : `fabrics.base.record.Record`, a row a converged state
    domain : "quarter", "whole" or "periodic"
    size : of the mesh, as it was given
    found : {quantity [unit]: value} that the case comes to

    Examples
    --------
    >>> pulled = wc.crossover.yarn("S-720", mesh="coarse")  # doctest: +SKIP
    >>> pulled.summary()["greatest tension [N]"], pulled.record["strain"][-1]  # doctest: +SKIP
    """

    kind = "case"
    uses = ("crossover",)

    fabric: Fabric
    case: str
    mesh: Any
    record: Record
    domain: str
    size: str
    found: dict[str, Any] = field(default_factory=dict)

    @cached_property
    def checks(self) -> tuple[Indicator, ...]:
        """Quality checks: of the mesh, whether the path was gone to its end, and of a yarn alone
        nodes that alternate along it."""
        from shellfabric.membrane import quality
        from weavecell.studies import crossover_checks

        found = (
            *crossover_checks.of_mesh(self.mesh, self.fabric.weave.thickness),
            *crossover_checks.of_paths([self.record]),
            *crossover_checks.of_pressing(self.record),
            *crossover_checks.of_strength(self.record, self.fabric),
        )
        if "astray" not in self.record.columns:
            return found
        height = self.fabric.weave.h0[self.record.facts["yarn"]]
        return (*found, *quality.of_yarn(self.record["astray"], 2 * height))

    def _what(self):
        return f"{self.fabric.name}, {self.case}"

    def summary(self) -> dict[str, Any]:
        """Return {quantity [unit]: value} that the case comes to, and what is assumed."""
        return self.found | self._what_is_assumed()

    def _columns(self):
        return dict(self.record.to_dataframe())

    def plot(self) -> Figure:
        """Draw a matplotlib figure: the curve of the case."""
        return figure(CASES[self.case].curve, self.fabric, self.record)

    _written = NAMES

    def _write(self, out):
        from weavecell.report import checks, pictures
        from weavecell.results import provenance

        record = self.record
        record.write(out / "case.h5")
        files.write(out / "case.csv", self.to_csv())
        content = {
            "fabric": self.fabric.name,
            "case": record.facts["case"],
            "domain": self.domain,
            "size": self.size,
            "rows": len(record["path"]),
            "failed": record.failed,
            "facts": record.facts,
            "found": self.found,
            **checks.summary(self.checks),
            **self._what_is_doubtful(),
            "provenance": provenance.stamp("", self.fabric),
        }
        json_file.write(out / "case.json", content)
        curve = pictures.render(CASES[self.case].curve, self.fabric, record)
        files.write(out / "pictures" / "curve.svg", curve)
        pictures_crossover.draw_deformed(self.mesh, record, out / "pictures" / "deformed.png")

    def lines(self) -> list[str]:
        """Write the lines that are printed, without what is doubtful."""
        rows = [f"{key:<44}{_text(value)}" for key, value in self.found.items()]
        return rows + self._list_assumed_laws()


def _text(value):
    """A number, some of them or a word, as it is printed."""
    if isinstance(value, list | tuple):
        return ", ".join(map(_text, value))
    if value is None:
        return "-"
    if isinstance(value, float | np.floating):
        return f"{value:.5g}"
    return str(value)
