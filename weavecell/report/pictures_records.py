"""Pictures of reduced records: compression of plies between platens, the motion of a projectile,
and that of one nose in several models."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import cycle
from typing import TYPE_CHECKING, Any

import numpy as np

from fabrics.base.counted import counted
from weavecell.report.pictures_style import BLUE, COLOURS, FAINT, INK, ORANGE
from weavecell.results.keys import find_axis

if TYPE_CHECKING:
    from weavecell.studies.compression_records import PressureLaw
    from weavecell.studies.displacement_record import Motion
    from weavecell.studies.pull_out_tests import FittedFriction

WIDTH = 9.0
# numbers of crossings at which a computed peak is drawn
CURVE = 12


def draw_compression(pyplot: Any, laws: Sequence[PressureLaw], title: str) -> Any:
    """Draw what each pack closes against pressure: its record, and the law that was fitted."""
    figure, axes = pyplot.subplots(figsize=(WIDTH, 5.4))
    for law, colour in zip(laws, COLOURS):
        name = counted(law.plies, "ply")
        if law.plies == 1:
            name = "1 ply"
        pressure, closed = law.curve()
        axes.plot(1e-6 * law.pressure, 1e6 * law.closed, ".", ms=4, color=colour, alpha=0.45)
        label = f"{name}: n = {law.exponent:.2f}, rms {1e6 * law.rms:.2g} µm"
        axes.plot(1e-6 * pressure, 1e6 * closed, color=colour, label=label)
    axes.set(
        xscale="log",
        xlabel="pressure [MPa]",
        ylabel="closed since the first load [µm]",
        title=title,
    )
    axes.legend()
    return figure


def draw_motion(pyplot: Any, motion: Motion, title: str, computed: Any = None) -> Any:
    """Draw the residual of the record, the velocity with its error, and the force with its error.

    Parameters
    ----------
    computed : {"time", "velocity", "contact_force": (n,)} of a shot, which is drawn beside; or None
    """
    time, speed, push = (find_axis(name, "shot") for name in ("time_s", "velocity_m_s", "force_N"))
    t = time.factor * motion.time
    figure, (residual, velocity, force) = pyplot.subplots(
        3, 1, figsize=(WIDTH, 9.6), sharex=True, height_ratios=(0.6, 1.2, 1.2)
    )
    off = 1e6 * (motion.measured - motion.displacement)
    residual.plot(t, off, ".", ms=3, color=FAINT)
    residual.set(ylabel="record less curve [µm]", title=title)
    for axes, value, error, (label, factor) in (
        (velocity, motion.velocity, motion.velocity_error, speed),
        (force, motion.force, motion.force_error, push),
    ):
        axes.fill_between(
            t,
            factor * (value - error),
            factor * (value + error),
            color=BLUE,
            alpha=0.2,
            lw=0,
            label="95 %",
        )
        axes.plot(
            t, factor * value, color=BLUE, label=f"record, up to {1e-3 * motion.bandwidth:.3g} kHz"
        )
        axes.set(ylabel=label)
    if computed is not None:
        at = time.factor * computed["time"]
        velocity.plot(at, speed.factor * computed["velocity"], color=ORANGE, label="computed")
        force.plot(at, push.factor * computed["contact_force"], color=ORANGE, label="computed")
        velocity.set_xlim(t[0], t[-1])
    force.axhline(0.0, color=INK, lw=0.8)
    force.set(xlabel=time.label)
    velocity.legend()
    force.legend()
    return figure


def draw_pull_outs(pyplot: Any, friction: FittedFriction, title: str) -> Any:
    """Draw measured load against displacement, slack taken off, and the computed one; peaks, where
    there are no records, against the number of crossings."""
    figure, axes = pyplot.subplots(figsize=(WIDTH, 5.4))
    if any(test.load.size for test in friction.tests):
        _draw_loads(axes, friction)
    else:
        _draw_peaks(axes, friction)
    axes.set(ylim=(0.0, None), title=title)
    axes.legend()
    return figure


def _draw_loads(axes, friction):
    from shellfabric.coupon.pull_out import follow
    from weavecell.studies.pull_out_tests import find_zero

    for group, colour in zip(friction.groups, cycle(COLOURS)):
        coupon = group.coupon
        reach = 0.0
        for test in group.tests:
            if test.load.size:
                moved = 1e3 * (test.displacement - test.zero)
                reach = max(reach, 1e-3 * float(moved[-1]))
                axes.plot(moved, test.load, color=colour, lw=0.8, alpha=0.45)
            else:
                axes.axhline(test.peak, color=colour, lw=0.8, alpha=0.45, ls=":")
        name = f"{coupon.crossings} crossings, {group.tests[0].pulled}, {coupon.pre_tension:g} N"
        label = f"{name}: measured"
        if friction.mu is not None and reach > 0:
            curve = follow(coupon.changed(mu=friction.mu, cohesion=friction.cohesion), reach)
            start = find_zero(curve.displacement, curve.load)
            label = f"{name}: computed (thick), measured"
            axes.plot(1e3 * (curve.displacement - start), curve.load, color=colour, lw=2.2)
        axes.plot([], [], color=colour, label=label)
    axes.set(xlabel="displacement of the crosshead without slack [mm]", ylabel="load [N]")


def _draw_peaks(axes, friction):
    for pulled, colour in zip(dict.fromkeys(test.pulled for test in friction.tests), COLOURS):
        groups = [group for group in friction.groups if group.tests[0].pulled == pulled]
        points = [(test.crossings, test.peak) for group in groups for test in group.tests]
        axes.plot(*zip(*points), "o", ms=5, color=colour, alpha=0.6, label=f"{pulled}, measured")
        if friction.mu is not None:
            # one line a tension
            for tension in dict.fromkeys(group.coupon.pre_tension for group in groups):
                alike = [one.coupon for one in groups if one.coupon.pre_tension == tension]
                ends = alike[0].crossings, alike[-1].crossings
                line = [
                    (number, friction.computed(alike[0].changed(crossings=number)))
                    for number in sorted({round(n) for n in np.linspace(*ends, CURVE)})
                ]
                name = f"{pulled}, computed, {tension:g} N"
                axes.plot(*zip(*line), color=colour, label=name)
    axes.set(xlabel="number of crossings", ylabel="peak load [N]")
