"""What the free offset of the platen curve, and the pressure from which it is compared, change in the misfit of a fit.

    python -m validation.published.platen.offset CHAIN [--page PAGE]

CHAIN is the folder of `weavecell calibrate --all --fit-solid`. The thesis states that the initial segment of its
compression records is truncated (chapter 7), so the closure is known up to a constant: one shift per curve is free in
the fit (`unitcell3d.identify.solid_fit`). Here the misfit of each fitted crossover is computed with that shift and
without it (both curves begin at the first pressure), and with it from higher first pressures on, without another fit.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.interpolate import PchipInterpolator

from fabrics import catalogue
from fabrics.checks import FloatArray
from fabrics.errors import InputError
from unitcell3d.identify.platen_misfit import misfit_of_points
from validation.program import program, publish
from weavecell.report.marked_page import markdown

FROM = (1e5, 3e5)  # [Pa] higher first pressures
MARKS = "<!-- offset of the platen curves -->", "<!-- end of the offsets -->"
HEAD = [
    "fabric", "shift [µm]", "misfit with the shift [µm]", "of the pressure [%]", "without [µm]", "of the pressure [%]",
    *(f"with the shift, from {1e-6 * P:g} MPa, of the pressure [%]" for P in FROM),
]  # fmt: skip


class Offset(NamedTuple):
    """Misfits of one fabric.

    Parameters
    ----------
    shift : [m] what the measured curve closes more than the computed one below the pressures of the best alignment:
        closure of the aligned computed curve at the first pressure, where the measured one is 0
    closure, pressure : [m], [-] rms with the free shift
    closure_fixed, pressure_fixed : [m], [-] rms if both curves begin with closure 0 at the first pressure
    higher : (n,) [-] of the pressure, from the first pressures FROM on, shift free
    """

    shift: float
    closure: float
    pressure: float
    closure_fixed: float
    pressure_fixed: float
    higher: tuple[float, ...]


def offset(pressure: FloatArray, computed: FloatArray, measured: FloatArray) -> Offset:
    """Misfits of closures (n,) [m] computed at pressures (n,) [Pa], with and without a shift."""
    best = misfit_of_points(pressure, computed, measured)
    fixed = computed - computed[0] - (measured - measured[0])
    lnP = PchipInterpolator(computed - computed[0], np.log(pressure), extrapolate=False)
    closed = np.clip(measured - measured[0], 0.0, computed[-1] - computed[0])
    ratio = np.expm1(lnP(closed) - np.log(pressure))
    higher = tuple(misfit_of_points(*(part[pressure >= P] for part in (pressure, computed, measured))) for P in FROM)
    return Offset(
        float(computed[0] - np.mean(computed - measured) - measured[0]), best.closure, best.pressure, _rms(fixed),
        _rms(ratio), tuple(found.pressure for found in higher),
    )  # fmt: skip


def read(chain: Path, fabric: str) -> Offset:
    """The misfits of a fabric's fit.

    Raises
    ------
    InputError : the folder has no fit of this fabric
    """
    path = chain / fabric / "solid.json"
    try:
        content = json.loads(path.read_text("utf-8"))
        arrays = [np.array(content[key]) for key in ("pressure_Pa", "closure_computed_m", "closure_measured_m")]
    except (OSError, ValueError, KeyError):
        raise InputError(f"has no fit of the solid of {fabric}", file=chain) from None
    return offset(*arrays)


def table(found: dict[str, Offset]) -> list[list[str]]:
    """A header and a row a fabric."""
    rows = [HEAD]
    for name, one in found.items():
        shares = (one.pressure, one.pressure_fixed, *one.higher)
        free, fixed, *higher = (f"{100 * share:.0f}" for share in shares)
        rows.append(
            [name, f"{1e6 * one.shift:.1f}", f"{1e6 * one.closure:.1f}", free, f"{1e6 * one.closure_fixed:.1f}", fixed,
             *higher]
        )  # fmt: skip
    return rows


def _rms(values):
    return float(np.sqrt(np.mean(np.square(values))))


def main(chain: Path, *, page: Path | None = None) -> None:
    names = [name for name in catalogue.list_names() if catalogue.load(name).areal_density_measured is not None]
    made = markdown(table({name: read(chain, name) for name in names}))
    publish(made, page, MARKS)


if __name__ == "__main__":
    program(main)
