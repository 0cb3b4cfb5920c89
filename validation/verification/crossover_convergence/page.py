"""The study as a page of the documentation, every number and every judgement in it from the entries."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from fabrics.files import write_whole
from validation.commits import computed
from validation.marked_page import markdown
from validation.verification.crossover_convergence import tables
from validation.verification.crossover_convergence.axes import METHOD
from validation.verification.crossover_convergence.study import MEASURED, Study, measured, name

QUESTION = "How far are forces and compression law of the 3D crossover from their limit, and what changes them?"
CONVERGENCE = """![Distance of each force from its limit](figures/crossover-convergence.png)

*Distance of the forces at the ends of the paths from their limit as mesh, contact stiffness and smoothing length of the
contact are refined. Open symbols: the values have no observed order, and the limit is a least-squares fit.*"""
EFFECTS = """![Change of the forces with choices of the model](figures/crossover-effects.png)

*Change of each force from that of the base, in per cent, when one choice of the model is another.*"""


def write(study: Study, path: Path, stamp: str, command: str, drawn: Sequence[str]) -> None:
    """Write the page; its pictures are in figures/ beside it.

    Parameters
    ----------
    stamp : one line that says when, where and by which version
    command : that makes it
    drawn : names of the pictures there are
    """
    methods, models = ([axis for axis in study.axes if (axis.kind == METHOD) == of] for of in (True, False))
    parts = [
        f"# 3D crossover: sensitivity to mesh, contact and model\n\n*{QUESTION}*\n\n"
        f"{computed(command, stamp)} Not to be edited by hand. {stamp}",
        _scene(study),
        _reference(study),
        _summary(study),
        "## Choices of the method",
        *([CONVERGENCE] if "convergence" in drawn else []),
        *(_axis(study, axis) for axis in methods),
    ]
    if models:
        parts += [
            "## Choices of the model\n\nEach is another model, so it has an effect and no error.",
            EFFECTS,
            *(_axis(study, axis) for axis in models),
        ]
    with write_whole(path) as file:
        file.write("\n\n".join(part.rstrip("\n") for part in parts) + "\n")


def _scene(study):
    ends = ", ".join(f"{name} ({1e6 * d1:g}, {1e6 * d2:g}) µm" for name, (d1, d2) in study.paths.items())
    base = " x ".join(map(str, study.base.case.size))
    return (
        f"{study.fabric} is pulled along three paths to fixed end displacements (d1, d2) per end: {ends}. T1, T2 and "
        "F_c are those at the end of a path; a and b are the law d_c = a - b / (F_c + F0)^(1/3) fitted to all three. "
        f"One choice at a time is varied about a base: the quarter crossover, {base} hexahedra a yarn, all defaults. "
        "Bold: the base. CPU times are of the three paths together, in a process of its own with one thread."
    )


def _reference(study):
    rows = [
        [
            tables.heading(quantity),
            tables.text(quantity, value),
            tables.text(quantity, half),
            f"{100 * half / abs(value):.2f}",
        ]
        for quantity, (value, half) in study.reference.items()
        if measured(quantity) or quantity in tables.LAW
    ]
    used = [axis.name for axis in study.axes if axis.counted and study.limits.get(axis.name)]
    return (
        "## Reference\n\nThe base, moved by the distance to the limit of each choice that has one: "
        f"{', '.join(used)}. Its half width adds up the scatter of each extrapolation and a quarter of its step beyond "
        "the last value. The chart of the 3D crossover in [charts.md](charts.md) extrapolates its meshes alone: the "
        "two references differ by up to the sum of their uncertainties.\n\n"
        + markdown([["quantity", "reference", "+-", "+- [%]"], *rows], numbers=True)
    )


def _summary(study):
    best = ", then ".join(
        f"{name(study, entry)} ({entry.result['cpu']:.1f} s, {100 * entry.error:.2f} %)" for entry in study.best
    )
    return (
        "## Time against error\n\n![CPU time of the three paths against the largest error]"
        "(figures/crossover-pareto.png)\n\n*One crossover of "
        f"{study.fabric}: every choice of the method. Numbered: Pareto-optimal.*\n\n"
        f"The error is the largest of those in T1, T2 and F_c at the ends of {' and '.join(MEASURED)}. "
        f"Pareto-optimal: {best}. A method that costs more is named only if it reduces the error by a tenth."
    )


def _axis(study, axis):
    text = f"### {axis.name[0].upper()}{axis.name[1:]}\n\n"
    text += f"{axis.lead}\n\n" if axis.lead else ""
    text += markdown([tables.columns(study, axis.name), *tables.rows(study, axis.name)], numbers=True)
    failed = [
        f"{entry.label}, {path}: {why}" for entry in study.of(axis.name) for path, why in entry.result["failed"].items()
    ]
    if failed:
        text += "\nFailed: " + "; ".join(failed) + ".\n"
    orders = list(tables.order_rows(study, axis.name))
    if orders:
        text += f"\nTo the limit ({axis.unit} to zero):\n\n{markdown([tables.ORDERS, *orders], numbers=True)}"
    return text
