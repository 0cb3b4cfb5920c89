"""A pack: plies behind each other in one opening, with a gap between each two.

Stacking. "aligned" plies are all alike; in an "alternating" pack every other one is turned by a right angle (thesis
section 5.2.3, Figure 5-55). Such a ply is the panel of the fabric with its warp called weft: the shell does not see
which yarn is on top, and each ply has its own grid. A ply at any other angle has its grid in a frame of its own
(`turn_kernels`), in which the opening is oblique (`panel.boundary`) and the projectile comes from elsewhere.

Gap. Play between the faces of plies at rest; their middle surfaces are the mean thickness and the gap apart (erratum
E-35). By default it is what tests of packs close and the law of the contact does not (`gap.ply_gap`).

Contact. Two plies press on each other by a law of pressure against closure (`fabrics.ply_law`), the same on every mesh.
The nose presses on half a ply of solid fibre: twice the stiffness of two half plies.

Time step. All plies share the shortest of their steps, or a shorter one for the contact (`PlyContact`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import cos, inf, pi, remainder, sin

import numpy as np

from fabrics.checks import FloatArray
from fabrics.errors import InputError
from fabrics.ply_law import PlyLaw
from fabrics.variants import rotated_90
from shellfabric.cell.model import CellModel, CellTable
from shellfabric.jit.simd import WIDTH
from shellfabric.panel.arrays import Constants, State, Work, has_out_of_plane
from shellfabric.panel.model import Panel
from shellfabric.panel.motion_kernels import AT_REST
from shellfabric.plies import friction, turn_kernels
from shellfabric.plies.arrays import Guard, Pair, Stack, guard
from shellfabric.plies.contact_simd_kernels import MAX_SQUEEZE
from shellfabric.plies.gap import gap_between, ply_gap
from shellfabric.plies.grading import area_factors
from shellfabric.plies.numerics import FORMS, PlyContact, law_table
from shellfabric.projectile import dynamics
from shellfabric.projectile.contact import PREDICTED
from shellfabric.sliding.model import CrossoverFriction, SlidingPanel, Slip

STACKINGS = ("aligned", "alternating")
_FASTER = 1.5  # than the projectile fabric before its nose may become
_LEAST = (0.25, 1e-3)  # deflections that are looked at: of the gap, of the thickness


@dataclass(frozen=True)
class Pack:
    """Plies in the order in which the projectile meets them.

    Parameters
    ----------
    plies : tuple of Panel, alike in opening, impact point, symmetry, projectile and numerics; see `stacked`
    gaps : (plies - 1,) [m] at rest
    contact : PlyContact
    friction : [-] Coulomb's coefficient between plies; torn fabric is held apart without friction
    laws : (plies - 1,) PlyLaw, pressure against closure of each ply on the next; none: those of their fabrics

    Raises
    ------
    InputError : no ply, a wrong number of gaps, a negative gap, plies that do not go together, or as `friction.check`
    """

    plies: tuple[Panel, ...]
    gaps: tuple[float, ...] = ()
    contact: PlyContact = field(default_factory=PlyContact)
    friction: float = 0.0
    laws: tuple[PlyLaw, ...] = ()

    def __post_init__(self):
        if not self.plies:
            raise InputError(key="plies", value=0, allowed="at least 1")
        if len(self.gaps) != len(self.plies) - 1:
            raise InputError(key="gaps", value=len(self.gaps), allowed=f"{len(self.plies) - 1} of them")
        for gap in self.gaps:
            if not 0 <= gap < inf:
                raise InputError(key="ply_gap", value=gap, allowed="at least 0")
        if not self.laws:
            own = {id(ply): PlyLaw.of(ply.fabric) for ply in self.plies[: len(self.plies) if self.gaps else 0]}
            laws = tuple(own[id(a)].between(own[id(b)]) for a, b in zip(self.plies, self.plies[1:]))
            object.__setattr__(self, "laws", laws)
        if len(self.laws) != len(self.gaps):
            raise InputError(key="laws", value=len(self.laws), allowed=f"{len(self.gaps)} of them, or none")
        first = self.plies[0]
        for key in ("symmetry", "projectile", "opening", "round", "impact_point"):
            if any(getattr(ply, key) != getattr(first, key) for ply in self.plies):
                raise InputError(f"the plies of a pack must have one {key}")
        if any(ply.grading != first.grading for ply in self.plies):
            raise InputError("the plies of a pack must have one grading")
        if len({ply.table.model.form for ply in self.plies}) > 1 or len({ply.trellis for ply in self.plies}) > 1:
            raise InputError("the plies of a pack must have cells of one form")
        if len({isinstance(ply, SlidingPanel) for ply in self.plies}) > 1:
            raise InputError(key="crossovers", value="sliding", allowed="sliding in all plies of a pack, or in none")
        friction.check(self.friction, first.numerics.cfl)

    @classmethod
    def stacked(
        cls, ply: Panel, plies: int, *, stacking: str = "aligned", gap: float | None = None,
        contact: PlyContact | None = None, friction: float = 0.0, law: PlyLaw | None = None,
    ) -> Pack:  # fmt: skip
        """A pack of one fabric.

        Parameters
        ----------
        ply : Panel, the first
        plies : their number
        stacking : "aligned" or "alternating"
        gap : [m] between all plies; None takes that of `gap.ply_gap`
        contact, friction : as of a Pack
        law : PlyLaw of two of these plies; None takes that of the fabric (`PlyLaw.of`)

        Raises
        ------
        InputError : no ply, unknown stacking, a weave that cannot be turned, or no law
        """
        if not plies >= 1:
            raise InputError(key="plies", value=plies, allowed="at least 1")
        if stacking not in STACKINGS:
            raise InputError(key="stacking", value=stacking, allowed=" or ".join(STACKINGS))
        law = law or (PlyLaw.of(ply.fabric) if plies > 1 else None)
        if gap is None:
            gap = ply_gap(ply.fabric, law).value if plies > 1 else 0.0
        both = (ply, turned(ply) if stacking == "alternating" and plies > 1 else ply)
        laws = (law,) * (plies - 1) if law else ()
        stack = tuple(both[n % 2] for n in range(plies))
        return cls(stack, (gap,) * (plies - 1), contact or PlyContact(), friction, laws)

    @classmethod
    def laid_up(
        cls, plies: Sequence[tuple[Panel, float]], *, gaps: Sequence[float | None], contact: PlyContact | None = None,
        friction: float = 0.0,
    ) -> Pack:  # fmt: skip
        """A pack of any plies.

        Parameters
        ----------
        plies : of each ply its panel as it lies at no angle, and the angle [rad] by which it is turned
        gaps : [m] between each two; None takes that of `gap.gap_between`
        contact, friction : as of a Pack

        Raises
        ------
        InputError : as Pack and `turned`
        """
        made: dict[tuple[int, float], Panel] = {}
        for panel, angle in plies:
            if (id(panel), angle) not in made:
                made[id(panel), angle] = at_angle(panel, angle)
        chosen = tuple(
            gap_between(front.fabric, rear.fabric).value if gap is None else gap
            for gap, (front, _), (rear, _) in zip(gaps, plies, plies[1:])
        )
        return cls(tuple(made[id(panel), angle] for panel, angle in plies), chosen, contact or PlyContact(), friction)

    @classmethod
    def of(cls, target: Panel | Pack) -> Pack:
        """The pack itself, or that of a single ply."""
        return target if isinstance(target, Pack) else cls((target,))

    @property
    def crossovers(self) -> tuple[CrossoverFriction, ...]:
        """(plies,) of sliding crossovers; empty of pinned ones."""
        return tuple(ply.friction for ply in self.plies if isinstance(ply, SlidingPanel))

    @property
    def angles(self) -> tuple[float, ...]:
        """(plies,) [rad] from the pack's axes to those of the plies' grids."""
        return tuple(ply.ply_angle for ply in self.plies)

    @cached_property
    def turns(self) -> FloatArray | None:
        """(plies, 2) of `turn_kernels.turn_of`; None where all plies have one frame."""
        if len(set(self.angles)) == 1:
            return None
        return np.array([self._turn(0, p) for p in range(len(self.plies))])

    def _turn(self, p, q):
        """Cosine and sine of the angle from the frame of ply p to that of ply q."""
        angle = self.angles[q] - self.angles[p]
        return cos(angle), sin(angle)

    @property
    def elements(self) -> int:
        """Number of elements of all plies."""
        return sum(ply.elements for ply in self.plies)

    @cached_property
    def time_step(self) -> float:
        """[s] the shortest of the plies' steps and of those of their contact (`PlyContact`)."""
        steps = [self.contact.courant * (self._density(p) / self._steepest(p)) ** 0.5 for p in range(len(self.laws))]
        return min(*(ply.time_step for ply in self.plies), *steps, inf)

    def _density(self, p):
        """[kg/m2] of the lighter one of plies p and p + 1, which bounds the step."""
        return min(ply.weave.areal_density for ply in self.plies[p : p + 2])

    def _steepest(self, p):
        """[Pa/m] highest stiffness of the contact of plies p and p + 1."""
        return self.contact.stiffness * self.laws[p].steepest

    def in_step_with(self, strike_velocity: float) -> Pack:
        """The same pack with laws that can stop the strike velocity within a ply's thickness.

        In a row of plies of the areal density A on springs K that is driven from one end at the speed w, neighbours are
        w sqrt(A / K) nearer to each other behind the compression wave, whatever their number; the damper keeps them
        from swinging beyond that. Contact has lost if they come nearer by the thickness t, of which the travel of the
        law holds little. w is the strike velocity times _FASTER, as plies before a nose may outrun it, and the depth
        must stay below the share MAX_SQUEEZE of it, beyond which sides are in question:

            K >= A (_FASTER strike_velocity / (MAX_SQUEEZE t))^2

        Solid fibre is softer than that only above 1300 to 1800 m/s (plies of Kevlar 129), where it would be compressed
        by more than its own thickness; there the pressure of the law is multiplied. A contact that is softened on
        purpose (`PlyContact.stiffness`) stays softer.
        """
        laws = []
        for p, law in enumerate(self.laws):
            whole = MAX_SQUEEZE * self._thickness(p)
            thin = max(whole - law.travel, 0.25 * whole)
            least = self._density(p) * (_FASTER * strike_velocity / thin) ** 2
            laws.append(law if law.stiffness >= least else law.scaled(least / law.stiffness))
        return self if tuple(laws) == self.laws else replace(self, laws=tuple(laws))

    def _thickness(self, p):
        """[m] mean of plies p and p + 1."""
        return float(np.mean([ply.weave.thickness for ply in self.plies[p : p + 2]]))

    def _firmer(self, ply):
        """Stiffness of the nose's contact with a ply of the pack, over that of a single ply."""
        knobs = ply.numerics
        plain = knobs.penalty * ply.weave.areal_density / ply.step_of_bound**2
        return self.contact.stiffness * 2 * max(law.stiffness for law in self.laws) / plain

    def _foreseen(self, slots):
        """Room for what firm springs foresee; a nose of explicit ones has none."""
        slots = slots if len(self.plies) > 1 else 0
        return {name: tuple(np.zeros(slots) for _ in range(3)) for name in PREDICTED}

    @cached_property
    def places(self) -> FloatArray:
        """(plies,) [m] where the middle surfaces stand at rest, the first at 0."""
        return np.concatenate([[0.0], np.cumsum([self._apart(p) for p in range(len(self.gaps))])])

    def constants(self) -> tuple[Constants, ...]:
        """(plies,) what the kernels need to know of each ply, all at one time step."""
        if len(self.plies) == 1:
            return (self.plies[0].constants(),)
        found, out_of_plane = {}, any(has_out_of_plane(ply) for ply in self.plies)
        for ply in self.plies:
            if id(ply) not in found:
                mine = self._in_step(ply)
                const = mine.constants(out_of_plane)
                law = const.point_law._replace(implicit_factor=self._firmer(mine))
                found[id(ply)] = const._replace(dt=self.time_step, point_law=law)
        return tuple(found[id(ply)] for ply in self.plies)

    def states(self, strike_velocity: float) -> tuple[tuple[State, ...], Stack]:
        """The plies at rest, with what they share: (tuple of State, Stack)."""
        count, shot = len(self.plies), self.plies[0].shot
        stack = Stack(
            awake=np.zeros(count, np.bool_), waits_for_plies=np.zeros(count, np.bool_), counter=np.zeros(3, np.int64),
            projectile_position=np.zeros((count, 3)), f_contact_nose=np.zeros((count, 3)),
            ply_counters=np.tile([AT_REST, 0, 0], (count, 1)), projectile_velocity=strike_velocity * shot.flight,
            turns=self.turns,
        )  # fmt: skip
        states = []
        for p, ply in enumerate(self.plies):
            state = self._in_step(ply).state(strike_velocity)
            stack.projectile_position[p] = state.projectile_position
            stack.projectile_position[p, 2] -= self.places[p]
            # rims move from the start, whether anything touches them or not
            stack.awake[p] = p == 0 or state.slip_force.size > 0
            states.append(
                state._replace(
                    projectile_position=stack.projectile_position[p],
                    f_contact_nose=stack.f_contact_nose[p],
                    counter=stack.ply_counters[p],
                    projectile_velocity=stack.projectile_velocity
                    if p == 0 or self.turns is None
                    else state.projectile_velocity,
                    **self._foreseen(state.mass.size),
                )
            )
            states[p] = states[p]._replace(**{name: getattr(states[0], name) for name in dynamics.STATE})
        return tuple(states), stack

    def works(self) -> tuple[Work, ...]:
        """(plies,) scratch of one thread; plies of one grid share theirs."""
        found = {}
        for ply in self.plies:
            if id(ply) not in found:
                found[id(ply)] = ply.work()
        return tuple(found[id(ply)] for ply in self.plies)

    def slips(self, states: Sequence[State]) -> tuple[Slip, ...]:
        """(plies,) slip of sliding crossovers, at rest; empty of pinned ones."""
        return tuple(ply.slip(state) for ply, state in zip(self.plies, states) if isinstance(ply, SlidingPanel))

    def pairs(self, consts: Sequence[Constants], states: Sequence[State]) -> tuple[Pair, ...]:
        """The contact of each two neighbouring plies, at rest, first of the one in front on the one behind, then of all
        those behind on the one in front."""
        both, apart = [(p, p + 1) for p in range(len(self.gaps))], self._apart
        on_next = [self._pair(p, q, apart(p), consts, states) for p, q in both]
        return (*on_next, *(self._pair(q, p, -apart(p), consts, states) for p, q in both))

    def guard(self, consts: Sequence[Constants], states: Sequence[State]) -> Guard:
        """What keeps the plies from passing through each other, at rest."""
        rest, thicknesses = [], [ply.weave.thickness for ply in self.plies]
        for p, (ply, z) in enumerate(zip(self.plies, self.places)):
            x, y = turn_kernels.turned_back(self._turn(0, p), *ply.coordinates())
            rest.append(np.stack([x, y, np.full_like(x, z)], axis=-1).reshape(-1, 3))
        return guard(consts, states, rest, thicknesses, self.time_step, self.turns)

    def _apart(self, p):
        """[m] between the middle surfaces of plies p and p + 1 at rest."""
        return self._thickness(p) + self.gaps[p]

    def _in_step(self, ply):
        """A ply with the Courant factor that gives it the pack's time step."""
        return ply if ply.time_step == self.time_step else _slower(ply, self.time_step)

    def _pair(self, p, q, apart, consts, states):
        front, rear, knobs = consts[p], consts[q], self.contact
        form, first = FORMS[knobs.form], min(p, q)
        n, start = (knobs.points, 0.5) if form == FORMS["smooth"] else (1, 0.0)
        area, thickness = front.dx * front.dy / n**2, self._thickness(first)
        table, cell = law_table(self.laws[first], area, self._density(first), knobs)
        nothing = lambda c: np.array([c.ni + 1, 0, c.row_stride, 0])  # noqa: E731
        nodal = lambda state: tuple(np.zeros(state.mass.size) for _ in range(3))  # noqa: E731
        sub = (np.arange(n) + start) / n
        foot = np.zeros((2, front.ni, n, n, front.nj))
        foot[0], foot[1] = self._first_places(p, q, sub)
        elements = front.ni * front.nj
        padded = lambda kind=float: np.zeros(foot[0].size + WIDTH, kind)  # noqa: E731
        return Pair(
            closest_point=tuple(np.pad(part.ravel(), (0, WIDTH)) for part in foot), cp_rate=(padded(), padded()),
            normal=(padded(), padded(), padded()), last_depth=padded(), depth_offset=padded(),
            status=padded(np.uint8), on_facet=padded(np.uint8), recheck_step=padded(),
            near_torn=np.zeros(elements, np.uint8),
            torn_elements=np.zeros(elements, np.int64), torn_counts=np.zeros(3, np.int64),
            lane_index=np.arange(float(WIDTH)), max_speed=np.zeros(2),
            f_front=nodal(states[p]), f_rear=nodal(states[q]), front_window=nothing(front),
            rear_window=nothing(rear), front_box=np.array(states[p].contact_window),
            rear_box=np.array([rear.ni + 1, -1, rear.row_stride, -1]), energy=np.zeros(5), surface_form=form,
            points_per_side=n, point_offset=start, law=table, law_step=cell,
            thickness=thickness, rest_distance=apart,
            min_deflection=max(_LEAST[0] * (abs(apart) - thickness), _LEAST[1] * thickness),
            turn=None if self.turns is None else self._turn(p, q),
            **area_factors(self.plies[p], self.plies[q], None if self.turns is None else foot),
            **friction.fields(
                self.friction, foot[0].size + WIDTH, self._slip_constants(self._density(first) * area, table[-1, 1])
            ),
        )  # fmt: skip

    def _slip_constants(self, mass, stiffness):
        """Stick between plies is bounded by the mass of one family alone, where the other slides through the nodes."""
        sliding = [ply for ply in self.plies if isinstance(ply, SlidingPanel)]
        mass *= min((min(ply.own_masses) for ply in sliding if not ply.friction.pins), default=1.0)
        cfl = self._in_step(self.plies[0]).numerics.cfl
        return friction.slip_constants(cfl, mass, self.time_step, stiffness, self.contact.damping)

    def _first_places(self, p, q, sub):
        """(along, across) [elements] where the points of ply p lie on ply q at rest, arrays that go together with
        (ni, points, points, nj).

        Near the borders of zones, where the spline's places are not in proportion to distances, a guess; of points
        beside ply q the nearest place on its rim.
        """
        front, rear = self.plies[p], self.plies[q]
        along, across = (np.arange(n)[:, None] + sub for n in front.counts)
        along, across = along[:, :, None, None], across.T[None, None, :, :]
        if front.sides is None and self.turns is None:
            (x0, y0), (X0, Y0), (dx, dy), (DX, DY) = front.origin, rear.origin, front.spacing, rear.spacing
            return (x0 - X0 + along * dx) / DX, (y0 - Y0 + across * dy) / DY
        x, y = (np.interp(at, np.arange(line.size), line) for at, line in zip((along, across), front.lines()))
        turn = None if self.turns is None else self._turn(p, q)
        places = turn_kernels.turned(turn, x, y)
        return tuple(np.interp(at, line, np.arange(line.size)) for at, line in zip(places, rear.lines()))


