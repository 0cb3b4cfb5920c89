"""A panel with a zone of resolved yarns about the nose.

Outside the zone the panel is the membrane, with one node a crossover; the two are tied at the rim,
and each has its own time step (`coupling_kernels`).
"""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from math import ceil, inf
from pathlib import Path
from typing import Annotated

import numpy as np

from fabrics.assumed import friction_between_yarns
from fabrics.base.assumed_number import Assumed
from fabrics.base.checks import FloatArray
from fabrics.base.errors import InputError
from fabrics.base.fields import check_fields, finite
from fabrics.base.frozen import explain_frozen
from fabrics.base.schema import refuse_unread
from fabrics.families import entries
from fabrics.weave import Weave
from shellfabric.cell.model import CellModel
from shellfabric.membrane.boundary import is_clamped
from shellfabric.membrane.model import Panel
from shellfabric.membrane.numerics import NumericsKeys
from shellfabric.membrane.slots import by_node
from shellfabric.panel_numbers import CellNumbers, PanelNumbers
from shellfabric.parts import Part, own_steps
from shellfabric.state import DAMAGED, GONE, RESOLVED, WARP_FAILED, WEFT_FAILED, Constants, State
from shellfabric.yarns.part import ResolvedYarns
from shellfabric.yarns.patch import RIM_ROWS, YarnPatch
from shellfabric.yarns.state import Zone

DATA = tomllib.loads((Path(__file__).parent / "assumed.toml").read_text("utf-8"))
# Default zone. Of one ply all yarns up to an opening of WHOLE_UP_TO [m]; beyond, and of packs, whose
# shifted plies no zone fills, a half width [m] of at least LEAST, and of PULLED over the friction,
# since with less friction yarn is drawn in from further away. Limits of 16 drawn panels of S-728 under a
# 5.5 mm sphere in 120 mm are .6 +- .4 % lower with 40 mm than with all yarns, and 3.0 +- 1.3 % lower with
# 20 mm. Two plies that tear take 5.6 +- .9 % more of the velocity with 40 mm than with 20 mm.
WHOLE_UP_TO = 120e-3
LEAST, PULLED = 40e-3, 8e-3
LEAST_ROWS = 2 * RIM_ROWS + 4  # of crossings of a zone at least
OFF_CROSSOVER = 0.25  # [spacings] of the default impact point, along warp and weft
MOST_STEPS = 2  # of the yarns in a step of the membrane: 3 take a tenth less time
IMAGES = 2  # rows of images of crossings beyond a plane of symmetry at least
REACH = 2.0  # spacings between the nose and the rim at least


@explain_frozen
@dataclass(frozen=True)
class YarnZone:
    """Yarns that are resolved about the nose.

    Parameters
    ----------
    half_width : [m] of the square zone about the impact point; inf resolves the whole panel; None
        takes the default
    friction : [-] Coulomb's coefficient of yarn on yarn; inf pins all crossings. That of
        `fabrics.assumed.friction_between_yarns` if not given
    lateral : factor on the lateral stiffness of a yarn (assumed.toml has its range)
    edge : [-] of the width of a yarn, how far beside its middle line it meets the nose (also there)
    seed : of the aim, by which plies of a pack are shifted against each other (`lie_anywhere`)
    default : [m] half width of a zone that is not given (`YarnZone.sized`); None takes LEAST or more

    Raises
    ------
    InputError : a value that is not positive, or a friction below 0
    """

    half_width: float | None = None
    friction: float = friction_between_yarns().number
    lateral: float = entries(DATA)["lateral_stiffness"].number
    edge: float = entries(DATA)["edge"].number
    seed: Annotated[int | Sequence[int] | None, finite(ge=0)] = None
    default: float | None = None

    def __post_init__(self):
        check_fields(self)
        if not self.width > 0:
            raise InputError(key="zone", value=self.half_width, allowed="above 0")
        if not self.friction >= 0:
            raise InputError(key="crossover_friction", value=self.friction, allowed="at least 0")
        if not 0 < self.lateral < inf:
            raise InputError(key="lateral", value=self.lateral, allowed="above 0")
        if not 0 <= self.edge <= 0.5:
            raise InputError(key="edge", value=self.edge, allowed="0 to 0.5")

    @property
    def width(self) -> float:
        """[m] the half width that is used."""
        if self.half_width is not None:
            return self.half_width
        if self.default is not None:
            return self.default
        return max(LEAST, PULLED / self.friction) if self.friction > 0 else inf

    def sized(self, plies: int, opening: float) -> YarnZone:
        """Return the zone with the default width of a target.

        Parameters
        ----------
        plies : number
        opening : [m] longer side
        """
        if plies == 1 and opening <= WHOLE_UP_TO:
            return replace(self, default=inf)
        return replace(self, default=None)

    @property
    def whole(self) -> YarnZone:
        """The zone that is the whole panel."""
        return replace(self, half_width=inf)

    @property
    def friction_range(self) -> tuple[float, ...]:
        """(low, high) of the friction; empty of one that is given."""
        if isinstance(self.friction, Assumed) and not self.friction.given:
            return self.friction.span
        return ()

    @property
    def assumptions(self) -> tuple[str, ...]:
        """What a run takes for granted of its yarns, a sentence each, wherever they are struck."""
        within = "in the whole panel"
        beyond = ""
        if self.width < inf:
            within = f"within {1e3 * self.width:g} mm of the impact point"
            beyond = ", and pinned to each other beyond"
        return (
            f"Yarns are resolved {within}, with a coefficient of friction of {self.friction:g} between them{beyond}.",
            f"A yarn meets the nose on its middle line and {self.edge:g} of its width beside it{self._edge_span}.",
        )

    @property
    def _edge_span(self):
        """The range of the edge if it is assumed, for a sentence."""
        if not isinstance(self.edge, Assumed):
            return ""
        return ", assumed {:g} to {:g}".format(*self.edge.span)

    @property
    def assumed_lines(self) -> tuple[str, ...]:
        """A line about the friction if it is the assumed one, which decides the outcome of many
        shots."""
        if not self.friction_range:
            return ()
        span = "{:g} .. {:g}".format(*self.friction_range)
        return (
            f"assumed: friction between resolved yarns {self.friction:g} ({span}), "
            "which decides whether a nose passes between them",
        )


