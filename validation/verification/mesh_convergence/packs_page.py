"""Tables of the convergence of packs: each quantity over the levels, failure times, and one key at a time."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from math import isfinite
from typing import TYPE_CHECKING, Any

from validation.marked_page import markdown
from validation.verification.mesh_convergence.study import quantity

if TYPE_CHECKING:
    from validation.verification.mesh_convergence.packs import Case, Found

# name, unit, value of a Found, half the width of its bracket, target [-] of the default against the limit
QUANTITIES: tuple[tuple[str, str, Callable[[Any], float], Callable[[Any], float], float], ...] = (
    ("critical velocity", "m/s", lambda f: f.middle, lambda f: 0.5 * (f.high - f.low), 0.03),
    ("peak tension of the warp", "N", lambda f: f.stop.warp, lambda f: 0.0, 0.05),
    ("peak tension of the weft", "N", lambda f: f.stop.weft, lambda f: 0.0, 0.05),
    ("absorbed energy", "J", lambda f: f.through.absorbed, lambda f: 0.0, 0.10),
    ("absorbed energy, mean of draws", "J", lambda f: f.drawn.mean, lambda f: f.drawn.error, 0.10),
)
CHANGE = 0.02  # target of a variation


def pages(found: Mapping[Case, Found], plan: Mapping[str, Any]) -> str:
    """All tables, in Markdown, of the cases that there are."""
    base = {case: one for case, one in found.items() if not case.variation}
    parts = ["No case has been computed."] if not base else [_levels(base, plan), _failures(base)]
    varied = {case: one for case, one in found.items() if case.variation}
    if varied:
        parts.append(_variations(varied, base, plan))
    shots = [shot for one in found.values() for shot in (one.stop, one.through) if shot is not None]
    if shots:
        worst = 100 * max(shot.balance for shot in shots)
        parts.append(f"Error of the energy balance at most {worst:.2g} % of the strike energy.\n")
    return "\n".join(parts)


def _has(one, name):
    return one.drawn is not None if "draws" in name else one.stop is not None and one.through is not None


def _levels(base, plan):
    """Each quantity over the levels, with its limit where there are three."""
    levels = sorted({case.level for case in base})
    default = plan["reference_level"]
    rows = [["plies", "fabric", "quantity", *(f"level {n}" for n in levels), "limit", "found by",
             f"level {default} off, %", "target, %"]]  # fmt: skip
    for start in sorted({replace(case, level=0) for case in base}, key=lambda case: (case.plies, case.fabric)):
        some = {n: base[replace(start, level=n)] for n in levels if replace(start, level=n) in base}
        for name, unit, value, half, target in QUANTITIES:
            values = {n: value(one) for n, one in some.items() if _has(one, name)}
            if not values:
                continue
            limit, basis, off = "", "", ""
            if len(values) >= 3:
                noise = max(half(some[n]) for n in values)
                entry = quantity(start.fabric, name, unit, list(values), list(values.values()), noise)
                limit, basis = f"{entry.extrapolation.limit:.4g}", entry.extrapolation.basis
                if default in values:
                    share = values[default] / entry.extrapolation.limit - 1
                    off = _marked(f"{100 * share:+.1f}", abs(share) <= target)
            texts = [_value(values.get(n), some.get(n), name) for n in levels]
            rows.append([f"{start.plies}", start.fabric, f"{name}, {unit}", *texts, limit, basis, off,
                         f"{100 * target:g}"])  # fmt: skip
    note = f"Shots at {plan['stops']:g} and {plan['perforates']:g} times the critical velocity of level {default}. "
    note += "Behind a critical velocity: zone of mixed outcomes (slowest perforation to fastest stop), m/s; behind "
    note += "another value: the outcome, where it is not the expected one.\n"
    return f"{markdown(rows)}\n{note}"


def _value(value, one, name):
    if value is None:
        return ""
    text = f"{value:.4g}"
    if name == "critical velocity" and one.mixed:
        return f"{text} ({one.mixed[0]:.0f} to {one.mixed[1]:.0f})"
    if name.startswith("peak") and one.stop.outcome != "stopped":
        return f"{text} ({one.stop.outcome})"
    if name == "absorbed energy" and one.through.outcome != "perforated":
        return f"{text} ({one.through.outcome})"
    return f"{text} ± {one.drawn.error:.2g}" if "draws" in name else text


def _failures(base):
    """Times at which each ply first fails, µs."""
    rows = [["plies", "fabric", "level", "strike, m/s", "first failure of each ply, µs"]]
    for case in sorted(base, key=lambda case: (case.plies, case.fabric, case.level)):
        shot = base[case].through
        if shot is not None:
            times = ", ".join(f"{1e6 * t:.1f}" if isfinite(t) else "none" for t in shot.failures)
            rows.append([f"{case.plies}", case.fabric, f"{case.level}", f"{shot.velocity:g}", times])
    return markdown(rows)


def _variations(varied, base, plan):
    """Change of each quantity by one key, %."""
    names = [name for name, *_ in QUANTITIES]
    rows = [["variation", "plies", "fabric", *(f"{name}, %" for name in names)]]
    for case, one in varied.items():
        plain = base.get(type(case)(case.fabric, case.plies, case.level))
        if plain is None:
            continue
        texts = []
        for name, _, value, _, _ in QUANTITIES:
            if not (_has(one, name) and _has(plain, name)):
                texts.append("")
                continue
            change = value(one) / value(plain) - 1
            texts.append(_marked(f"{100 * change:+.1f}", abs(change) <= CHANGE))
        rows.append([case.variation, f"{case.plies}", case.fabric, *texts])
    note = f"Level {plan['reference_level']}; bold: more than {100 * CHANGE:g} %.\n"
    return f"{markdown(rows)}\n{note}"


def _marked(text, met):
    return text if met else f"**{text}**"
