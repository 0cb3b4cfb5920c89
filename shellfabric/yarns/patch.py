"""A patch of fabric of resolved yarns: its geometry, its constants, its arrays. Crossings lie on the grid of
the weave. A yarn has a node at each and one halfway between, and runs one spacing beyond its first and
last crossing. Nodes at a crossing are up or down by the amplitude that the crimp asks for; those halfway at
mid-height where the yarn changes sides, on its side where it floats on; those at the rim at mid-height.

What is stiffer than the yarn only shortens the time step. In units of EA / l0 of the softer family's
segment: crossings follow the compression laws of their two yarns in series up to CROSSING, and are linear
from there; their friction springs have FRICTION, the nose NOSE, neighbours that cannot come closer HARD.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from math import inf, pi, sqrt
from typing import Any

import numpy as np

from fabrics import assumed
from fabrics.base.checks import FloatArray, IntArray
from shellfabric.cell.model import CellModel
from shellfabric.membrane import failure
from shellfabric.panel_numbers import PanelNumbers
from shellfabric.state import Numbers
from shellfabric.yarns.rest import find_contacts
from shellfabric.yarns.state import Zone

CROSSING, FRICTION, NOSE, HARD = 0.5, 0.1, 0.1, 0.2  # stiffnesses over EA / l0
CROSSING_DAMPING = 0.1  # of sqrt(k m), the hardest crossing on the lightest node
HEXAGONAL = pi / sqrt(12)  # densest packing of round fibres
MOST_CLOSEST = 0.9  # of the width of a yarn
CROSSING_HEIGHT = 0.75  # of the sum of the amplitudes: the splines of two zigzags are as far apart
FLOATING_HEIGHT = 0.125  # of the amplitude of a yarn, for each side on which it floats on
LAW_SAMPLES = 256
MOST_APART = (
    2.0  # spacings between the two yarns of a shadow node: further apart they are no fabric
)
RIM_ROWS = 2  # outer rows of crossings that are pinned: a yarn does not slide out of the patch


@dataclass(frozen=True)
class YarnPatch:
    """Warp and weft yarns that cross each other on a rectangle.

    Heights: yarns of the cell are cosines, here zigzags, whose splines stand lower for the same
    crimp: at 0.75 of the amplitude, and an eighth higher for each side on which the yarn floats on.
    By the share s, 0.83 in plain weave, crossings close as much more, and the cell's law is taken
    at the closure over s. Tensions of a biaxial patch are then within 4 % of the cell's, within 7 %
    in basket 2x2 and twill 2/2.

    Neighbours touch at the width of a yarn. Round packed yarns are closest at sqrt 3 diameters
    where a crossing yarn passes between them (Peirce's jammed weave), at one where it floats over
    both. Until then a yarn is squeezed sideways: k1 = E t s / w with half the ply's thickness t,
    the spacing s along the yarn and the width w. E lies between the transverse moduli of the loose
    and of the packed yarn (`fabrics.solid`); their geometric mean is taken, nobody has measured it.

    Parameters
    ----------
    model : CellModel, of whose fabric and compression laws it is
    crossings : (along warp, along weft) numbers of crossings: of weft yarns, of warp yarns
    origin : [m] (x, y) of the first crossing at rest
    first : numbers of the warp yarn and of the weft yarn there, in the repeat of the weave
    friction : [-] Coulomb's coefficient of yarn on yarn; inf pins all crossings
    rim_rows : outer rows of crossings that are pinned
    viscosity : [-] damping ratio of the segments
    failure : whether yarns fail
    strength_factors : (warp, weft) factors on the strength of each yarn; None where all are alike
    rate_law : as `Panel.rate_law`
    lateral : factor on the lateral stiffness of yarns
    edge : [-] of the width of a yarn, how far beside its middle line it meets the nose
    numbers : PanelNumbers
    images : (along warp, along weft) rows of crossings before a plane of symmetry, which is the
        middle line of the yarn behind them; 0 without one
    middle : (along warp, along weft) number of the weft and of the warp yarn that the line of flight
        is nearest to; by default those in the middle
    """

    model: CellModel
    crossings: tuple[int, int]
    origin: tuple[float, float] = (0.0, 0.0)
    first: tuple[int, int] = (0, 0)
    friction: float = 0.2
    rim_rows: int = RIM_ROWS
    viscosity: float = 0.1
    failure: bool = True
    strength_factors: tuple[FloatArray, FloatArray] | None = None
    rate_law: FloatArray = field(default_factory=lambda: np.zeros((2, 3, 0)))
    lateral: float = 1.0
    edge: float = 0.0
    numbers: PanelNumbers = field(default_factory=PanelNumbers)
    images: tuple[int, int] = (0, 0)
    middle: tuple[int, int] | None = None

    @property
    def weave(self) -> Any:
        """Weave of the fabric."""
        return self.model.fabric.weave

    @property
    def spacing(self) -> tuple[float, float]:
        """[m] of the crossings along warp and weft."""
        return 2 * self.weave.w1, 2 * self.weave.w2

    @property
    def amplitudes(self) -> tuple[float, float]:
        """(warp, weft) [m] height of a yarn's node at a crossing over mid-height."""
        shares = self.weave.pattern.interlacings
        crimps = (yarn.crimp / share for yarn, share in zip(self.weave.yarns, shares))
        warp, weft = (0.5 * p * sqrt((1 + c) ** 2 - 1) for p, c in zip(self.spacing, crimps))
        return warp, weft

    @property
    def warp_share(self) -> float:
        """[-] w of `shadow_kernels`."""
        warp, weft = self.amplitudes
        if warp + weft == 0:
            return 0.5
        return weft / (warp + weft)

    @cached_property
    def shadow_mobility(self) -> FloatArray:
        """(rows, columns) [1/kg] inverse masses of the shadow nodes, by weft and warp yarn."""
        chains = self._chains()
        _, yarns, nodes = self.layout
        own = []
        for family in range(2):
            of_yarns = chains["inverse_mass"][self._span(family)]
            own.append(of_yarns.reshape(yarns[family], nodes[family])[:, 2:-2:2])
        warp, weft = own
        return self.warp_share**2 * warp.T + (1 - self.warp_share) ** 2 * weft

    @property
    def gap(self) -> float:
        """[m] between the splines of two yarns that cross, at rest, in the mean."""
        mean = CROSSING_HEIGHT * sum(self.amplitudes)
        for amplitude, share in zip(self.amplitudes, self.weave.pattern.interlacings):
            mean += 2 * FLOATING_HEIGHT * amplitude * (1 - share)
        return mean

    @cached_property
    def rest(self) -> tuple[FloatArray, FloatArray]:
        """(warp yarns, weft yarns, 2) indices of each crossing on its warp and weft, and (warp yarns, weft
        yarns) [m] gap between the splines there at which the yarns touch. Beyond the rim, at whose
        height yarns are tied, none floats on."""
        warp, weft = (self._floats(family) for family in range(2))
        heights = self.amplitudes[0] * warp + self.amplitudes[1] * weft.T
        gaps = CROSSING_HEIGHT * sum(self.amplitudes) + FLOATING_HEIGHT * heights
        of_warp, of_weft = np.indices(gaps.shape)
        place = 2.0 * (np.stack([of_weft, of_warp], axis=-1) + 1)
        # a pinned crossing stays at its nodes; the others touch on a flank if a yarn floats on
        leaning = (warp + weft.T > 0) & ~self._pinned
        if leaning.any():
            yarns = [self._nodes_at_rest(family) for family in range(2)]
            place, distances = find_contacts(yarns[0], yarns[1], place, leaning)
            gaps[leaning] = distances[leaning]
        return place, gaps * self.touching

    def _nodes_at_rest(self, family):
        """(yarns, nodes of a yarn, 3) [m] places of the nodes of a family."""
        _, yarns, nodes = self.layout
        places = self._chains()["x"].T[self._span(family)]
        return places.reshape(yarns[family], nodes[family], 3)

    def _floats(self, family):
        """(yarns, crossings of a yarn) on how many sides of a crossing the yarn floats on."""
        up = self.up(family)
        same = up[:, 1:] == up[:, :-1]
        found = np.zeros(up.shape)
        found[:, 1:] += same
        found[:, :-1] += same
        return found

    @property
    def height_share(self) -> float:
        """[-] s: height of the splines over that of the cell's centrelines."""
        if self.weave.pattern.is_plain:
            return self.gap / sum(self.weave.h0)
        return self.gap / sum(self.amplitudes)

    @property
    def touching(self) -> float:
        """[-] share of the gaps of the yarns at rest at which they touch: with floats they are slack until
        they are straight from crossing to crossing, as in the cell."""
        if self.weave.pattern.is_plain:
            return 1.0
        return sum(self.weave.h0) / sum(self.amplitudes)

    @cached_property
    def unit_stiffness(self) -> float:
        """[N/m] EA / l0 of the softer family's segment."""
        return min(2 * yarn.EA / S0 for yarn, S0 in zip(self.weave.yarns, self.weave.S0))

    @property
    def _solid_laws(self):
        return assumed.with_solid_laws(self.model.fabric).solid_laws

    def _beside(self, family):
        """Return (w1 [m], k1 [N/m], k2) of `neighbour_kernels`, of a family."""
        yarn = self.weave.yarns[family]
        law = self._solid_laws[family]
        apart = self.spacing[1 - family]
        thickness = 0.5 * self.weave.thickness
        width = self.model.fabric.yarn_width[family]
        if width is None:  # of an ellipse that is half as high as the ply
            width = 4 * yarn.A_s / law.Vf0 / (pi * thickness)
        width = min(width, apart)
        modulus = self.lateral * law.E_c * sqrt(law.K_r)
        soft = modulus * thickness * self.spacing[family] / width
        return width, soft, HARD * self.unit_stiffness

    @cached_property
    def beside(self) -> dict[str, FloatArray]:
        """{name in `Zone`: (2,) constant of neighbours of warp and weft}."""
        names = "touch_distance", "touch_stiffness", "closest_stiffness"
        families = zip(self._beside(0), self._beside(1))
        return {name: np.array(both) for name, both in zip(names, families)}

    def _closest(self, family):
        """Return (yarns, nodes of a yarn) [m] w2 of `neighbour_kernels`, of the points of a family."""
        _, yarns, nodes = self.layout
        diameter = sqrt(4 * self.weave.yarns[family].A_s / (pi * HEXAGONAL))
        up = self.up(family)
        number = np.arange(yarns[family])
        # a point meets the yarn beside it that is nearer to the line of flight
        beside = number + np.sign(self._middles[family] - number)
        found = np.full((yarns[family], nodes[family]), sqrt(3) * diameter)
        found[:, 2:-2:2][up == up[beside]] = diameter
        return np.minimum(found, MOST_CLOSEST * self.beside["touch_distance"][family])

    @property
    def _middles(self):
        """Numbers of the warp yarn and of the weft yarn that the line of flight is nearest to."""
        middle = self.middle
        if middle is None:
            middle = self.crossings[0] // 2, self.crossings[1] // 2
        return middle[::-1]

    @cached_property
    def law(self) -> dict[str, Any]:
        """{name in `Zone`: value} of the law of a crossing."""
        laws = self.model.used_laws
        s = self.height_share
        hardest = CROSSING * self.unit_stiffness

        def compliance(F):
            return sum(float(law.dd_dF(F)) for law in laws)

        high = 1e-9
        while compliance(high) * s > 1 / hardest:
            high *= 2
        forces = np.concatenate([[0.0], np.geomspace(1e-9, high, 4000)])
        closures = np.sum([np.maximum(law.d(forces), 0.0) for law in laws], axis=0)
        if not closures[-1] > 0:  # incompressible yarns
            return {"law": np.array([[0.0, hardest, 0.0, 0.0]]), "law_scale": 1.0}
        closure = np.linspace(0.0, closures[-1], LAW_SAMPLES)
        force = np.interp(closure, closures, forces)
        closure *= s
        force[0] = 0.0
        step = closure[1]
        energy = np.concatenate([[0.0], np.cumsum(0.5 * step * (force[1:] + force[:-1]))])
        slope = np.append(np.diff(force) / step, hardest)
        return {
            "law": np.column_stack([force, slope, energy, step * np.arange(force.size)]),
            "law_scale": 1 / step,
        }

    @cached_property
    def critical_step(self) -> float:
        """[s] bound on the time step with its viscosity: 2 / w of the stiffest node.

        Its two segments act along the yarn, contacts across it, friction springs both ways.
        """
        chains = self._chains()
        unit = self.unit_stiffness
        _, slope, _, _ = self.law["law"].T
        hardest = max(CROSSING * unit, slope.max())
        beside = (self.beside["touch_stiffness"] + self.beside["closest_stiffness"]).max()
        across = 1.2 * hardest + 2 * NOSE * unit + 2 * beside
        highest = 0.0
        for family, yarn in enumerate(self.weave.yarns):
            own = self._span(family)
            along = 4 * yarn.EA / chains["rest_length"][own][chains["whole"][own]].min()
            stiffness = max(along, across) + 1.2 * FRICTION * unit
            lightest = chains["mass"][own][chains["inverse_mass"][own] > 0].min()
            highest = max(highest, stiffness / lightest)
        damped = sqrt(1 + self.viscosity**2) - self.viscosity
        return float(2 / sqrt(highest) * damped)

    def _span(self, family):
        """Nodes of the yarns of a family."""
        first, yarns, nodes = self.layout
        return slice(first[family], first[family] + yarns[family] * nodes[family])

    @cached_property
    def layout(self) -> tuple[IntArray, IntArray, IntArray]:
        """(first, yarns, nodes) of warp and weft: first node, number of yarns, nodes of a yarn."""
        yarns = np.array(self.crossings[::-1])
        nodes = 2 * np.array(self.crossings) + 3
        return np.array([0, yarns[0] * nodes[0]]), yarns, nodes

    def _chains(self):
        """Arrays of the chains at rest, by name."""
        _, yarns, nodes = self.layout
        size = int(yarns @ nodes)
        x = np.zeros((3, size))
        mass = np.zeros(size)
        inverse = np.ones(size)
        rest = np.ones(size)
        whole = np.zeros(size, np.bool_)
        tied = []
        for family, yarn in enumerate(self.weave.yarns):
            across = 1 - family
            span = self._span(family)
            shape = (yarns[family], nodes[family])
            k = np.arange(nodes[family])
            number = np.arange(yarns[family])
            place = np.zeros((*shape, 3))
            place[..., family] = self.origin[family] + (0.5 * k - 1) * self.spacing[family]
            place[..., across] = self.origin[across] + number[:, None] * self.spacing[across]
            height = self.amplitudes[family] * self.up(family)
            place[:, 2:-2:2, 2] = height
            place[:, 3:-3:2, 2] = 0.5 * (height[:, 1:] + height[:, :-1])
            place[:, [1, -2], 2] = 0.5 * place[:, [2, -3], 2]
            length = np.linalg.norm(np.diff(place, axis=1), axis=2)
            own = np.zeros(shape)
            own[:, :-1] += 0.5 * yarn.linear_density * length
            own[:, 1:] += 0.5 * yarn.linear_density * length
            x[:, span] = place.reshape(-1, 3).T
            mass[span] = own.ravel()
            rest[span].reshape(shape)[:, :-1] = length
            whole[span].reshape(shape)[:, :-1] = True
            ends = np.arange(span.start, span.stop).reshape(shape)[:, [0, -1]]
            tied.append(ends)
            inverse[ends] = 0.0
        free = inverse > 0
        inverse[free] = 1 / mass[free]
        return {
            "x": x,
            "mass": mass,
            "inverse_mass": inverse,
            "rest_length": rest,
            "whole": whole,
            "tied_node": np.concatenate([ends.ravel() for ends in tied]),
        }

    def up(self, family: int) -> FloatArray:
        """Return (yarns, crossings of a yarn) 1 where a yarn of the family is on top, -1 where it
        is below."""
        _, yarns, _ = self.layout
        own = self.first[family] + np.arange(yarns[family])
        across = self.first[1 - family] + np.arange(yarns[1 - family])
        return self.weave.pattern.sides(family, *np.ix_(own, across))

    def _failing(self, dt):
        """Arrays of the failure criterion, by name."""
        _, yarns, nodes = self.layout
        fabric = self.model.fabric
        weave = self.weave
        size = int(yarns @ nodes)
        strength = np.ones(size)
        half = np.ones(size)
        factors = []
        firsts = []
        weights = []
        for family, yarn in enumerate(weave.yarns):
            place = self.spacing[1 - family] * np.arange(yarns[family])
            own_first, own_weights = failure.mean_weights(place, fabric.failure_length, False)
            firsts.append(own_first)
            weights.append(own_weights)
            span = self._span(family)
            own = np.ones(yarns[family])
            if self.strength_factors is not None:
                own = np.asarray(self.strength_factors[family], float)
            strength[span] = np.repeat(yarn.strength * own, nodes[family])
            half[span] = failure.half_strength(
                Numbers.of(self.numbers), strength[span], yarn.EA, self.rate_law, family
            )
            # a segment is half a crossover long
            factors.append(failure.filter_factor(fabric, family, 0.5 * self.spacing[family], dt))
        if not self.failure:
            strength[:] = half[:] = inf
        rate_damage = np.zeros(0)
        if self.rate_law.size:
            rate_damage = np.zeros(size)
        return {
            "strength": strength,
            "half_strength": half,
            "filtered": half.copy(),
            "filter_factor": np.array(factors),
            "mean_first": np.concatenate(firsts),
            "mean_weights": _side_by_side(weights),
            "rate_damage": rate_damage,
            "panel": Numbers.of(self.numbers),
            "rate_law": failure.rate_table(self.rate_law),
            "peak_tension": np.zeros(2),
            "peak_segment": np.zeros(2, np.int64),
        }

    @property
    def _pinned(self):
        """(warp yarns, weft yarns) whether nothing slips at a crossing."""
        _, yarns, _ = self.layout
        pinned = np.full((int(yarns[0]), int(yarns[1])), self.friction == inf)
        if self.rim_rows:
            rows = self.rim_rows
            # warp yarns are counted along y, weft yarns along x
            pinned[-rows:] = pinned[:, -rows:] = True
            if not self.images[1]:
                pinned[:rows] = True
            if not self.images[0]:
                pinned[:, :rows] = True
        return pinned

    def _crossings(self):
        """Arrays of crossings and neighbours, by name."""
        _, yarns, nodes = self.layout
        shape = (int(yarns[0]), int(yarns[1]))
        place, gaps = self.rest
        size = int(yarns @ nodes)
        foot = np.zeros(size)
        foot_onset = np.zeros(size)
        closest = np.zeros(size)
        for family in range(2):
            span = self._span(family)
            foot[span] = np.tile(np.arange(nodes[family]), yarns[family])
            foot_onset[span] = self.beside["touch_distance"][family]
            closest[span] = self._closest(family).ravel()
        return {
            "place": np.moveaxis(place, -1, 0).copy(),
            "slider": np.zeros((3, *shape)),
            "touching": np.ones(shape, np.bool_),
            "pinned": self._pinned,
            "sign": self.up(0),
            "contact_force": np.zeros(shape),
            "contact_energy": np.zeros(shape),
            "contact_onset": gaps.copy(),
            "contact_damping": np.zeros(shape),
            "foot": foot,
            "foot_energy": np.zeros(size),
            "foot_onset": foot_onset,
            "foot_wait": np.zeros(size),
            "gap": gaps,
            "closest_distance": closest,
        }

    @property
    def crossing_share(self) -> FloatArray:
        """(warp yarns, weft yarns) shares of the crossings that are modelled: 0 of images, halves on
        planes of symmetry."""
        rows, columns = self._line_shares()
        return np.outer(columns, rows)

    def _line_shares(self):
        """Shares of the weft yarns, of the warp yarns, that are modelled."""
        found = []
        for count, images in zip(self.crossings, self.images):
            share = np.ones(count)
            share[:images] = 0.0
            if images:
                share[images] = 0.5
            found.append(share)
        return found

    def _shares(self):
        """Shares of what is modelled, and the middle, by name."""
        _, _, nodes = self.layout
        lines = self._line_shares()
        node, segment, tied = [], [], []
        for family in range(2):
            across = lines[1 - family]
            g = self.images[family]
            k = np.ones(nodes[family])
            s = np.ones(nodes[family])
            if g:
                k[: 2 * (g + 1)] = 0.0
                k[2 * (g + 1)] = 0.5
                s[: 2 * (g + 1)] = 0.0
            node.append(np.outer(across, k).ravel())
            segment.append(np.outer(across, s).ravel())
            ends = np.stack([across * (g == 0), across], axis=1)
            tied.append(ends.ravel())
        return {
            "mirror_first": np.array([g if g else -1 for g in self.images], np.int64),
            "middle": np.array(self._middles, np.int64),
            "node_share": np.concatenate(node),
            "segment_share": np.concatenate(segment),
            "crossing_share": self.crossing_share,
            "tied_share": np.concatenate(tied),
        }

    def arrays(
        self,
        dt: float,
        steps: int = 1,
        corner: tuple[int, int] = (0, 0),
        row_stride: int = 0,
        nose_friction: float = 0.0,
        seen: bool = False,
    ) -> Zone:
        """Build the arrays of the patch at rest.

        Parameters
        ----------
        dt : [s] time step
        steps : in a step of the ply
        corner : (row, column) of the panel's node at the corner of the rim
        row_stride : slots of a row of the panel
        nose_friction : of the projectile, whose springs need room
        seen : whether other plies or a block see the patch (`shadow_kernels`)
        """
        first, yarns, nodes = self.layout
        chains = self._chains()
        size = chains["mass"].size
        unit = self.unit_stiffness
        rubbing = 0
        if nose_friction > 0:
            rubbing = size
        lightest = chains["mass"][chains["inverse_mass"] > 0].min()
        rows, columns = self.crossings
        column, row = np.arange(columns) + corner[1] + 1, np.arange(rows) + corner[0] + 1
        warp = np.column_stack(
            [corner[0] * row_stride + column, (corner[0] + rows + 1) * row_stride + column]
        )
        weft = np.column_stack(
            [row * row_stride + corner[1], row * row_stride + corner[1] + columns + 1]
        )
        return Zone(
            **chains,
            **self._failing(dt),
            **self._crossings(),
            dt=dt,
            first=first,
            yarns=yarns,
            nodes=nodes,
            v=np.zeros((3, size)),
            f=np.zeros((3, size)),
            pull=np.zeros((3, size)),
            breaking=np.zeros(size, np.bool_),
            torn=np.zeros((2, int(yarns.max())), np.bool_),
            stiffness=np.array([yarn.EA for yarn in self.weave.yarns]),
            drag=np.array(
                [self.viscosity * sqrt(yarn.EA * yarn.linear_density) for yarn in self.weave.yarns]
            ),
            tension=np.zeros(size),
            viscous_force=np.zeros(size),
            **self.law,
            friction=0.0 if self.friction == inf else float(self.friction),
            friction_stiffness=FRICTION * unit,
            damping=CROSSING_DAMPING * sqrt(CROSSING * unit * lightest),
            **self.beside,
            rod=0.25 * self.weave.thickness,
            nose_stiffness=NOSE * unit,
            nose_edge=self.edge * self.beside["touch_distance"],
            nose_energy=np.zeros((size, 6)),
            friction_slip=np.zeros((rubbing, 6, 3)),
            friction_force=np.zeros((rubbing, 6, 3)),
            substeps=steps,
            warp_share=self.warp_share,
            **self._shares(),
            furthest=MOST_APART * max(self.spacing),
            has_shadow=seen,
            outer_force=np.zeros((chains["tied_node"].size + 1, 3)),
            taken_force=np.zeros((chains["tied_node"].size + 1, 3)),
            tied_slot=np.concatenate([warp.ravel(), weft.ravel()]),
            tied_rest=chains["x"][:, chains["tied_node"]].T,
            **Zone.totals(),
        )


def _side_by_side(weights):
    """Rows of two arrays below each other, the shorter ones filled with zeros."""
    longest = max(part.shape[1] for part in weights)
    return np.concatenate(
        [np.pad(part, ((0, 0), (0, longest - part.shape[1]))) for part in weights]
    )


def kinetic_energy(zone: Zone) -> float:
    """Compute the kinetic energy [J] of the chains' own nodes at the present whole step, m v(n-1/2)
    v(n+1/2) / 2."""
    after = zone.v + zone.dt * zone.inverse_mass * zone.f
    own = zone.inverse_mass > 0
    return 0.5 * float((zone.node_share * zone.mass * zone.v * after)[:, own].sum())
