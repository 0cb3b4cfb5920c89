"""The arrays of a panel that the kernels work on: what they need to know, the state of a march, scratch."""

from collections import namedtuple
from math import inf

import numpy as np

from shellfabric.cloth import boundary_kernels
from shellfabric.jit import barrier
from shellfabric.jit.aligned import room
from shellfabric.panel import boundary, grading, step_kernels
from shellfabric.projectile import contact, contact_kernels, dynamics

PRECISIONS = {"double": np.float64, "single": np.float32}
_PIECE = 256  # slots that loops of two halves go over at a time (see `membrane_kernels`): a whole number of eights
USUAL_POINTS = 8  # of contact along a crossover, under a nose that they resolve
SPACING = 0.8  # [nose radii] of contact points at most: peak tensions are within 3 % of those of points much closer
MOST_POINTS = 32  # along a side of an element: all those of an element are kept in memory, four numbers each
_ROWS = 6  # of a block at least: with fewer, most of the work would be on the rows about it that two blocks need

Constants = namedtuple(
    "Constants",
    "ni nj s block per mirror_x mirror_y x0 y0 dx dy rx0 ry0 dt "
    "tension1 tension2 ceiling1 unit1 ceiling2 unit2 spline level x0t rx top1 y0t ry top2 grid per1 per2 variational "
    "split1 split2 cv1 cv2 V G1 G2 gamma1 gamma2 w1 S01 EA1 w2 S02 EA2 strength1 strength2 strengths1 strengths2 lag "
    "widest near points shares point_stiffness point_damping point_mass firmer R rho projectile_mass free idle_steps "
    "shape form length frame tilted roaming depth reach top shoulder friction rim_node rim_axis rim bending jam ends "
    "bar_mass bar_h bar_area bar_law bar_parts backed",
)
State = namedtuple(
    "State",
    "u v g0 g1 mass inverse_mass kick L N T D slope y intact failed filtered flag thin stale most "
    "pressed touching due pushed usual contact position speed reaction "
    "contact_energy rows counter sums peak window stuck rim_force rim_sums "
    "outer behind bar_u bar_v bar_plastic bar_stress bar_sums",
)
Work = namedtuple(
    "Work",
    "A B l1 l2 i1 i2 m1 m2 T1 T2 N1 N2 K1 K2 own1 own2 given1 given2 on1 on2 turn1 turn2 cross up spots shared touch",
)


