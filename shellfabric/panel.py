"""A fabric panel with its projectile: grid, masses, supports, time step, and the arrays that the kernels work on.

Time step. The highest frequency of the cloth is bounded by w^2 = 4 D / (m d^2), with d the shorter side, m the areal
density, and D the largest over 0 <= a <= 1 of lambda a + 2 G2 t a (1 - a): that of the mode whose phase turns by
2 arcsin(sqrt a) from node to node along both yarns. lambda is the largest eigenvalue of the table's membrane tangent,
G2 t that of the trellis, which has one point in each element and so is blind to a = 1. Along a straight yarn this is
d / c with the wave speed c = sqrt(E / rho) / sqrt(1 + mass of the crossing yarn over its own): the factor sqrt 2 of
woven yarn (erratum E-38). Viscous forces act on the velocity of half a step ago, which limits the step to
(2 / w) (sqrt(1 + xi^2) - xi) at damping ratio xi. How much of that is taken depends on the cell: see `pace`.
"""

from __future__ import annotations

from collections import namedtuple
from dataclasses import dataclass, field
from functools import cached_property
from math import inf

import numpy as np

from fabrics.errors import InputError
from shellfabric import (
    behind,
    body,
    cell_kernels,
    contact,
    contact_kernels,
    edges,
    edges_kernels,
    grading,
    march_kernels,
    pace,
    team,
)
from shellfabric.backing import Backing
from shellfabric.cell import CellTable
from shellfabric.projectile import Projectile

PRECISIONS = {"double": np.float64, "single": np.float32}
_STEPS = 256  # of the force, in what it tells of the tension
_PIECE = 256  # slots that loops of two halves go over at a time (see `membrane_kernels`): a whole number of eights
_ROWS = 6  # of a block at least: with fewer, most of the work would be on the rows about it that two blocks need
SYMMETRIES = {"quarter": (True, True), "half": (True, False), "whole": (False, False)}

Constants = namedtuple(
    "Constants",
    "ni nj s block per mirror_x mirror_y x0 y0 dx dy rx0 ry0 dt "
    "tension1 tension2 ceiling1 unit1 ceiling2 unit2 spline level x0t rx top1 y0t ry top2 grid per1 per2 variational "
    "split1 split2 cv1 cv2 V G1 G2 gamma1 gamma2 w1 S01 EA1 w2 S02 EA2 strength1 strength2 strengths1 strengths2 lag "
    "widest near points shares point_stiffness point_damping R rho projectile_mass free idle_steps "
    "shape form length frame tilted roaming depth reach top shoulder friction rim_node rim_axis rim bending jam ends "
    "bar_mass bar_h bar_area bar_law bar_parts backed",
)
State = namedtuple(
    "State",
    "u v g0 g1 mass inverse_mass kick L N T D slope y intact failed filtered flag thin stale most "
    "pressed touching contact position speed reaction "
    "contact_energy rows counter sums peak window stuck rim_force rim_sums "
    "outer behind bar_u bar_v bar_plastic bar_stress bar_sums",
)
Work = namedtuple(
    "Work",
    "A B l1 l2 i1 i2 m1 m2 T1 T2 N1 N2 K1 K2 own1 own2 given1 given2 on1 on2 turn1 turn2 cross up spots shared touch",
)