def _slower(ply, step):
    """A ply with the Courant factor that gives it a time step [s]."""
    cfl = ply.numerics.cfl * step / ply.time_step
    return replace(ply, numerics=replace(ply.numerics, cfl=cfl))


def turned(panel: Panel) -> Panel:
    """The same panel with its fabric turned by a right angle; opening and edges stay where they are.

    Raises
    ------
    InputError : an oblique weave, or a cell that comes from a response surface
    """
    if panel.weave_angle:
        raise InputError(key="stacking", value="alternating", allowed="aligned where the weave is oblique")
    model = panel.table.model
    if not isinstance(model, CellModel):
        raise InputError(key="stacking", value="alternating", allowed="aligned where the cell is a response surface")
    model = replace(model, fabric=rotated_90(model.fabric), laws=model.laws and model.laws[::-1], toe=model.toes[::-1])
    factors = panel.strength_factors
    return replace(
        panel, table=CellTable.fill(model, panel.table.stretch1.size), bending=panel.bending[::-1],
        strength_factors=factors and factors[::-1],
    )  # fmt: skip


def at_angle(panel: Panel, angle: float) -> Panel:
    """The same panel with its fabric turned by an angle [rad], from warp to weft; opening and edges stay.

    Raises
    ------
    InputError : as `turned`; an angle that is not one of half a turn; edges that are not clamped, or a model that is
        not whole, of any but a right angle
    """
    if not -pi / 2 < angle <= pi / 2:
        raise InputError(key="angle", value=angle, allowed="above -pi/2 and at most pi/2")
    if angle == 0.0:
        return panel
    if angle == pi / 2 and panel.weave_angle == 0.0:
        return turned(panel)
    oblique = remainder(panel.weave_angle + angle, pi)
    return replace(panel, weave_angle=oblique, ply_angle=oblique - panel.weave_angle)
