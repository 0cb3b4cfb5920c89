"""Quality indicators: is the result of a run to be trusted? Each is a number with a stated limit.

A `Monitor` samples of a run what its result does not keep; `of_solver` computes the indicators of a
run. A run is "doubtful" if one of them is beyond its limit, and "noted" if one is beyond the lower
value of its note. The limits follow from where the methods were found to fail
(docs/reports/numerics.md) and, of the viscous energy, from experiments; docs/reports/numerics.md
says how many of those points they flag, and how many scenes at default settings.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from fabrics.base.checks import FloatArray
from shellfabric.membrane import coarse_fabric
from shellfabric.membrane.indicator import Check, Indicator

_T = ("T1", "T2")
EVERY = 4  # samples of the solver from one sample to the next: a sample costs a third of a step
LIGHT = 0.03  # of the strength: tensions below it count as it
# [-] share of the cuts after the echo from which on a bullet is doubtful: bullets are fired at free packs,
# fragments at plies in a frame, whose echo is a part of the test
ECHO_OF_A_BULLET = 0.5
# [radii] that a bullet of metal has moved while it still cuts plies, about; four shots at packs of S-728
CUTS_WITHIN = 4.0

# what each check is, declared once: messages, results and pages (`tools/pages.py`) take it from here
_CHECKS = (
    Check(
        "time step",
        1.0,
        "time step over the stability limit of the explicit integration",
        "a smaller numerics.cfl",
    ),
    Check(
        "energy error",
        0.005,
        "largest error of the energy balance over the strike energy",
        "leave [numerics] out, and take smaller elements under the nose",
    ),
    Check(
        "yarn snap",
        0.005,
        "energy that steps lose while yarns stiffen, over the strike energy",
        "a smaller numerics.cfl",
    ),
    Check(
        "energy gained in contact",
        0.008,
        "energy that contact forces created, over the strike energy",
        "leave [numerics] out, and take smaller elements under the nose",
    ),
    Check(
        "viscous energy",
        0.15,
        "energy dissipated by viscosity over the energy absorbed, until a yarn first fails",
        "smaller elements under the nose; half of numerics.stretch_viscosity should not "
        "change the outcome",
        note=0.1,
    ),
    Check(
        "formulation energy",
        0.1,
        "work of the cell's forces that no potential stores, over the energy absorbed",
        "{variational cell}, whose forces have a potential",
    ),
    Check(
        "tension oscillation",
        0.07,
        "rms oscillation of the tension from node to node over the rms tension",
        "leave [numerics] out, and take smaller elements under the nose",
    ),
    Check(
        "nose penetration",
        1.8,
        "largest penetration of the projectile into the fabric over its edge radius",
        "leave [numerics] out, and take a larger projectile.edge_radius or smaller "
        "elements under the nose",
    ),
    Check(
        "contact point spacing",
        1.2,
        "spacing of the contact points over the projectile's edge radius",
        "more numerics.contact_points, a larger projectile.edge_radius or smaller "
        "elements under the nose",
    ),
    Check(
        "element side",
        1.0,
        "longest element side over the projectile's radius",
        "smaller elements under the nose",
    ),
    Check(
        "element over failure length",
        1.0,
        "if yarns fail: element side over the failure length",
        "smaller elements under the nose",
        note=0.5,
    ),
    Check(
        "path over fine mesh",
        1.0,
        "distance from the impact point to the furthest fabric under the projectile at "
        "the end, over the half width of the fine mesh, beyond which fabric does not "
        "touch the projectile",
        "a wider first zone of panel.grading",
    ),
    Check(
        "coarse fabric in the nose",
        0.1,
        "deepest that fabric from beyond the fine mesh, which does not touch the "
        "projectile, has been in it, over its radius",
        "a wider first zone of panel.grading",
    ),
    Check(
        "yarns an element",
        1.0,
        "yarns per element side under the projectile",
        "smaller elements under the nose",
    ),
    Check(
        "tension over cell table",
        1.0,
        "peak tension over the largest tension tabulated for the unit cell",
        "yarns that do not fail are stretched further than tabulated: let them fail, or "
        "strike slower",
    ),
    Check(
        "tension over sampled surface",
        1.0,
        "peak tension over the largest tension sampled for the response surface",
        "a surface that is sampled to larger tensions",
    ),
    Check(
        "contact force over fitted range",
        1.0,
        "force between yarns over the largest that the law was fitted to",
        "compare with a run with {incompressible cell}, which the law tends to",
    ),
    Check(
        "swelling under contact",
        0.001,
        "growth of a yarn's thickness under a light contact force over its thickness",
        'a law of the form "regularised"',
    ),
    Check(
        "relaxation residual",
        1.0,
        "out-of-balance force over the tolerance of the relaxation",
        "more run.steps, or more run.max_iterations",
    ),
    Check(
        "shear beyond locking",
        2.0,
        "shear angle over that at which the yarns lock, beyond which the law is an extrapolation",
        "state that the law is extrapolated, or measure it to larger angles",
        note=1.0,
    ),
    Check(
        "misfit of the law",
        0.1,
        "rms distance of the samples from the compression law over its greatest compression a",
        "see whether the yarns are at closest packing (mesh), or take a response surface",
        note=0.05,
    ),
    Check(
        "node alternation",
        0.01,
        "displacements that alternate from node to node over the yarn's thickness",
        "a finer mesh",
    ),
    Check(
        "ply penetration",
        0.75,
        "largest loaded penetration of a ply into the next over the ply's thickness",
        "smaller elements under the nose; check panel.ply_gap",
    ),
    Check(
        "ply collisions",
        0.1,
        "energy of collisions of plies over the strike energy; it measures the mesh: "
        "smaller elements take less",
        "smaller elements under the nose",
        note=0.05,
    ),
    Check(
        "jacket strain",
        1.0,
        "largest plastic strain of the projectile's jacket over that at which it would "
        "tear, which is not computed",
        "state that the jacket may tear, and compare with a bullet without one",
    ),
    Check(
        "projectile hourglass",
        0.01,
        "energy of the hourglass control of the projectile over the strike energy",
        "a finer drawing of the projectile",
    ),
    Check(
        "yarns that changed sides",
        0.0,
        "crossings of taut resolved yarns that have passed through each other, and carry "
        "no force any more",
        "a smaller numerics.cfl",
    ),
    Check(
        "cut after the echo of the frame",
        1.0,
        "share of the yarns of a pack that were cut after the tension wave had come back "
        "from a clamped edge: the outcome is that of this frame, not of a larger or a "
        "free pack",
        "the opening that would do, or {free edges}",
        note=0.5,
    ),
    Check(
        "node ahead of the strike",
        2.0,
        "fastest node of a ply of a pack before it tears, along the flight, over the "
        "strike velocity: an elastic collision with the projectile leaves twice that at "
        "most",
        "smaller elements under the nose",
    ),
    Check(
        "yarns past the next ply",
        0.01,
        "nodes of resolved yarns that were half a thickness or more behind the next ply, "
        "at one time at most, over the nodes of a ply's yarns; plies touch at the mean of "
        "warp and weft, single yarns may reach past",
        "state it, and compare with a larger panel.ply_gap",
        note=0.001,
    ),
    Check(
        "motion at held faces",
        0.06,
        "largest motion of a block a brick away from its held faces over the deepest "
        "dent: too small a block holds the clay that a dent drives out",
        "widen and deepen backing.size",
        note=0.03,
    ),
    Check(
        "face under held fabric",
        0.5,
        "share of the block's face under fabric that is held on all sides and keeps down "
        "the rim: the dent closes again",
        "widen backing.size, or take {free edges}",
    ),
    Check(
        "face across symmetry",
        0.05,
        "furthest that a node of the block has come across a plane of symmetry, over the "
        "smallest brick",
        "compare with {whole panel}",
    ),
    Check(
        "hourglass energy of the block",
        0.1,
        "largest energy in the hourglass springs of the block over the energy that it has taken up",
        "smaller backing.min_size",
        note=0.07,
    ),
    Check(
        "folded bricks",
        1.0,
        "largest share of its part of a brick's volume that a corner of it has lost at "
        "the end: above 1 it is turned inside out, and the brick is folded in an "
        "hourglass mode",
        "smaller backing.min_size",
        note=0.9,
    ),
    Check(
        "deepest node of the dent",
        1.3,
        "depth of the deepest node of the face over that which a gauge finds: a single node is no "
        "dent",
        "smaller backing.min_size",
    ),
    Check(
        "brick on the dent's floor",
        1.0,
        "longest brick on the floor of the dent over the dent's radius, both as they are",
        "smaller backing.min_size",
        note=0.5,
    ),
    Check(
        "change of the dent",
        0.05,
        "change of the dent in the time in which a shear wave crosses its radius, at the "
        "end of the run, over its greatest depth",
        "longer backing.after_stop and run.end_time",
        note=0.02,
    ),
    Check(
        "springback of the dent",
        0.5,
        "share of its greatest depth by which the dent has fallen at the end; what is "
        "left of a dent in clay stays",
        "see whether the block is too small, and whether its modulus is known",
        note=0.1,
    ),
    Check(
        "dent back at the pack",
        1.0,
        "depth of the pack that the block has left behind over the least depth of the "
        "dent since: above 1 they meet again",
        "the dent at rest leaves out that they meet",
    ),
)
CHECKS = {check.name: check for check in _CHECKS}


def indicator(name: str, value: float) -> Indicator:
    """Return the Indicator of one of CHECKS with a value."""
    return CHECKS[name].judge(value)


class Monitor:
    """Samples of a run, taken with the solver's own, reduced to sums and maxima.

    Tension oscillation and ply penetration are sampled until the first yarn fails: what unloads
    then rings, and torn fabric hangs in other fabric, without an error.

    Parameters
    ----------
    solver : PackSolver, which is not kept: a run whose solver is dropped frees its memory at once

    Attributes
    ----------
    found : (plies, 3) sums over samples, nodes and the band of yarns about the impact point of the
        squares of the node-to-node alternation of the tension and of the tension [N2]; furthest
        that the ply and those behind it have closed, over the thickness [-]
    coarse_depth : (plies,) [m] deepest that fabric from beyond the fine mesh has been in the
        projectile
    fastest : (plies,) [m/s] fastest node along the flight so far, of a ply that has not torn
    """

    def __init__(self, solver: Any) -> None:
        self.found = np.zeros((len(solver.plies), 3))
        self.coarse_depth = np.zeros(len(solver.plies))
        self.fastest = np.zeros(len(solver.plies))
        plies = solver.pack.plies
        self._places = [ply.nearest_lines for ply in plies]
        self._light = [tuple(LIGHT * strength for strength in ply.strengths) for ply in plies]

    def sampled(self, solver: Any) -> None:
        """Take a sample at every EVERY-th sample of the solver."""
        from shellfabric.membrane.quality_kernels import sample

        if solver.replaces_membrane:
            return  # about the nose there are yarns in the place of the panel's edges
        # nodes that are thrown ahead fly on for a few samples, and not for EVERY of them
        for p, state in enumerate(solver.states):
            if not state.failures:
                self.fastest[p] = max(self.fastest[p], float(np.max(state.v[2])))
        if len(solver.samples) % EVERY:
            return
        self._sample_coarse_fabric(solver)
        if any(state.failures for state in solver.states):
            return
        for (_, const, state), row, (i, j), light in zip(
            solver.plies, self.found, self._places, self._light
        ):
            sample(state, const, i, j, *light, row)
        self.found[:-1, -1] = solver.deepest

    def _sample_coarse_fabric(self, solver):
        """Keep how deep the fabric of each graded ply from beyond its first zone is in the
        projectile."""
        for p, (panel, const, state) in enumerate(solver.plies):
            if panel.sides is not None:
                depth = coarse_fabric.depth_in_nose(panel, const, state)
                self.coarse_depth[p] = max(self.coarse_depth[p], depth)

    @property
    def oscillation(self) -> float:
        """[-] root of the ratio of the two sums of squares."""
        alternation, squares = self.found[:, :-1].sum(axis=0)
        if squares > 0:
            return float(np.sqrt(alternation / squares))
        return 0.0


def split_viscous(cut_yarns: FloatArray, energies: Mapping[str, FloatArray]) -> tuple[float, float]:
    """Split what viscosity dissipates at the last sample before the first failure is seen: yarns
    fail between samples.

    After the split it takes the energy of recoiling cut yarns, which is lost whatever the
    viscosity.

    Parameters
    ----------
    cut_yarns : (n,) so far, of all plies
    energies : {name: (n,)} [J] of which "viscous" and "kinetic_projectile" are used

    Returns
    -------
    share : [-] of viscosity in what the projectile has lost, at the split or, where no yarn fails,
        at the end
    recoil : [J] dissipated by viscosity after the split; 0 where no yarn fails
    """
    viscous = energies["viscous"]
    kinetic = energies["kinetic_projectile"]
    # the first sample has none: without a cut this is the last sample
    split = int(np.argmax(cut_yarns > 0)) - 1
    lost = max(kinetic[0] - kinetic[split], 1e-3 * kinetic[0])
    return float(viscous[split] / lost), float(viscous[-1] - viscous[split])


def of_solver(solver: Any) -> tuple[Indicator, ...]:
    """Return the Indicators of a run of a `loop.pack_solver.PackSolver`."""

    panel = solver.panel
    const = solver.const
    strike = solver.strike_energy
    energies = {name: solver.sample(name) for name in solver.energy_names}
    cut_yarns = solver.sample("cut_yarns")
    absorbed = max(strike - float(energies["kinetic_projectile"][-1]), 1e-3 * strike)
    broken = float(cut_yarns[-1] > 0 and not solver.replaces_membrane)
    depth = max(float(state.max_penetration) for state in solver.states)
    nose = panel.projectile.nose_radius
    bound = panel.time_step / panel.numerics.cfl
    largest = {name: float(np.abs(energy).max()) for name, energy in energies.items()}
    contacts = (solver.contacts.keys() - {"ply_friction"}) & energies.keys()
    given = max(-float(energies[name].min()) for name in contacts)
    found = [
        indicator("time step", const.dt / bound),
        indicator("energy error", largest["error"] / strike),
        indicator("yarn snap", largest["yarn_snap"] / strike),
        indicator("energy gained in contact", max(given, 0.0) / strike),
        indicator("viscous energy", split_viscous(cut_yarns, energies)[0]),
        indicator("formulation energy", largest["formulation_residual"] / absorbed),
        indicator("tension oscillation", solver.monitor.oscillation),
        indicator("nose penetration", depth / nose),
        *worst(_mesh(ply, ply_const, broken) for ply, ply_const, _ in solver.plies),
        *_echo(solver, cut_yarns),
        *_path(solver),
        *_coarse_fabric(solver),
        *worst(_extrapolation(ply, state) for ply, _, state in solver.plies),
    ]
    found += solver.part_indicators
    if len(solver.plies) > 1:
        found.append(indicator("ply penetration", solver.monitor.found[:, -1].max()))
        collided = float(energies["ply_collisions"][-1])
        found.append(indicator("ply collisions", max(collided, 0.0) / strike))
        ahead = float(solver.monitor.fastest.max()) / solver.strike_velocity
        found.append(indicator("node ahead of the strike", ahead))
    return tuple(found)


def foresee(pack: Any, strike_velocity: float, pinned: bool = True) -> tuple[Indicator, ...]:
    """Foresee, before a run, the Indicators of its mesh, if yarns fail, and of the echo of its frame, if
    it is to stop a bullet of metal.

    Parameters
    ----------
    pack : plies.model.Pack
    strike_velocity : [m/s]
    pinned : whether yarns are pinned under the nose, where those that fail have elements
    """
    found = [
        indicator("element over failure length", _element_ratio(ply))
        for ply in pack.plies
        if ply.yarn_failure and pinned
    ]
    back, wave = _way_to_the_frame(pack)
    shot = pack.plies[0].projectile
    if len(pack.plies) > 1 and shot.body == "metal" and np.isfinite(back):
        cuts_for = CUTS_WITHIN * shot.radius / strike_velocity
        meaning = f"time for which such a bullet cuts plies, about {1e6 * cuts_for:.0f} us, over that after which "
        meaning += "the tension wave is back from the frame; "
        meaning += f"an opening of {1e3 * wave * cuts_for:.0f} mm would do, or free edges"
        echo = indicator("cut after the echo of the frame", cuts_for / back)
        found.append(replace(echo, note=None, meaning=meaning))
    return worst([[one] for one in found])


def judge_echo(share: float, of_a_bullet: bool) -> Indicator:
    """Return the indicator of a share of cuts after the echo: of a fragment it is noted alone."""
    found = indicator("cut after the echo of the frame", share)
    if of_a_bullet:
        return replace(found, limit=ECHO_OF_A_BULLET, note=None)
    return found


def _way_to_the_frame(pack):
    """Time [s] after the strike at which the tension wave is back at the impact point from the
    nearest clamped edge, along straight yarns in the weave, inf without one; and the speed [m/s] of
    the fastest wave."""
    back = np.inf
    fastest = 0.0
    for panel in pack.plies:
        for axis, (places, pair) in enumerate(zip(panel.lines(), panel.supports)):
            speed = panel.weave.tension_wave_speed(axis)
            fastest = max(fastest, speed)
            ends = -float(places[0]), float(places[-1])
            ways = [far for side, far in zip(pair, ends) if side == "clamped" and far > 0]
            back = min([back, *(2 * far / speed for far in ways)])
    return back, fastest


def _echo(solver, cut_yarns):
    """The indicator of yarns that are cut after the wave is back from a clamped edge: [] of one ply,
    whose frame is a part of the test, without such an edge, and without a cut."""
    back, wave = _way_to_the_frame(solver.pack)
    if len(solver.plies) == 1 or not (np.isfinite(back) and cut_yarns[-1] > 0):
        return []
    time = solver.sample("t")
    before = float(np.interp(back, time, cut_yarns))
    share = 1.0 - before / float(cut_yarns[-1])
    last = float(time[np.argmax(cut_yarns == cut_yarns[-1])])
    found = judge_echo(share, solver.panel.projectile.body == "metal")
    words = f"back after {1e6 * back:.0f} us, cuts go on to {1e6 * last:.0f} us: in "
    words += f"an opening of {1e3 * wave * last:.0f} mm it would be back after them, with free edges never"
    return [replace(found, meaning=f"{found.meaning}; {words}")]


def _path(solver):
    """The indicator of a projectile that moves sideways over a graded panel."""
    shares = [
        panel.share_of_first_zone(state.projectile_position)
        for panel, const, state in solver.plies
        if panel.sides is not None and const.window_follows
    ]
    return [indicator("path over fine mesh", max(shares))] if shares else []


def _coarse_fabric(solver):
    """The indicator of fabric that has come under the projectile from beyond the fine mesh."""
    depth = solver.monitor.coarse_depth.max()
    if depth == 0:
        return []
    return [indicator("coarse fabric in the nose", depth / solver.panel.projectile.radius)]


def _mesh(panel, const, broken):
    """Indicators of the elements of a ply, beside its projectile and its own failure length.

    Parameters
    ----------
    broken : 1.0 if a pinned yarn has failed in any ply, else 0.0
    """
    shot = panel.projectile
    spacing = max(const.dx, const.dy) / const.points_per_side
    longest = max(panel.spacing)
    return (
        indicator("contact point spacing", spacing / shot.nose_radius),
        indicator("element side", longest / shot.radius),
        indicator("element over failure length", broken * _element_ratio(panel)),
        indicator("yarns an element", float(panel.finest)),
    )


def _element_ratio(panel):
    """[-] longest element side under the projectile over the failure length."""
    return max(panel.spacing) / panel.fabric.failure_length


def _extrapolation(panel, state):
    """Indicators of the cell of a ply that is used beyond where it is known."""
    peaks = state.peak_tension
    table = panel.table
    found = []
    if not panel.yarn_failure:
        found.append(
            indicator(
                "tension over cell table", max(p / table.values[T].max() for p, T in zip(peaks, _T))
            )
        )
    else:  # the step in which a yarn fails may go beyond its strength, and no further
        peaks = np.minimum(peaks, panel.strengths)
    return (*found, *of_cell(table, peaks))


def of_cell(table: Any, peaks: FloatArray | Sequence[float]) -> tuple[Indicator, ...]:
    """Return the Indicators of a CellTable in which the tensions (warp, weft) [N] have come as far
    as `peaks`."""
    model = table.model
    values = table.values
    if hasattr(model, "surface"):
        sampled = (model.surface.T1, model.surface.T2)
        reached = max(peak / float(np.max(T)) for peak, T in zip(peaks, sampled))
        return (indicator("tension over sampled surface", reached),)
    if model.cell_model != "compressible":
        return ()
    inside = np.logical_and(*(values[T] <= max(peak, 0.0) for peak, T in zip(peaks, _T)))
    largest = float(np.max(values["F"], where=inside, initial=0.0))
    return _of_laws(model, largest, values["F"])


def of_forces(model: Any, forces: FloatArray) -> tuple[Indicator, ...]:
    """Return the Indicators of the compression laws of a CellModel that come to contact forces
    (n,) [N]."""
    if model.cell_model != "compressible":
        return ()
    return _of_laws(model, float(forces.max()), forces)


def _of_laws(model, force, forces):
    """The indicators of laws: of the largest `force` that is reached, of the least of `forces`."""
    found = []
    known = [law.F_range[1] for law in model.used_laws if law.F_range is not None]
    if known:
        found.append(indicator("contact force over fitted range", force / min(known)))
    least = float(forces.min(where=forces > 0, initial=np.inf))
    if least == np.inf:
        least = 0.0
    swelling = max(_swelling(law, least, height) for law, height in zip(model.used_laws, model.h0))
    found.append(indicator("swelling under contact", swelling))
    return tuple(found)


def _swelling(law, force, height):
    """[-] by which a yarn grows thicker under a light contact force, over its height."""
    shift = 0.0
    if law.form == "regularised":
        shift = law.F0
    if force + shift > 0:
        return max(0.0, law.b / np.cbrt(force + shift) - law.a) / height
    return 0.0


def of_coupon(
    table: Any, tensions: Sequence[float], residual: float, tolerance: float
) -> tuple[Indicator, ...]:
    """Return the Indicators of a quasi-static test.

    Parameters
    ----------
    table : CellTable
    tensions : (warp, weft) [N] largest of each family
    residual, tolerance : [-] largest out-of-balance force over the reaction, and what relaxation
        was to reach
    """
    over = max(peak / float(table.values[T].max()) for peak, T in zip(tensions, _T))
    found = (
        indicator("relaxation residual", residual / tolerance),
        indicator("tension over cell table", over),
    )
    return (*found, *of_cell(table, tensions))


def of_yarn(astray: FloatArray, thickness: float) -> tuple[Indicator, ...]:
    """Return the Indicators of a yarn of solids whose nodes alternate along it by `astray` (n,)
    [m]."""
    return (indicator("node alternation", float(np.max(astray)) / thickness),)


def worst(runs: Iterable[Iterable[Indicator]]) -> tuple[Indicator, ...]:
    """Select each indicator of several runs' Indicators where it is furthest beyond its limit."""
    found: dict[str, Indicator] = {}
    for one in (one for indicators in runs for one in indicators):
        if one.name not in found or one.excess > found[one.name].excess:
            found[one.name] = one
    return tuple(found.values())