@dataclass(frozen=True)
class Numerics:
    """Numerical knobs, set by stability and convergence; none is fitted to an outcome.

    The figures below are of S-720, at 92.5 m/s after 250 us: peak tension 135 N in the warp and 154 N in the weft.

    Parameters
    ----------
    safety : of the time step against its bound; 0.9 leaves room for shear stiffening in distorted elements. Where yarns
        snap taut a step loses energy, with its square, whatever the mesh, since a snap is a few elements wide: for
        S-731 at 116 m/s 0.17 % of the strike energy, at 0.45 0.04. It is booked as "cell" (see `march`). Giving it back
        to the front (a viscosity that is less by dK dL / 12) was tried: the peak of the first front along S-745 at 215
        m/s, 658 N at 0.9 and 648 at 0.1, is 693 then
    stretch_viscosity : damping ratio of the highest mode along a straight yarn, which costs as much of the time step.
        Without it crimped yarns that snap taut ring, and the peak is 190 and 380 N; from 0.05 to 0.2 it moves by 1 %.
        In a yarn that stiffens as its crimp goes, fronts are shocks, which dissipate whatever the viscosity: from 0.1
        to 0.02 the loss of S-731 at 110 m/s falls from 13.3 to 11.2 % of the strike energy, and with half the element
        from 13.3 to 12.9
    penalty : stiffness of the contact where it covers an element, in units of nodal mass / dt^2, with the dt that
        `safety` would make of the bound (see `pace`). From 0.3 to 1 the peak moves by 2 %, and the critical velocity,
        which feels how deep the rim of the nose presses itself in, by 3 to 6 %, from 0.6 to 1 by 1 to 2 %; at 1 and
        above yarns bounce off the nose. The bound is 1.5 at the damping below
    contact_damping : ratio to critical of that mass on that spring; from 0.25 to 0.7 the peak stays
    contact_points : along each side of a crossover, and at least 2 along that of an element (see `contact_kernels`)
    failure_time : [s] over which a yarn's tension is low-passed before it is held against its strength; 0: not at all
    widest : stretch of the gap left by failed yarns at which its element loses contact: two neighbours' worth
    clear_time : [s] without a push and with nothing ahead, after which the panel counts as perforated
    block : elements worked on together, six rows at least: more share the cost of a block and of the rows about it,
        fewer keep its scratch in cache
    precision : "double" or "single", in which forces are kept from step to step, and the constants of nodes and edges;
        all is computed in double precision, and places, velocities and stretches are kept in it
    threads : that march; None takes all that the process may use where it pays (`team`). No result depends on it
    """

    safety: float = 0.9
    stretch_viscosity: float = 0.1
    penalty: float = 0.6
    contact_damping: float = 0.5
    contact_points: int = 8
    failure_time: float = 0.0
    widest: float = 3.0
    clear_time: float = 2e-6
    block: int = 2000
    precision: str = "double"
    threads: int | None = None

    def __post_init__(self):
        for key in ("safety", "penalty", "contact_points", "widest", "clear_time", "block"):
            if not getattr(self, key) > 0:
                raise InputError(key=key, value=getattr(self, key), allowed="above 0")
        for key in (
            "stretch_viscosity",
            "contact_damping",
            "contact_points",
            "failure_time",
        ):
            if not getattr(self, key) >= 0:
                raise InputError(key=key, value=getattr(self, key), allowed="at least 0")
        if self.precision not in PRECISIONS:
            raise InputError(key="precision", value=self.precision, allowed=" or ".join(PRECISIONS))
        if self.threads is not None and self.threads < 1:
            raise InputError(key="threads", value=self.threads, allowed="at least 1")
        if self.safety > 1:
            raise InputError(key="safety", value=self.safety, allowed="at most 1")


