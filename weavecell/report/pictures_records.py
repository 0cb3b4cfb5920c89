"""Pictures of reduced records: compression of plies between platens, the motion of a projectile,
and that of one nose in several models."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from fabrics.base.counted import counted
from weavecell.report.pictures_style import BLUE, COLOURS, FAINT, INK, ORANGE
from weavecell.results.keys import find_axis

if TYPE_CHECKING:
    from weavecell.studies.compression_records import PressureLaw
    from weavecell.studies.displacement_record import Motion

WIDTH = 9.0


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


def draw_noses(pyplot: Any, curves: Sequence[Any], until: float, title: str) -> Any:
    """Draw the velocity of a nose in several models, in time and over its way.

    Parameters
    ----------
    curves : (name, t, z, v) of each, t (n,) [s], z [m], v [m/s]
    until : [s] to which the models are compared
    """
    figure, (in_time, over_way) = pyplot.subplots(1, 2, figsize=(WIDTH, 4.6), sharey=True)
    time, velocity, way = (
        find_axis(name, "patch") for name in ("time_s", "*_velocity_m_s", "*_way_m")
    )
    for (name, t, z, v), colour in zip(curves, COLOURS):
        speed = velocity.factor * v
        in_time.plot(time.factor * t, speed, color=colour, label=name)
        over_way.plot(way.factor * z, speed, color=colour)
    in_time.axvline(time.factor * until, color=FAINT, lw=1.0, ls=":")
    in_time.set(xlabel=time.label, ylabel=velocity.label)
    over_way.set(xlabel=way.label)
    in_time.legend()
    figure.suptitle(title)
    return figure
