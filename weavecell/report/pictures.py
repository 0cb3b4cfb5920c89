"""Plots of the report, from plain arrays in SI units to matplotlib figures. Units are converted
here, on the axes."""

from __future__ import annotations

import io
import textwrap
from collections.abc import Callable, Mapping
from itertools import cycle
from typing import Any

import numpy as np

from fabrics.base.extras import explain_missing
from weavecell.report import page
from weavecell.report.pictures_style import (
    BLUE,
    COLOURS,
    DASHES,
    FAINT,
    GREEN,
    INK,
    ORANGE,
    PUBLISHED,
    PURPLE,
    RED,
    SKY,
    STEEL,
    WARP,
    WEFT,
    legend_beside,
)
from weavecell.results.display import US
from weavecell.results.keys import TABLES, find_axis

UM = 1e6

# energies from the largest and best known down to the losses: name in the results, name in the
# plot, colour
ENERGIES = (
    ("kinetic_projectile", "projectile, kinetic", "#c9d2db"),
    ("elastic_projectile", "projectile, elastic", "#97a6b5"),
    ("plastic_projectile", "projectile, plastic", "#5b6b7b"),
    ("kinetic_fabric", "fabric, kinetic", SKY),
    ("yarn_strain", "fabric, membrane", BLUE),
    ("shear", "fabric, shear", GREEN),
    ("bending", "fabric, bending", "#7fb8a4"),
    ("packing", "fabric, packing", "#a9cdbd"),
    ("failure_dissipation", "failure of yarns", RED),
    ("contact", "contact", ORANGE),
    ("friction", "friction", "#b5651d"),
    ("clamp_friction", "friction in the clamps", "#8c8c3f"),
    ("boundary_work", "work of pull-ins", "#4d6b3c"),
    ("viscous", "viscous", PURPLE),
    ("yarn_snap", "yarns that snap taut", "#e5c7dd"),
    ("recoil_of_cut_yarns", "recoil of cut yarns", "#d3aecd"),
    ("crossover_contact", "yarns, crossings pressed", "#6f9ceb"),
    ("neighbour_contact", "yarns, neighbours pressed", "#c2a83e"),
    ("crossover_friction", "yarns, friction of crossings", "#8fbc5a"),
    ("slack_contact", "yarns, contacts of slack ones", "#d46a92"),
    ("ply_collisions", "plies, collisions", "#a08bd6"),
    ("ply_contact_lost", "plies, contact lost", "#c9b8e8"),
    ("backing_kinetic", "block, kinetic", "#f3dfc1"),
    ("backing_elastic", "block, elastic", "#e3c08a"),
    ("backing_plastic", "block, plastic", "#c58f45"),
    ("backing_eroded", "block, eroded", "#8a5a1f"),
    ("backing_absorbed", "block, gone through its far faces", "#d9c7ae"),
    ("backing_viscous", "block, viscous", "#b79bb0"),
    ("backing_hourglass", "block, hourglass", "#7d6a86"),
    ("backing_contact", "block, contact springs", "#efc4a0"),
    ("backing_damped", "block, contact damping", "#d98f63"),
)
# of energies without a colour in ENERGIES, such as that of a new part, in turn
OTHER_COLOURS = "#4fa3a5", "#b8894a", "#7a9e3f", "#b45f7d"
LONGEST_LABEL = 28  # letters that the legend has room for in a line
# the balance, and what is drawn with the strain energy, the contact and the friction
NOT_DRAWN = "error", "formulation_residual", "ply_contact", "ply_friction"


def list_bands(energies: Mapping[str, Any]) -> list[tuple[str, str, str]]:
    """List (name, name in the plot, colour) of energies: ENERGIES, and after them what else there is, by
    the meaning of its key."""
    known = {name for name, *_ in ENERGIES}
    meanings = {key.name: key.meaning for key in TABLES["energies"]}
    others = [name for name in energies if name not in known and name not in NOT_DRAWN]
    texts = [meanings.get(name, name.replace("_", " ")).partition(";")[0] for name in others]
    labels = [textwrap.fill(text, LONGEST_LABEL) for text in texts]
    return [*ENERGIES, *zip(others, labels, cycle(OTHER_COLOURS))]


