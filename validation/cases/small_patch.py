"""One small patch of a fabric struck by a nose in three models: pinned crossovers, resolved yarns,
and woven solid yarns, which neither of the other two was built from.

All three have the same fabric, the same number of crossovers between clamped edges, the same nose,
place, velocity, and friction. They differ in what they assume of a crossover: it is pinned; it
slips, and yarns resist sideways with an assumed stiffness; or neither.

Time counts from the first touch, which resolved yarns meet later than the others: their middle
lines carry the contact. Models are compared as long as in none of them a fibre has failed; then a
patch as small as this is torn from its clamps.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from math import ceil, inf
from typing import Any, Literal

import numpy as np

from fabrics import assumed
from fabrics.base.checks import FloatArray
from fabrics.base.errors import InputError
from fabrics.base.schema import refuse_unread
from fabrics.fabric import Fabric
from meshing import patch
from shellfabric.impact.run import run_impact
from shellfabric.impact.setup import ImpactSetup
from shellfabric.panel_numbers import CellNumbers, PanelNumbers
from shellfabric.yarns.model import LEAST_ROWS, REACH, RIM_ROWS, YarnZone
from validation.models.solids.mesh import SolidMesh
from validation.models.solids.model import SolidPatch, check_projectile
from validation.models.solids.solver import SolidSolver
from validation.models.solids.strike import LONGEST, MOST

Place = Literal["gap", "crossover"]
MODELS = ("pinned", "yarns", "solids")
PLACES = ("gap", "crossover")
COARSE = (2, 2, 1)
INTERVAL = 0.25e-6  # [s] between samples
# [-] of the strike velocity by which two models may differ and count as alike: a patch of solids on two
# meshes differs by up to 0.02
ALIKE = 0.05


@dataclass(frozen=True)
class Struck:
    """A patch that has been struck, in one model.

    Parameters
    ----------
    model : one of MODELS
    t : (n,) [s] since the first touch
    v : (n,) [m/s] of the nose
    z : (n,) [m] its way since then
    first_failure : [s] since then at which the first fibre or yarn failed; infinite if none did
    energy_error : [-] largest, over the strike energy
    steps : number
    cpu : [s] of the steps, on one core; without meshing and compiling
    """

    model: str
    t: FloatArray
    v: FloatArray
    z: FloatArray
    first_failure: float
    energy_error: float
    steps: int
    cpu: float

    def velocity(self, at: float) -> float:
        """Return the velocity [m/s] of the nose at a time [s] since the first touch."""
        return float(np.interp(at, self.t, self.v))


@dataclass(frozen=True)
class SmallPatch:
    """What is struck, and how.

    Parameters
    ----------
    shot : ImpactSetup, of whose fabric, laws, projectile, strike velocity, cell and failure it is;
        one ply
    crossings : of each family, an even number
    place : "gap" between four yarns, or "crossover", under the middle of the nose
    size : hexahedra of the solids along, across and through a quarter of a yarn in one crossing
    duration : [s]

    Raises
    ------
    InputError : a shot that no patch stands for, or a number that is not allowed
    """

    shot: ImpactSetup
    crossings: int
    place: Place = "gap"
    size: tuple[int, int, int] = COARSE
    duration: float = 50e-6

    def __post_init__(self):
        shot = self.shot
        if shot.plies > 1:
            raise InputError(key="plies", value=shot.plies, allowed="1 for a patch")
        for key in ("backing", "surface"):
            if getattr(shot, key) is not None:
                raise InputError(key=key, value="given", allowed="left out for a patch")
        refuse_unread(CellNumbers, shot, "solids", "solid yarns")
        refuse_unread(PanelNumbers, shot, "solids", "solid yarns")
        check_projectile(shot.projectile)
        shot.fabric.weave.require_plain("a patch, whose solid yarns are of plain weave")
        assumed.with_solid_laws(shot.fabric)
        if self.place not in PLACES:
            raise InputError(key="struck", value=self.place, allowed=" or ".join(PLACES))
        if len(self.size) != 3 or any(n < least for n, least in zip(self.size, (2, 2, 1))):
            allowed = "three whole numbers, at least 2 along, 2 across and 1 through"
            raise InputError(key="mesh", value=self.size, allowed=allowed)
        least = fewest_crossings(shot)
        if least > MOST:
            widest = 1e3 * 2 * max_radius(shot)
            allowed = f"at most {widest:.3g} mm for a patch, which has {MOST} crossings at most"
            raise InputError(key="diameter", value=2 * shot.projectile.radius, allowed=allowed)
        if not least <= self.crossings <= MOST or self.crossings % 2:
            allowed = f"an even number from {least}, for this nose, to {MOST}"
            raise InputError(key="crossings", value=self.crossings, allowed=allowed)
        if not 4 * INTERVAL <= self.duration <= LONGEST:
            allowed = (
                f"from {4 * INTERVAL:g} to {LONGEST:g} s: a patch is for the first microseconds"
            )
            raise InputError(key="duration", value=self.duration, allowed=allowed)

    @property
    def fabric(self) -> Fabric:
        """The fabric; solid laws that its file does not give are those of its fibre family."""
        return assumed.with_solid_laws(self.shot.fabric)

    @property
    def zone(self) -> YarnZone:
        """The whole patch as a zone of resolved yarns, with the assumed friction of its fibres if none
        is given; where it is struck is the patch's, not drawn by a seed."""
        given = self.shot.crossovers or self.shot.instead
        if given is None:
            given = YarnZone(friction=assumed.friction_between_yarns(self.shot.fabric).number)
        return replace(given, half_width=inf, seed=None)

    @property
    def friction(self) -> float:
        """[-] of yarn on yarn."""
        return self.zone.friction

    @property
    def bricks(self) -> int:
        """Number of hexahedra of the solids."""
        return 8 * int(np.prod(self.size)) * self.crossings**2

    def strike(self) -> Iterator[Callable[[], Struck]]:
        """Yield what strikes it in each of MODELS, the cheapest first."""
        yield self.strike_pinned
        yield self.strike_yarns
        yield self.strike_solids

    def strike_pinned(self) -> Struck:
        """Strike the panel with pinned crossovers."""
        return self._strike_panel("pinned", self.pinned_setup())

    def strike_yarns(self) -> Struck:
        """Strike the patch of resolved yarns."""
        return self._strike_panel("yarns", self.yarns_setup())

    def pinned_setup(self) -> ImpactSetup:
        """Return the shot at the patch with pinned crossovers, on a mesh of like elements as fine as
        its default mesh is about the nose."""
        # resolved yarns have a mesh of their own
        used = replace(self.shot, crossovers=None, instead=None).meshed
        count = used.elements_per_crossover
        if used.grading is not None:
            count = round(1 / float(used.grading[0][1]))
        return self._panel_setup(0.0, elements_per_crossover=count)

    def yarns_setup(self) -> ImpactSetup:
        """Return the shot at the patch of resolved yarns; the nose has some time to touch it."""
        weave = self.fabric.weave
        before = 2 * (weave.thickness + max(weave.w)) / self.shot.strike_velocity
        return self._panel_setup(before, elements_per_crossover=1, crossovers=self.zone)

    def solids(self) -> dict[str, Any]:
        """Return {parameter: value} of the SolidPatch, but for its mesh."""
        return {
            "fabric": self.fabric,
            "projectile": self.shot.projectile,
            "aim": self._off({"gap": 0.0, "crossover": 0.5}),
            "friction": self.friction,
            "failure": self.shot.yarn_failure,
        }

    @property
    def solids_in_words(self) -> str:
        """What the solid yarns take for granted, in a sentence."""
        failing = "whose fibres fail at their strength"
        if not self.shot.yarn_failure:
            failing = "whose fibres do not fail"
        along, across, through = self.size
        return (
            f"Woven yarns of hexahedra, {failing}, in contact with friction {self.friction:g} on each other; "
            f"{along} along, {across} across and {through} through a quarter of a yarn in one crossing."
        )

    def strike_solids(self, mesh: Any = None) -> Struck:
        """Strike the patch of solid yarns; `mesh` is one of `meshing.patch` that has been made."""
        mesh = mesh or patch.build(self.fabric, (self.crossings,) * 2, size=self.size)
        patched = SolidPatch(SolidMesh.of(mesh), **self.solids(), fibre_fractions=tuple(mesh.Vf0))
        solver = SolidSolver(patched, self.shot.strike_velocity, self.duration, interval=INTERVAL)
        clock = StepClock()
        solver.run([clock])
        failed = np.flatnonzero(solver.sample("failed_bars"))
        t = solver.sample("t")
        return Struck(
            model="solids",
            t=t,
            v=solver.sample("v"),
            z=solver.sample("z") - solver.sample("z")[0],
            first_failure=float(t[failed[0]]) if failed.size else inf,
            energy_error=float(np.abs(solver.sample("error")).max() / solver.strike_energy),
            steps=solver.steps,
            cpu=clock.seconds,
        )

    def _off(self, spacings):
        """[m] of the nose from the middle, along both families."""
        spacing = spacings[self.place]
        x, y = (2 * spacing * w for w in self.fabric.weave.w)
        return float(x), float(y)

    def _panel_setup(self, before, **choices):
        """The shot at a panel of as many crossovers, whose middle is one of them; the nose has `before`
        [s] to touch it."""
        return replace(
            self.shot,
            opening=tuple(2 * w * self.crossings for w in self.fabric.weave.w),
            boundary="clamped",
            weave_angle=0.0,
            round=False,
            symmetry="whole",
            impact_point=self._off({"gap": 0.5, "crossover": 0.0}),
            end_time=self.duration + before,
            audit_interval=INTERVAL,
            snapshot_interval=None,
            history=None,
            strength=None,
            # its yarns stand for those of a panel
            length_effect=False,
            rate_dependence=False,
            grading=None,
            bending=0.0,
            **{"crossovers": None, "instead": None} | choices,
        )

    def _strike_panel(self, model, setup):
        clock = StepClock()
        result = run_impact(setup, hooks=[clock])
        t, z, v, force = result.step_history.T[:4]
        first = max(int(np.argmax(force != 0)) - 1, 0)
        cut = np.flatnonzero(result.cut_yarns)
        kept = (t >= t[first]) & (t <= t[first] + self.duration)
        return Struck(
            model=model,
            t=t[kept] - t[first],
            v=v[kept],
            z=z[kept] - z[first],
            first_failure=float(result.time[cut[0]] - t[first]) if cut.size else inf,
            energy_error=result.energy_error_max,
            steps=len(t),
            cpu=clock.seconds,
        )


