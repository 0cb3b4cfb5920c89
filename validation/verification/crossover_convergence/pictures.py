"""Pictures of the study: convergence along the choices that have a limit, effects of the others, time against error."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from meshing.pictures_style import BLUE, COLOURS, FAINT, INK, RED
from validation.program import save
from validation.verification.crossover_convergence.axes import MODEL
from validation.verification.crossover_convergence.study import Study, measured, name, quantities

MARKERS = ("o", "s", "^", "D", "v", "P")
CONVERGING = ("mesh", "penalty", "smoothing length")
LEAST = 1e-5  # of a value: nothing below is shown


def draw_all(study: Study, folder: Path) -> list[str]:
    """Write the pictures that there is something for into a folder; returns their names."""
    drawn = {"pareto": pareto}
    if any(study.limits.get(choice) for choice in CONVERGING):
        drawn["convergence"] = convergence
    if any(axis.kind == MODEL for axis in study.axes):
        drawn["effects"] = effects
    for title, draw in drawn.items():
        save(draw, study, to=folder / f"crossover-{title}.png", dpi=130)
    return list(drawn)


def convergence(pyplot: Any, study: Study) -> Any:
    """Distance of each force from its limit, one panel a choice; hollow where the limit has no observed order."""
    names = [choice for choice in CONVERGING if study.limits.get(choice)]
    figure, row = pyplot.subplots(1, max(len(names), 1), figsize=(10.4, 4.8), sharey=True, squeeze=False)
    forces = [force for force in study.reference if measured(force)]
    for axes, choice in zip(row[0], names):
        entries = [entry for entry in study.of(choice) if not entry.result["failed"]]
        x = np.array([entry.x for entry in entries])
        orders = []
        for number, quantity in enumerate(forces):
            limit = study.limits[choice][quantity]
            away = np.array([abs(quantities(entry.result)[quantity] / limit.limit - 1) for entry in entries])
            sure = limit.basis == "Richardson"
            orders += [limit.order] if sure else []
            colour = COLOURS[number % 6]
            axes.plot(
                x, np.maximum(100 * away, 100 * LEAST), color=colour, marker=MARKERS[number % 6], ms=6, lw=1.5,
                mfc=colour if sure else "white", ls="-" if sure else "--",
            )  # fmt: skip
        note = f"orders {min(orders):.1f} to {max(orders):.1f}" if orders else "no order observed"
        axes.set(xscale="log", yscale="log")
        axes.set_title(f"{choice}\n", fontsize=12)
        axes.text(0, 1.02, note, transform=axes.transAxes, va="bottom", fontsize=10)
        labels = [entry.label.replace(" ", "").replace("default", "1") for entry in entries]
        axes.set_xticks(x, labels, rotation=40 if choice == "mesh" else 0, fontsize=10)
        axes.set_xticks([], minor=True)
        axes.set_xlabel("hexahedra per yarn" if choice == "mesh" else f"{choice}, of the default")
    row[0][0].set_ylabel("distance from the limit [%]")
    handles = [pyplot.Line2D([], [], color=COLOURS[k % 6], marker=MARKERS[k % 6], lw=1.5) for k in range(len(forces))]
    figure.legend(handles, forces, loc="outside lower center", ncols=3)
    return figure


def effects(pyplot: Any, study: Study) -> Any:
    """Change of each quantity from the base, in per cent, of the choices of another model that change any by 0.1 %."""
    rows = [
        entry
        for axis in study.axes
        if axis.kind == MODEL
        for entry in study.of(axis.name)
        if entry.case != study.base.case
    ]
    columns = [force for force in study.reference if measured(force)]
    table = np.array([[100 * entry.change.get(force, np.nan) for force in columns] for entry in rows])
    kept = [i for i, line in enumerate(table) if not (np.abs(line) < 0.1).all()]
    rows, table = [rows[i] for i in kept], table[kept]
    figure, axes = pyplot.subplots(figsize=(10.4, 1.9 + 0.36 * max(len(rows), 1)))
    image = axes.imshow(np.clip(table, -20, 20), cmap="RdBu_r", vmin=-20, vmax=20, aspect="auto")
    for i, line in enumerate(table):
        for j, value in enumerate(line):
            text = "failed" if np.isnan(value) else f"{value:+.2g}" if abs(value) >= 0.005 else "0"
            axes.text(j, i, text, ha="center", va="center", fontsize=10, color="white" if abs(value) > 13 else INK)
    axes.set_xticks(range(len(columns)), [force.replace(", ", "\n") for force in columns], fontsize=10)
    axes.set_yticks(range(len(rows)), [f"{entry.axis}: {entry.label}" for entry in rows], fontsize=10)
    axes.tick_params(length=0, top=True, labeltop=True, bottom=False, labelbottom=False)
    axes.spines[:].set_visible(False)
    axes.grid(False)
    bar = figure.colorbar(image, ax=axes, extend="both", aspect=30)
    bar.set_label("change from the base [%]")
    bar.outline.set_visible(False)
    return figure


def pareto(pyplot: Any, study: Study) -> Any:
    """CPU time of the three paths against the largest error in the forces; Pareto-optimal methods are named."""
    figure, axes = pyplot.subplots(figsize=(10.4, 4.8))
    shown = list({entry.case: entry for entry in study.entries if entry.error is not None}.values())
    best = [entry.case for entry in study.best]
    others = [entry for entry in shown if entry.case not in best]
    axes.plot(*_place(others), "o", ms=6, mfc="#d5dbe1", mec=FAINT, label="other methods")
    for number, entry in enumerate(study.best, 1):
        x, y = (one[0] for one in _place([entry]))
        axes.plot(x, y, "o", ms=9, color=BLUE, label=f"{number}  {name(study, entry)}: {x:.3g} s, {y:.2g} %")
        axes.annotate(str(number), (x, y), xytext=(-8, -16), textcoords="offset points", ha="center", weight="bold")
    if study.base.case not in best and study.base.error is not None:
        axes.plot(*_place([study.base]), "D", ms=9, mfc="white", mec=RED, mew=1.8, label="the base")
    unsure = 100 * max(half / abs(value) for force, (value, half) in study.reference.items() if measured(force))
    axes.axhspan(1e-9, unsure, color="#f1ead9", zorder=0, label=f"reference known to ± {unsure:.2g} %")
    axes.set(xlabel="CPU time of the three paths [s]", ylabel="largest error in T1, T2, F_c [%]", xscale="log",
             yscale="log", ylim=(min(unsure, *(100 * entry.error for entry in shown)) / 1.6, None))  # fmt: skip
    figure.legend(loc="outside right upper", fontsize=10)
    return figure


def _place(entries):
    return [entry.result["cpu"] for entry in entries], [100 * entry.error for entry in entries]