@explain_missing()
def render(draw: Callable, *arguments: Any, kind: str = "svg") -> bytes:
    """Draw with `draw(pyplot, ...)` in the project's style; returns the picture as bytes, "svg" or
    "png".

    The canvas is asked for it directly: `savefig` draws a figure that has a layout engine twice.
    """
    # modules that only write words of a run load no plotter
    from weavecell.report.pictures_figure import complete, plots

    with plots():
        from matplotlib import rcParams
        from matplotlib.backends.backend_svg import FigureCanvasSVG

        figure = complete(draw, *arguments)
        content = io.BytesIO()
        figure.set_dpi(rcParams["savefig.dpi"])
        if kind == "svg":
            FigureCanvasSVG(figure).print_svg(content, metadata={"Date": None})
        else:
            figure.canvas.print_png(content, pil_kwargs={"compress_level": 4})
    return content.getvalue()


def draw_figure(
    name: str, caption: str, draw: Callable, *arguments: Any, kind: str = "svg", **shape: bool
) -> page.Figure:
    """Draw a picture of a page.

    Parameters
    ----------
    name : of its file
    draw, arguments, kind : as in `render`
    shape : wide and tall, as in `page.Figure`
    """
    content = render(draw, *arguments, kind=kind)
    return page.Figure(content, kind, caption, name, **shape)


def place(
    figure: Any,
    left: float,
    right: float,
    bottom: float,
    top: float,
    *,
    across: float = 0.0,
    down: float = 0.0,
) -> None:
    """Set the margins of a figure without a layout engine, and the gaps between its axes, all in
    inches.

    A layout engine draws all text twice to measure it, which takes longer than drawing the picture.
    """
    rows, columns = figure.axes[0].get_gridspec().get_geometry()
    width, height = figure.get_size_inches()
    # width of one pair of axes
    wide = (width - left - right - (columns - 1) * across) / columns
    high = (height - bottom - top - (rows - 1) * down) / rows
    figure.subplots_adjust(
        left / width,
        bottom / height,
        1 - right / width,
        1 - top / height,
        across / wide,
        down / high,
    )


def fit(pyplot: Any, samples: Any, laws: Any, platen: Any = None) -> Any:
    """Draw contact force against compression of one yarn: samples of the 3D crossover and the laws.

    Parameters
    ----------
    samples : {path name: (F, d_c)} [N, m]
    laws : {label: CompressionLaw}, the fitted one first
    platen : (F, d_c) of the compression between plates, or None
    """
    figure, axes = pyplot.subplots(figsize=(10.4, 4.6))
    for (name, (F, d)), colour in zip(samples.items(), COLOURS):
        axes.plot(
            F,
            UM * np.asarray(d),
            "o",
            ms=5,
            color=colour,
            alpha=0.75,
            mew=0,
            label=f"3D crossover, {name}",
        )
    if platen is not None:
        F, d = platen
        axes.plot(
            F,
            UM * np.asarray(d),
            "s",
            ms=4.5,
            mfc="none",
            mec=FAINT,
            label="3D crossover between rigid plates",
        )
    top = max(float(np.max(F)) for F, _ in samples.values())
    force = np.linspace(0.0, 1.05 * top, 600)
    for (label, law), colour, dash in zip(laws.items(), (INK, PUBLISHED), DASHES):
        axes.plot(force, UM * law.d(force), dash, color=colour, label=label, zorder=3)
    axes.set(
        xlabel="contact force F [N]",
        ylabel="compression of one yarn d$_c$ [µm]",
        xlim=(0, 1.05 * top),
    )
    axes.set_ylim(bottom=min(0.0, axes.get_ylim()[0]))
    legend_beside(axes)
    return figure


def cell(pyplot: Any, cases: Any) -> Any:
    """Draw yarn tension against strain of the cell, one panel a load case.

    Parameters
    ----------
    cases : {title: {"strain": (n,), "curves": {label: (T1, T2)}, "points": (strain, T1, T2) or
        None}} [-, N]
    """
    figure, row = pyplot.subplots(
        1, len(cases), figsize=(10.4, 4.2), sharey=True, squeeze=False, layout="none"
    )
    place(figure, 0.75, 0.1, 0.6, 0.32, across=0.15)
    for axes, (title, case) in zip(row[0], cases.items()):
        for (label, tensions), dash in zip(case["curves"].items(), DASHES):
            _tensions(axes, case["strain"], tensions, label, ls=dash)
        if case.get("points") is not None:
            strain, *tensions = case["points"]
            circles = {"ls": "none", "marker": "o", "ms": 5, "mfc": "white", "mew": 1.4}
            _tensions(axes, strain, tensions, "3D crossover", **circles)
        axes.set_title(title, y=1.0)
        axes.set_xlabel("strain of the cell [%]")
        axes.set_xlim(left=0)
    row[0][0].set_ylabel("yarn tension [N]")
    # all axes share their limits, so this is set once everything is drawn
    row[0][0].set_ylim(bottom=0)
    row[0][0].legend(loc="upper left", fontsize=None if len(cases) < 4 else 9)
    return figure


