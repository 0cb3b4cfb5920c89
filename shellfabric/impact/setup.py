"""Set-up of an impact: what strikes which panel, of one ply or several, and how it is meshed."""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from itertools import groupby, product
from math import ceil, degrees, inf, pi
from typing import Annotated, Any, TypeAlias

import numpy as np

from fabrics import plausible
from fabrics.base.assumed_number import Assumed
from fabrics.base.checks import refuse
from fabrics.base.errors import InputError
from fabrics.base.fields import check_fields, finite, limits
from fabrics.base.frozen import explain_frozen
from fabrics.base.schema import declared
from fabrics.compression import CompressionLaw
from fabrics.fabric import Fabric
from fabrics.surface import ResponseSurface
from fabrics.variants import rotated_90
from shellfabric import shot_keys
from shellfabric.cell import table_cache
from shellfabric.cell.model import CellModel, CellTable
from shellfabric.cell.surface_cell import SurfaceCell
from shellfabric.impact.plausible_numbers import list_numbers
from shellfabric.impact.strengths import YarnStrength, with_strengths
from shellfabric.loop import histories
from shellfabric.membrane import boundary, grading
from shellfabric.membrane.model import Panel
from shellfabric.membrane.panel_setup import PanelSetup
from shellfabric.panel_numbers import CellNumbers
from shellfabric.plies.model import Pack, PlyContact, at_angle
from shellfabric.plies.pack_keys import PackKeys, PackNumbers
from shellfabric.yarns.model import YarnPanel, YarnZone, lie_anywhere

ELEMENT_SIDE = 0.8  # [projectile radii] of an element at most, by default: longer ones miss what a narrow nose cuts
MOST_ELEMENTS = 8  # a crossover, by default
RESOLVED = 0.5  # [failure lengths] an element about the impact point at most, by default
CARRIED = 1e-3  # [s] for which a block carries free fabric along, at least as measured (docs/reports/backing.md)
OPENING_ERROR = 1e-3  # [-] of its sides, beyond which it is said
# [-] of the strength that the fabric states, up to which the last cells of a table hold within 0.2 % of it;
# tables of stronger yarns, and there are few of them, reach further in steps
STRONGEST = 1.15
STRONGER = 0.25
UNFAILING = (
    20.0  # reach of the table, see CellModel, of yarns that do not fail: 60 % of strain in Kevlar
)


# of a ply: its fabric, and (warp, weft) laws, None of the published ones
Material: TypeAlias = tuple[Fabric, tuple[CompressionLaw, CompressionLaw] | None]


@dataclass(frozen=True)
class Mesh:
    """Elements of a ply: along each side of a crossover, None where a grading says it; and the grading,
    None of elements that are all alike."""

    elements_per_crossover: int | None
    grading: tuple | None


@explain_frozen
@dataclass(frozen=True)
class Ply:
    """One ply of a lay-up.

    Parameters
    ----------
    fabric : Fabric, as in ImpactSetup
    laws : (warp, weft) CompressionLaw; None takes the fabric's published ones
    angle : [rad] by which it is turned, from warp to weft, above -pi/2 and at most pi/2
    gap : [m] to the next ply at rest; None takes that of `plies.gap.gap_between`
    """

    fabric: Fabric
    laws: tuple[CompressionLaw, CompressionLaw] | None = None
    angle: Annotated[float, finite(gt=-pi / 2, le=pi / 2)] = 0.0
    gap: Annotated[float | None, limits(shot_keys.PLY_GAP)] = None

    def __post_init__(self):
        check_fields(self)


