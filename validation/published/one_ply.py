"""python -m validation.published.one_ply [--out results/one-ply] [--page docs/reports/one-ply.md]

One ply of the six Kevlar fabrics: critical and residual velocities, histories and energies of the captions' shots,
back-face profiles, wave fronts, reactions. Writes a table (.csv) and a picture (.png) of each. With --page the tables
go into that page, between its marks, and the pictures beside it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from fabrics import catalogue
from fabrics.files import write_whole
from meshing.pictures_style import BLUE, FAINT, GREEN, INK, ORANGE, RED, WARP, WEFT
from shellfabric.cell.model import CellTable
from shellfabric.impact import ballistic_limit, lambert_jonas
from shellfabric.impact.ballistic_limit import Limit, Shot
from shellfabric.impact.lambert_jonas import LambertJonas
from shellfabric.impact.simulation import ImpactResult, ImpactSetup, run
from shellfabric.output.histories import Histories, HistoryRequest
from shellfabric.output.wave_fronts import Front, fronts
from validation.marked_page import markdown
from validation.program import program, publish_all, write_csv
from validation.published.shots import CAPTIONS, TESTED, TESTS
from weavecell.report.pictures import ENERGIES, render
from weavecell.results import provenance

MULTIPLES = (1.01, 1.03, 1.06, 1.1, 1.2, 1.35, 1.5, 1.75, 2.0)  # of the critical velocity
TOLERANCE = 0.25  # [m/s] between a stop and a perforation
INTERVAL = 1e-6  # [s] of the histories


@dataclass(frozen=True)
class Curve:
    """Residual velocities of one fabric.

    Parameters
    ----------
    fabric : name
    limit : Limit, the bisection
    shots : tuple of Shot, at MULTIPLES of the critical velocity
    fit : LambertJonas, with the critical velocity as its limit
    """

    fabric: str
    limit: Limit
    shots: tuple[Shot, ...]
    fit: LambertJonas


@dataclass(frozen=True)
class Caption:
    """One shot of a caption, with what was recorded of it.

    Parameters
    ----------
    fabric : name
    expected : outcome in the thesis's simulation, "stopped" or "perforated"
    result : ImpactResult
    """

    fabric: str
    expected: str
    result: ImpactResult

    @property
    def velocity(self) -> float:
        """[m/s] strike velocity."""
        return self.result.setup.strike_velocity

    @property
    def histories(self) -> Histories:
        """Histories along the yarns through the impact point and at the edges."""
        return self.result.histories[0]

    @property
    def fronts(self) -> tuple[Front, ...]:
        """Fronts of the longitudinal and the transverse wave, along warp and weft."""
        return fronts(self.histories)

    @property
    def kinetic_over_internal(self) -> float:
        """[-] kinetic energy of the cloth over its internal energy, mean over the last half of the shot."""
        energies, t = self.result.energies, self.result.t
        stored = energies["yarn_strain"] + energies["shear"]
        late = (t > 0.5 * t[-1]) & (stored > 0)
        return float(np.mean(energies["kinetic_fabric"][late] / stored[late]))


@cache
def table(fabric: str) -> CellTable:
    """The cell's table of one fabric."""
    return setup(fabric, 100.0).table()


def setup(fabric: str, velocity: float, history: HistoryRequest | None = None) -> ImpactSetup:
    """One shot at the thesis's panel."""
    return ImpactSetup(catalogue.load(fabric).with_effective_density(), velocity, history=history)


def curve(fabric: str) -> Curve:
    """Critical velocity and residual velocities of one fabric.

    Raises
    ------
    InputError, UnstableError : as `ballistic_limit.critical_velocity`
    """
    panel = setup(fabric, 100.0).panel(table(fabric))
    limit = ballistic_limit.critical_velocity(panel, tolerance=TOLERANCE)
    strikes = [multiple * limit.velocity for multiple in MULTIPLES]
    shots = ballistic_limit.shoot(panel, strikes)
    through = [shot for shot in shots if shot.perforated]
    fit = lambert_jonas.fit(
        [shot.strike_velocity for shot in through],
        [shot.residual_velocity for shot in through],
        limit=limit.velocity,
    )
    return Curve(fabric, limit, shots, fit)


