"""Pictures of the study: convergence along the choices that have a limit, effects of the others, time against error."""

from __future__ import annotations

from pathlib import Path

import matplotlib

from validation.verification.crossover_convergence.study import Study

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import TwoSlopeNorm

from fabrics.files import replace_whole
from meshing.pictures_style import COLOURS
from validation.verification.crossover_convergence.axes import MODEL
from validation.verification.crossover_convergence.study import measured, name, quantities

INK, FAINT = "#1d2733", "#8a94a0"
MARKERS = ("o", "s", "^", "D", "v", "P")
CONVERGING = ("mesh", "penalty", "toe")
LEAST = 1e-5  # of a value: nothing below is shown


def draw_all(study: Study, folder: Path) -> list[str]:
    """Write the pictures that there is something for into a folder; returns their names."""
    drawn = {"pareto": pareto}
    if any(study.limits.get(choice) for choice in CONVERGING):
        drawn["convergence"] = convergence
    if any(axis.kind == MODEL for axis in study.axes):
        drawn["effects"] = effects
    for title, draw in drawn.items():
        figure = draw(study)
        with replace_whole(folder / f"crossover-{title}.png") as beside:
            figure.savefig(beside, dpi=150)
        plt.close(figure)
    return list(drawn)


def convergence(study: Study) -> matplotlib.figure.Figure:
    """Distance of each force from its limit, one panel a choice; hollow where the limit has no observed order."""
    names = [choice for choice in CONVERGING if study.limits.get(choice)]
    figure, row = plt.subplots(
        1, max(len(names), 1), figsize=(4.6 * max(len(names), 1), 4.9), sharey=True, squeeze=False
    )
    forces = [force for force in study.reference if measured(force)]
    for axes, choice in zip(row[0], names):
        entries = [entry for entry in study.of(choice) if not entry.result["failed"]]
        orders = []
        for number, quantity in enumerate(forces):
            limit = study.limits[choice][quantity]
            x = np.array([entry.x for entry in entries])
            away = np.array([abs(quantities(entry.result)[quantity] / limit.limit - 1) for entry in entries])
            sure = limit.basis == "Richardson"
            orders += [limit.order] if sure else []
            colour = COLOURS[number % 6]
            axes.plot(
                x, np.maximum(100 * away, 100 * LEAST), color=colour, marker=MARKERS[number % 6], ms=6.5, lw=1.5,
                mfc=colour if sure else "white", mec=colour, ls="-" if sure else "--", label=quantity,
            )  # fmt: skip
        note = f"orders observed {min(orders):.1f} to {max(orders):.1f}" if orders else "no order observed"
        unit = next(axis.unit for axis in study.axes if axis.name == choice)
        axes.set(xlabel=unit, xscale="log", yscale="log")
        axes.set_title(choice, loc="left", fontsize=13, fontweight="bold", color=INK)
        if choice == "mesh":
            axes.set_xticks([entry.x for entry in entries], [entry.label.replace(" ", "") for entry in entries])
            axes.set_xticks([], minor=True)
            axes.tick_params(axis="x", labelsize=8)
        axes.text(0.03, 0.97, note, transform=axes.transAxes, va="top", fontsize=10, color=INK)
        _plain(axes)
    row[0][0].set_ylabel("distance from the limit [%]")
    handles, labels = row[0][0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="lower center", ncols=3, frameon=False)
    figure.text(
        0.995, 0.99, "hollow and dashed: the values have no order, their limit is a least-squares fit", ha="right",
        va="top", fontsize=9, color=FAINT,
    )  # fmt: skip
    figure.tight_layout(rect=(0, 0.12, 1, 0.96))
    return figure


