"""Impact on packs: outcomes, gaps, stacking, the elastic projectile (thesis sections 5.2.2, 5.2.4.2, 6.4.4)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from validation.claims.checks import series
from validation.claims.checks.impact import PERFORATED, STOPPED, outcome_of
from validation.claims.registry import Found, Run, RunResult, check

FILTER = 2e-6  # [s] over which a tension is averaged before it is held against the strength


def pack(fabric: str, velocity: float, plies: int, **changes: Any) -> Run:
    """A shot at a pack."""
    return Run.of("pack", fabric=fabric, velocity=velocity, plies=plies, **changes)


def noisy(fabric: str, velocity: float, plies: int, failure_time: float = 0.0) -> Run:
    """A shot at a pack whose plies push node on node, as a contact that makes noise; no guard ends it."""
    return Run.of("noisy_pack", fabric=fabric, velocity=velocity, plies=plies, failure_time=failure_time)


@check(lambda fabric, velocity, plies: {"run": pack(fabric, velocity, plies)})
def outcome(run: RunResult, fabric: str, velocity: float, plies: int) -> Found:
    cut = run["plies"]["cut_yarns"][-1]
    return {
        "outcome": outcome_of(run),
        "decided": outcome_of(run) in (STOPPED, PERFORATED),
        "note": f"residual velocity {max(run['residual'], 0):.0f} m/s, {1e3 * run['z'].max():.1f} mm deep after "
        f"{1e6 * run['t'][-1]:.0f} us; cut yarns by ply: {', '.join(f'{n:.1f}' for n in cut)}; deepest contact "
        f"{100 * run['deepest'].max():.0f} % of a ply; balance {100 * run['balance']:.2f} %",
    }


@check(lambda fabric, velocity, plies: {name: pack(fabric, velocity, plies, stacking=name) for name in _STACKS})  # type: ignore[has-type]
def stacking(aligned: RunResult, alternating: RunResult, fabric: str, velocity: float, plies: int) -> Found:
    """Velocity after 60 us, shape of the last ply but one, and what the contact between plies takes."""
    t = np.linspace(60e-6, min(run["t"][-1] for run in (aligned, alternating)), 60)
    lead = np.interp(t, aligned["t"], aligned["v"]) - np.interp(t, alternating["t"], alternating["v"])
    shapes = []
    for run in (aligned, alternating):
        _, cones = min(run["cones"], key=lambda entry: abs(entry[0] - 100e-6))
        warp, weft = cones[2]
        shapes.append(abs(weft / warp - 1))
    pushed = [run["energies"]["ply_contact"][-1] for run in (aligned, alternating)]
    return {
        "mean lead of the aligned": lead.mean(),
        "least lead of the aligned": lead.min(),
        "asymmetry, alternating over aligned": shapes[1] / shapes[0],
        "contact between plies, alternating over aligned": pushed[1] / pushed[0],
        "note": f"lead {lead.min():.2f} to {lead.max():.2f} m/s; after 100 us the third ply's cone is off square by "
        f"{shapes[0]:.3f} aligned, {shapes[1]:.3f} alternating; contact took {pushed[0]:.3f} and {pushed[1]:.3f} J",
    }


_STACKS = ("aligned", "alternating")


@check(
    lambda fabrics, velocities, plies: {
        f"run{n}": pack(f, v, plies) for n, (f, v) in enumerate(zip(fabrics, velocities))
    }
)
def cones(fabrics: Sequence[str], velocities: Sequence[float], plies: int, **runs: RunResult) -> Found:
    """How far the cone of the last ply is from square, after 100 us."""
    off = {}
    for n, fabric in enumerate(fabrics):
        _, shapes = min(runs[f"run{n}"]["cones"], key=lambda entry: abs(entry[0] - 100e-6))
        warp, weft = shapes[-1]
        off[fabric] = max(weft / warp, warp / weft) - 1
    return {
        "most even": min(off, key=off.get),
        "note": ", ".join(f"{fabric} {value:.3f}" for fabric, value in off.items()),
    }


@check(lambda fabric, velocity, plies: {"many": pack(fabric, velocity, plies), "one": pack(fabric, velocity, 1)})
def noise(many: RunResult, one: RunResult, fabric: str, velocity: float, plies: int) -> Found:
    """RMS of the weft's tension beside the projectile above 30 kHz, of the first ply of a pack and of a lone one."""
    found = []
    for run in (many, one):
        t, T = run["t"][1:], run["tension"]
        window = (t > 10e-6) & (t < 100e-6)
        found.append(series.noise(t[window], T[window]))
    return {"ratio": found[0] / found[1], "note": f"{found[0]:.2f} N in the pack, {found[1]:.2f} N alone"}