def captions() -> tuple[Caption, ...]:
    """The twelve shots of the captions, in the order of the thesis.

    Raises
    ------
    UnstableError : as `simulation.run`
    """
    found = []
    for fabric, velocities in CAPTIONS.items():
        for velocity, expected in zip(velocities, ("stopped", "perforated")):
            shot = setup(fabric, velocity, HistoryRequest(interval=INTERVAL))
            found.append(Caption(fabric, expected, run(shot, table=table(fabric))))
    return tuple(found)


Rows = list[list[str]]
STRAIGHT = 0.9  # least coefficient of determination of a line whose slope is called a speed
_WORDS = {"stopped": "stops", "perforated": "perforates"}


def limit_table(curves: Sequence[Curve]) -> Rows:
    """Critical velocity of each fabric beside the two captions of the thesis, and the Lambert-Jonas curve."""
    rows = [["fabric", "thesis's simulation stops / perforates at, m/s", "test stops / perforates at, m/s",
             "computed critical velocity, m/s", "a (95 %)", "p (95 %)", "rms of the fit, m/s"]]  # fmt: skip
    for curve in curves:
        low, high = CAPTIONS[curve.fabric]
        test = f"{TESTS[0]:g} / {TESTS[1]:g}" if curve.fabric == TESTED else "-"
        fitted = [_interval(getattr(curve.fit, name), curve.fit.intervals[name]) for name in ("a", "p")]
        velocity = f"{curve.limit.velocity:.1f}"
        if not low < curve.limit.velocity < high:
            velocity = f"**{velocity}**"
        rows.append([curve.fabric, f"{low:g} / {high:g}", test, velocity, *fitted, f"{curve.fit.residual_rms:.1f}"])
    return rows


def _interval(value: float, interval: tuple[float, float] | None) -> str:
    return f"{value:.2f} ({interval[0]:.2f} to {interval[1]:.2f})" if interval else f"{value:.2f} (bound)"


def residual_table(curves: Sequence[Curve]) -> Rows:
    """One row a shot of the residual velocities."""
    rows = [["fabric", "strike velocity, m/s", "outcome", "residual velocity, m/s", "after, µs", "cut yarns",
             "energy error, %"]]  # fmt: skip
    for curve in curves:
        for shot in curve.shots:
            rows.append([
                curve.fabric, f"{shot.strike_velocity:.1f}", _WORDS[shot.outcome], f"{shot.residual_velocity:.1f}",
                f"{1e6 * shot.time:.0f}", f"{shot.cut_yarns:.1f}", f"{100 * shot.balance:.3f}",
            ])  # fmt: skip
    return rows


def caption_table(shots: Sequence[Caption]) -> Rows:
    """One row a caption: outcome, duration, deflection, tensions, ratio of energies, balance."""
    rows = [["fabric", "strike, m/s", "thesis's simulation", "computed", "after, µs", "peak deflection, mm",
             "peak tension warp / weft, N", "of the strength", "kinetic / internal energy",
             "energy error, %"]]  # fmt: skip
    for shot in shots:
        result = shot.result
        text = _WORDS[result.outcome]
        if result.outcome == "perforated":
            text += f", {result.residual_velocity:.0f} m/s left"
        peaks = result.peak_tension
        strengths = [yarn.strength for yarn in result.setup.fabric.weave.yarns]
        rows.append([
            shot.fabric, f"{shot.velocity:g}", _WORDS[shot.expected],
            text if result.outcome == shot.expected else f"**{text}**", f"{1e6 * result.t[-1]:.0f}",
            f"{1e3 * result.max_deflection:.1f}", f"{peaks[0]:.0f} / {peaks[1]:.0f}",
            f"{peaks[0] / strengths[0]:.2f} / {peaks[1] / strengths[1]:.2f}",
            f"{shot.kinetic_over_internal:.2f}", f"{100 * result.energy_error_max:.3f}",
        ])  # fmt: skip
    return rows


def wave_table(shots: Sequence[Caption]) -> Rows:
    """One row a stopped shot: crimps, and the speeds of the waves along warp and weft."""
    rows = [["fabric", "strike, m/s", "crimp warp / weft, %", "longitudinal wave warp / weft, m/s",
             "c / sqrt 2 warp / weft, m/s", "transverse wave warp / weft, m/s"]]  # fmt: skip
    for shot in _stopped(shots):
        yarns = shot.result.setup.fabric.weave.yarns
        speed = {(front.kind, front.family): front.speed if front.r2 >= STRAIGHT else np.nan for front in shot.fronts}
        rows.append([
            shot.fabric, f"{shot.velocity:g}", " / ".join(f"{100 * yarn.crimp:.2f}" for yarn in yarns),
            _pair(speed, "longitudinal"), " / ".join(f"{yarn.wave_speed / np.sqrt(2):.0f}" for yarn in yarns),
            _pair(speed, "transverse"),
        ])  # fmt: skip
    return rows


