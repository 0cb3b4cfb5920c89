"""Tables of the study of one ply, as rows of text with a header each."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from validation.published.one_ply.study import Caption, Curve
from validation.published.shots import CAPTIONS, TESTED, TESTS

Rows = list[list[str]]
STRAIGHT = 0.9  # least coefficient of determination of a line whose slope is called a speed
_WORDS = {"stopped": "stops", "perforated": "perforates"}


def limits(curves: Sequence[Curve]) -> Rows:
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


def residual(curves: Sequence[Curve]) -> Rows:
    """One row a shot of the residual velocities."""
    rows = [["fabric", "strike velocity, m/s", "outcome", "residual velocity, m/s", "after, µs", "failed yarn segments",
             "energy error, %"]]  # fmt: skip
    for curve in curves:
        for shot in curve.shots:
            rows.append([
                curve.fabric, f"{shot.strike_velocity:.1f}", _WORDS[shot.outcome], f"{shot.residual_velocity:.1f}",
                f"{1e6 * shot.time:.0f}", f"{shot.failed}", f"{100 * shot.balance:.3f}",
            ])  # fmt: skip
    return rows


def captions(shots: Sequence[Caption]) -> Rows:
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


def waves(shots: Sequence[Caption]) -> Rows:
    """One row a stopped shot: crimps, and the speeds of the waves along warp and weft."""
    rows = [["fabric", "strike, m/s", "crimp warp / weft, %", "longitudinal wave warp / weft, m/s",
             "c / sqrt 2 warp / weft, m/s", "transverse wave warp / weft, m/s"]]  # fmt: skip
    for shot in shots:
        if shot.expected != "stopped":
            continue
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