def constants(panel) -> Constants:
    """What the kernels need to know, as plain numbers and arrays."""
    (ni, nj), (dx, dy), (mirror_x, mirror_y) = panel.counts, panel.spacing, panel.mirrors
    weave, table, knobs, dt = panel.weave, panel.table, panel.numerics, panel.time_step
    (w1, w2), (S01, S02), (warp, weft) = weave.w, weave.S0, weave.yarns
    rx, ry = (1 / step for step in table.steps)
    shear = panel.fabric.shear if panel.trellis else None
    G1, G2, gamma1, gamma2 = (shear.G1, shear.G2, shear.gamma1, shear.gamma2) if shear else (0.0, 0.0, 0.5, 1.0)
    lag = panel.critical_step / dt
    mass = weave.areal_density * dx * dy
    (x0, y0), shot = panel.origin, panel.projectile
    rim_node, rim_axis, rim = boundary.rim(panel)
    strengths = _strengths(panel)
    roaming = shot.roaming or rim_node.size > 0  # over the cloth: it slides, or the cloth is drawn under it
    cv1, cv2 = (knobs.stretch_viscosity * lag * yarn.EA for yarn in (warp, weft))
    slots = {"rx0": 1 / dx, "ry0": 1 / dy, "cv1": cv1, "cv2": cv2, "V": dx * dy * weave.thickness}
    slots |= {"split1": 0.5, "split2": 0.5}
    if panel.sides is not None:
        slots = grading.slots(panel.sides, panel.spacing, weave.thickness, (cv1, cv2), room)
    return Constants(
        ni=ni, nj=nj, s=nj + 1, block=_block(panel), mirror_x=mirror_x, mirror_y=mirror_y,
        x0=x0, y0=y0, dx=dx, dy=dy, dt=dt, per=panel.elements_per_crossover, **slots,
        tension1=table.tension1.reshape(-1, 4), tension2=table.tension2.reshape(-1, 4),
        ceiling1=panel.ceilings[0][0], unit1=panel.ceilings[0][1],
        ceiling2=panel.ceilings[1][0], unit2=panel.ceilings[1][1],
        spline=panel.potential[0], level=panel.potential[1],
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
        near=_near(panel, roaming), **_contact(panel, mass),
        R=shot.radius, rho=shot.edge_radius, projectile_mass=shot.mass * panel.share,
        free=(0.0 if mirror_x else 1.0, 0.0 if mirror_y else 1.0, 1.0),
        idle_steps=max(1, round(knobs.clear_time / dt)),
        shape=shot.number, form=shot.form, length=inf if shot.length is None else shot.length, frame=shot.frame,
        tilted=shot.tilted, roaming=roaming, depth=2 * shot.radius, reach=panel.reach(), top=shot.top,
        shoulder=shot.shoulder, friction=shot.friction, rim_node=rim_node, rim_axis=rim_axis, rim=rim,
        bending=np.array([n * EI / d for n, EI, d in zip(panel.yarns_a_line, panel.bending, panel.spacing)]),
        jam=np.array(panel.jam, float), ends=boundary.yarn_ends(panel),
        backed=panel.backing is not None, **dynamics.constants(shot, panel.share, dt),
    )  # fmt: skip


