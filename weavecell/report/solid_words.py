"""Constants of a fitted law and of a fitted solid, in words."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from fabrics.base.door import option
from weavecell.results import display
from weavecell.results.named_value import NamedValue

if TYPE_CHECKING:
    from fabrics.compression import CompressionLaw
    from unitcell3d.identify.solid_record import SolidFit

NAMES_OF_SOLID = ("E_c", "V_c", "K_r")


def say_parts(pair: Any) -> str:
    """Return the shares of warp and weft as "1.9 / 1.7 %"."""
    return display.number(pair, "%", ".2g").replace(", ", " / ") + " %"


def say_shares(shares: Mapping[str, float]) -> str:
    """Say what makes the range, the largest first."""
    parts = [
        f"{name} {display.number(share, '%', '.0f')} %"
        for name, share in shares.items()
        if share >= 0.005
    ]
    return ", ".join(parts) + " of its variance"


def say_kept(fitted: NamedValue, determined: bool) -> str:
    """Say what the measurements say of a constant that was not fitted."""
    if determined:
        return f"they would tell it: {fitted.interval()}, 95 %; {option('constants', '')}"
    return "they do not tell it"


def name_constants(
    a: Any, b: Any, rms: float | None = None, rms_name: str = "rms"
) -> tuple[NamedValue, ...]:
    """Name a and b of a law, each a number [m], [m N^(1/3)], the (low, high) of one, or None, and
    the rms [m] of its fit."""
    constants = []
    for name, given, unit in (("a", a, "m"), ("b", b, "m N^(1/3)")):
        if np.ndim(given):
            low, high = given
            constants.append(NamedValue(name, None, unit, low, high, form=".4f"))
        else:
            constants.append(NamedValue(name, given, unit, form=".4f"))
    return (*constants, NamedValue(rms_name, rms, "fine m", form=".2f"))


def list_solid(solid: SolidFit) -> list[tuple[NamedValue, NamedValue, bool]]:
    """List (constant of the solid with its interval, the same in the fabric's file, whether the
    curve determines it)."""
    listed = []
    for name, value in solid.values.items():
        low, high = solid.intervals[name]
        fitted = NamedValue(name, value, "1", low, high, margin=".3g")
        before = NamedValue(name, _read_value_of_file(solid.started, name), "1")
        listed.append((fitted, before, solid.determined[name]))
    return listed


def say_misfits(solid: SolidFit) -> Iterator[str]:
    """Say how the platens are met, on both meshes; nothing without a curve of platens."""
    platens = solid.platens
    if platens is None:
        return
    yield f"{say_misfit(platens.misfit)}, before {say_misfit(platens.misfit_before)}, to {platens.curve.source}"
    if platens.misfit_checked is not None:
        yield f"on the mesh {solid.sizes[1]}: {say_misfit(platens.misfit_checked)}"


def say_misfit(of: Any) -> str:
    """Say a PlatenMisfit."""
    closure = display.text(of.closure, "fine m", ".1f")
    pressure = display.text(of.pressure, "%", ".0f")
    return f"{closure} and {pressure} of the pressure (rms)"


def _read_value_of_file(fabric, name):
    """The value of the fabric's file, of the warp."""
    law = fabric.solid_laws[0]
    if name == "K_r E_c":
        return law.K_r * law.E_c
    return getattr(law, name)


def say_forces(law: CompressionLaw) -> str:
    """Say over which forces a law was fitted."""
    low, high = law.F_range or (np.nan, np.nan)
    return f"over F = {low:.2g} to {high:.3g} N"
