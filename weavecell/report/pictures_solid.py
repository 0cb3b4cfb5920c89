"""Plot of a compression between plates, measured and computed."""

from __future__ import annotations

from typing import Any

from meshing.pictures_style import FAINT, FITTED, INK


def plates(pyplot: Any, fit: Any) -> Any:
    """Pressure against closure.

    Parameters
    ----------
    fit : unitcell3d.identify.solid_record.SolidFit
    """
    figure, axes = pyplot.subplots(figsize=(8.6, 4.6))
    pressure = 1e-6 * fit.pressure
    axes.plot(1e6 * fit.measured, pressure, "o", ms=6, mfc="white", mec=INK, mew=1.4, label="measured")
    axes.plot(1e6 * fit.before, pressure, "--", color=FAINT, lw=2, label="before the fit")
    axes.plot(1e6 * fit.computed, pressure, color=FITTED, lw=2.4, label="fitted")
    axes.set(xlabel="closed by the plates [µm]", ylabel="pressure [MPa]", yscale="log")
    axes.legend(loc="upper left")
    return figure