class StepClock:
    """A hook that adds up the CPU time of the steps from the first sample on, so that compiling and
    the set-up do not count; the first interval is taken to last as long as the mean of the others."""

    def __init__(self) -> None:
        self._first = 0.0
        self._last = 0.0
        self._samples = 0

    def __call__(self, solver: object) -> None:
        self._last = time.process_time()
        if self._samples == 0:
            self._first = self._last
        self._samples += 1

    @property
    def seconds(self) -> float:
        """[s] so far."""
        intervals = max(self._samples - 1, 1)
        return (self._last - self._first) * (intervals + 1) / intervals


def fewest_crossings(shot: ImpactSetup) -> int:
    """Count the crossings, an even number, that a patch has at least for the nose of a shot:
    resolved yarns keep it away from the rim."""
    reach = shot.projectile.radius / (2 * min(shot.fabric.weave.w))
    rows = max(LEAST_ROWS + 2, 2 * (reach + REACH + RIM_ROWS))
    return 2 * ceil(0.5 * rows - 1e-9)


def max_radius(shot: ImpactSetup) -> float:
    """Return the radius [m] of the widest nose that the largest patch is for."""
    return 2 * min(shot.fabric.weave.w) * (0.5 * MOST - REACH - RIM_ROWS)


def compare_until(struck: Sequence[Struck]) -> float:
    """Return the time [s] since the first touch to which models are compared: the end of the
    shortest, or the first failure."""
    return min(min(one.t[-1], one.first_failure) for one in struck)


def largest_difference(one: Struck, other: Struck, until: float, velocity: float) -> float:
    """Return the largest difference [-] of two noses' velocities up to a time, over the strike
    velocity."""
    at = np.linspace(0.0, until, 101)
    apart = np.interp(at, one.t, one.v) - np.interp(at, other.t, other.v)
    return float(np.abs(apart).max()) / velocity


def judge(struck: Sequence[Struck], velocity: float) -> str:
    """Say in a sentence whether crossovers may be pinned, by what solid yarns do."""
    pinned, yarns, solids = struck
    until = compare_until(struck)
    of_pinned = largest_difference(pinned, solids, until, velocity)
    of_yarns = largest_difference(yarns, solids, until, velocity)
    found = f"over {1e6 * until:.3g} us pinned within {of_pinned:.1%} of the strike velocity of solid yarns"
    found += f", resolved within {of_yarns:.1%}"
    if of_pinned <= ALIKE:
        return f"crossovers may be pinned for this nose: {found}"
    if of_yarns <= ALIKE:
        return f'crossovers may not be pinned for this nose, take crossovers = "yarns": {found}'
    return f"neither pinned nor resolved yarns are as solid ones for this nose: {found}"
