"""A pack: plies behind each other in one opening, with a gap between each two.

"aligned" plies are all alike; in an "alternating" pack every other one is turned by a right angle (thesis section
5.2.3, Figure 5-55): the panel of the fabric with its warp called weft, since the shell does not see which yarn is on
top. A ply at any other angle has its grid in a frame of its own, in which the opening is oblique and the projectile
comes from elsewhere. The gap is the play between faces at rest; middle surfaces are the mean thickness and the gap
apart (erratum E-35; default: `gap.ply_gap`). Plies press by a law of pressure (`fabrics.ply_law`); the nose presses
on half a ply of solid fibre, twice the stiffness of two half plies. All share the shortest of their steps, or a
shorter one for the contact (`PlyContact`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise
from math import cos, inf, pi, remainder, sin

import numpy as np

from fabrics import ply_laws
from fabrics.base import sums
from fabrics.base.checks import FloatArray
from fabrics.base.errors import InputError
from fabrics.ply_law import PlyLaw
from fabrics.variants import rotated_90
from shellfabric.cell.model import CellModel, CellTable
from shellfabric.contact import friction
from shellfabric.jit.simd import WIDTH
from shellfabric.membrane.arrays import nose_law
from shellfabric.membrane.model import Panel
from shellfabric.membrane.motion_kernels import AT_REST
from shellfabric.plies.arrays import empty_contact, pack_contact
from shellfabric.plies.gap import gap_between, ply_gap
from shellfabric.plies.numerics import PlyContact, law_tables
from shellfabric.plies.pack_keys import STACKINGS
from shellfabric.plies.state import PackContact
from shellfabric.projectile import frames
from shellfabric.state import Constants, Stack, State, Work
from shellfabric.yarns.model import YarnPanel


@dataclass(frozen=True)
class Pack:
    """Plies in the order in which the projectile meets them.

    Parameters
    ----------
    plies : tuple of Panel, alike in opening, impact point, symmetry, projectile and numerics; see
        `stacked`
    gaps : (plies - 1,) [m] at rest
    contact : PlyContact
    friction : [-] Coulomb's coefficient between plies
    laws : (plies - 1,) PlyLaw, pressure against closure of each ply on the next; none: those of
        their fabrics

    Raises
    ------
    InputError : no ply, a wrong number of gaps, a negative gap, plies that do not go together, or
        as `friction.check`
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
            raise InputError(
                key="gaps", value=len(self.gaps), allowed=f"{len(self.plies) - 1} of them"
            )
        for gap in self.gaps:
            if not 0 <= gap < inf:
                raise InputError(key="ply_gap", value=gap, allowed="at least 0")
        if not self.laws:
            own = ()
            if self.gaps:
                own = self._each(lambda ply: ply_laws.default(ply.fabric))
            laws = tuple(front.between(rear) for front, rear in pairwise(own))
            object.__setattr__(self, "laws", laws)
        if len(self.laws) != len(self.gaps):
            raise InputError(
                key="laws", value=len(self.laws), allowed=f"{len(self.gaps)} of them, or none"
            )
        first = self.plies[0]
        for key in ("symmetry", "projectile", "opening", "round", "impact_point", "grading"):
            if any(getattr(ply, key) != getattr(first, key) for ply in self.plies):
                raise InputError(f"the plies of a pack must have one {key}")
        if len({(ply.table.model.cell_formulation, ply.trellis) for ply in self.plies}) > 1:
            raise InputError("the plies of a pack must have cells of one form")
        self._join_zones()
        friction.check(self.friction, first.numerics.cfl)

    def _join_zones(self):
        """Let the zones of resolved yarns of several plies see each other."""
        resolved = [isinstance(ply, YarnPanel) for ply in self.plies]
        if not any(resolved) or len(self.plies) == 1:
            return
        if not all(resolved):
            raise InputError(
                key="crossovers", value="yarns", allowed="those of all plies of a pack, or of none"
            )
        joined = self._each(lambda ply: ply if ply.among_plies else replace(ply, among_plies=True))
        object.__setattr__(self, "plies", joined)

    def at_shorter_step(self, factor: float) -> Pack:
        """Return the pack with a time step that is `factor` times as long."""

        shorter = self._each(lambda ply: _with_courant(ply, factor * ply.numerics.cfl))
        return replace(self, plies=shorter)

    @classmethod
    def stacked(
        cls,
        ply: Panel,
        plies: int,
        *,
        stacking: str = "aligned",
        gap: float | None = None,
        contact: PlyContact | None = None,
        friction: float = 0.0,
        law: PlyLaw | None = None,
    ) -> Pack:
        """Stack a pack of one fabric.

        Parameters
        ----------
        ply : Panel, the first
        plies : their number
        stacking : "aligned" or "alternating"
        gap : [m] between all plies; None takes that of `gap.ply_gap`
        contact, friction : as in a Pack
        law : PlyLaw of two of these plies; None takes that of the fabric (`ply_laws.default`)

        Raises
        ------
        InputError : no ply, unknown stacking, a weave that cannot be turned, or no law
        """
        if not plies >= 1:
            raise InputError(key="plies", value=plies, allowed="at least 1")
        if stacking not in STACKINGS:
            raise InputError(key="stacking", value=stacking, allowed=" or ".join(STACKINGS))
        contact = contact or PlyContact()
        if plies == 1:
            return cls((ply,), contact=contact, friction=friction)
        law = law or ply_laws.default(ply.fabric)
        if gap is None:
            gap = ply_gap(ply.fabric, law).value
        both = ply, ply
        if stacking == "alternating":
            both = ply, turned(ply)
        stack = tuple(both[n % 2] for n in range(plies))
        between = plies - 1
        return cls(stack, (gap,) * between, contact, friction, (law,) * between)

    @classmethod
    def laid_up(
        cls,
        plies: Sequence[tuple[Panel, float]],
        *,
        gaps: Sequence[float | None],
        contact: PlyContact | None = None,
        friction: float = 0.0,
    ) -> Pack:
        """Lay up a pack of any plies.

        Parameters
        ----------
        plies : of each ply its panel as it lies at no angle, and the angle [rad] by which it is
            turned
        gaps : [m] between each two; None takes that of `gap.gap_between`
        contact, friction : as in a Pack

        Raises
        ------
        InputError : as Pack and `turned`
        """
        kinds = {(id(panel), angle): panel for panel, angle in plies}
        made = {kind: at_angle(panel, kind[1]) for kind, panel in kinds.items()}
        chosen = []
        for gap, (front, _), (rear, _) in zip(gaps, plies, plies[1:]):
            if gap is None:
                gap = gap_between(front.fabric, rear.fabric).value
            chosen.append(gap)
        return cls(
            tuple(made[id(panel), angle] for panel, angle in plies),
            tuple(chosen),
            contact or PlyContact(),
            friction,
        )

    @classmethod
    def of(cls, target: Panel | Pack) -> Pack:
        """Return the pack itself, or that of a single ply."""
        if isinstance(target, Pack):
            return target
        return cls((target,))

    @property
    def angles(self) -> tuple[float, ...]:
        """(plies,) [rad] from the pack's axes to those of the plies' grids."""
        return tuple(ply.ply_angle for ply in self.plies)

    @cached_property
    def turns(self) -> FloatArray:
        """(plies, 2) cosine and sine of the angles from the frame of the first ply to those of the
        plies."""
        angles = np.array(self.angles) - self.angles[0]
        return np.stack([np.cos(angles), np.sin(angles)], axis=1)

    @property
    def elements(self) -> int:
        """Number of elements of all plies."""
        return sum(ply.elements for ply in self.plies)

    @cached_property
    def time_step(self) -> float:
        """[s] the shortest of the plies' steps and of those of their contact (`PlyContact`)."""
        steps = [
            self.contact.closing_courant * (self._density(p) / self._steepest(p)) ** 0.5
            for p in range(len(self.laws))
        ]
        return min(*(ply.time_step for ply in self.plies), *steps, inf)

    @cached_property
    def contact_laws(self) -> tuple[PlyLaw, ...]:
        """(plies - 1,) the laws as far as they are followed (`PlyContact.stiffness`)."""
        return tuple(law.capped(self.contact.stiffness) for law in self.laws)

    def _density(self, p):
        """[kg/m2] of the lighter one of plies p and p + 1, which bounds the step."""
        return min(ply.contact_density for ply in self.plies[p : p + 2])

    def _steepest(self, p):
        """[Pa/m] highest stiffness of the contact of plies p and p + 1."""
        return self.contact_laws[p].steepest

    def _thickness(self, p):
        """[m] mean of plies p and p + 1."""
        return float(np.mean([ply.weave.thickness for ply in self.plies[p : p + 2]]))

    @cached_property
    def places(self) -> FloatArray:
        """(plies,) [m] where the middle surfaces stand at rest, the first at 0."""
        return np.concatenate([[0.0], np.cumsum([self._apart(p) for p in range(len(self.gaps))])])

    def constants(self) -> tuple[Constants, ...]:
        """Return what the kernels need to know of each ply, (plies,), all at one time step."""
        if len(self.plies) == 1:
            return (self.plies[0].constants(),)

        def of(ply):
            ply = self._in_step(ply)
            const = ply.constants()
            law = nose_law(ply, const.point_law.mass, implicit=True)
            # of the plies' steepest spring; the nose's is two of solid fibre in a row
            between = 0.5 * min(self.contact.stiffness, 1.0) * law.stiffness
            drag = self.contact.share_ratio * (between * law.mass) ** 0.5
            law = law._replace(share_drag=drag)
            return const._replace(dt=self.time_step, point_law=law)

        return self._each(of)

    def states(self, strike_velocity: float) -> tuple[tuple[State, ...], Stack]:
        """Return the plies at rest, with what they share: (tuple of State, Stack)."""
        found = Stack.zeros(plies=len(self.plies))
        found["ply_steps"][:] = AT_REST
        found["projectile_velocity"][:] = strike_velocity * self.plies[0].shot.flight
        found["turns"][:] = self.turns
        stack = Stack(motion=np.zeros(0), **found)
        states = []
        angles = np.array(self.angles) - self.angles[0]
        for p, ply in enumerate(self.plies):
            state = self._in_step(ply).state(strike_velocity)
            stack.projectile_position[p] = state.projectile_position
            if p > 0 and isinstance(ply, YarnPanel):  # its nose stands before the first ply's yarns
                x, y, z = stack.projectile_position[0]
                stack.projectile_position[p] = *sums.multiply(frames.axes(angles[p]), (x, y)), z
            stack.projectile_position[p, 2] -= self.places[p]
            # rims move from the start, whether anything touches them or not; of resolved yarns the
            # nose may meet those of any ply first
            stack.awake[p] = p == 0 or state.slip_force.size > 0 or isinstance(ply, YarnPanel)
            shared = {
                "projectile_position": stack.projectile_position[p],
                "f_contact_nose": stack.f_contact_nose[p],
                "steps": stack.ply_steps[p, ...],
                "failures": stack.ply_failures[p, ...],
            }
            if p == 0:
                shared["projectile_velocity"] = stack.projectile_velocity
            states.append(state._replace(**shared))
        return tuple(states), stack

    def works(self) -> tuple[Work, ...]:
        """Allocate the scratch of one thread, (plies,); plies of one grid share theirs."""
        return self._each(Panel.work)

    def _each(self, function):
        """(plies,) what a function makes of each ply, once of plies that are one object."""
        kinds = {id(ply): ply for ply in self.plies}
        made = {kind: function(ply) for kind, ply in kinds.items()}
        return tuple(made[id(ply)] for ply in self.plies)

    def plies_contact(self, consts: Sequence[Constants], states: Sequence[State]) -> PackContact:
        """Set up the contact between the plies, at rest; of a single ply one without points."""
        if len(self.plies) == 1:
            return empty_contact()
        points = self.contact.points
        places = [self._first_places(p) for p in range(len(self.gaps))]
        areas = [self._areas(p, np.array(at)) for p, at in enumerate(places)]
        smallest = [float(np.prod(ply.spacing)) / points**2 for ply in self.plies[:-1]]
        densities = [self._density(p) for p in range(len(self.gaps))]
        laws, law_cell = law_tables(self.contact_laws, smallest, densities, self.contact)
        factors = [self._in_step(ply).numerics.cfl for ply in self.plies]
        sticks = [
            friction.stick(max(factors[p : p + 2]), d * a, self.time_step, self._steepest(p) * a)
            for p, (d, a) in enumerate(zip(densities, smallest))
        ]
        feet = [
            np.concatenate([np.ravel(at[axis]) for at in places] + [np.zeros(WIDTH)])
            for axis in (0, 1)
        ]
        first = lambda counts: np.concatenate([[0], np.cumsum(counts)])  # noqa: E731
        return pack_contact(
            consts,
            states,
            self.places,
            [ply.weave.thickness for ply in self.plies],
            self.turns,
            points_per_side=points,
            first_point=first([at[0].size for at in places]),
            closest_a=feet[0],
            closest_b=feet[1],
            first_element=first([area.size for area in areas]),
            area_ratio=np.concatenate([np.ravel(area) for area in areas] + [np.zeros(WIDTH)]),
            laws=laws,
            law_cell=law_cell,
            resilience=float(self.contact.resilience),
            share_drag=self.contact.share_drag,
            friction=float(self.friction),
            stick_stiffness=np.array([spring for spring, _ in sticks]),
            stick_damping=np.array([damper for _, damper in sticks]),
            same_angle=np.array([abs(a - b) < 1e-12 for a, b in pairwise(self.angles)]),
        )

    def _apart(self, p):
        """[m] between the middle surfaces of plies p and p + 1 at rest."""
        return self._thickness(p) + self.gaps[p]

    def _in_step(self, ply):
        """A ply with the Courant factor that gives it the pack's time step."""
        if ply.time_step == self.time_step:
            return ply
        return _with_courant(ply, ply.numerics.cfl * self.time_step / ply.time_step)

    def _first_places(self, p):
        """(along, across) [elements], each (ni, points, points, nj): where the points of ply p lie
        on the next at rest.

        Near the borders of zones, where the spline's places are not in proportion to distances, a
        guess; of points beside that ply the nearest position on its rim.
        """
        front = self.plies[p]
        rear = self.plies[p + 1]
        n = self.contact.points
        sub = (np.arange(n) + 0.5) / n
        along, across = (np.arange(count)[:, None] + sub for count in front.counts)
        lines = [
            np.interp(at, np.arange(line.size), line)
            for at, line in zip((along, across), front.lines())
        ]
        x, y = np.broadcast_arrays(lines[0][:, :, None, None], lines[1].T[None, None])
        angle = self.angles[p + 1] - self.angles[p]
        x, y = cos(angle) * x + sin(angle) * y, cos(angle) * y - sin(angle) * x
        return tuple(
            np.interp(at, line, np.arange(line.size)) for at, line in zip((x, y), rear.lines())
        )

    def _areas(self, p, places):
        """(ni, nj) [-] areas that the points of an element of ply p stand for, over that of its
        smallest: its own, or what its points have where elements of another grid behind it are
        smaller, whose nodes' mass would bear no stiffer spring.

        places : of `_first_places`
        """
        front, rear = self.plies[p : p + 2]
        own, other = (
            np.multiply.outer(*(np.diff(line) for line in ply.lines())) for ply in (front, rear)
        )
        if (
            own.shape == other.shape
            and np.array_equal(own, other)
            and self.angles[p] == self.angles[p + 1]
        ):
            return own / np.prod(front.spacing)
        wide = np.pad(other, 1, mode="edge")
        m, n = other.shape
        shifts = [(a, b) for a in range(3) for b in range(3)]
        least = np.min([wide[a : a + m, b : b + n] for a, b in shifts], axis=0)
        at = np.minimum(
            places.astype(np.int64), np.array(other.shape)[:, None, None, None, None] - 1
        )
        return np.minimum(
            own, self.contact.points**2 * least[at[0], at[1]].min(axis=(1, 2))
        ) / np.prod(front.spacing)