@dataclass(frozen=True)
class Panel:
    """A rectangle of whole crossovers about the impact point, and the projectile before it.

    Parameters
    ----------
    table : CellTable of the fabric
    opening : (along warp, along weft) [m], but for an oblique weave; as many whole crossovers as fit from the centre to
        an edge are meshed, as in the source (erratum E-34: 79 of 79.9 for S-720)
    projectile : Projectile
    symmetry : "quarter", "half" (x >= 0) or "whole"
    elements_per_crossover : along each side
    edge : "clamped", "free" or a slipping side, for all sides or each on its own (see `edges`)
    numerics : Numerics
    trellis : whether the fabric's shear law acts; a fabric without one has none
    failure : whether yarns fail
    weave_angle : [rad] of the warp against the first side of the opening, towards the second (see `edges`)
    bending : (warp, weft) [N m2] bending stiffness of a yarn; none as in the source. It lies between the sum over its
        fibres, n E pi d^4 / 64, when they slide, and that of a solid section of its fibre area, E A^2 / 4 pi: for
        S-720 with fibres of 12 um 9.5e-8 and 9.3e-5 (see `bending_kernels`)
    strength_factors : (warp, weft) factors on the strength of each yarn, as many as `yarn_counts`, or None where all
        are alike. They are those of the modelled part: across a plane of symmetry a yarn has that of its image
    backing : Backing, the block behind the cloth, or None (see `behind`)
    jam : stiffness [N] of a yarn against being bunched up, and the stretch at which it begins; none as in the source
        (see `jam_kernels`)
    grading : ((until, side), ...) [crossovers] elements that are longer the further they are from the impact point, or
        None (see `grading`); for straight shots at cloth that is held or free at its edges

    Raises
    ------
    InputError : unknown symmetry or edge, an opening smaller than the projectile needs, or a symmetry that shot, edges
        or weave do not have
    """

    table: CellTable
    opening: tuple[float, float] = (0.203, 0.203)
    projectile: Projectile = field(default_factory=Projectile)
    symmetry: str = "quarter"
    elements_per_crossover: int = 1
    edge: str | edges.PullIn | edges.Grip | tuple = "clamped"
    numerics: Numerics = field(default_factory=Numerics)
    trellis: bool = True
    failure: bool = True
    weave_angle: float = 0.0
    bending: tuple[float, float] = (0.0, 0.0)
    strength_factors: tuple | None = None
    backing: Backing | None = None
    jam: tuple[float, float] = (0.0, 1.0)
    grading: tuple | None = None

    def __post_init__(self):
        if self.symmetry not in SYMMETRIES:
            raise InputError(key="symmetry", value=self.symmetry, allowed=" or ".join(SYMMETRIES))
        edges.check(self)
        behind.check(self)
        if self.failure and any(self.table.model.toes):  # a yarn whose crossings have failed is linear in the march
            raise InputError(key="toe", value=self.table.model.toe, allowed="0 in a panel whose yarns fail")
        for axis, mirrored in enumerate(self.mirrors):
            if mirrored and not self.projectile.mirrored(axis):
                raise InputError(key="symmetry", value=self.symmetry, allowed="one that the oblique shot has, or whole")
        if self.grading is not None:
            grading.check(self.grading)
        if self.elements_per_crossover < 1:
            raise InputError(key="elements_per_crossover", value=self.elements_per_crossover, allowed="1, 2, 3, ...")
        if not all(0 <= EI < inf for EI in self.bending):
            raise InputError(key="bending", value=self.bending, allowed="at least 0")
        if len(self.jam) != 2 or not (0 <= self.jam[0] < inf and 0 < self.jam[1] <= 1):
            raise InputError(key="jam", value=self.jam, allowed="a force of at least 0 and a stretch of at most 1")
        for family, given, count in zip(("warp", "weft"), self.strength_factors or (), self.yarn_counts):
            if np.shape(given) != (count,) or not np.all(np.isfinite(given) & (np.asarray(given) > 0)):
                raise InputError(key=f"strength_factors of the {family}", allowed=f"{count} numbers above 0")
        for length, w in zip(self.opening, self.weave.w):
            if not length / 2 >= max(2 * self.projectile.radius, 4 * w):
                raise InputError(key="opening", value=length, allowed="wider than two projectiles and four crossovers")
        if self.grading is not None:
            self._check_grading()

    def _check_grading(self):
        for key, value, plain in (
            ("elements_per_crossover", self.elements_per_crossover, 1),
            ("weave_angle", self.weave_angle, 0.0),
            ("bending", tuple(self.bending), (0.0, 0.0)),
            ("backing", self.backing, None),
            ("jam", tuple(self.jam), (0.0, 1.0)),
        ):
            if value != plain:
                raise InputError(key=key, value=value, allowed=f"{plain} on a graded panel")
        if edges.slips(self.edge):
            raise InputError(key="edge", value=self.edge, allowed="clamped or free on a graded panel")
        if self.projectile.roaming:
            raise InputError(key="grading", value=self.grading, allowed="none where the projectile moves sideways")
        fine = self._fine
        for place, step, reach in zip((fine[1], fine[3]), self.spacing, self._reach()):
            least = int(np.ceil(reach / step)) + 1  # and what the smooth surface of the last element has beside it
            if self.sides is not None and place < least:
                allowed = f"a first zone of {least * self._finest} crossovers or more"
                raise InputError(key="grading", value=self.grading, allowed=f"{allowed}, all that comes under the nose")

    @property
    def fabric(self):
        return self.table.model.fabric

    @property
    def weave(self):
        return self.fabric.weave

    @property
    def mirrors(self):
        """(x, y) whether x = 0 and y = 0 are planes of symmetry that bound the modelled part."""
        return SYMMETRIES[self.symmetry]

    @property
    def _finest(self):
        """Crossovers along a side of an element at the impact point."""
        return 1 if self.grading is None else int(self.grading[0][1])

    @property
    def spacing(self):
        """(dx, dy) [m] sides of an element, of the smallest on a graded panel."""
        return tuple(2 * w * self._finest / self.elements_per_crossover for w in self.weave.w)

    @property
    def _half(self):
        """(along warp, along weft) crossovers from the impact point to an edge."""
        return tuple(int(length / 2 / (2 * w) + 1e-9) for length, w in zip(edges.extent(self), self.weave.w))

    @cached_property
    def sides(self):
        """((ni,), (nj,)) [m] sides of the elements along warp and weft; None where all are alike."""
        if self.grading is None or len({side for _, side in self.grading}) == 1:
            return None
        found = []
        for length, w, mirrored in zip(self._half, self.weave.w, self.mirrors):
            outward = 2 * w * grading.sides(self.grading, length)
            found.append(outward if mirrored else np.concatenate([outward[::-1], outward]))
        return tuple(found)

    @property
    def _fine(self):
        """Rows and columns (i0, i1, j0, j1) of the smallest elements, counted from the impact point."""
        bounds = []
        for n, step, half in zip(range(2), self.spacing, self._half):
            if self.sides is None:
                count = half * self.elements_per_crossover // self._finest
            else:
                alike = np.abs(self.sides[n] - step) < 1e-9 * step
                count = int(alike.sum()) // (1 if self.mirrors[n] else 2)
            bounds += [0 if self.mirrors[n] else -count, count]
        return tuple(bounds)

    @property
    def counts(self):
        """(ni, nj) elements along warp and weft."""
        if self.sides is not None:
            return tuple(part.size for part in self.sides)
        half = [n * self.elements_per_crossover // self._finest for n in self._half]
        return tuple(n if mirrored else 2 * n for n, mirrored in zip(half, self.mirrors))

    @property
    def yarn_counts(self):
        """(warp, weft) yarns of the modelled part, with those on its rims; lines on a graded panel."""
        return tuple(count // self.elements_per_crossover + 1 for count in self.counts[::-1])

    @property
    def elements(self):
        """Number of elements."""
        return self.counts[0] * self.counts[1]

    @property
    def share(self):
        """Part of the whole panel, and of the projectile, that is modelled."""
        return 0.5 ** sum(self.mirrors)

    @property
    def membrane_stiffness(self):
        """[N/m] the D of the time step's bound."""
        stiffness, shear = self.table.stiffness(), self.fabric.shear
        locked = 2 * shear.G2 * self.weave.thickness if self.trellis and shear is not None else 0.0
        return stiffness if locked <= stiffness else (stiffness + locked) ** 2 / (4 * locked)

    @property
    def critical_step(self):
        """[s] 2 / w of the undamped cloth."""
        m, shares = self.weave.areal_density, zip(self._yarns_a_line, self.bending, self.spacing, self.spacing[::-1])
        membrane = self.membrane_stiffness / (m * min(self.spacing) ** 2)
        # a yarn that turns to and fro at every node has the energy 1/2 n EI / L (4 w / L)^2 a node
        return (membrane + sum(4 * n * EI / (m * d**4 * across) for n, EI, d, across in shares)) ** -0.5

    @property
    def _yarns_a_line(self):
        """(warp, weft) yarns that a grid line stands for at the impact point."""
        return tuple(count * d for count, d in zip((self.weave.warp_count, self.weave.weft_count), self.spacing[::-1]))

    @property
    def time_step(self):
        """[s] the step that is taken."""
        return self._step_of_bound * self._pace

    @property
    def _step_of_bound(self):
        """[s] share `safety` of the bound; what the contact is as stiff as, whatever is taken of it."""
        xi = self.numerics.stretch_viscosity
        return self.numerics.safety * self.critical_step * ((1 + xi**2) ** 0.5 - xi)

    @cached_property
    def _pace(self):
        return pace.share(self.table, self.numerics.stretch_viscosity)

    @property
    def _block(self):
        """Element rows of a block: all blocks are of one size, but the last."""
        ni, nj = self.counts
        rows = max(_ROWS, self.numerics.block / (nj + 1))
        return -(-ni // max(1, round(ni / rows)))

    def coordinates(self):
        """(X, Y) [m] of the nodes at rest, each (ni+1, nj+1); the impact point is the origin."""
        return np.meshgrid(*self.lines(), indexing="ij")

    def lines(self):
        """((ni+1,), (nj+1,)) [m] places x and y of the lines of the grid at rest."""
        if self.sides is None:
            return tuple(x0 + d * np.arange(n + 1) for x0, d, n in zip(self.origin, self.spacing, self.counts))
        found = []
        for sides, mirrored in zip(self.sides, self.mirrors):
            x = np.insert(np.cumsum(sides), 0, 0.0)
            found.append(x if mirrored else x - x[sides.size // 2])
        return tuple(found)

    @property
    def origin(self):
        """(x0, y0) [m] of the first node at rest; on a graded panel as if all elements were the smallest.

        There the smallest are where they would be then, and nothing else is looked for by its place.
        """
        return tuple(0.0 if m else -0.5 * n * d for m, n, d in zip(self.mirrors, self.counts, self.spacing))

    def constants(self) -> Constants:
        """What the kernels need to know, as plain numbers and arrays."""
        (ni, nj), (dx, dy), (mirror_x, mirror_y) = self.counts, self.spacing, self.mirrors
        weave, table, knobs, dt = self.weave, self.table, self.numerics, self.time_step
        (w1, w2), (S01, S02), (warp, weft) = weave.w, weave.S0, weave.yarns
        rx, ry = (1 / step for step in table.steps)
        shear = self.fabric.shear if self.trellis else None
        G1, G2, gamma1, gamma2 = (shear.G1, shear.G2, shear.gamma1, shear.gamma2) if shear else (0.0, 0.0, 0.5, 1.0)
        lag = self.critical_step / dt
        mass = weave.areal_density * dx * dy
        (x0, y0), shot = self.origin, self.projectile
        rim_node, rim_axis, rim = edges.rim(self)
        strengths = self._strengths()
        roaming = shot.roaming or rim_node.size > 0  # over the cloth: it slides, or the cloth is drawn under it
        cv1, cv2 = (knobs.stretch_viscosity * lag * yarn.EA for yarn in (warp, weft))
        slots = {"rx0": 1 / dx, "ry0": 1 / dy, "cv1": cv1, "cv2": cv2, "V": dx * dy * weave.thickness}
        slots |= {"split1": 0.5, "split2": 0.5}
        if self.sides is not None:
            slots = grading.slots(self.sides, self.spacing, weave.thickness, (cv1, cv2), _room)
        return Constants(
            ni=ni, nj=nj, s=nj + 1, block=self._block, mirror_x=mirror_x, mirror_y=mirror_y,
            x0=x0, y0=y0, dx=dx, dy=dy, dt=dt, per=self.elements_per_crossover, **slots,
            tension1=table.tension1.reshape(-1, 4), tension2=table.tension2.reshape(-1, 4),
            ceiling1=self._ceilings[0][0], unit1=self._ceilings[0][1],
            ceiling2=self._ceilings[1][0], unit2=self._ceilings[1][1],
            spline=self._spline[0], level=self._spline[1],
            x0t=table.stretch1[0], rx=rx, top1=table.stretch1.size - 2,
            y0t=table.stretch2[0], ry=ry, top2=table.stretch2.size - 2,
            grid=(
                table.stretch1[0], rx, table.stretch1.size - 2.0, table.stretch2[0], ry, table.stretch2.size - 2.0,
                table.stretch2.size - 1.0,
            ),
            per1=rx / (2 * w1), per2=ry / (2 * w2), variational=table.model.form == "variational",
            G1=G1, G2=G2, gamma1=gamma1, gamma2=gamma2,
            w1=w1, S01=S01, EA1=warp.EA, w2=w2, S02=S02, EA2=weft.EA,
            strength1=strengths[0].min(), strength2=strengths[1].min(),
            strengths1=strengths[0], strengths2=strengths[1],
            lag=-np.expm1(-dt / knobs.failure_time) if knobs.failure_time > 0 else 0.0, widest=knobs.widest,
            near=self._near(roaming), **self._contact(mass),
            R=shot.radius, rho=shot.edge_radius, projectile_mass=shot.mass * self.share,
            free=(0.0 if mirror_x else 1.0, 0.0 if mirror_y else 1.0, 1.0),
            idle_steps=max(1, round(knobs.clear_time / dt)),
            shape=shot.number, form=shot.form, length=inf if shot.length is None else shot.length, frame=shot.frame,
            tilted=shot.tilted, roaming=roaming, depth=2 * shot.radius, reach=self._reach(), top=shot.top,
            shoulder=shot.shoulder, friction=shot.friction, rim_node=rim_node, rim_axis=rim_axis, rim=rim,
            bending=np.array([n * EI / d for n, EI, d in zip(self._yarns_a_line, self.bending, self.spacing)]),
            jam=np.array(self.jam, float), ends=edges.yarn_ends(self),
            backed=self.backing is not None, **body.constants(shot, self.share, dt),
        )  # fmt: skip

    def _contact(self, mass):
        """Constants of the contact of elements of a mass [kg]."""
        knobs = self.numerics
        points = max(2, -(-knobs.contact_points * self._finest // self.elements_per_crossover))
        return contact.constants(points, mass, self._step_of_bound, knobs.penalty, knobs.contact_damping)

    def state(self, strike_velocity) -> State:
        """The panel at rest, flat at z = 0, touched by the projectile that flies at it at `strike_velocity` [m/s]."""
        const = self.constants()
        ni, s = const.ni, const.s
        slots = (ni + 2) * s + 16
        real = PRECISIONS[self.numerics.precision]
        mass, inverse, kick = (*_room(2, slots), *_room(1, slots, real))
        mass[: (ni + 1) * s] = self.masses().ravel()
        loose = np.flatnonzero(edges.loose(self))
        inverse[loose] = 1.0 / mass[loose]
        kick[:] = const.dt * inverse
        blocks = -(-ni // const.block)
        three, two = (lambda kind=float: _room(3, slots, kind)), (lambda: _room(2, slots, real))
        # the last changes of stretch and slopes enter the audit alone: 7 digits are enough
        small, slopes = _room(2, slots, np.float32), _room(2, slots, np.float32)
        forces, lengths, stretches = two(), two(), _room(2, slots)
        for y, length, L in zip(lengths, self._yarn_lengths(const), stretches):
            y[: length.size], L[:] = length, 1.0
        i0, i1 = const.near[:2]
        state = State(
            u=three(), v=three(), g0=three(real), g1=three(real), mass=mass, inverse_mass=inverse, kick=kick,
            L=stretches, N=forces, T=two() if const.variational else forces, D=small, slope=slopes,
            y=lengths, intact=tuple((y > 0).astype(float) for y in lengths),
            failed=(np.zeros(slots, np.uint8), np.zeros(slots, np.uint8)),
            filtered=_room(2, slots if const.lag > 0 else 0),
            thin=np.zeros(blocks, np.uint8), stale=np.zeros(blocks, np.bool_), most=np.zeros((blocks, 2)),
            flag=np.zeros(slots, np.uint8), contact=three(),
            **contact.memory(const.near, const.points, const.shares, const.friction),
            position=self.projectile.start(), speed=strike_velocity * self.projectile.flight, reaction=np.zeros(3),
            contact_energy=np.zeros(4), rows=np.array([max(i0 - 2, 0), min(i1 + 2, ni)]), counter=np.zeros(3, np.int64),
            sums=np.zeros((blocks, 5)), peak=np.zeros(2), window=np.array(const.near),
            rim_force=np.zeros(const.rim_node.size), rim_sums=np.zeros(3),
            outer=np.zeros(3), behind=three() if const.backed else _room(3, 0),
            **body.state(self.projectile, strike_velocity),
        )  # fmt: skip
        if const.roaming:
            contact_kernels.follow(state, const)
            state.rows[:] = max(state.window[0] - 2, 0), min(state.window[1] + 2, ni)
        if np.any(const.rim[:, 0]):
            state.rows[:] = 0, ni  # led edges move before any wave comes to them
        march_kernels.first_forces(state, const, self.work())
        edges_kernels.hold(state, const, 0.0)
        return state

    def work(self) -> Work:
        """Scratch of one thread, for one block of elements."""
        const = self.constants()
        size = (const.block + 4) * const.s + 16
        rows = {name: _room(1, size)[0] for name in Work._fields}
        rows["A"], rows["B"], rows["shared"] = _room(3, size), _room(3, size), np.zeros(team.ROOM, np.int64)
        rows["spots"] = np.zeros(_PIECE, np.int32)
        # what is asked for last takes the room of what is no longer needed then: scratch is to fit into the cache
        rows["T1"], rows["T2"], rows["on1"], rows["on2"] = (rows[name] for name in ("own1", "own2", "given1", "given2"))
        rows["up"], rows["touch"] = (rows["m1"], rows["m2"], rows["own1"]), contact.scratch(const)
        return Work(**rows)

    def segments(self):
        """(warp, weft) each (ni+1, nj+1): yarn segments that an edge stands for; half of one on a plane of symmetry."""
        shape, found = (self.counts[0] + 1, self.counts[1] + 1), []
        for family, mirrored in enumerate(self.mirrors[::-1]):
            n = np.ones(shape)
            if self.sides is not None:
                along, across = (2 * w for w in (self.weave.w[family], self.weave.w[1 - family]))
                own, other = self.sides[family] / along, self.sides[1 - family] / across
                lines = grading.tributary(other)
                lines[-1] = other[-1]  # the yarns at the rim break as whole ones
                n = np.multiply.outer(np.append(own, 0.0), lines)
                n = n if family == 0 else n.T
            elif mirrored:
                np.moveaxis(n, 1 - family, 0)[0] *= 0.5
            found.append(n)
        return found

    def masses(self):
        """(ni+1, nj+1) [kg] of the nodes."""
        (ni, nj), (dx, dy) = self.counts, self.spacing
        corner = 0.25 * self.weave.areal_density * (dx if self.sides is None else self.sides[0][:, None])
        corner = corner * (dy if self.sides is None else self.sides[1])
        mass = np.zeros((ni + 1, nj + 1))
        for i in (slice(None, -1), slice(1, None)):
            for j in (slice(None, -1), slice(1, None)):
                mass[i, j] += corner
        return mass

    def _yarn_lengths(self, const):
        """(warp, weft) [m] length of yarn of each edge at its slot: an edge's own times its yarns, half on the rim."""
        if self.sides is not None:
            (a, b), (m, n) = self.sides, map(grading.tributary, self.sides)
            warp, weft = np.zeros((2, const.ni + 1, const.s))
            warp[:-1], weft[:, :-1] = np.multiply.outer(a, n), np.multiply.outer(m, b)
            return [(self.weave.warp_count * warp).ravel(), (self.weave.weft_count * weft).ravel()]
        found, area = [], const.dx * const.dy
        for count, axis in ((self.weave.warp_count, 0), (self.weave.weft_count, 1)):
            y = np.zeros((const.ni + 1, const.s))
            lines = np.moveaxis(y, axis, 0)[:-1]
            lines[:] = area * count
            lines[:, [0, -1]] *= 0.5
            found.append(y.ravel())
        return found

    @cached_property
    def _spline(self):
        """(cells, 8), (cells,) [J] the table's potential but for its constants, each row a cache line, and these."""
        columns = self.table.spline.reshape(-1, 9)
        rows = _room(1, 8 * len(columns))[0].reshape(-1, 8)
        rows[:] = columns[:, [3, 6, 1, 2, 4, 7, 5, 8]]  # of p, p p, q, q q, p q, p p q, p q q, p p q q
        return rows, columns[:, 0].copy()

    @cached_property
    def _ceilings(self):
        """Of warp and weft: what the forces of the variational form tell of the tensions (`_ceiling`)."""
        table, found = self.table, []
        potential = np.moveaxis(table.spline.reshape(-1, 3, 3), 0, -1)  # of p^a q^b at [a, b]
        for family, values in enumerate((table.tension1, table.tension2)):
            W = potential if family == 0 else potential.swapaxes(0, 1)
            T = np.moveaxis(values.reshape(-1, 4), 0, -1)[[0, 1, 2, 3] if family == 0 else [0, 2, 1, 3]]
            force = np.stack([W[1], W[1] + 2 * W[2]]) / (2 * self.weave.w[family] * table.steps[family])
            none = np.zeros_like(T[0])
            tension = np.array([[T[0], T[2], none], [T[0] + T[1], T[2] + T[3], none]])
            found.append(_ceiling(force, tension))
        return found

    def _strengths(self):
        """(warp, weft) [N] strength of each yarn of the modelled part."""
        factors = self.strength_factors or tuple(np.ones(count) for count in self.yarn_counts)
        return tuple(
            np.asarray(given, float) * (yarn.strength if self.failure else inf)
            for given, yarn in zip(factors, self.weave.yarns)
        )

    def _reach(self):
        """(along warp, along weft) [m] from the projectile's middle that cloth can come from to be under it.

        A straightened, stretched yarn draws cloth in by at most its crimp and strain times its length; a leaning
        projectile is wider in the panel's plane.
        """
        wide = self.projectile.radius / self.projectile.frame[2, 2]
        return tuple(
            wide + (yarn.crimp + yarn.failure_strain) * max(x[-1], -x[0]) + 2 * step
            for x, step, yarn in zip(self.lines(), self.spacing, self.weave.yarns)
        )

    def _near(self, roaming):
        """Element rows and columns (i0, i1, j0, j1) that can come under the projectile: all of them if it roams."""
        if roaming:
            return 0, self.counts[0], 0, self.counts[1]
        bounds = []
        for start, step, count, reach in zip(self.origin, self.spacing, self.counts, self._reach()):
            bounds += [max(0, int((-reach - start) / step)), min(count, int((reach - start) / step) + 1)]
        return tuple(bounds)


def _ceiling(force, tension):
    """((steps, 2) [N], [N]) see `cell_kernels.ceiling`, and the width of its steps.

    force, tension (2, 3, cells) [N] : of one family, coefficients over the other's local coordinate, at both ends of
    its own, along which both are linear. A quadratic lies between the least and most of its Bernstein coefficients.
    """
    found, excess, tensions = map(_bernstein, (force, tension - force, tension))
    low, high, over, top = found.min((0, 1)), found.max((0, 1)), excess.max((0, 1)), tensions.max((0, 1))
    most = max(high.max(), top.max())
    unit, rounding, steps = most / _STEPS, 1e-9 * most, np.empty((_STEPS + 1, 2))
    cell_kernels.ceiling(low - rounding, high + rounding, over + rounding, top + rounding, unit, steps)
    return steps, unit


def _bernstein(quadratics):
    """(2, 3, n) coefficients of Bernstein from those of 1, x, x x, on 0 <= x <= 1."""
    a, b, c = quadratics[:, 0], quadratics[:, 1], quadratics[:, 2]
    return np.stack([a, a + 0.5 * b, a + b + c], axis=1)


def _room(count, slots, kind=float):
    """`count` flat arrays of zeros that begin with a cache line, in different sets of the cache."""
    width = (-(-slots // 16) | 1) * 16
    whole = np.zeros(count * width + 16, kind)
    start = -whole.ctypes.data % 64 // whole.itemsize
    return tuple(whole[start + m * width : start + m * width + slots] for m in range(count))