@explain_frozen
@dataclass(frozen=True)
class ImpactSetup(PanelSetup, CellNumbers, PackNumbers):
    """A projectile that strikes the middle of a panel of one ply or several.

    Parameters
    ----------
    fabric : Fabric; its linear densities are used as they are (see Fabric.effective)
    strike_velocity : [m/s] along the projectile's line of flight
    laws : (CompressionLaw, CompressionLaw) of warp and weft; None takes the fabric's published ones
    opening : [m] side of the square opening, or both sides: along warp and weft, but for an oblique
        weave
    end_time : [s] at the latest; a run ends when the projectile stops or has passed
    elements_per_crossover : along each side; None takes a graded mesh (`meshed`), or where there is
        none 1, or as many as put an element's longer side within ELEMENT_SIDE of the projectile's
        radius, at most MOST_ELEMENTS
    bending : [N m2] bending stiffness of a yarn, or of (warp, weft); see Panel
    surface : ResponseSurface to make the cell from instead of laws, or None; see
        surface_cell.SurfaceCell
    table_size : stretches along each side of the cell's table; 201 puts its tensions within 0.2 %
        of the yarn's strength of the cell's
    audit_interval, snapshot_interval : [s]; no snapshots where None
    history : histories.HistoryRequest, what to record along yarns and at the edges; None for
        nothing
    crossovers : yarns.model.YarnZone of yarns that are resolved about the nose; None pins all crossovers
    instead : YarnZone of yarns that are resolved if friction may not hold pinned ones;
        what cannot choose refuses it (`target`)
    pinned : whether `crossovers` is None because pinned yarns were asked for: commands resolve those of
        which nothing is said
    ply_friction : [-] Coulomb's coefficient between plies
    strength : strengths.YarnStrength of yarns that differ in strength; None if they are all alike
    contact : plies.model.PlyContact, numerical parameters of the contact between plies; None takes
        its defaults
    lay_up : every Ply from the front, where they are not all alike; the first has `fabric` and
        `laws`, `plies` is their number, and stacking and ply_gap are not used. Empty for plies that
        are
    others : see `PanelSetup`, `CellNumbers` and `PackNumbers`. Where yarns do not fail, the table goes to UNFAILING
        times their failure strain; with `rate_dependence` their modulus is that of the highest rate

    Raises
    ------
    InputError : a lay-up of another number of plies, or of cells from a response surface; yarns
        that differ in strength and do not fail, or of a part of the panel
    """

    fabric: Fabric
    strike_velocity: Annotated[float, limits(shot_keys.STRIKE_VELOCITY)]
    laws: tuple[CompressionLaw, CompressionLaw] | None = None
    opening: Annotated[float | tuple[float, float], limits(shot_keys.OPENING)] = 0.203
    end_time: Annotated[float, limits(shot_keys.END_TIME)] = 800e-6
    elements_per_crossover: Annotated[int | None, limits(shot_keys.ELEMENTS)] = None
    bending: Annotated[float | tuple[float, float], limits(shot_keys.BENDING)] = 0.0
    surface: ResponseSurface | None = None
    table_size: Annotated[int, finite(ge=2)] = 201
    audit_interval: Annotated[float, finite(gt=0.0)] = 2e-6
    snapshot_interval: Annotated[float | None, limits(shot_keys.SNAPSHOT_INTERVAL)] = None
    history: histories.HistoryRequest | None = None
    crossovers: YarnZone | None = None
    ply_friction: Annotated[float, declared(PackKeys)["ply_friction"]] = Assumed(0.0)
    contact: PlyContact | None = None
    lay_up: tuple[Ply, ...] = ()
    strength: YarnStrength | None = None
    instead: YarnZone | None = None
    pinned: bool = False

    def __post_init__(self):
        check_fields(self)
        boundary.sides(self.boundary)
        if self.grading is not None:
            grading.check(self.grading)
        if self.lay_up and self.plies != len(self.lay_up):
            refuse(self, "plies", f"{len(self.lay_up)}, as many as the lay-up has")
        if self.lay_up and self.surface is not None:
            raise InputError(
                key="surface", value="given", allowed="left out with plies of a lay-up"
            )
        if self.strength is not None and self.symmetry != "whole":
            allowed = "whole: each yarn has a strength of its own"
            refuse(self, "symmetry", allowed)
        if self.strength is not None and not self.yarn_failure:
            raise InputError(key="strength", allowed="left out: the yarns do not fail")
        plausible.judge(list_numbers(self))

    @property
    def title(self) -> str:
        """The fabric with the number of its plies, or what the lay-up is made of."""
        if self.plies > 1 and not self.lay_up:
            return f"{self.plies} x {self.name}"
        return self.name

    @property
    def name(self) -> str:
        """The name of the fabric, or what the lay-up is made of."""
        if not self.lay_up:
            return self.fabric.name
        same = groupby((ply.fabric.name, ply.angle) for ply in self.lay_up)
        parts = []
        for (name, angle), plies in same:
            if angle:
                name += f" at {degrees(angle):g} deg"
            parts.append(f"{len(list(plies))} x {name}")
        return " + ".join(parts)

    @property
    def fabrics(self) -> tuple[Fabric, ...]:
        """The fabrics of the plies, each once."""
        return tuple({one.name: one for one in map(self.fabric_of, range(self.plies))}.values())

    @property
    def areal_density(self) -> float:
        """[kg/m2] of all plies."""
        return sum(self.fabric_of(p).weave.areal_density for p in range(self.plies))

    def fabric_of(self, ply: int) -> Fabric:
        """Return the fabric of a ply, the first is 0."""
        if self.lay_up:
            return self.lay_up[ply].fabric
        return self.fabric

    def angle_of(self, ply: int) -> float:
        """Return the angle [rad] by which a ply, the first is 0, is turned."""
        if self.lay_up:
            return self.lay_up[ply].angle
        if self.stacking == "alternating" and ply % 2 == 1:
            return pi / 2
        return 0.0

    def is_turned(self, ply: int) -> bool:
        """Tell whether a ply, the first is 0, is turned by a right angle: its warp is the weft of
        its panel."""
        return self.angle_of(ply) == pi / 2 and self.weave_angle == 0

    @property
    def _oblique_angles(self):
        """[rad] all angles of plies but right ones."""
        return {self.angle_of(ply) for ply in range(self.plies) if not self.is_turned(ply)}

    @property
    def angled(self) -> bool:
        """Whether a ply is at another angle than 0 and a right one."""
        return any(self.angle_of(ply) not in (0.0, pi / 2) for ply in range(self.plies))

    @property
    def _carried_notes(self):
        """A line about fabric that a block carries along for longer than the run lasts."""
        if self.backing is None or not self._hangs_free or self.end_time >= CARRIED:
            return ()
        return (
            "no edge stops fabric with free edges: block, fabric and projectile move on together "
            f"for {1e3 * CARRIED:g} ms or longer, and the run ends {1e6 * self.end_time:.0f} us "
            "after the strike: a longer run.end_time",
        )

    @cached_property
    def opening_notes(self) -> tuple[str, ...]:
        """A line about each opening that differs from the given one by more than OPENING_ERROR,
        since its edges follow yarns."""
        asked = np.broadcast_to(self.opening, 2)
        found = []
        for name, held in self._held_openings():
            if np.abs(held / asked - 1).max() > OPENING_ERROR:
                made, given = (
                    "{:.1f} by {:.1f} mm".format(*(1e3 * side)) for side in (held, asked)
                )
                line = f"{name}: the edges follow yarns, the opening is {made} in place of {given}"
                found.append(line)
        return tuple(dict.fromkeys(found))

    def _held_openings(self):
        """(name of a fabric, `Panel.held_opening`) of plies whose edges follow yarns."""
        angles = self._oblique_angles
        if not (self.weave_angle or self.round or any(self.impact_point) or angles - {0.0}):
            return
        for flat in self.plain_panels():
            for angle in sorted(angles):
                panel = at_angle(flat, angle)
                yield panel.fabric.name, np.array(panel.held_opening)

    @property
    def notes(self) -> tuple[str, ...]:
        """What has to be known of the opening, of the fabrics, and of numbers that are not plausible,
        a line each; of the opening nothing if the set-up is refused when it is run."""
        fabrics = [self.fabric_of(ply) for ply in range(self.plies)]
        of_fabrics = [note.removeprefix("note: ") for fabric in fabrics for note in fabric.notes]
        found = (
            *self.projectile.notes,
            *dict.fromkeys(of_fabrics),
            *plausible.judge(list_numbers(self)),
            *self._carried_notes,
        )
        try:
            return (*self.opening_notes, *found)
        except InputError:
            return found

    def failure_in_words(self, drawn: bool) -> str:
        """Say whether and when yarns fail; `drawn` where each has a strength of its own."""
        if not self.yarn_failure:
            return "Yarns do not fail."
        opening = tuple(np.broadcast_to(self.opening, 2).tolist())
        strengths = []
        for ply in range(self.plies):
            fabric = self.fabric_of(ply)
            angle = self.weave_angle + self.angle_of(ply)
            factors = self.find_length_factors(fabric, opening, angle)
            pairs = zip(fabric.weave.yarns, factors)
            warp, weft = (yarn.strength * factor for yarn, factor in pairs)
            words = f"{fabric.name}, warp / weft"
            if self.length_effect:
                words += (
                    f"; {factors[0]:.3g} / {factors[1]:.3g} times that of yarns of "
                    f"{1e3 * fabric.gauge_length:g} mm, Weibull shape {fabric.weibull_shape:g}"
                )
            strengths.append(f"{warp:.0f} / {weft:.0f} N ({words})")
        rate = "at any strain rate"
        if self.rate_dependence:
            rate = "multiplied by what its strain rate makes of it"
        scatter = "it is the same for all yarns"
        if drawn:
            scatter = "each yarn has a drawn strength about it"
        said = ", ".join(dict.fromkeys(strengths))
        return f"A yarn fails at its strength, {said}, {rate}; {scatter}."

    @property
    def materials(self) -> tuple[Material, ...]:
        """(fabric, laws) of the plies, each once, those of the first ply first."""
        found = [(self.fabric, self.laws)]
        for ply in self.lay_up:
            if (ply.fabric, ply.laws) not in found:
                found.append((ply.fabric, ply.laws))
        return tuple(found)

    def kind_of(self, ply: int) -> ImpactSetup:
        """Return the same shot at one ply alone of the fabric and laws of a ply, the first is 0, not
        turned."""
        fabric = self.fabric
        laws = self.laws
        if self.lay_up:
            fabric = self.lay_up[ply].fabric
            laws = self.lay_up[ply].laws
        return replace(self, plies=1, lay_up=(), fabric=fabric, laws=laws)

    @cached_property
    def meshed(self) -> ImpactSetup:
        """The set-up with the mesh that is used, see `mesh`."""
        if self.mesh == self._given_mesh:
            return self
        return replace(self, **vars(self.mesh))

    @property
    def _given_mesh(self):
        return Mesh(self.elements_per_crossover, self.grading)

    @cached_property
    def mesh(self) -> Mesh:
        """The mesh that is used: the given one, or the default, which follows from the failure length.

        As far as anything can come under the projectile an element is at most RESOLVED failure
        lengths long, and no longer than ELEMENT_SIDE of the projectile's radius, with MOST_ELEMENTS
        to a crossover at most. Further out elements are twice as long and longer, up
        to two crossovers. A yarn whose end is not clamped may be drawn under the projectile from
        anywhere: then all elements are alike, unless a block holds the fabric back
        (`keeps_its_middle`).

        Raises
        ------
        InputError : as `panel`
        """
        given = self.grading is not None or self.elements_per_crossover is not None
        if given or self.crossovers is not None:
            return self._given_mesh
        return self._grade()

    @cached_property
    def zone(self) -> YarnZone | None:
        """The zone of resolved yarns with its size; None of pinned yarns."""
        if self.crossovers is None:
            return None
        return self.crossovers.sized(self.plies, float(np.max(self.opening)))

    @property
    def stops_a_bullet(self) -> bool:
        """Whether a pack is struck by a bullet of metal."""
        return self.plies > 1 and self.projectile.body == "metal"

    @property
    def mesh_in_words(self) -> str:
        """How long the elements about the impact point are, how far out they lie, and what they resolve."""
        mesh = self.mesh
        side = 1.0 / (mesh.elements_per_crossover or 1)
        until = inf
        if mesh.grading is not None:
            until, side = mesh.grading[0]
        crossover = max(2 * max(fabric.weave.w) for fabric in self.fabrics)
        longest = crossover * side
        where = "everywhere"
        if until < inf:
            where = f"within {1e3 * crossover * until:.2g} mm of the impact point"
        share = max(
            2 * max(fabric.weave.w) * side / fabric.failure_length for fabric in self.fabrics
        )
        return (
            f"elements of {1e3 * longest:.2g} mm {where}, {share:.2g} of the failure length, "
            f"{longest / self.projectile.radius:.2g} of the projectile's radius"
        )

    @property
    def clamped(self) -> bool:
        """Whether all four edges are clamped."""
        return boundary.is_clamped(self.boundary)

    @property
    def keeps_its_middle(self) -> bool:
        """Whether what is about the impact point stays there, so that elements further out may be
        longer: clamped fabric, and fabric with free edges before a block, which presses it on the
        nose all round. The check "coarse fabric in the nose" looks whether it has stayed."""
        before_block = self.backing is not None and self._hangs_free
        return self.clamped or (before_block and self.impact_point == (0.0, 0.0))

    @property
    def _hangs_free(self):
        """Whether all four edges are free."""
        return all(side == "free" for pair in boundary.sides(self.boundary) for side in pair)

    def _count_elements(self, resolved):
        """Elements per crossover that are at most `resolved` failure lengths long, MOST_ELEMENTS
        at most."""
        lengths = [
            2 * max(fabric.weave.w) / (resolved * fabric.failure_length) for fabric in self.fabrics
        ]
        side = ELEMENT_SIDE * self.projectile.radius
        under_the_nose = [2 * max(fabric.weave.w) / side for fabric, _ in self.materials]
        return min(max(ceil(max(lengths) - 1e-9), *map(ceil, under_the_nose)), MOST_ELEMENTS)

    def graded(self, resolved: float = RESOLVED, longest: int = 2) -> ImpactSetup:
        """Return the set-up with the mesh that follows from the failure length: graded, or uniform
        if fabric may come under the nose from anywhere.

        Parameters
        ----------
        resolved : [failure lengths] length of the elements about the impact point at most
        longest : [crossovers] side of the elements far from it; a power of 2

        Raises
        ------
        InputError : as `panel`
        """
        return replace(self, **vars(self._grade(resolved, longest)))

    def _grade(self, resolved=RESOLVED, longest=2):
        """The Mesh of `graded`."""
        count = self._count_elements(resolved)
        if not self.keeps_its_middle:
            return Mesh(count, self.grading)
        materials = list(self.materials)
        if any(self.is_turned(ply) for ply in range(self.plies)):
            materials += [(rotated_90(of), laws and laws[::-1]) for of, laws in materials]
        # uniform panels with free edges reach over all of their fabric
        fine = Mesh(count, self.grading)
        # the reach does not depend on the values of the table
        tables = [self._plain_table(*of) for of in materials]
        plain = [self._make_panel(table, fine, boundary="clamped") for table in tables]
        needed = 0
        for panel, angle in product(plain, self._oblique_angles | {0.0}):
            turned = at_angle(panel, angle)
            for far, path, step, w in zip(
                turned.reach(), turned.path(), turned.spacing, turned.weave.w
            ):
                # two elements for the two that `reach` has, one for the smooth surface beside them
                needed = max(needed, ceil((far + path - 2 * step) * count / (2 * w)) + 3)
        near = ceil(needed / count)
        side = Fraction(1, count)
        zones = []
        while side < longest:
            zones.append((float(near), float(side)))
            wider = Fraction(3, 2)
            if side >= 1:
                wider = Fraction(2)
            near = ceil(wider * near)
            if side < 1 and side.denominator % 2:
                side = Fraction(1)
            else:
                side = 2 * side
        return Mesh(self.elements_per_crossover, (*zones, (inf, float(longest))))

    @property
    def snapshots(self) -> int:
        """Snapshots of a run to the end time."""
        if not self.snapshot_interval:
            return 0
        return round(self.end_time / self.snapshot_interval)

    @property
    def sample_interval(self) -> float:
        """[s] between samples, which are as frequent as what is recorded."""
        if self.history:
            return min(self.audit_interval, self.history.interval)
        return self.audit_interval

    def cell(self) -> CellModel | SurfaceCell:
        """Return the crossover's cell; of a lay-up, that of its first ply."""
        return self._cell(self.fabric, self.laws)

    def _cell(self, fabric, laws):
        """The cell of a ply of a fabric and laws."""
        if self.surface is not None:
            return SurfaceCell(fabric, self.surface, self.cell_formulation)
        reach = UNFAILING
        if self.yarn_failure:
            reach = 1.0
        if self.rate_dependence and fabric.strain_rate is not None:
            reach = max(reach, *fabric.strain_rate.strength)
            fabric = fabric.at_high_rate()
        if self.length_effect and self.yarn_failure:
            (shortest,) = fabric.length_factors([np.min(self.opening)])
            if shortest > STRONGEST:
                reach *= STRONGER * ceil(shortest / STRONGER)
        return CellModel(
            fabric,
            laws,
            self.crossover_gap,
            self.cell_model,
            self.cell_formulation,
            reach=reach,
            mean_crossing=self.crossovers is not None,
        )

    def table(self, kept: bool = False) -> CellTable:
        """Return the cell's table, which set-ups that differ in panel, shot or mesh alone share
        (`cell.table_cache`).

        Parameters
        ----------
        kept : whether to take it from the user's cache folder, and to keep it there

        Raises
        ------
        InputError : as CellModel, SurfaceCell and CellTable
        """
        return self._share_table(self.cell(), kept)

    def _share_table(self, cell, on_disk=False):
        if isinstance(cell, CellModel):
            return table_cache.share(cell, self.table_size, on_disk=on_disk)
        return cell.table(self.table_size)

    def plain_table(self) -> CellTable:
        """Fill a coarse table, of straight yarns if it is no response surface's: for the geometry
        of a panel alone."""
        return self._plain_table(self.fabric, self.laws)

    def _plain_table(self, fabric, laws):
        """The coarse table of a ply of a fabric and laws."""
        cell = self._cell(fabric, laws)
        if isinstance(cell, SurfaceCell):
            return cell.table(11)
        return CellTable.straight(cell)

    def plain_panels(self) -> list[Panel]:
        """Build one ply of each of `materials`, with coarse tables: for the geometry alone.

        Raises
        ------
        InputError : as `panel`
        """
        return [self._make_panel(self._plain_table(*of)) for of in self.materials]

    def panel(self, table: CellTable | None = None) -> Panel:
        """Build one ply, of several the first, with its own table or one that a like set-up has
        filled.

        Raises
        ------
        InputError : as `table` and Panel
        """
        return self._make_panel(table or self.table())

    def _make_panel(self, table, mesh=None, **changes):
        """One ply with a table, in a Mesh, None of the one that is used, and with `changes` of its fields."""
        if mesh is None:
            mesh = self.mesh
        own: dict[str, Any] = self.of_ply() | {
            "table": table,
            "opening": tuple(np.broadcast_to(self.opening, 2).tolist()),
            "bending": tuple(np.broadcast_to(self.bending, 2).tolist()),
            "elements_per_crossover": mesh.elements_per_crossover or 1,
            "grading": mesh.grading,
            **changes,
        }
        if self.crossovers is not None:
            return YarnPanel(**own, resolved=self.zone)
        return Panel(**own)

    def check_contact_points(self) -> None:
        """Refuse a number of contact points of which the mesh makes more.

        Raises
        ------
        InputError : fewer than two along each element of its own mesh; as `panel`
        """
        given = self.numerics.contact_points
        if given is None:
            return
        panel = self.panel(self.plain_table())
        least = ceil(2 * panel.lines_per_crossover / panel.finest)
        if given < least:
            allowed = f"at least {least}, two along each element under the nose"
            raise InputError(key="contact_points", value=given, allowed=allowed)

    def target(self, table: CellTable | None = None) -> Pack:
        """Build what the projectile strikes, of one ply or several; `table` as in `panel`.

        Raises
        ------
        InputError : as `panel`, Pack and Pack.stacked
        """
        if self.instead is not None:
            raise InputError(key="crossovers", value="auto", allowed="pinned or yarns here")
        others = [self._share_table(self._cell(*of)) for of in self.materials[1:]]
        pack = self._pack([self.panel(table), *map(self._make_panel, others)])
        if self.strength is None:
            return pack
        return with_strengths(pack, self.strength)

    def plain_target(self) -> Pack:
        """Build what the projectile strikes as `plain_panels` does: no table is filled.

        Raises
        ------
        InputError : as `target`
        """
        return self._pack(self.plain_panels())

    def _pack(self, panels):
        """Return the plies, of `panels` of each of `materials`, with yarns that are all alike."""
        pack = self._stack(panels)
        if self.crossovers is not None and self.plies > 1:
            pack = replace(pack, plies=lie_anywhere(pack.plies, self.crossovers.seed))
        return pack

    def _stack(self, panels):
        """Return the plies, each behind the other."""
        if self.lay_up:
            numbers = [self.materials.index((ply.fabric, ply.laws)) for ply in self.lay_up]
            return Pack.laid_up(
                [(panels[number], ply.angle) for number, ply in zip(numbers, self.lay_up)],
                gaps=[ply.gap for ply in self.lay_up[:-1]],
                contact=self.contact,
                friction=self.ply_friction,
            )
        return Pack.stacked(
            panels[0],
            self.plies,
            stacking=self.stacking,
            gap=self.ply_gap,
            contact=self.contact,
            friction=self.ply_friction,
        )
