"""What the comparisons of two panels share: what is compared, what it is called, and what else differs."""

from __future__ import annotations

from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING

from fabrics.base import run_cache
from weavecell.api.study_result import DrawnResult
from weavecell.api.target import list_assumptions

if TYPE_CHECKING:
    from weavecell.api.target import Target

# fields of a set-up that a comparison is about
COMPARED = (
    *("fabric", "laws", "surface", "lay_up", "plies", "stacking", "ply_gap", "ply_friction"),
    *("bending", "cell_model", "packed_area", "contact", "grading", "elements_per_crossover"),
    *("strike_velocity", "table_size"),
)


class OfTwoPanels(DrawnResult):
    """What results about two panels share. A derived class has what raises NotImplementedError
    here."""

    @property
    def targets(self) -> tuple[Target, Target]:
        """The Target of A and of B."""
        raise NotImplementedError

    @property
    def names(self) -> tuple[str, str]:
        """What A and B are called: what is shot at, or the stem of the file where that is the
        same."""
        titles = [panel.title for panel in self.targets]
        if titles[0] == titles[1]:
            titles = [Path(panel.name).stem or panel.title for panel in self.targets]
        return f"A, {titles[0]}", f"B, {titles[1]}"

    @property
    def title(self) -> str:
        """Of picture and page."""
        return " or ".join(self.names)

    @property
    def areal_densities(self) -> tuple[float, float]:
        """[kg/m2] of A and of B, all plies."""
        a, b = (panel.setup.areal_density for panel in self.targets)
        return float(a), float(b)

    @property
    def other_differences(self) -> list[str]:
        """Names of what else differs between A and B, such as the opening: then the fabrics alone are
        not compared."""
        a, b = (panel.setup for panel in self.targets)
        named = [field.name for field in fields(a) if field.name not in COMPARED]
        return [
            name
            for name in named
            if run_cache.inputs_digest(getattr(a, name))
            != run_cache.inputs_digest(getattr(b, name))
        ]

    @property
    def heavier(self) -> float:
        """Areal density of A over that of B, less 1."""
        a, b = self.areal_densities
        return a / b - 1

    @property
    def assumed(self) -> tuple[str, ...]:
        """Lines that name what is assumed of the fabrics."""
        lines = [line for panel in self.targets for line in list_assumptions(panel.setup)]
        return tuple(dict.fromkeys(lines))
