"""Numbers of a panel, each declared once: here.

A line has the type of a number, what an input file says of it (`fabrics.base.schema`), the models of
the yarns that read it, and its default. From the line follow the key of the table [panel] with its
checks, page and keyword; a field of `ImpactSetup` and of each `Panel`; and what kernels read,
`const.panel.NAME` of the membrane and `zone.panel.NAME` of resolved yarns, NaN where it is None.
A model that does not read a number refuses it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from fabrics.base.schema import flag, key


@dataclass(frozen=True, kw_only=True)
class PanelNumbers:
    """Numbers of a panel. Models: "pinned" and "yarns" (resolved), as `panel.crossovers` has them, and
    "solids" of a patch of solid yarns."""

    yarn_failure: Annotated[
        bool, key(flag("whether a yarn fails at its strength"), "pinned yarns solids")
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
    ] = False