def state(panel, strike_velocity) -> State:
    """The panel at rest, flat at z = 0, touched by the projectile that flies at it at `strike_velocity` [m/s]."""
    const = constants(panel)
    ni, s = const.ni, const.s
    slots = (ni + 2) * s + 16
    real = PRECISIONS[panel.numerics.precision]
    mass, inverse, kick = (*room(2, slots), *room(1, slots, real))
    mass[: (ni + 1) * s] = panel.masses().ravel()
    loose = np.flatnonzero(boundary.loose(panel))
    inverse[loose] = 1.0 / mass[loose]
    kick[:] = const.dt * inverse
    blocks = -(-ni // const.block)
    three, two = (lambda kind=float: room(3, slots, kind)), (lambda: room(2, slots, real))
    # the last changes of stretch and slopes enter the audit alone: 7 digits are enough
    small, slopes = room(2, slots, np.float32), room(2, slots, np.float32)
    forces, lengths, stretches = two(), two(), room(2, slots)
    for y, length, L in zip(lengths, _yarn_lengths(panel, const), stretches):
        y[: length.size], L[:] = length, 1.0
    i0, i1 = const.near[:2]
    state = State(
        u=three(), v=three(), g0=three(real), g1=three(real), mass=mass, inverse_mass=inverse, kick=kick,
        L=stretches, N=forces, T=two() if const.variational else forces, D=small, slope=slopes,
        y=lengths, intact=tuple((y > 0).astype(float) for y in lengths),
        failed=(np.zeros(slots, np.uint8), np.zeros(slots, np.uint8)),
        filtered=room(2, slots if const.lag > 0 else 0),
        thin=np.zeros(blocks, np.uint8), stale=np.zeros(blocks, np.bool_), most=np.zeros((blocks, 2)),
        flag=np.zeros(slots, np.uint8), contact=three(),
        **contact.memory(const.near, const.points, const.shares, const.friction),
        position=panel.projectile.start(), speed=strike_velocity * panel.projectile.flight, reaction=np.zeros(3),
        contact_energy=np.zeros(5), rows=np.array([max(i0 - 2, 0), min(i1 + 2, ni)]), counter=np.zeros(3, np.int64),
        sums=np.zeros((blocks, 5)), peak=np.zeros(2), window=np.array(const.near),
        rim_force=np.zeros(const.rim_node.size), rim_sums=np.zeros(3),
        outer=np.zeros(3), behind=three() if const.backed else room(3, 0),
        **dynamics.state(panel.projectile, strike_velocity),
    )  # fmt: skip
    if const.roaming:
        contact_kernels.follow(state, const)
        state.rows[:] = max(state.window[0] - 2, 0), min(state.window[1] + 2, ni)
    if np.any(const.rim[:, 0]):
        state.rows[:] = 0, ni  # led edges move before any wave comes to them
    step_kernels.first_forces(state, const, work(panel))
    boundary_kernels.hold(state, const, 0.0)
    return state


def work(panel) -> Work:
    """Scratch of one thread, for one block of elements."""
    const = constants(panel)
    size = (const.block + 4) * const.s + 16
    rows = {name: room(1, size)[0] for name in Work._fields}
    rows["A"], rows["B"], rows["shared"] = room(3, size), room(3, size), np.zeros(barrier.ROOM, np.int64)
    rows["spots"] = np.zeros(_PIECE, np.int32)
    # what is asked for last takes the room of what is no longer needed then: scratch is to fit into the cache
    rows["T1"], rows["T2"], rows["on1"], rows["on2"] = (rows[name] for name in ("own1", "own2", "given1", "given2"))
    rows["up"], rows["touch"] = (rows["m1"], rows["m2"], rows["own1"]), contact.scratch(const)
    return Work(**rows)


def _block(panel):
    """Element rows of a block: all blocks are of one size, but the last."""
    ni, nj = panel.counts
    rows = max(_ROWS, panel.numerics.block / (nj + 1))
    return -(-ni // max(1, round(ni / rows)))


def _contact(panel, mass):
    """Constants of the contact of elements of a mass [kg]."""
    knobs, usual = panel.numerics, panel.numerics.contact_points or USUAL_POINTS
    points = max(2, -(-usual * panel.finest // panel.elements_per_crossover))
    if knobs.contact_points is None:
        resolving = np.ceil(max(panel.spacing) / (SPACING * panel.projectile.nose_radius))
        points = max(points, int(min(resolving, MOST_POINTS)))
    return contact.constants(points, mass, panel.step_of_bound, knobs.penalty, knobs.contact_damping)


def _yarn_lengths(panel, const):
    """(warp, weft) [m] length of yarn of each edge at its slot: an edge's own times its yarns, half on the rim."""
    if panel.sides is not None:
        (a, b), (m, n) = panel.sides, map(grading.tributary, panel.sides)
        warp, weft = np.zeros((2, const.ni + 1, const.s))
        warp[:-1], weft[:, :-1] = np.multiply.outer(a, n), np.multiply.outer(m, b)
        return [(panel.weave.warp_count * warp).ravel(), (panel.weave.weft_count * weft).ravel()]
    found, area = [], const.dx * const.dy
    for count, axis in ((panel.weave.warp_count, 0), (panel.weave.weft_count, 1)):
        y = np.zeros((const.ni + 1, const.s))
        lines = np.moveaxis(y, axis, 0)[:-1]
        lines[:] = area * count
        lines[:, [0, -1]] *= 0.5
        found.append(y.ravel())
    return found


def _strengths(panel):
    """(warp, weft) [N] strength of each yarn of the modelled part."""
    factors = panel.strength_factors or tuple(np.ones(count) for count in panel.yarn_counts)
    return tuple(
        np.asarray(given, float) * (yarn.strength if panel.failure else inf)
        for given, yarn in zip(factors, panel.weave.yarns)
    )


def _near(panel, roaming):
    """Element rows and columns (i0, i1, j0, j1) that can come under the projectile: all of them if it roams."""
    if roaming:
        return 0, panel.counts[0], 0, panel.counts[1]
    bounds = []
    for start, step, count, reach in zip(panel.origin, panel.spacing, panel.counts, panel.reach()):
        bounds += [max(0, int((-reach - start) / step)), min(count, int((reach - start) / step) + 1)]
    return tuple(bounds)
