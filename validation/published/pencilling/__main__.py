"""python -m validation.published.pencilling [CASE ...] [--edge free] [--out FOLDER] [--page docs/reports/pencilling.md]

The runs of thesis Table 6-2 before the block of Table 6-1, and the bare block. Writes pencilling.csv, depths.png and
craters.png, and keeps each shot in shots/, so that --resume goes on with those that are missing. With --page the
table goes into that page, between the marks of its edges, the pictures beside it.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, Literal

import numpy as np

from fabrics import run_cache
from fabrics.errors import InputError
from meshing.pictures_style import BLUE, GREEN, INK, ORANGE, RED, SKY, STEEL
from validation.marked_page import markdown
from validation.program import program, publish, save, write_csv
from validation.published.pencilling.study import CASES, PROJECTILE, Case, fire

BARE, TEXT = "bare block", "4 plies, 924 g/m²"


def name_of(number: int) -> str:
    """A case in words."""
    case = CASES[number]
    plies = "1 ply" if case.plies == 1 else f"{case.plies} plies"
    return f"{number}: {plies}, {96 * case.modulus:.0f} GPa, {1e3 * case.mass:.0f} g/m²"


def table(shots: Any) -> list[Any]:
    """A header, and a row a shot."""
    rows = [("target", "outcome", "after, µs", "depth of the projectile, mm", "crater, mm", "half-width, mm",
             "wall against the face, deg", "hexahedra eroded", "energy error, %",
             "hourglass of the block, %")]  # fmt: skip
    for name, shot in shots.items():
        eroded = "-" if shot.block is None else str(int(shot.block.gone.sum()))
        glass = shot.energies.get("backing_hourglass", shot.energies.get("hourglass"))
        lost = shot.energies.get("kinetic_projectile", shot.energies.get("projectile"))
        rows.append((
            name, shot.outcome, f"{1e6 * shot.t[-1]:.0f}", f"{1e3 * shot.depth:.1f}", f"{1e3 * shot.crater_depth:.1f}",
            f"{1e3 * shot.half_width:.1f}", f"{np.degrees(shot.steepness):.0f}", eroded, f"{100 * shot.balance:.2f}",
            f"{100 * float(glass[-1]) / float(lost[0] - lost[-1]):.1f}",
        ))  # fmt: skip
    return rows


def main(
    cases: Sequence[int] = (4, 5, 2, 1, 3),
    *,
    edge: Literal["clamped", "free"] = "clamped",
    elements: int = 2,
    no_bare: bool = False,
    text: bool = False,
    resume: bool = False,
    out: Path = Path("results/pencilling"),
    page: Path | None = None,
) -> None:
    if unknown := [number for number in cases if number not in CASES]:
        raise InputError(key="CASE", value=unknown[0], allowed=f"one of {', '.join(map(str, CASES))}")
    wanted = {name_of(n): CASES[n] for n in cases}
    if text:
        wanted[TEXT] = Case(4, 1.0, 0.924)
    if not no_bare:
        wanted[BARE] = None
    fired = run_cache.results(
        fire, [(case, edge, elements) for case in wanted.values()], folder=out / "shots", resume=resume
    )
    shots = dict(sorted(zip(wanted, fired)))
    rows = table(shots)
    write_csv(out / "pencilling.csv", rows)
    folder, prefix = (
        (page.parent / "figures", {"clamped": "pencilling-", "free": "pencilling-free-"}[edge]) if page else (out, "")
    )
    save(compose_depths, shots, to=folder / f"{prefix}depths.png", dpi=110)
    covered = {name: shot for name, shot in shots.items() if shot.block is not None}
    save(compose_craters, covered, to=folder / f"{prefix}craters.png", dpi=110)
    marks = f"<!-- table of validation.published.pencilling, {edge} edges -->", "<!-- end of the table -->"
    publish(markdown(rows), page, marks)


_COLOURS = (BLUE, SKY, RED, ORANGE, GREEN, INK)
_DASHES = ("-", "--", "-", "--", "-.", "-")


def compose_depths(pyplot: Any, shots: Any) -> Any:
    """Displacement of the projectile through time, and the crater's face; the bare block, far deeper, on its own."""
    covered = {name: shot for name, shot in shots.items() if shot.block is not None}
    alone = {name: shot for name, shot in shots.items() if shot.block is None}
    widths = [1.25, 1, 0.7] if alone else [1.25, 1]
    figure, row = pyplot.subplots(1, len(widths), figsize=(12.4, 5.2), width_ratios=widths)
    left, right = row[:2]
    for (name, shot), colour, dash in zip(covered.items(), _COLOURS, _DASHES):
        left.plot(1e6 * shot.t, 1e3 * shot.z, dash, color=colour, label=name)
        order = np.argsort(shot.crater[:, 0])
        right.plot(1e3 * shot.crater[order, 0], 1e3 * shot.crater[order, 1], dash, color=colour)
    left.set(title="targets", ylabel="displacement of the projectile [mm]")
    right.set(title="crater at the end", xlabel="radius along the warp [mm]", ylabel="depth of the face [mm]")
    right.set_xlim(0, 45)
    right.invert_yaxis()
    for name, shot in alone.items():
        row[2].plot(1e6 * shot.t, 1e3 * shot.z, color=INK, label=name)
        row[2].set(title=name)
    for axes in (left, *row[2:]):
        axes.set(xlabel="time after strike [µs]", xlim=(0, None), ylim=(0, None))
    if covered:
        figure.legend(*left.get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return figure


def compose_craters(pyplot: Any, shots: Any) -> Any:
    """The blocks cut along the warp, mirrored, coloured by effective plastic strain, all to one scale, and the nose."""
    from matplotlib.collections import PolyCollection

    across = min(3, len(shots))
    down = -(-len(shots) // across)
    deepest = 1e3 * max(shot.block.depth for shot in shots.values())
    reach = max(30.0, 1.1 * deepest)
    most = max(float(shot.block.plastic[~shot.block.gone].max()) for shot in shots.values())
    tall = 10.6 / across * (1.3 * deepest + 14) / (2 * reach)
    figure, grid = pyplot.subplots(
        down, across, figsize=(11.4, 1.0 + down * (0.8 * tall + 0.5)), squeeze=False, sharex=True, sharey=True
    )
    for axes in grid.flat[len(shots) :]:
        axes.set_visible(False)
    for axes, (name, shot) in zip(grid.flat, shots.items()):
        block = shot.block
        x = block.nodes[block.bricks]
        cut = ~block.gone & (np.abs(x[:, [0, 1, 4, 5], 1]).max(axis=1) < 1e-9)
        corners = 1e3 * (x[cut][:, [0, 1, 5, 4]][..., [0, 2]] - np.array([0, block.face]))
        for side in (1, -1):
            faces = PolyCollection(corners * np.array([side, 1]), cmap="cividis_r", ec="#6b5a45", lw=0.2)
            faces.set_array(block.plastic[cut])
            faces.set_clim(0, most)
            axes.add_collection(faces)
        radius = 1e3 * PROJECTILE.radius
        nose = 1e3 * (float(shot.z[-1]) - block.face)
        axes.add_patch(pyplot.Rectangle((-radius, nose - 40), 2 * radius, 40, fc=STEEL, ec=INK, lw=0.6, zorder=3))
        axes.set(xlim=(-reach, reach), ylim=(1.3 * deepest + 2, -12), aspect="equal")
        axes.grid(False)
        axes.set_title(name, fontsize=10)
    for axes in grid[:, 0]:
        axes.set_ylabel("depth [mm]")
    for number, axes in enumerate(grid.flat[: len(shots)]):
        if number + across >= len(shots):
            axes.set_xlabel("from the impact point [mm]")
            axes.tick_params(labelbottom=True)
    bar = figure.colorbar(faces, ax=grid, shrink=0.7)
    bar.set_label("effective plastic strain [-]")
    bar.outline.set_visible(False)
    return figure


if __name__ == "__main__":
    program(
        main,
        elements="along each side of a crossover",
        no_bare="leave the bare block out",
        text="also four plies of 924 g/m², as the text has it",
        resume="take shots of this code that are done from the folder",
    )