def _gaps(fabric, velocity, plies, added):
    scenes = {"body": "full", "end_time": 100e-6}  # whose waves do not end in plastic flow
    return {f"run{n}": pack(fabric, velocity, plies, added=a, **scenes) for n, a in enumerate(added)}


@check(_gaps)
def gaps(fabric: str, velocity: float, plies: int, added: Sequence[float], **runs: RunResult) -> Found:
    """How far the tip's velocity jumps about that of the centre of mass, and the early response, with wider gaps."""
    rough, early = [], []
    for n in range(len(added)):
        run = runs[f"run{n}"]
        t, v = series.even(run["fine"][:, 0], run["fine"][:, 2], 2e-7)
        rough.append(np.sqrt(np.mean((run["fine"][:, 4] - run["fine"][:, 2]) ** 2)))
        early.append(np.interp(np.linspace(20e-6, 100e-6, 81), t, v))
    steps = np.diff(early, axis=0)
    return {
        "noise, second over first": rough[1] / rough[0],
        "least rise of the velocity": steps.min(),
        "least mean rise of the velocity": steps.mean(axis=1).min(),
        "note": "RMS of tip less centre "
        + ", ".join(f"{value:.2f}" for value in rough)
        + " m/s; mean velocity to 100 us "
        + ", ".join(f"{value.mean():.2f}" for value in early)
        + " m/s",
    }


def _forms(fabric, velocity, plies):
    """The smooth contact between plies; node to node; and that with tensions averaged before they fail a yarn."""
    return {
        "smooth": pack(fabric, velocity, plies),
        "nodes": noisy(fabric, velocity, plies),
        "averaged": noisy(fabric, velocity, plies, FILTER),
    }


@check(_forms)
def naive(smooth: RunResult, nodes: RunResult, averaged: RunResult, fabric: str, velocity: float, plies: int) -> Found:
    """Cut yarns and outcomes with smooth contact and with nodes pushing on the nodes opposite to them."""
    failed = {name: _failed(run) for name, run in _named(smooth, nodes, averaged)}
    return {
        "cut yarns, node to node": failed["node to node"],
        "cut yarns, smooth": failed["smooth"],
        "cut yarns, node to node, averaged": failed["averaged"],
        "outcome, smooth": outcome_of(smooth),
        "outcome, node to node": outcome_of(nodes),
        "outcome, averaged": outcome_of(averaged),
        "note": "; ".join(
            f"{name}: {outcome_of(run)} after {1e6 * run['t'][-1]:.0f} us, {failed[name]:.1f} cut yarns{_guarded(run)}"
            for name, run in _named(smooth, nodes, averaged)
        ),
    }


def _failed(run):
    """Cut yarns of all plies, at the end or where a guard would have ended the run."""
    return run["failed_then"] if run.get("problem") else run["plies"]["cut_yarns"][-1].sum()


def _guarded(run):
    """What a guard would have ended the run for, and what has failed by its end."""
    last = run["plies"]["cut_yarns"][-1].sum()
    return f" until {run['problem']}; {last:.1f} at the end" if run.get("problem") else ""


def _named(smooth, nodes, averaged):
    return (("smooth", smooth), ("node to node", nodes), ("averaged", averaged))