def _pair(speed: dict[tuple[str, str], float], kind: str) -> str:
    found = (speed[kind, family] for family in ("warp", "weft"))
    return " / ".join("no line" if np.isnan(one) else f"{one:.0f}" for one in found)


US, MM = 1e6, 1e3
_INSTANTS = (50, 100, 150, 200, 250, 300)  # [us] of the back-face profiles


def draw_residual(pyplot: Any, curves: Sequence[Curve]) -> Any:
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


def draw_limits(pyplot: Any, curves: Sequence[Curve]) -> Any:
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
    figure.legend(*axes.get_legend_handles_labels(), loc="outside lower center", ncols=1)
    return figure


def _stopped(shots):
    return [shot for shot in shots if shot.expected == "stopped"]


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
    chosen = [shot for shot in _stopped(shots) if shot.fabric in ("S-720", "S-726")]
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


def draw_fronts(pyplot: Any, shots: Sequence[Caption]) -> Any:
    """Distance of the longitudinal and the transverse wave front from the impact point against time."""
    figure, grid = pyplot.subplots(2, 3, figsize=(10.4, 6.4), sharey=True)
    for axes, shot in zip(grid.flat, _stopped(shots)):
        for front in shot.fronts:
            colour = WARP if front.family == "warp" else WEFT
            mark = "-" if front.kind == "longitudinal" else "--"
            axes.plot(US * front.time, MM * front.place, mark, color=colour, lw=1.6,
                      label=f"{front.kind}, {front.family}")  # fmt: skip
        crimps = " / ".join(f"{100 * yarn.crimp:.1f}" for yarn in shot.result.setup.fabric.weave.yarns)
        axes.set_title(f"{shot.fabric}, {shot.velocity:g} m/s\ncrimp {crimps} %", fontsize=11)
        axes.set(xlim=(0, 180), ylim=(0, 105))
    for axes in grid[1]:
        axes.set_xlabel("time after strike [µs]")
    figure.supylabel("distance of the front from the impact point [mm]", fontsize=12)
    figure.legend(*grid[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=4)
    return figure


def reactions(pyplot: Any, shots: Sequence[Caption]) -> Any:
    """Tension at the clamped ends of the two yarns through the impact point, one panel a stopped shot."""
    figure, grid = pyplot.subplots(2, 3, figsize=(10.4, 6.2), sharey=True)
    for axes, shot in zip(grid.flat, _stopped(shots)):
        for family, colour in (("warp", WARP), ("weft", WEFT)):
            axes.plot(US * shot.result.t, shot.result.reactions[family], color=colour, lw=1.6, label=f"{family} yarn")
        axes.set_title(f"{shot.fabric}, {shot.velocity:g} m/s")
        axes.set_xlim(0, None)
    grid[0, 0].legend(loc="upper left")
    figure.supxlabel("time after strike [µs]", fontsize=12)
    figure.supylabel("tension at the clamped end [N]", fontsize=12)
    return figure


def main(*, out: Path = Path("results/one-ply"), page: Path | None = None) -> None:
    stamp = provenance.stamp()  # before a page of the checkout is written to
    curves, shots = [curve(fabric) for fabric in CAPTIONS], captions()
    tables = {
        "limits": limit_table(curves), "residual": residual_table(curves), "captions": caption_table(shots),
        "waves": wave_table(shots),
    }  # fmt: skip
    for name, rows in tables.items():
        write_csv(out / f"{name}.csv", rows)
    drawn: dict[Any, Any] = {draw_residual: curves, draw_limits: curves}
    drawn |= dict.fromkeys((velocities, energies, profiles, draw_fronts, reactions), shots)
    folder, prefix = (page.parent / "figures", "validation-") if page else (out, "")
    for draw, content in drawn.items():
        with write_whole(folder / f"{prefix}{draw.__name__.removeprefix('draw_')}.png", "wb") as file:
            file.write(render(draw, content, kind="png"))
    texts = {name: markdown(rows) for name, rows in tables.items()}
    publish_all(texts, page, "validation.published.one_ply", stamp)


if __name__ == "__main__":
    program(main)
