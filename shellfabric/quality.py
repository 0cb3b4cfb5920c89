"""Quality indicators: is the result of a run to be trusted? Each is a number with a stated limit.

A `Monitor` samples a march at its audits what the result itself does not keep; `of_impact` and `of_pack` compute the
indicators from a result. A run is "doubtful" if one of them is beyond its limit. The limits follow from where the
methods were found to fail (docs/stability.md); docs/checks.md says how many of those points they flag, and how many
scenes at default settings.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from math import isfinite

import numpy as np

from shellfabric.contact_kernels import DEEPEST

OK, DOUBTFUL = "ok", "doubtful"
BAND = 4  # yarns of each family, from the impact point outwards, whose tension is sampled
_T = ("T1", "T2")
ALTERNATION, SQUARES, DEFLECTION = 0, 1, 2


@dataclass(frozen=True)
class Indicator:
    """One number that tells whether a run went well.

    Parameters
    ----------
    name : for the reader and as the key in summary.json
    value, limit : value <= limit where all is well; a value that is not finite is not well
    unit : of both; "" where it is a ratio
    meaning : what a larger value stands for, in one sentence
    """

    name: str
    value: float
    limit: float
    unit: str = ""
    meaning: str = ""

    @property
    def ok(self):
        """Whether the value is within the limit."""
        return isfinite(self.value) and self.value <= self.limit

    @property
    def excess(self):
        """[-] value over limit."""
        if not isfinite(self.value):
            return float("inf")
        return self.value / self.limit if self.limit > 0 else (float("inf") if self.value > self.limit else 0.0)

    def __str__(self):
        unit = f" {self.unit}" if self.unit else ""
        return f"{self.name} {self.value:.3g}{unit} (limit {self.limit:g}{unit})"

    def entry(self):
        """As a dict, for summary.json."""
        return asdict(self) | {"ok": self.ok}


# name: (limit, unit, meaning)
LIMITS = {
    "time step": (1.0, "", "the explicit step over its stability bound"),
    "energy error": (0.01, "", "largest error of the energy balance over the strike energy"),
    "energy gained in contact": (0.002, "", "energy that a contact gave but never took, over the strike energy"),
    "viscous energy": (0.3, "", "viscous energy over the energy absorbed"),
    "formulation energy": (0.1, "", "work of the cell's forces that no potential stores, over the energy absorbed"),
    "tension oscillation": (0.1, "", "node-to-node alternation of the tension over the tension, rms along the yarns"),
    "nose penetration": (0.3, "", "depth of the nose in the cloth over the radius of its edge"),
    "contact point spacing": (1.0, "", "spacing of the contact points over the radius of the nose's edge"),
    "element side": (1.0, "", "longest side of an element over the projectile's radius"),
    "yarns an element": (1.0, "", "yarns that an element under the nose stands for, along each side"),
    "tension over cell table": (1.0, "", "peak tension over the largest of the cell's table"),
    "tension over sampled surface": (1.0, "", "peak tension over the largest that the response surface was sampled at"),
    "contact force over fitted range": (1.0, "", "force between yarns over the largest that the law was fitted to"),
    "swelling under contact": (1e-3, "", "growth of a yarn under a light contact force over its height"),
    "ply penetration": (0.5, "", "depth of a ply in the next over the thickness"),
    "torn cloth not held apart": (0.1, "", "share of the contacts of torn cloth that were not resolved"),
}


def _make(name, value):
    limit, unit, meaning = LIMITS[name]
    return Indicator(name, float(value), limit, unit, meaning)


class Monitor:
    """Samples of a march at its audits, reduced to sums and maxima.

    Parameters
    ----------
    parts : ((Panel, Constants, State), ...) of the plies

    Attributes
    ----------
    found : (plies, 3) sums over samples, nodes and the band of yarns about the impact point of the squares of the
        node-to-node alternation of the tension and of the tension [N2]; largest deflection of whole cloth [m]
    """

    def __init__(self, parts):
        self.parts = parts
        self.found = np.zeros((len(parts), 3))

    def sample(self):
        """Take a sample of the present state."""
        for ply, (panel, const, state) in enumerate(self.parts):
            for lines in _bands(panel, const, state):
                third = lines[3:] - lines[:-3] + 3.0 * (lines[1:-2] - lines[2:-1])
                if not lines.all():
                    # a broken or slack yarn ends there, with a jump
                    whole = lines > 0.0
                    third = third[whole[3:] & whole[:-3] & whole[1:-2] & whole[2:-1]]
                third = third.ravel()
                self.found[ply, ALTERNATION] += third @ third / 64.0
                self.found[ply, SQUARES] += np.vdot(lines, lines)
            high = float(np.max(state.u[2], where=state.flag == 0, initial=0.0))
            self.found[ply, DEFLECTION] = max(self.found[ply, DEFLECTION], high)

    @property
    def deflection(self):
        """[m] largest deflection of whole cloth, of any ply from its own plane, at the audits."""
        return float(self.found[:, DEFLECTION].max())


def _bands(panel, const, state):
    """Tensions (n, BAND) [N] along the BAND yarns of warp and weft next to the impact point, on one side of it."""
    shape, per = (const.ni + 1, const.s), const.per
    i, j = (0 if mirrored else n // 2 for mirrored, n in zip(panel.mirrors, panel.counts))
    warp, weft = (tension[: shape[0] * shape[1]].reshape(shape) for tension in state.T)
    return warp[i : const.ni, j : j + BAND * per : per], weft[i : i + BAND * per : per, j : const.nj].T


def of_march(march):
    """Tuple of Indicator of a run of one ply or a pack, a `march.March` or `pack_march.PackMarch`."""
    panel, shot = march.panel, march.panel.projectile
    strike = march.strike_energy
    energies = {name: march.sample(name) for name in march.energy_names}
    absorbed = max(strike - float(energies["kinetic_projectile"][-1]), 1e-3 * strike)
    total, squares = march.monitor.found[:, :DEFLECTION].sum(axis=0)
    depth = max(float(state.contact_energy[DEEPEST]) for _, _, state in march.monitor.parts)
    nose = nose_radius(shot)
    xi = panel.numerics.stretch_viscosity
    bound = panel.time_step / panel.numerics.safety
    given = max(float(np.max(-energies[name])) for name in ("contact", "plies") if name in energies)
    found = [
        _make("time step", march.const.dt / bound),
        _make("energy error", float(np.max(np.abs(energies["balance"]))) / strike),
        _make("energy gained in contact", max(given, 0.0) / strike),
        _make("viscous energy", float(energies["viscous"][-1]) / absorbed),
        _make("formulation energy", float(np.max(np.abs(energies["cell"]))) / absorbed),
        _make("tension oscillation", (total / squares) ** 0.5 if squares > 0 else 0.0),
        _make("nose penetration", depth / nose),
        _make("contact point spacing", _spacing(march.const) / nose),
        _make("element side", max(panel.spacing) / shot.radius),
        _make("yarns an element", float(panel.finest)),
        *_extrapolation(march),
    ]
    if hasattr(march, "deepest"):
        found.append(_make("ply penetration", float(np.max(march.deepest, initial=0.0))))
        held, missed = march.held_apart
        found.append(_make("torn cloth not held apart", float(missed) / max(1.0, float(held + missed))))
    return tuple(found)


def nose_radius(shot):
    """[m] smallest radius that cloth is bent round by the nose of a Projectile."""
    if shot.shape in ("sphere", "hemisphere"):
        return shot.radius
    return min(shot.edge_radius, shot.tip_radius) if shot.shape == "cone" else shot.edge_radius


def _spacing(const):
    """[m] between the points of contact of the smallest elements."""
    return max(const.dx, const.dy) / const.points


def _extrapolation(march):
    """Indicators of a cell that is used beyond where it is known."""
    peaks = np.max([state.peak for _, _, state in march.monitor.parts], axis=0)
    table = march.panel.table
    found = [_make("tension over cell table", float(max(peak / table.values[T].max() for peak, T in zip(peaks, _T))))]
    return (*found, *of_cell(table, peaks))


def of_cell(table, peaks):
    """Indicators of a CellTable in which the tensions (warp, weft) [N] have come as far as `peaks`."""
    model, values, found = table.model, table.values, []
    if hasattr(model, "surface"):
        sampled = (model.surface.T1, model.surface.T2)
        reached = max(peak / float(np.max(T)) for peak, T in zip(peaks, sampled))
        return (_make("tension over sampled surface", reached),)
    if model.model != "compressible":
        return ()
    inside = np.logical_and(*(values[T] <= max(peak, 0.0) for peak, T in zip(peaks, _T)))
    force = float(np.max(values["F"], where=inside, initial=0.0))
    known = [law.F_range[1] for law in model.used_laws if law.F_range is not None]
    if known:
        found.append(_make("contact force over fitted range", force / min(known)))
    light = values["F"][values["F"] > 0]
    least = float(light.min()) if light.size else 0.0
    found.append(_make("swelling under contact", max(_swelling(law, least, h) for law, h in zip(model.used_laws, model.h0))))
    return tuple(found)


def _swelling(law, force, height):
    """[-] by which a yarn grows thicker under a light contact force, over its height."""
    shift = law.F0 if law.form == "regularised" else 0.0
    return max(0.0, law.b / np.cbrt(force + shift) - law.a) / height if force + shift > 0 else 0.0
