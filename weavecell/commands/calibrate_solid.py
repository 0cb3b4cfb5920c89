"""The solid yarn fitted to a plate curve before the crossover is calibrated (`weavecell calibrate --platen-curve`).

Writes solid.json and law-interval.json beside the calibration, and a chapter of its report. The folder
solid-runs holds what is kept for --resume.
"""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fabrics import run_cache
from fabrics.checks import FilePath
from fabrics.errors import InputError
from fabrics.plate_curve import PlateCurve
from weavecell.report import pictures, pictures_solid
from weavecell.report.page import Figure, Section, Table
from weavecell.results import json_file, progress

if TYPE_CHECKING:
    from fabrics.compression import CompressionLaw
    from fabrics.fabric import Fabric
    from unitcell3d.identify.chain import LawInterval
    from unitcell3d.identify.platen_misfit import PlatenMisfit
    from unitcell3d.identify.solid_record import SolidFit

EXPECTED = 20  # trials, for the progress bar
RUNS = "solid-runs"


def curve_for(fabric: Fabric, path: FilePath | None) -> PlateCurve:
    """The plate curve of a file, or without one the pressure law at the fabric's measured areal density.

    Raises
    ------
    InputError : a bad file, or no measured areal density
    """
    if path is not None:
        return PlateCurve.read(path)
    if fabric.areal_density_measured is None:
        raise InputError(
            f"fabric {fabric.name} has no areal_density_measured, which the pressure law needs: give --platen-curve"
        )
    return PlateCurve.pressure_law(fabric.areal_density_measured)


def begin(out: Path, resume: bool) -> Path:
    """The folder of kept runs, emptied unless the command goes on."""
    if not resume:
        shutil.rmtree(out / RUNS, ignore_errors=True)
    return out / RUNS


def fit(fabric: Fabric, curve: PlateCurve, out: Path, *, resume: bool = False) -> SolidFit:
    """Fit, write solid.json into the folder `out`, and print what the curve determines; returns the SolidFit."""
    from unitcell3d.identify.solid_fit import fit_solid

    kept = run_cache.RunCache(begin(out, resume))
    key = run_cache.key(("fit", fabric, curve), fit_solid.__module__)
    if key not in kept:
        with progress.bar(f"Solid of {fabric.name} from platens") as advance:
            kept[key] = fit_solid(
                fabric,
                curve,
                on_progress=lambda trials, rms: advance(min(trials / EXPECTED, 0.99), f"misfit {1e6 * rms:.1f} µm"),
            )
    found = kept[key]
    found.write(out / "solid.json")
    for name, value in found.values.items():
        low, high = found.intervals[name]
        known = "" if found.determined[name] else ", not determined by the curve"
        print(f"{name:<12}{value:.4g} ({low:.3g} .. {high:.3g}, 95 %{known}); from {_before(found.started, name):.4g}")
    print(f"{'misfit':<12}{misfit(found.misfit)}, before {misfit(found.misfit_before)}, to {curve.source}")
    if found.misfit_checked is not None:
        print(f"{'':<12}on the mesh {found.sizes[1]}: {misfit(found.misfit_checked)}")
    return found


def misfit(of: PlatenMisfit) -> str:
    """A PlatenMisfit as a text."""
    return f"{1e6 * of.closure:.1f} um and {100 * of.pressure:.0f} % of the pressure (rms)"


def law_interval(
    found: SolidFit, law: CompressionLaw, out: Path, *, friction: float, jobs: int, executor: str
) -> tuple[LawInterval | None, dict[str, Any]]:
    """Solve the paths at the ends of the solid's intervals, write law-interval.json, print it; (LawInterval, around).

    `around` is {"a", "b": (low, high)} about the CompressionLaw `law`; None and {} where no law fits.
    """
    from unitcell3d.identify.chain import law_intervals

    with progress.bar(f"Intervals of {found.fabric.name}") as advance:
        (interval,) = law_intervals(
            [found], folder=out / RUNS, friction=friction, jobs=jobs, executor=executor,
            report=lambda done, total: advance(done / total, f"{done} of {total} paths"),
        )  # fmt: skip
    if isinstance(interval, Exception):
        print(f"{'intervals':<12}none: {interval}")
        return None, {}
    around = interval.around(law)
    json_file.write(out / "law-interval.json", interval_numbers(interval, around))
    a, b = (" .. ".join(f"{1e3 * end:.4f}" for end in around[key]) for key in "ab")
    print(f"{'of the solid':<12}a = {a} mm, b = {b} mm N^(1/3), 95 % of its constants")
    return interval, around


def interval_numbers(interval: LawInterval, around: Any) -> dict[str, Any]:
    """A LawInterval as plain types."""
    ends = [[None if law is None else {"a_m": law.a, "b_m_N^(1/3)": law.b} for law in pair] for pair in interval.ends]
    return {
        "a_interval_m": around["a"],
        "b_interval_m_N^(1/3)": around["b"],
        "laws_of_the_limits_of_solid.json": ends,
        "law_of_their_middle": {"a_m": interval.law.a, "b_m_N^(1/3)": interval.law.b},
    }


def chapter(found: SolidFit, around: Any) -> Section:
    """The chapter of a SolidFit, with the intervals `around` of the law."""
    rows = tuple(
        (
            name,
            f"{value:.4g}",
            f"{_before(found.started, name):.4g}",
            "{:.3g} to {:.3g}".format(*found.intervals[name]),
            "yes" if found.determined[name] else "no",
        )
        for name, value in found.values.items()
    )
    columns = ("parameter", "fitted [SI]", "the fabric's file", "95 % interval", "determined by the curve")
    loose = [name for name, known in found.determined.items() if not known]
    lead = (
        f"E_c, V_c and K_r of both yarns, fitted to {found.curve.source}; misfit {misfit(found.misfit)}, before "
        f"the fit {misfit(found.misfit_before)}. "
        + (f"The curve does not tell {' and '.join(loose)}." if loose else "The curve tells all three.")
        + "".join(
            f" What it leaves open makes {key} of the law {1e3 * low:.4f} to {1e3 * high:.4f} {unit} (95 %)."
            for (key, (low, high)), unit in zip(around.items(), ("mm", "mm N^(1/3)"))
        )
    )
    content = pictures.render(pictures_solid.plates, found)
    return Section(
        "solid",
        "The solid yarn from a plate test",
        lead,
        (Figure(content, "svg", "What the platens close against their pressure; zero is free.", "solid"),),
        (Table(columns, rows, numeric=columns[1:4]),),
    )


def _before(fabric, name):
    """The value of the fabric's file, of the warp."""
    solid = fabric.solid_laws[0]
    return solid.K_r * solid.E_c if name == "K_r E_c" else getattr(solid, name)
