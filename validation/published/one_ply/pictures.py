"""Pictures of the study of one ply, from its curves and shots to matplotlib figures."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from meshing.pictures_style import BLUE, FAINT, GREEN, INK, ORANGE, RED, WARP, WEFT
from validation.published.one_ply.study import Caption, Curve
from validation.published.shots import CAPTIONS, TESTED, TESTS
from weavecell.report.pictures import ENERGIES

US, MM = 1e6, 1e3
_INSTANTS = (50, 100, 150, 200, 250, 300)  # [us] of the back-face profiles


def residual(pyplot: Any, curves: Sequence[Curve]) -> Any:
    """Residual against strike velocity with the Lambert-Jonas curve, one panel a fabric."""
    figure, grid = pyplot.subplots(2, 3, figsize=(10.4, 6.8), sharex=True, sharey=True)
    top = max(shot.strike_velocity for curve in curves for shot in curve.shots)
    for axes, curve in zip(grid.flat, curves):
        limit = curve.limit.velocity
        velocities = limit + (1.03 * top - limit) * np.linspace(0, 1, 300) ** 3
        axes.plot([0, 1.03 * top], [0, 1.03 * top], color=FAINT, lw=1, ls=":", label="no loss of velocity")
        axes.plot(velocities, curve.fit.residual_velocity(velocities), color=BLUE, label="Lambert-Jonas fit")
        through = [shot for shot in curve.shots if shot.perforated]
        stopped = [shot for shot in curve.shots if not shot.perforated]
        for shots, style, label in ((through, {"mfc": RED, "mec": "white"}, "computed, perforated"),
                                    (stopped, {"mfc": "white", "mec": GREEN}, "computed, stopped")):  # fmt: skip
            if shots:
                axes.plot([s.strike_velocity for s in shots], [s.residual_velocity for s in shots], "o", ms=6,
                          label=label, zorder=3, **style)  # fmt: skip
        axes.axvline(limit, color=ORANGE, lw=1.6, label="computed critical velocity")
        if curve.fabric == TESTED:
            axes.axvspan(*TESTS, color=INK, alpha=0.15, lw=0, label="between the two tests")
        axes.set_title(f"{curve.fabric}, {limit:.0f} m/s")
        axes.set(xlim=(80, 1.03 * top), ylim=(-8, 1.03 * top))
    handles = {label: handle for axes in grid.flat for handle, label in zip(*axes.get_legend_handles_labels())}
    for axes in grid[1]:
        axes.set_xlabel("strike velocity [m/s]")
    for axes in grid[:, 0]:
        axes.set_ylabel("residual velocity [m/s]")
    figure.legend(handles.values(), handles.keys(), loc="outside lower center", ncols=3)
    return figure


def limits(pyplot: Any, curves: Sequence[Curve]) -> Any:
    """Computed critical velocity of each fabric, the captions of the thesis's simulations and the two tests."""
    figure, axes = pyplot.subplots(figsize=(10.4, 3.8))
    for row, curve in enumerate(curves):
        first = row == 0
        axes.plot(CAPTIONS[curve.fabric], (row, row), "-", lw=7, color="#cfe0ec", solid_capstyle="butt",
                  label="thesis's simulations: from the caption that stops to the one that perforates"
                  if first else None)  # fmt: skip
        if curve.fabric == TESTED:
            axes.plot(TESTS, (row, row), "-", lw=3, color=INK, solid_capstyle="butt",
                      label="tests: stopped at 96, perforated at 110 m/s")  # fmt: skip
        axes.plot(curve.limit.velocity, row, "D", ms=8, color=ORANGE, mec="white",
                  label="computed, one element per crossover" if first else None)  # fmt: skip
    axes.set_yticks(range(len(curves)), [curve.fabric for curve in curves])
    axes.invert_yaxis()
    axes.set(xlabel="strike velocity [m/s]")
    handles, labels = axes.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=1)
    return figure


def velocities(pyplot: Any, shots: Sequence[Caption]) -> Any:
    """Velocity of the projectile against time, one panel a fabric with its two shots."""
    figure, grid = pyplot.subplots(2, 3, figsize=(10.4, 6.2), sharex=True, sharey=True)
    for axes, fabric in zip(grid.flat, CAPTIONS):
        for shot, colour in zip((s for s in shots if s.fabric == fabric), (GREEN, RED)):
            t, v = shot.result.step_history[:, 0], shot.result.step_history[:, 2]
            axes.plot(US * t, v, color=colour, label=f"{shot.velocity:g} m/s, {shot.result.outcome}")
        axes.axhline(0.0, color=FAINT, lw=1)
        axes.set_title(fabric)
        if axes.lines[:-1]:
            axes.legend(loc="upper right", fontsize=10)
    axes.set(xlim=(0, None), ylim=(-5, 245))
    figure.supxlabel("time after strike [µs]", fontsize=12)
    figure.supylabel("velocity of the projectile [m/s]", fontsize=12)
    return figure