@check(
    lambda fabric, velocity, plies: {
        name: pack(fabric, velocity, plies, body=body, end_time=100e-6)
        for name, body in (("full", "full"), ("bar", "elastic_bar"))
    }
)
def swing(full: RunResult, bar: RunResult, fabric: str, velocity: float, plies: int) -> Found:
    """Period in which tip and tail of the elastic projectile swing, and how far apart their velocities are.

    The thesis gives no bore, and only a cylinder without one stays elastic and swings in 2 L / c (erratum E-37).
    """
    split, bored = (np.abs(run["fine"][:, 4] - run["fine"][:, 5]).max() for run in (full, bar))
    return {
        "period": full["swing"],
        "largest split": split,
        "note": f"velocities of tip and tail up to {split:.1f} m/s apart; balance {100 * full['balance']:.2f} %; bored "
        f"to 3 g it yields: {bored:.1f} m/s apart, strongest after {1e6 * bar['swing']:.1f} us",
    }


@check(
    lambda fabric, velocity, plies: {
        "bar": pack(fabric, velocity, plies, body="elastic_bar", end_time=100e-6),
        "rigid": pack(fabric, velocity, plies, end_time=100e-6),
    }
)
def rigid_has_no_swing(bar: RunResult, rigid: RunResult, fabric: str, velocity: float, plies: int) -> Found:
    """Jumps of the velocity of a rigid projectile over those of the tip of an elastic one.

    RMS of what is faster than `series.QUIET`, from 10 us on. And how far tip and tail of each are apart: a rigid body
    has one velocity, and no columns of tip and tail.
    """
    jumps = []
    for run, column in ((rigid, 2), (bar, 4)):
        t, v = series.even(run["fine"][:, 0], run["fine"][:, column], 2e-7)
        jumps.append(series.noise(t[t > 10e-6], v[t > 10e-6]))
    columns = rigid["fine"].shape[1]
    return {
        "jumps, rigid over elastic": jumps[0] / jumps[1],
        "split of the rigid": 0.0 if columns == 4 else float(np.ptp(rigid["fine"][:, 4:6], axis=1).max()),
        "split of the bar": np.abs(bar["fine"][:, 4] - bar["fine"][:, 5]).max(),
        "note": f"{jumps[0]:.2f} and {jumps[1]:.2f} m/s",
    }


@check(
    lambda fabric, velocity, plies: {
        "same": pack(fabric, velocity, plies),
        "cheap": pack(fabric, velocity, plies, face={"modulus": 0.5, "strain": 1.0}),
    }
)
def cheap_face(same: RunResult, cheap: RunResult, fabric: str, velocity: float, plies: int) -> Found:
    """Velocity in zone I with a struck ply of half the modulus and strength."""
    t = np.linspace(0, 60e-6, 61)
    off = np.interp(t, cheap["t"], cheap["v"]) - np.interp(t, same["t"], same["v"])
    return {"largest change": np.abs(off).max()}


def _early(cases):
    runs = {f"run{n}": noisy(*case) for n, case in enumerate(cases)}
    return runs | {f"averaged{n}": noisy(*case, FILTER) for n, case in enumerate(cases)}


@check(_early)
def averaged(cases: Sequence[Sequence[float | str]], **runs: RunResult) -> Found:
    """Failed segments of packs that fail early, node to node, with tensions as they are and averaged over FILTER."""
    at_once, later = ([_failed(runs[f"{name}{n}"]) for n in range(len(cases))] for name in ("run", "averaged"))
    return {
        "least failed at once": min(at_once),
        "most failed, averaged": max(later),
        "all stop, averaged": all(outcome_of(runs[f"averaged{n}"]) == STOPPED for n in range(len(cases))),
        "note": "; ".join(
            f"{case[2]} plies of {case[0]} at {case[1]:g} m/s: {a:.0f} segments failed at once, {b:.0f} averaged, "
            f"{outcome_of(runs[f'averaged{n}'])}"
            for n, (case, a, b) in enumerate(zip(cases, at_once, later))
        ),
    }


@check(lambda cases: {f"run{n}": pack(*case, failure_time=FILTER) for n, case in enumerate(cases)})
def filtered(cases: Sequence[Sequence[float | str]], **runs: RunResult) -> Found:
    """Outcomes with tensions that are low-passed over FILTER before they are held against the strength."""
    found = [outcome_of(runs[f"run{n}"]) for n in range(len(cases))]
    return {"outcomes": found, "all stop": all(one == "stops" for one in found)}
