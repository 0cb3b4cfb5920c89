"""Quasi-static tests on coupons: bias extension, picture frame, uniaxial and biaxial tension.

Each test cuts a coupon (`coupon`), holds some of its nodes, moves them step by step and relaxes the
rest (`coupon.solver`). A run names what has gone wrong with it: yarns that have passed one another,
shear that has run into bands (thesis section 4.4.3, Figure 4-27), no equilibrium. Keywords
`relaxing` go to `coupon.solver.run`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import asin, pi, sqrt
from typing import TYPE_CHECKING, Any

import numpy as np

from fabrics.base.checks import BoolArray, FloatArray, IntArray
from fabrics.base.errors import InputError, UnstableError
from shellfabric.cell.model import CellTable
from shellfabric.coupon.dynamic_relaxation import State
from shellfabric.coupon.model import Coupon, mesh_coupon
from shellfabric.coupon.solver import Result, run

if TYPE_CHECKING:
    from fabrics.fabric import Fabric

ZONES = ("A", "B", "C")
# [-] yarns over shear: of 1e4, 3e4, 1e5 and 3e5 the greatest at which strips of dry glass weave
# find an equilibrium
STIFFEST = 3e4
# [-] of the work: more than this may not go into yarns whose stiffness is lowered
MOST_SOFTENED = 0.02
DIRECTIONS = {"warp": 1, "weft": -1}  # order of (warp, weft) that gives (along, across)
_SLACK = 1e-6  # of a half side: by which a node on the outline may miss it
_INNER = 1 - _SLACK
BANDS = 3.0  # `concentration` above which shear is in bands; a coupon that shears as one stays below 1.5


def bias_extension(
    table: CellTable,
    *,
    length: float = 0.1435,
    width: float = 0.074,
    elongation: float = 0.010,
    steps: int = 20,
    elements_per_crossover: int = 1,
    trellis: bool = True,
    **relaxing: Any,
) -> Result:
    """Pull a coupon whose yarns run at 45 degrees to the load; yarns do not fail (thesis section
    4.4.3).

    The load runs along y. In a weave with equal counts length and width are rounded to whole
    diagonals of an element, and the grid is laid so that the corners of the clamps are crossovers.

    Parameters
    ----------
    table : CellTable in the variational form
    length, width : [m] between the clamps, and across
    elongation : [m] of the coupon as a whole
    steps : load steps
    elements_per_crossover, trellis : see `coupon.model.mesh_coupon`

    Raises
    ------
    InputError : a coupon that is not longer than wide
    UnstableError : shear in bands, yarns that passed one another, no equilibrium, yarns that were
        computed too soft (`yarn_share`); its attribute `result` holds the run
    """
    coupon, grips, (length, width) = bias_coupon(
        table, length, width, elements_per_crossover, trellis
    )
    inextensible_shear(length, width, elongation)  # refuses what aligned yarns would not allow
    y = coupon.points[:, 1]
    centre = zones(coupon, length, width) == ZONES.index("C")

    def no_bands(state):
        gamma = np.abs(coupon.shear_angles(state.x))
        ratio = concentration(gamma, centre)
        if ratio > BANDS:
            worst = int(np.argmax(gamma))
            load = abs(state.reaction[grips == 1, 1].sum())
            raise UnstableError(
                f"the shear has run into bands: one element in a hundred shears {ratio:.3g} times as far as the middle "
                f"of the central zone, up to {np.degrees(gamma[worst]):.0f} degrees, under a load of {load:.2g} N",
                where=f"element {worst}",
                when=f"at an elongation of {1e3 * state.load * elongation:.3g} mm",
            )

    def stiff_enough(state):
        part = softened_work(coupon, state)
        if part > MOST_SOFTENED:
            raise UnstableError(
                f"the yarns, computed with {coupon.yarn_share:.2g} of their stiffness, take {100 * part:.2g} % of the "
                f"work, at most {100 * MOST_SOFTENED:g} % is allowed: end the test at a smaller elongation",
                when=f"at an elongation of {1e3 * state.load * elongation:.3g} mm",
            )

    def path(load):
        return coupon.points + 0.5 * load * elongation * np.stack([0 * y, np.sign(y)], axis=1)

    return run(coupon, grips, path, elongation, steps, (no_bands, stiff_enough), **relaxing)


def bias_coupon(
    table: CellTable,
    length: float,
    width: float,
    elements_per_crossover: int = 1,
    trellis: bool = True,
) -> tuple[Coupon, IntArray, tuple[float, float]]:
    """Mesh the coupon of a bias test: (Coupon, (n,) its grips, (length, width) [m] as meshed);
    arguments as in `bias_extension`."""
    if not length > width > 0:
        raise InputError(key="length", value=length, allowed=f"above the width, {width:g} m")
    length, width, offset = _fit_diagonals(table, length, width, elements_per_crossover)
    slack = 1e-6 * width
    share = 1.0
    if trellis:
        share = yarn_share(table.model.fabric)
    row = 1.01 * sum(table.model.fabric.weave.w) * sqrt(2) / elements_per_crossover
    coupon = mesh_coupon(
        table,
        lambda x, y: (np.abs(y) < length / 2 + row / 2 + slack) & (np.abs(x) < width / 2 + slack),
        length,
        angle=pi / 4,
        offset=offset,
        elements_per_crossover=elements_per_crossover,
        trellis=trellis,
        yarn_share=share,
    )
    y = coupon.points[:, 1]
    held = length / 2 - slack
    grips = np.select([y > held, y < -held], [1, 2])
    return coupon, grips, (length, width)


def yarn_share(fabric: Fabric) -> float:
    """Compute the share [-] of the yarns' stiffness with which a bias coupon is computed: 1 up to
    STIFFEST.

    The ratio is E A over the shear stiffness of a spacing, spacing x thickness x G1: 2e3 of the
    thesis's fabrics, 3e5 of a dry glass weave, whose yarns act as if they did not stretch.
    Relaxation finds no equilibrium at such a ratio. What softer yarns change is measured in every
    run (`softened_work`).
    """
    weave = fabric.weave
    shear = fabric.shear
    if shear is None:
        return 1.0
    sheared = [2 * w * weave.thickness * shear.G1 for w in reversed(weave.w)]
    ratio = max(yarn.EA / one for yarn, one in zip(weave.yarns, sheared))
    return min(1.0, STIFFEST / ratio)


def softened_work(coupon: Coupon, state: State) -> float:
    """Compute the share [-] of the work up to a state that went into yarns of a lowered stiffness;
    0 if they have their own.

    The energy of an equilibrium falls with the share s of the stiffness by dE/ds = E_yarns / s.
    E_yarns itself goes as 1 / s where the shear sets the tensions, so that yarns that do not
    stretch would take more work by E_yarns, and halving s takes off as much.
    """
    if coupon.yarn_share == 1:
        return 0.0
    yarns, trellis = state.energies
    return abs(yarns) / (abs(yarns) + trellis)


def zones(coupon: Coupon, length: float, width: float) -> IntArray:
    """Return the index (q,) into ZONES of the elements of a bias coupon: 2, 1, 0 of their yarns
    lead to a clamp (Fig. 4-25)."""
    x, y = coupon.points[coupon.quads].mean(axis=1).T
    reach = (length - width) / 2
    return 2 - (np.abs(y - x) > reach).astype(int) - (np.abs(y + x) > reach)


def concentration(gamma: FloatArray, centre: BoolArray) -> float:
    """Compute the shear angle that one element in a hundred exceeds, over the median of the
    elements `centre` [-].

    A hundredth is about one row of elements, the narrowest band there is.
    """
    return float(np.quantile(np.abs(gamma), 0.99) / np.median(np.abs(gamma[centre])))


def bias_size(result: Result) -> tuple[float, float]:
    """Return (length, width) [m] of the coupon of a bias test, as it was meshed."""
    top = result.coupon.points[result.grips == 1]
    return 2 * float(top[:, 1].min()), float(np.ptp(result.coupon.points[:, 0]))


def inextensible_shear(length: float, width: float, elongation: float) -> float:
    """Shear angle [rad] of zone C if yarns do not stretch: the zone's diagonal, length - width,
    takes all of it.

    With the angle between the yarns at 90 degrees - gamma a cell's diagonal grows by sqrt(1 + sin
    gamma), so that sin gamma = (1 + elongation / (length - width))^2 - 1 (erratum E-31).
    """
    sine = (1 + elongation / (length - width)) ** 2 - 1
    if not 0 <= sine <= 1:
        raise InputError(
            key="elongation", value=elongation, allowed="within what aligned yarns allow"
        )
    return asin(sine)


def picture_frame(
    table: CellTable,
    *,
    crossovers: int = 8,
    shear_angle: float = 0.6,
    steps: int = 12,
    elements_per_crossover: int = 1,
    **relaxing: Any,
) -> Result:
    """Shear a square in a hinged frame that keeps the yarns' lengths, to `shear_angle` [rad]
    (Figure 4-24)."""
    if not 0 < shear_angle < pi / 2:
        raise InputError(key="shear_angle", value=shear_angle, allowed="above 0 and below pi/2")
    coupon, half = _cut_rectangle(table, (crossovers, crossovers), "warp", elements_per_crossover)
    x, y = coupon.points.T
    grips = np.any(np.abs(coupon.points) > _INNER * half, axis=1).astype(int)

    def path(load):
        c = np.cos(0.5 * load * shear_angle)
        s = np.sin(0.5 * load * shear_angle)
        return np.stack([c * x + s * y, s * x + c * y], axis=1)

    return run(coupon, grips, path, shear_angle, steps, **relaxing)


def frame_stress(result: Result) -> FloatArray:
    """Compute the shear stress (steps,) [Pa] of a picture frame test: work of the frame for a
    change of angle, over the volume."""
    x, y = result.coupon.points.T
    volume = (
        len(result.coupon.quads) * np.prod(result.coupon.spacing) * result.coupon.weave.thickness
    )
    stress = []
    for gamma, state in zip(result.prescribed, result.states):
        c = 0.5 * np.cos(0.5 * gamma)
        s = 0.5 * np.sin(0.5 * gamma)
        stress.append(
            np.sum(state.reaction * np.stack([-s * x + c * y, c * x - s * y], axis=1)) / volume
        )
    return np.array(stress)


def uniaxial(
    table: CellTable,
    *,
    direction: str = "warp",
    length: float = 0.10,
    width: float = 0.03,
    strain: float = 0.03,
    steps: int = 15,
    failure: bool = True,
    elements_per_crossover: int = 1,
    **relaxing: Any,
) -> Result:
    """Pull a strip along x, the direction of its warp or weft yarns, between clamps, with free
    sides.

    Ends where a yarn reaches its strength, unless `failure` is False. Sizes are rounded to whole
    crossovers.
    """
    if direction not in DIRECTIONS:
        raise InputError(key="direction", value=direction, allowed=" or ".join(DIRECTIONS))
    pitch = table.model.fabric.weave.w[:: DIRECTIONS[direction]]
    many = [max(2, round(size / (2 * w))) for size, w in zip((length, width), pitch)]
    coupon, half = _cut_rectangle(table, many, direction, elements_per_crossover)
    x, y = coupon.points.T
    grips = np.select([x > _INNER * half[0], x < -_INNER * half[0]], [1, 2])

    def path(load):
        return np.stack([x * (1 + load * strain), y], axis=1)

    return run(coupon, grips, path, strain, steps, failure=failure, **relaxing)


def biaxial(
    table: CellTable,
    *,
    strain: Sequence[float] | Callable[[float], Sequence[float]] = (0.01, 0.01),
    centre: int = 12,
    arm: int = 8,
    cross_yarns_removed: bool = True,
    steps: int = 12,
    failure: bool = True,
    elements_per_crossover: int = 1,
    **relaxing: Any,
) -> Result:
    """Pull a cross-shaped specimen by its four arms, the warp along x (thesis section 5.3, Figure
    5-58).

    The grips are moved as if the whole specimen stretched by `strain` (warp, weft), or along a path
    of such strains, strain(load) with load from 0 to 1, and carry their yarn ends without turning;
    read the strain of the middle from `middle_strain`. Grips: 1 and 2 at +x and -x, 3 and 4 at +y
    and -y.

    Parameters
    ----------
    centre, arm : [crossovers] side of the central square, length of an arm; Figure 5-58 with the
        sizes is missing
    cross_yarns_removed : from the arms, so that the middle is pulled by single yarns
    """
    weave = table.model.fabric.weave
    half = [centre * w for w in weave.w]
    full = [(centre + 2 * arm) * w for w in weave.w]
    slack = 1e-6 * min(half)

    def outline(x, y):
        across = np.abs(x) < half[0] + slack
        along = np.abs(y) < half[1] + slack
        return (along & (np.abs(x) < full[0] + slack)) | (across & (np.abs(y) < full[1] + slack))

    woven = None
    if cross_yarns_removed:

        def woven(x, y):
            return np.abs(y) < half[1], np.abs(x) < half[0]

    coupon = mesh_coupon(
        table,
        outline,
        max(full),
        woven=woven,
        elements_per_crossover=elements_per_crossover,
        offset=_about((centre, centre), elements_per_crossover),
    )
    x, y = coupon.points.T
    grips = np.select(
        [x > full[0] - slack, x < -full[0] + slack, y > full[1] - slack, y < -full[1] + slack],
        [1, 2, 3, 4],
    )

    def along(load):
        if callable(strain):
            return strain(load)
        return load * np.asarray(strain)

    def path(load):
        return coupon.points * (
            1 + np.asarray(along(load)) * np.stack([grips < 3, grips > 2], axis=1)
        )

    return run(coupon, grips, path, max(along(1.0)), steps, failure=failure, **relaxing)


def middle_strain(result: Result, half: Sequence[float]) -> FloatArray:
    """Compute the strains (steps, 2) [-] along warp and weft of the part |X| < half[0], |Y| <
    half[1] [m] of a coupon."""
    coupon = result.coupon
    found = []
    inside = [
        np.all(np.abs(coupon.points[edges].mean(axis=1)) < np.asarray(half), axis=1)
        for edges in coupon.edges
    ]
    for state in result.states:
        found.append([L[part].mean() - 1 for L, part in zip(coupon.stretches(state.x), inside)])
    return np.array(found)


def _cut_rectangle(table, crossovers, direction, elements_per_crossover):
    """(Coupon, half its sides [m]) of so many crossovers along x and y; the yarns of `direction`
    lie along x."""
    order = DIRECTIONS[direction]
    angle = 0.0
    if direction == "weft":
        angle = pi / 2
    half = np.array(crossovers) * table.model.fabric.weave.w[::order]
    outer = (1 + _SLACK) * half
    coupon = mesh_coupon(
        table,
        lambda x, y: (np.abs(x) < outer[0]) & (np.abs(y) < outer[1]),
        max(half),
        angle=angle,
        elements_per_crossover=elements_per_crossover,
        offset=_about(crossovers[::order], elements_per_crossover),
    )
    return coupon, half


def _fit_diagonals(table, length, width, m):
    """Length and width as whole diagonals of a square element, and the offset that puts clamp
    corners on nodes."""
    (dX, dY) = (2 * w / m for w in table.model.fabric.weave.w)
    if abs(dX - dY) > 1e-9 * dX:
        return length, width, (0.0, 0.0)
    step = dX / sqrt(2)
    rows = round(length / (2 * step))
    columns = round(width / (2 * step))
    return 2 * rows * step, 2 * columns * step, ((rows + columns) % 2 / 2,) * 2


def _about(crossovers, elements_per_crossover):
    """Offset that centres a coupon of so many crossovers on the origin."""
    return tuple(0.5 * (many * elements_per_crossover % 2) for many in crossovers)
