"""Numbers of a panel, each declared once: here.

A line has the type of a number, what an input file says of it (`fabrics.base.schema`), the models of
the yarns that read it, and its default. From the line follow the key of the table [panel] with its
checks, page and keyword; a field of `ImpactSetup` and of each `Panel`; and what kernels read,
`const.panel.NAME` of the membrane and `zone.panel.NAME` of resolved yarns, NaN where it is None.
A model that does not read a number refuses it.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated

from fabrics.base.schema import NoPlace, Unread, flag, key, named, number, quantity, whole

if TYPE_CHECKING:
    from fabrics.fabric import Fabric


UNSTRETCHED = "left out: a picture frame shears the fabric, and stretches no yarn"


@dataclass(frozen=True, kw_only=True)
class CellNumbers:
    """Numbers of the unit cell, keys of the table [fabric]. Resolved yarns touch where they are: they
    read the "yarns" ones alone, and solid yarns of a patch none."""

    cell_model: Annotated[
        str,
        key(
            named(
                "unit cell: yarns that compress, incompressible yarns, or warp and weft without interaction",
                "compressible",
                "incompressible",
                "decoupled",
            ),
            "pinned yarns",
        ),
        Unread("picture_frame", UNSTRETCHED),
    ] = "compressible"
    cell_formulation: Annotated[
        str,
        key(
            named(
                "how forces follow from the state of the cell: gradient of the stored energy (`variational`), force "
                "equilibrium as in the thesis (`equilibrium`), or interpolated tensions of a response surface "
                "(`direct`)",
                "variational",
                "equilibrium",
                "direct",
            ),
            "pinned",
        ),
    ] = "variational"
    crossover_gap: Annotated[
        float,
        key(
            quantity(
                "play between warp and weft at a crossover before they touch",
                "m",
                "0 mm",
                zero=True,
            ),
            "pinned",
        ),
        Unread("picture_frame", UNSTRETCHED),
    ] = 0.0


NO_SLIP = "left out: no law here lets yarns slip"


@dataclass(frozen=True, kw_only=True)
class ZoneKeys:
    """What a table [panel] says of resolved yarns, see `yarns.model.YarnZone`."""

    zone: Annotated[
        float | None,
        key(
            quantity(
                "resolved yarns: half width of the square zone about the nose; if not given all of one ply up to "
                "an opening of 120 mm, beyond it and of a pack 40 mm, or 8 mm divided by `crossover_friction` if this "
                "is more",
                "m",
                "20 mm",
            ),
            "yarns",
        ),
        Unread("export", NO_SLIP),
    ] = None
    aim_seed: Annotated[
        int | None,
        key(
            whole(
                "resolved yarns: seed of a random impact point within a cell of the weave about the middle of the "
                "opening; by it, too, the plies of a pack whose edges are clamped are shifted against each other, by "
                "0 if not given",
                0,
                2**31 - 1,
            ),
            "yarns",
        ),
        Unread("export", NO_SLIP),
    ] = None
    crossover_friction: Annotated[
        float | None,
        key(
            number(
                "resolved yarns: Coulomb coefficient of yarn on yarn; assumed by fibre family if not given, 0.2 of "
                "para-aramid",
                0.2,
                ranged=True,
                ge=0.0,
                le=2.0,
            ),
            "yarns",
        ),
        Unread("export", NO_SLIP),
    ] = None


@dataclass(frozen=True, kw_only=True)
class PanelNumbers:
    """Numbers of a panel. Models: "pinned" and "yarns" (resolved), as `panel.crossovers` has them, and
    "solids" of a patch of solid yarns."""

    yarn_failure: Annotated[
        bool,
        key(flag("whether a yarn fails at its strength"), "pinned yarns solids"),
        NoPlace("export", "nothing breaks"),
    ] = True
    rate_dependence: Annotated[
        bool,
        key(
            flag(
                "strength of the yarns as a function of their strain rate, and their modulus at high rates, from the "
                "table `[strain_rate]` of the fabric file, else assumed by fibre family "
                "([strength](../reports/yarns.md))"
            ),
            "pinned yarns",
        ),
        Unread("export", "false: cards have one strength"),
    ] = False

    def rate_in_words(self, fabrics: Iterable[Fabric]) -> str:
        """Say how stiffness and strength of the yarns of some fabrics follow the strain rate."""
        if not self.rate_dependence:
            return "Stiffness and strength of the yarns do not depend on it."
        sentences = []
        for fabric in fabrics:
            law = fabric.strain_rate
            assert law is not None  # a set-up with rate dependence has checked it
            low = min(law.strength)
            high = max(law.strength)
            sentence = f"{fabric.name}: strength {low:.3g} to {high:.3g} times that of slow tests"
            if law.modulus:
                sentence += f", modulus {law.modulus[-1]:.3g} times, that of the highest rate"
            sentences.append(f"{sentence}.")
        return " ".join(sentences)