def effects(study: Study) -> matplotlib.figure.Figure:
    """Change of each quantity from the base, in per cent, of the choices of another model."""
    rows = [
        entry
        for axis in study.axes
        if axis.kind == MODEL
        for entry in study.of(axis.name)
        if entry.case != study.base.case
    ]
    columns = [force for force in study.reference if measured(force)]
    table = np.array([[100 * entry.change.get(force, np.nan) for force in columns] for entry in rows])
    figure, axes = plt.subplots(figsize=(11, 1.6 + 0.34 * max(len(rows), 1)), layout="constrained")
    shown = np.clip(table, -20, 20)
    axes.imshow(shown, cmap="RdBu_r", norm=TwoSlopeNorm(0, -20, 20), aspect="auto")
    for i, line in enumerate(table):
        for j, value in enumerate(line):
            dark = abs(value) > 13
            text = "failed" if np.isnan(value) else f"{value:+.2g}" if abs(value) >= 0.005 else "0"
            axes.text(j, i, text, ha="center", va="center", fontsize=10, color="white" if dark else INK)
    axes.set_xticks(range(len(columns)), [force.replace(", ", "\n") for force in columns], fontsize=10)
    axes.set_yticks(range(len(rows)), [f"{entry.axis}: {entry.label}" for entry in rows], fontsize=10)
    axes.tick_params(length=0, top=True, labeltop=True, bottom=False, labelbottom=False)
    for side in axes.spines.values():
        side.set_visible(False)
    axes.set_title("change from the base, % (colours end at 20 %)", fontsize=12, loc="left", color=INK, pad=12)
    return figure


def pareto(study: Study) -> matplotlib.figure.Figure:
    """CPU time of the three paths against the largest error in the forces; methods that none beats are named."""
    figure, axes = plt.subplots(figsize=(12.5, 6.4), layout="constrained")
    shown = list({entry.case: entry for entry in study.entries if entry.error is not None}.values())
    best = [entry.case for entry in study.best]
    others = [entry for entry in shown if entry.case not in best]
    axes.plot(*_place(others), "o", ms=6, mfc="#d5dbe1", mec=FAINT, ls="", label="the others")
    axes.plot(*_place(study.best), "o-", ms=9, color=COLOURS[0], lw=1.6, label="Pareto-optimal")
    lines = []
    for number, entry in enumerate(study.best, 1):
        x, y = _place([entry])
        axes.annotate(
            str(number), (x[0], y[0]), xytext=(-9, -15), textcoords="offset points", ha="center", fontsize=12,
            fontweight="bold", color=INK,
        )  # fmt: skip
        lines.append(f"{number}  {name(study, entry)}\n    {x[0]:.3g} s, {y[0]:.2g} %")
    axes.text(
        1.02, 0.97, "Pareto-optimal\n\n" + "\n".join(lines), transform=axes.transAxes, va="top", fontsize=11, color=INK,
        linespacing=1.5,
    )  # fmt: skip
    if study.base.case not in best and study.base.error is not None:
        x, y = _place([study.base])
        axes.plot(x, y, "D", ms=9, mfc="white", mec=COLOURS[3], mew=1.8, ls="", label="the base")
    unsure = 100 * max(half / abs(value) for force, (value, half) in study.reference.items() if measured(force))
    axes.axhspan(0, unsure, color="#f1ead9", zorder=0)
    axes.set(
        xlabel="CPU time of the three paths [s]", ylabel="largest error in T1, T2, F_c [%]", xscale="log", yscale="log"
    )
    low = min(unsure, *(100 * entry.error for entry in shown)) / 1.6
    axes.set_ylim(bottom=low)
    axes.text(
        0.01, unsure, f" within {unsure:.2g} %: no better known than the reference", fontsize=10, color=FAINT,
        va="top", transform=axes.get_yaxis_transform(),
    )  # fmt: skip
    axes.legend(frameon=False, loc="upper right", fontsize=11)
    _plain(axes)
    return figure


def _place(entries):
    return [entry.result["cpu"] for entry in entries], [100 * entry.error for entry in entries]


def _plain(axes):
    axes.grid(alpha=0.3, which="major")
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