def _with_courant(ply, factor):
    """A ply with another Courant factor."""
    return replace(ply, numerics=replace(ply.numerics, cfl=factor))


def turned(panel: Panel) -> Panel:
    """Return the same panel with its fabric turned by a right angle; opening and edges stay where
    they are.

    Raises
    ------
    InputError : an oblique weave, or a cell that comes from a response surface
    """
    if panel.weave_angle:
        raise InputError(
            key="stacking", value="alternating", allowed="aligned if the weave is oblique"
        )
    model = panel.table.model
    if not isinstance(model, CellModel):
        raise InputError(
            key="stacking",
            value="alternating",
            allowed="aligned if the cell is a response surface",
        )
    model = replace(
        model,
        fabric=rotated_90(model.fabric),
        laws=model.laws and model.laws[::-1],
    )
    factors = panel.strength_factors
    return replace(
        panel,
        table=CellTable.fill(model, panel.table.stretch1.size),
        bending=panel.bending[::-1],
        strength_factors=factors and factors[::-1],
    )


def at_angle(panel: Panel, angle: float) -> Panel:
    """Return the same panel with its fabric turned by an angle [rad], from warp to weft; opening
    and edges stay.

    Raises
    ------
    InputError : as `turned`; an angle that is not one of half a turn; edges that are not clamped,
        or a model that is not whole, of any but a right angle
    """
    if not -pi / 2 < angle <= pi / 2:
        raise InputError(key="angle", value=angle, allowed="above -pi/2 and at most pi/2")
    if angle == 0.0:
        return panel
    if angle == pi / 2 and panel.weave_angle == 0.0:
        return turned(panel)
    oblique = remainder(panel.weave_angle + angle, pi)
    return replace(panel, weave_angle=oblique, ply_angle=oblique - panel.weave_angle)
