"""Plot of a compression between plates: the measured curve and the crossover's."""

from __future__ import annotations

from weavecell.style import FAINT, FITTED, INK


def plates(pyplot, fit):
    """Pressure against closure.

    Parameters
    ----------
    fit : unitcell3d.fit_solid.SolidFit
    """
    figure, axes = pyplot.subplots(figsize=(8.6, 4.6))
    pressure = 1e-6 * fit.pressure
    axes.plot(1e6 * fit.measured, pressure, "o", ms=6, mfc="white", mec=INK, mew=1.4, label="measured")
    axes.plot(1e6 * fit.before, pressure, "--", color=FAINT, lw=2, label="before the fit")
    axes.plot(1e6 * fit.computed, pressure, color=FITTED, lw=2.4, label="fitted")
    axes.set(xlabel="closed by the plates [µm]", ylabel="pressure [MPa]", yscale="log")
    axes.legend(loc="upper left")
    return figure