def energies(pyplot: Any, shots: Sequence[Caption]) -> Any:
    """Where the strike energy goes, one panel a shot: shots that stop above, shots that perforate below."""
    ordered = [shot for k in (0, 3) for stops in (True, False) for shot in shots
               if shot.fabric in list(CAPTIONS)[k : k + 3] and (shot.expected == "stopped") == stops]  # fmt: skip
    shares = []
    for shot in ordered:
        energy = shot.result.energies
        shares.append({name: 100 * np.maximum(part, 0) / shot.result.strike_energy for name, part in energy.items()})
    known = [each for each in ENERGIES if any(np.max(share.get(each[0], 0.0)) > 0.5 for share in shares)]  # [%]
    figure, grid = pyplot.subplots(-(-len(ordered) // 3), 3, figsize=(10.4, 10.8), sharey=True, squeeze=False)
    for axes, shot, share in zip(grid.flat, ordered, shares):
        t = US * shot.result.t
        parts = [share.get(name, np.zeros(t.size)) for name, _, _ in known]
        axes.stackplot(t, parts, labels=[label for _, label, _ in known], colors=[colour for *_, colour in known])
        axes.axhline(100, color=INK, lw=1, ls=":")
        axes.set_title(f"{shot.fabric}, {shot.velocity:g} m/s: {shot.result.outcome}", fontsize=11)
        axes.set(xlim=(0, t[-1]), ylim=(0, 104))
    for axes in grid[-1]:
        axes.set_xlabel("time after strike [µs]")
    figure.supylabel("energy [% of the strike energy]", fontsize=12)
    figure.legend(*grid[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=4)
    return figure


def profiles(pyplot: Any, shots: Sequence[Caption]) -> Any:
    """Back-face deflection along warp and weft at given instants, one row a shot that stops."""
    chosen = [shot for shot in shots if shot.expected == "stopped" and shot.fabric in ("S-720", "S-726")]
    figure, grid = pyplot.subplots(len(chosen), 2, figsize=(10.4, 3.1 * len(chosen)), sharex=True, squeeze=False)
    for row, shot in zip(grid, chosen):
        for axes, family, colour in zip(row, ("warp", "weft"), (WARP, WEFT)):
            yarn = shot.histories.through(family)
            for number, instant in enumerate(_INSTANTS):
                if instant > US * shot.histories.t[-1]:
                    continue
                k = int(np.argmin(np.abs(US * shot.histories.t - instant)))
                shade = 0.25 + 0.75 * number / (len(_INSTANTS) - 1)
                axes.plot(MM * yarn.place[k], MM * yarn.deflection[k], color=colour, alpha=shade, lw=1.8,
                          label=f"{instant} µs")  # fmt: skip
            axes.set_title(f"{shot.fabric} at {shot.velocity:g} m/s, along the {family}")
            axes.set_xlim(0, None)
        row[0].set_ylabel("deflection [mm]")
        row[1].legend(loc="upper right", fontsize=10)
    for axes in grid[-1]:
        axes.set_xlabel("distance from the impact point [mm]")
    return figure


def fronts(pyplot: Any, shots: Sequence[Caption]) -> Any:
    """Distance of the longitudinal and the transverse wave front from the impact point against time."""
    stopped = [shot for shot in shots if shot.expected == "stopped"]
    figure, grid = pyplot.subplots(2, 3, figsize=(10.4, 6.4), sharey=True)
    for axes, shot in zip(grid.flat, stopped):
        for front in shot.fronts:
            colour = WARP if front.family == "warp" else WEFT
            mark = "-" if front.kind == "longitudinal" else "--"
            axes.plot(US * front.time, MM * front.place, mark, color=colour, lw=1.6,
                      label=f"{front.kind}, {front.family}")  # fmt: skip
        crimps = " / ".join(f"{100 * yarn.crimp:.1f}" for yarn in shot.result.setup.fabric.weave.yarns)
        axes.set_title(f"{shot.fabric}, {shot.velocity:g} m/s\ncrimp {crimps} %", fontsize=11)
        axes.set(xlim=(0, 180), ylim=(0, 105))
    handles, labels = grid[0, 0].get_legend_handles_labels()
    for axes in grid[1]:
        axes.set_xlabel("time after strike [µs]")
    figure.supylabel("distance of the front from the impact point [mm]", fontsize=12)
    figure.legend(handles, labels, loc="outside lower center", ncols=4)
    return figure


def reactions(pyplot: Any, shots: Sequence[Caption]) -> Any:
    """Tension at the clamped ends of the two yarns through the impact point, one panel a stopped shot."""
    stopped = [shot for shot in shots if shot.expected == "stopped"]
    figure, grid = pyplot.subplots(2, 3, figsize=(10.4, 6.2), sharey=True)
    for axes, shot in zip(grid.flat, stopped):
        for family, colour in (("warp", WARP), ("weft", WEFT)):
            axes.plot(US * shot.result.t, shot.result.reactions[family], color=colour, lw=1.6, label=f"{family} yarn")
        axes.set_title(f"{shot.fabric}, {shot.velocity:g} m/s")
        axes.set_xlim(0, None)
    grid[0, 0].legend(loc="upper left")
    figure.supxlabel("time after strike [µs]", fontsize=12)
    figure.supylabel("tension at the clamped end [N]", fontsize=12)
    return figure