def aim(
    weave: Weave,
    seed: int | Sequence[int] | None = None,
    mirrors: tuple[bool, bool] = (False, False),
) -> tuple[float, float]:
    """Choose the impact point [m] from a crossover, along warp and weft; 0 across a plane of symmetry
    (`mirrors`), which is the middle line of a yarn.

    Anywhere in a repeat of the weave, two crossovers each way in plain weave, by a seed; without one a
    quarter of a spacing off: neither on a crossover, nor on a yarn, nor in the middle of a gap.
    """
    share = np.full(2, OFF_CROSSOVER)
    if seed is not None:
        warp_yarns, weft_yarns = weave.pattern.matrix.shape
        half = 0.5 * np.array([weft_yarns, warp_yarns])
        share = half * np.random.default_rng(seed).uniform(-1.0, 1.0, 2)
    share[np.asarray(mirrors)] = 0.0
    x, y = 2 * share * weave.w
    return float(x), float(y)


@dataclass(frozen=True)
class YarnPanel(Panel):
    """A Panel with a zone of resolved yarns; a crossover in the middle of the opening, wherever it
    is struck.

    Parameters
    ----------
    resolved : YarnZone, and the others of Panel
    shift : [m] of its grid against the opening, along the two sides
    among_plies : whether other plies lie on it

    Raises
    ------
    InputError : as Panel; what the zone does not have, a zone that is too small for the nose, or
        one that an edge of the opening crosses
    """

    resolved: YarnZone = field(default_factory=YarnZone)
    shift: tuple[float, float] = (0.0, 0.0)
    among_plies: bool = False

    def __post_init__(self):
        model = self.table.model
        wanted = [
            ("elements_per_crossover", self.elements_per_crossover, 1),
            ("grading", self.grading, None),
            ("bending", self.bending, (0.0, 0.0)),
        ]
        if not isinstance(model, CellModel):
            raise InputError(key="surface", value="given", allowed="left out with resolved yarns")
        for key, value, allowed in wanted:
            if value != allowed:
                text = "left out" if allowed is None else str(allowed)
                raise InputError(key=key, value=value, allowed=f"{text} with resolved yarns")
        if model.cell_model == "decoupled":
            allowed = "compressible or incompressible with resolved yarns, which touch"
            raise InputError(key="cell_model", value=model.cell_model, allowed=allowed)
        if self.parts:
            raise InputError(key="parts", allowed="left out with resolved yarns")
        refuse_unread(CellNumbers, model, "yarns", "resolved yarns")
        refuse_unread(PanelNumbers, self, "yarns", "resolved yarns")
        refuse_unread(NumericsKeys, self.numerics, "yarns", "resolved yarns")
        super().__post_init__()
        self._check_pattern()
        self._check_zone()

    def _check_pattern(self):
        """InputError of a plane of symmetry that the weave does not have."""
        pattern = self.weave.pattern
        # the plane across the warp is the middle line of a weft yarn
        for family, mirrored in zip((1, 0), self.mirrors):
            if mirrored and pattern.find_mirror(family) is None:
                allowed = f"whole for resolved yarns of {pattern.name}, not its own mirror image"
                raise InputError(key="symmetry", value=self.symmetry, allowed=allowed)

    @cached_property
    def zone_width(self) -> float:
        """[m] half width of the zone; one that is not given is narrowed to what the edges of an oblique,
        round or shifted opening leave."""
        width = self.resolved.width
        if self.resolved.half_width is not None or not self.stepped:
            return width
        width = min(width, 0.5 * max(self.opening))
        while width > 0 and not self._is_free(width):
            width -= min(self.spacing)
        return width

    def _is_free(self, width):
        """Whether no edge holds a node inside the rim of a zone."""
        (i0, i1), (j0, j1) = self._rows_of(width)
        return bool(self.loose()[i0 + 1 : i1, j0 + 1 : j1].all())

    def _check_zone(self):
        (i0, i1), (j0, j1) = self.rim_rows
        reach = self.projectile.radius
        if self.projectile.turned is not None:
            allowed = (
                "rigid or elastic_bar with resolved yarns, whose forces do not reach the rings "
                "of a body of metal"
            )
            raise InputError(key="body", value="metal", allowed=allowed)
        for low, high, spacing, mirrored in zip((i0, j0), (i1, j1), self.spacing, self.mirrors):
            least = max(LEAST_ROWS + 2, 2 * (reach / spacing + REACH + RIM_ROWS))
            if (high - low) * (1 + mirrored) < least:
                smallest = 1e3 * 0.5 * (least + 1) * spacing
                allowed = f"at least {smallest:.3g} mm for this nose, in a larger opening"
                self._refuse_zone(allowed)
        if not self._is_free(self.zone_width):
            self._refuse_zone("smaller: an edge of the opening crosses it")

    def _refuse_zone(self, allowed):
        """Refuse the zone that is given, or say which one is taken where none is."""
        width = self.zone_width
        if self.resolved.half_width is not None:
            raise InputError(key="zone", value=width, allowed=allowed)
        message = f"is not given, and {1e3 * width:g} mm does not fit"
        raise InputError(message, key="zone", allowed=allowed)

    @property
    def grid_middle(self) -> tuple[float, float]:
        """[m] as in Panel: the grid stays in the middle of the opening, so that a shot need not hit
        a crossover."""
        return self.shift

    @property
    def is_seen(self) -> bool:
        """Whether other plies or a block touch the yarns, which shadow nodes stand for."""
        return self.among_plies or self.backing is not None

    @property
    def contact_density(self) -> float:
        """[kg/m2] as in PanelGrid: of the lightest shadow node, over the area of a crossing."""
        mass = 1 / float(self.patch.shadow_mobility.max())
        return min(mass / float(np.prod(self.spacing)), self.weave.areal_density)

    @property
    def _fills(self):
        """As in Panel: a line of the grid is one yarn, at the spacing of the weave."""
        return False

    @property
    def rim_rows(self) -> tuple[tuple[int, int], tuple[int, int]]:
        """((first, last) row, (first, last) column) of nodes of the rim."""
        return self._rows_of(self.zone_width)

    def _rows_of(self, width):
        """`rim_rows` of a half width [m]."""
        found = []
        for middle, spacing, count in zip(self.nearest_lines, self.spacing, self.counts):
            half = min(width / spacing, count) + 1
            found.append((max(middle - int(half), 0), min(middle + int(half), count)))
        return found[0], found[1]

    def holds_nose(self, position: FloatArray) -> bool:
        """Return whether the nose at a position [m] is over the zone, by its radius from the pinned
        rows."""
        axes = zip(position, self.lines(), self.rim_rows, self.spacing, self.mirrors)
        for place, lines, (first, last), spacing, mirrored in axes:
            reach = self.projectile.radius + RIM_ROWS * spacing
            low = lines[first]
            if mirrored:
                low = -lines[last]
            if not low + reach <= place <= lines[last] - reach:
                return False
        return True

    @cached_property
    def images(self) -> tuple[int, int]:
        """(along warp, along weft) rows of images of crossings beyond planes of symmetry, as many
        as the mean of the failure criterion takes in."""
        found = []
        for spacing, mirrored in zip(self.spacing, self.mirrors):
            wide = ceil(self.fabric.failure_length / spacing + 0.5)
            found.append(mirrored * max(IMAGES, wide))
        return found[0], found[1]

    @property
    def corner(self) -> tuple[int, int]:
        """(row, column) of the grid from which the yarns of the zone begin; below 0 beyond a plane
        of symmetry."""
        (i0, _), (j0, _) = self.rim_rows
        found = []
        for count, first in zip(self.images, (i0, j0)):
            if count:
                first = -1 - count
            found.append(first)
        return found[0], found[1]

    @cached_property
    def patch(self) -> YarnPatch:
        """The yarns of the zone."""
        (_, i1), (_, j1) = self.rim_rows
        i0, j0 = self.corner
        # numbers of grid lines, of those that are images below 0
        rows, columns = np.arange(i0 + 1, i1), np.arange(j0 + 1, j1)
        drawn = self.strength_factors or tuple(np.ones(count) for count in self.yarn_counts)
        warp, weft = (at * np.asarray(own) for at, own in zip(self.length_factors, drawn))
        factors = (warp[abs(columns)], weft[abs(rows)])
        whole = self.zone_width == inf
        x, y = (
            float(np.sign(first) * lines[abs(first)])
            for first, lines in zip((i0 + 1, j0 + 1), self.lines())
        )
        near = self.nearest_lines
        return YarnPatch(
            self.table.model,
            (rows.size, columns.size),
            origin=(x, y),
            first=self._number_yarns(i0 + 1, j0 + 1),
            images=self.images,
            middle=(near[0] - i0 - 1, near[1] - j0 - 1),
            friction=self.resolved.friction,
            rim_rows=0 if whole else RIM_ROWS,
            viscosity=self.numerics.stretch_viscosity,
            failure=self.yarn_failure,
            strength_factors=factors,
            rate_law=self.rate_law,
            lateral=self.resolved.lateral,
            edge=self.resolved.edge,
            numbers=self,
        )

    def _number_yarns(self, row, column):
        """(warp, weft) numbers in the repeat of the weave of the yarns that cross at a row and a column
        of the grid: an aim is counted from the middle crossover, whatever the size of the panel."""
        found = []
        numbers = zip((row, column), self.counts, self.mirrors, self.weave.pattern.centre[::-1])
        for number, count, mirrored, centre in numbers:
            middle = 0
            if not mirrored:
                middle = count // 2
            found.append(number - middle + centre)
        weft, warp = found
        return warp, weft

    @property
    def time_step(self) -> float:
        """[s] step of the membrane, of which the yarns make a whole number."""
        steps = MOST_STEPS
        if self.is_seen:  # the places of shadow nodes after a step have to be known before it
            steps = 1
        # ends that whip make energy if rim and yarns differ in step; there is no membrane beyond them
        if self.ends_free:
            steps = 1
        return min(super().time_step, steps * self._longest_step)

    @property
    def ends_free(self) -> bool:
        """Whether the zone reaches all edges of the opening, and one of them holds no yarn."""
        (i0, i1), (j0, j1) = self.rim_rows
        if (i0, j0) != (0, 0) or (i1, j1) != self.counts:
            return False
        loose = self.loose()
        sides = [loose[-1, 1:-1], loose[1:-1, -1]]
        # the first lines of a mirrored panel are its planes of symmetry
        for axis, mirrored in enumerate(self.mirrors):
            if not mirrored:
                sides.append(np.moveaxis(loose, axis, 0)[0, 1:-1])
        return any(bool(side.any()) for side in sides)

    @property
    def _longest_step(self):
        """[s] that the yarns can take."""
        return self.numerics.cfl * self.patch.critical_step

    def constants(self) -> Constants:
        """Return the constants of Panel; no element of the membrane touches the nose."""
        return self._constants_of_zone

    @cached_property
    def _constants_of_zone(self):
        (i0, _), (j0, _) = self.rim_rows
        return super().constants()._replace(window_limits=(i0, i0, j0, j0), window_follows=False)

    def make_parts(self) -> tuple[Part, ...]:
        """Make the modules of Panel, with the resolved yarns."""
        return *super().make_parts(), ResolvedYarns(self)

    def cut_out(self, state: State) -> None:
        """Take the membrane inside the rim out of a state, and put the nose before the yarns that
        stand out."""
        highest = max(self.patch.amplitudes) + 0.25 * self.weave.thickness
        flight = self.shot.flight
        state.projectile_position[:] -= highest / flight[2] * flight
        (i0, i1), (j0, j1) = self.rim_rows
        const = self.constants()
        grid = partial(by_node, const=const)
        inside = slice(i0 + 1 - self.mirrors[0], i1), slice(j0 + 1 - self.mirrors[1], j1)
        for slots in (state.intact_fraction, state.yarn_length):
            grid(slots[0])[i0:i1, inside[1]] = 0.0
            grid(slots[1])[inside[0], j0:j1] = 0.0
        # elements deeper inside have no node with a mass: what is computed of them goes nowhere
        flag = np.full((i1 - i0, j1 - j0), WARP_FAILED | WEFT_FAILED | RESOLVED)
        flag[1 - self.mirrors[0] : -1, 1 - self.mirrors[1] : -1] = RESOLVED * self.is_seen
        grid(state.element_flag)[i0:i1, j0:j1] = flag
        per = const.rows_per_block
        state.block_damage[max(i0 - 2, 0) // per : min(i1 + 2, const.ni - 1) // per + 1] = DAMAGED
        state.first_row = max(i0 - 3, 0)
        state.end_row = min(i1 + 3, const.ni)
        held = grid(state.inverse_mass) == 0.0
        mass = self._rim_masses(grid(state.yarn_length[0]), grid(state.yarn_length[1]))
        grid(state.mass)[i0 : i1 + 1, j0 : j1 + 1] = mass
        loose = ~held[i0 : i1 + 1, j0 : j1 + 1] & (mass > 0)
        inverse = np.where(loose, 1 / np.where(mass > 0, mass, inf), 0.0)
        grid(state.inverse_mass)[i0 : i1 + 1, j0 : j1 + 1] = inverse
        grid(state.dt_over_mass)[i0 : i1 + 1, j0 : j1 + 1] = self.time_step * inverse
        grid(state.mass)[inside] = 0.0
        # the membrane is gone if no edge of it is left at a node that moves
        left = const.slip_node.size > 0
        for axis in range(2):
            ends = np.moveaxis(grid(state.inverse_mass), axis, 0) > 0
            edges = np.moveaxis(grid(state.intact_fraction[axis]), axis, 0)[:-1] > 0
            left = left or (edges & (ends[:-1] | ends[1:])).any()
        if not left:
            state.block_damage[:] = GONE
        if self.is_seen:
            g0, g1 = self.images
            mobility = self.patch.shadow_mobility[g0:, g1:] / self.patch.crossing_share.T[g0:, g1:]
            grid(state.dt_over_mass)[inside] = self.time_step * mobility

    def _rim_masses(self, warp, weft):
        """(rows, columns) [kg] of the nodes of the zone and its rim: half of each edge of the
        membrane that is left, and the tied ends of the yarns."""
        (i0, i1), (j0, j1) = self.rim_rows
        mass = np.zeros(warp.shape)
        for axis, (edges, yarn, S0) in enumerate(
            zip((warp, weft), self.weave.yarns, self.weave.S0)
        ):
            half = 0.5 * yarn.linear_density * S0 * (edges > 0)
            if self.mirrors[1 - axis]:
                np.moveaxis(half, 1 - axis, 0)[0] *= 0.5
            lines = np.moveaxis(mass, axis, 0)
            own = np.moveaxis(half, axis, 0)
            lines[:-1] += own[:-1]
            lines[1:] += own[:-1]
        zone = self.zone()
        real = zone.tied_share > 0
        np.add.at(
            mass.reshape(-1),
            zone.tied_slot[real],
            (zone.tied_share * zone.mass[zone.tied_node])[real],
        )
        mass = mass[i0 : i1 + 1, j0 : j1 + 1]
        mass[1 - self.mirrors[0] : -1, 1 - self.mirrors[1] : -1] = 0.0
        return mass

    def zone(self) -> Zone:
        """Return the arrays of the zone at rest."""
        steps = own_steps(self.time_step, self._longest_step)
        return self.patch.arrays(
            self.time_step / steps,
            steps,
            self.corner,
            self.counts[1] + 1,
            self.projectile.friction,
            seen=self.is_seen,
        )


def lie_anywhere(
    panels: Sequence[YarnPanel], seed: int | Sequence[int] | None
) -> tuple[YarnPanel, ...]:
    """Shift the grids of plies behind the first, each by a part of a cell of its weave that a seed
    draws: windows of plies do not lie behind each other. Without clamped edges, which are lines of
    the grid, they lie aligned.

    Parameters
    ----------
    seed : of the aim (`aim`); None is 0
    """
    found = [panels[0]]
    for number, panel in enumerate(panels[1:], 1):
        shift = (0.0, 0.0)
        if is_clamped(panel.boundary):
            shift = aim(panel.weave, [*np.atleast_1d(seed or 0), number], panel.mirrors)
        found.append(replace(panel, shift=shift))
    return tuple(found)


def crossings_of(panel: Panel) -> int:
    """Count the crossings of resolved yarns; 0 of a panel without a zone."""
    if not isinstance(panel, YarnPanel):
        return 0
    rows, columns = panel.patch.crossings
    return rows * columns