def _tensions(axes, strain, tensions, label, **looks):
    """The tensions of both families against the strain of the cell."""
    for family, colour, tension in zip(("warp", "weft"), (WARP, WEFT), tensions):
        axes.plot(100 * strain, tension, color=colour, label=f"{family}, {label}", **looks)


def velocity(pyplot: Any, runs: Any) -> Any:
    """Draw the velocity of the projectile against time.

    Parameters
    ----------
    runs : {label: (t, v)} [s, m/s]; of runs of one strike velocity, the first is drawn broad, the
        next dashed over it
    """
    figure, axes = pyplot.subplots(figsize=(10.4, 4.2))
    strikes = list(dict.fromkeys(round(float(v[0]), 6) for _, v in runs.values()))
    seen = dict.fromkeys(strikes, 0)
    for label, (t, v) in runs.items():
        strike = round(float(v[0]), 6)
        broad = {}
        if seen[strike] == 0 and len(runs) > len(strikes):
            broad = {"lw": 5.5, "alpha": 0.4}
        axes.plot(
            US * t,
            v,
            DASHES[seen[strike] % 4],
            color=COLOURS[strikes.index(strike) % 6],
            label=label,
            **broad,
        )
        seen[strike] += 1
    axes.axhline(0.0, color=FAINT, lw=1)
    time, velocity = (find_axis(name, "histories").label for name in ("time", "velocity"))
    axes.set(xlabel=time, ylabel=velocity)
    axes.set_xlim(left=0)
    if len(runs) > 1:
        legend_beside(axes)
    return figure


def _draw_velocity_axes(pyplot, title, low, high):
    """Figure and axes of residual against strike velocities from low to high."""
    figure, axes = pyplot.subplots(figsize=(10.4, 5.2))
    strike, residual = map(find_axis, ("strike_velocity_m_s", "residual_velocity_m_s"))
    axes.set(title=title, xlabel=strike.label, ylabel=residual.label)
    axes.set(xlim=(low, high), ylim=(-0.02 * high, high))
    axes.plot([low, high], [low, high], color=FAINT, lw=1, ls=":", label="no loss of velocity")
    return figure, axes


def draw_tests(pyplot: Any, title: str, tests: Any) -> Any:
    """Draw residual against strike velocity of tests, with their V50.

    Parameters
    ----------
    tests : weavecell.runs.laboratory_tests.ReducedTests
    """
    table = tests.table
    strike = tests.table["strike_velocity_m_s"]
    velocities = [*strike]
    v50 = None
    if tests.posterior is not None:
        v50 = tests.posterior.velocities["V50"]
        velocities.append(v50.value)
    low = 0.94 * min(velocities)
    high = 1.02 * max(velocities)
    figure, axes = _draw_velocity_axes(pyplot, title, low, high)
    if v50 is not None:
        start, end = (max(low, min(high, v)) for v in v50[1:])
        axes.axvspan(start, end, color=STEEL, alpha=0.25, lw=0)
        words = f"V50 of the tests\n{v50.value:.1f} m/s\n(grey: 90 % interval)"
        axes.axvline(v50.value, color=STEEL, lw=1.5, label=words)
    fit = tests.lambert_jonas
    if not fit.reason:
        axes.plot(*fit.sample(high), color=STEEL, lw=1.2, label="tests, Lambert-Jonas")
    for outcome, fill in (("perforated", STEEL), ("stopped", "white")):
        residual = table["tested_residual_velocity_m_s"].where(table["tested"] == outcome).dropna()
        axes.plot(
            strike[residual.index],
            residual,
            "s",
            ms=7,
            mfc=fill,
            mec=STEEL,
            label=f"test, {outcome}",
        )
    legend_beside(axes, labelspacing=0.9)
    return figure
