"""What a shot and each ply of it have alike: `ImpactSetup` and `PanelGrid` inherit it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, fields
from typing import Annotated, Any

from fabrics.base.fields import finite, limits
from fabrics.base.run_cache import ADDED_LATER
from fabrics.data_sheet import entries
from fabrics.fabric import Fabric
from shellfabric import shot_keys
from shellfabric.block.block import Backing
from shellfabric.membrane import boundary
from shellfabric.membrane.boundary import Boundary
from shellfabric.membrane.numerics import Numerics
from shellfabric.membrane.yarn_lengths import find_yarn_lengths
from shellfabric.panel_numbers import PanelNumbers
from shellfabric.part_of_others import PartOfOthers
from shellfabric.parts import Part
from shellfabric.projectile.projectile import Projectile


@dataclass(frozen=True, kw_only=True)
class PanelSetup(PanelNumbers):
    """What a set-up has of each of its plies.

    Parameters
    ----------
    projectile : Projectile
    symmetry : "quarter", "half" (x >= 0), "other half" (y >= 0) or "whole"
    boundary : "clamped", "free" or a slipping side, for all sides or each on its own (see
        `boundary`)
    numerics : Numerics
    weave_angle : [rad] of the warp against the first side of the opening, towards the second (see
        `boundary`)
    round : whether the opening is a circle
    impact_point : [m] from the middle of the opening, along its two sides
    backing : Backing, the block behind the fabric, or None (see `block.coupling`)
    packed_area : [-] share of its area at rest that packed fabric keeps (see
        `membrane.packing_kernels`)
    grading : ((until, side), ...) [crossovers] elements that are longer the further they are from
        the impact point, or None (see `grading`); not with grips at the edges
    length_effect : whether the strength of a yarn follows its length in the panel
        (`find_length_factors`); else it is that of the fabric at every length
    parts : of each ply, besides bending and packing: functions that make a `parts.Part` of its Panel,
        such as a `PartOfOthers`
    others : see `PanelNumbers`
    """

    projectile: Projectile = field(default_factory=Projectile)
    symmetry: Annotated[str, limits(shot_keys.SYMMETRY)] = "quarter"
    boundary: Boundary = "clamped"
    numerics: Numerics = field(default_factory=Numerics)
    weave_angle: Annotated[float, limits(shot_keys.WEAVE_ANGLE)] = 0.0
    round: bool = False
    impact_point: Annotated[tuple[float, float], limits(shot_keys.IMPACT_POINT)] = (0.0, 0.0)
    backing: Backing | None = None
    packed_area: Annotated[float, finite(gt=0.0, le=1.0)] = entries()["packed_area"].number
    grading: tuple[tuple[float, float], ...] | None = None
    length_effect: bool = True
    parts: tuple[Callable[[Any], Part], ...] = field(default=(), metadata=ADDED_LATER)

    def of_ply(self) -> dict[str, Any]:
        """Return {name: value} of what each ply has alike."""
        return {entry.name: getattr(self, entry.name) for entry in fields(PanelSetup)}

    def find_length_factors(
        self, fabric: Fabric, opening: tuple[float, float], weave_angle: float
    ) -> tuple[float, float]:
        """Compute the mean strength of the yarns (warp, weft) of a ply at their length in the panel, over
        that which its fabric states [-]: the one place that scales it.

        Parameters
        ----------
        opening, weave_angle : of the ply
        """
        if not self.length_effect:
            return 1.0, 1.0
        lengths = find_yarn_lengths(
            fabric.weave, opening, weave_angle, self.impact_point, self.round
        )
        warp, weft = fabric.length_factors(lengths)
        return warp, weft

    @property
    def frame_in_words(self) -> tuple[str, ...]:
        """What a run takes for granted of the edges and of the modelled part, a sentence each."""
        part = {
            "quarter": "A quarter of the panel is modelled: the rest is its image in two planes.",
            "half": "Half of the panel is modelled, x >= 0: the rest is its image in a plane.",
            "other half": "Half of the panel is modelled, y >= 0: the rest is its image in a plane.",
            "whole": "The whole panel is modelled.",
        }
        others = [f"{one.in_words}." for one in self.parts if isinstance(one, PartOfOthers)]
        edges = f"{'; '.join(boundary.list_in_words(self.boundary))}."
        return (edges, part[self.symmetry], *others)
