"""The solid yarn fitted to a plate curve before the crossover is calibrated (`weavecell calibrate --platen-curve`).

Writes solid.json beside the calibration, and a chapter of its report.
"""

from __future__ import annotations

from fabrics.errors import InputError
from fabrics.plate_curve import PlateCurve
from weavecell.report import pictures, pictures_solid
from weavecell.report.page import Figure, Section, Table
from weavecell.results import progress

EXPECTED = 25  # compressions, for the progress bar


def curve_for(fabric, path):
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


def fit(fabric, curve, out, *, jobs=1, executor="local", resume=False):
    """Fit, write solid.json into the folder `out`, and print what the curve determines; returns the SolidFit."""
    from unitcell3d.identify.solid_fit import fit_solid

    with progress.bar(f"Solid of {fabric.name} from plates") as advance:
        found = fit_solid(
            fabric,
            curve,
            jobs=jobs,
            executor=executor,
            keep=out / "solid",
            resume=resume,
            on_progress=lambda runs, rms: advance(runs / EXPECTED, f"misfit {1e6 * rms:.1f} µm"),
        )
    found.write(out / "solid.json")
    for name, value in found.values.items():
        low, high = found.intervals[name]
        known = "" if found.determined[name] else ", not determined by the curve"
        print(f"{name:<12}{value:.4g} ({low:.3g} .. {high:.3g}, 95 %{known}); from {_before(found.started, name):.4g}")
    rms = found.summary()["rms_before_m"]
    print(f"{'misfit':<12}{1e6 * found.rms:.1f} um rms, before {1e6 * rms:.1f}, to {curve.source}")
    return found


def chapter(found):
    """The chapter of a SolidFit."""
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
        f"E_c, V_c and K_r of both yarns, fitted to {found.curve.source}; misfit {1e6 * found.rms:.1f} µm rms, before "
        f"the fit {1e6 * found.summary()['rms_before_m']:.1f} µm. "
        + (f"The curve does not tell {' and '.join(loose)}." if loose else "The curve tells all three.")
    )
    content = pictures.render(pictures_solid.plates, found)
    return Section(
        "solid",
        "The solid yarn from a plate test",
        lead,
        (Figure(content, "svg", "What the plates close against their pressure; zero is free.", "solid"),),
        (Table(columns, rows, numeric=columns[1:4]),),
    )


def _before(fabric, name):
    """The value of the fabric's file, of the warp."""
    solid = fabric.solid_laws[0]
    return solid.K_r * solid.E_c if name == "K_r E_c" else getattr(solid, name)
