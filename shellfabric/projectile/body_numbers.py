"""Numbers of a projectile's body, each declared once, with the bodies that have it, as `PanelNumbers`
are: the metals and the drawing of a body of metal, and the bore of the elastic bar."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any

from fabrics import metals
from fabrics.base.schema import flag, key, named, quantity


@dataclass(frozen=True, kw_only=True)
class BodyNumbers:
    """Numbers of a body, other than a rigid one. Models: "metal" and "elastic_bar", as
    `projectile.body` has them."""

    bore_diameter: Annotated[
        float | None,
        key(
            quantity(
                "diameter of a bore into the rear of the elastic bar; its depth follows from the mass",
                "m",
                "4.5 mm",
            ),
            "elastic_bar",
        ),
    ] = None
    core: Annotated[
        Any,
        key(
            named(
                'metal of the core of a body "metal"; if not given lead',
                *metals.list_names(),
                kind=metals.Metal,
            ),
            "metal",
        ),
    ] = None
    jacket: Annotated[
        Any,
        key(
            named(
                'metal of the jacket of a body "metal"; none if not given',
                *metals.list_names(),
                kind=metals.Metal,
            ),
            "metal",
        ),
    ] = None
    jacket_thickness: Annotated[
        float | None,
        key(quantity("thickness of the jacket; required with a jacket", "m", "0.5 mm"), "metal"),
    ] = None
    bare_tip: Annotated[
        float | None,
        key(
            quantity(
                "length of the tip that the jacket leaves bare; none if not given", "m", "2 mm"
            ),
            "metal",
        ),
    ] = None
    open_base: Annotated[
        bool | None,
        key(flag("whether the jacket leaves the base bare; if not given it does"), "metal"),
    ] = None
    cavity_diameter: Annotated[
        float | None,
        key(
            quantity(
                "diameter of a conical hole in the tip of a hollow point, at most the diameter of the flat of the tip; "
                "given with cavity_depth",
                "m",
                "3 mm",
            ),
            "metal",
        ),
    ] = None
    cavity_depth: Annotated[
        float | None,
        key(quantity("depth of that hole; given with cavity_diameter", "m", "4 mm"), "metal"),
    ] = None
    element_size: Annotated[
        float | None,
        key(
            quantity(
                'size of the elements of a body "metal"; if not given a tenth of the diameter',
                "m",
                "0.6 mm",
            ),
            "metal",
        ),
    ] = None
