"""Numerical parameters of a panel: time step, viscosity, contact, threads."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Annotated, Any

from fabrics.base.fields import check_fields, finite
from fabrics.base.frozen import explain_frozen
from fabrics.base.schema import described, key, number, whole


@dataclass(frozen=True, kw_only=True)
class NumericsKeys:
    """Numerical parameters that are keys of the table [numerics]; as in `PanelNumbers` a line says all
    of one. The contact of the nose with the membrane is that of pinned crossovers."""

    cfl: Annotated[
        float,
        key(
            number("time step over its stability bound (Courant factor)", 0.5, gt=0.0, le=1.0),
            "pinned yarns pack",
        ),
    ] = 0.9
    stretch_viscosity: Annotated[
        float,
        key(
            number("damping ratio of the highest mode along a yarn", 0.2, ge=0.0, le=1.0),
            "pinned yarns pack",
        ),
    ] = 0.1
    nose_stiffness: Annotated[
        float,
        key(
            number(
                "stiffness of the contact between projectile and fabric over that of half a ply of solid fibre, to "
                "see what depends on it",
                2.0,
                gt=0.0,
            ),
            "pinned pack",
        ),
    ] = 1.0
    contact_damping: Annotated[
        float,
        key(
            number("damping ratio of the contact between projectile and fabric", 0.6, ge=0.0),
            "pinned pack",
        ),
    ] = 0.5
    contact_points: Annotated[
        int | None,
        key(
            whole(
                "contact points along each side of a crossover, at least two along that of an element, of which "
                "they are made a whole number; if not given 8, and more under a sharp nose",
                1,
                64,
                16,
            ),
            "pinned pack",
        ),
    ] = None
    erosion_gap: Annotated[
        float,
        key(
            number(
                "length, over that at rest, at which an element whose yarns of one family have failed is eroded: it "
                "leaves the contact with projectile, plies and block, with its mass; one without yarns does so at once",
                2.0,
                gt=1.0,
            ),
            "pinned pack",
        ),
    ] = 3.0
    threads: Annotated[
        int | None,
        key(
            Annotated[
                int | None,
                described(
                    "threads that share the plies of a pack, at most one for each ply, and the bricks of a block. If "
                    "not given, chosen by the size of the model. Results do not depend on it",
                    "a number of threads",
                    example=1,
                    ge=1,
                ),
            ],
            "pinned yarns pack",
        ),
    ] = None


@explain_frozen
@dataclass(frozen=True)
class Numerics(NumericsKeys):
    """Numerical parameters, set by stability and convergence (docs/reports/numerics.md), none by an
    outcome.

    Parameters
    ----------
    cfl : Courant factor, the time step over its stability bound; 0.9 leaves room for shear
        stiffening in distorted elements. Where yarns snap taut a step loses energy, with its
        square, whatever the mesh, since a snap is a few elements wide; the loss stays in the energy
        error
    stretch_viscosity : damping ratio of the highest mode along a straight yarn, which costs as much
        of the time step. Without it crimped yarns that snap taut ring. In a yarn that stiffens as
        its crimp goes, fronts are shocks, which dissipate whatever the viscosity
    nose_stiffness : of the contact with the projectile over that of half a ply of solid fibre
        (`fabrics.ply_laws.half_a_ply`), which does not depend on mesh, step or number of plies
    contact_damping : ratio to critical of that mass on that spring
    contact_points : along each side of a crossover, and at least 2 along that of an element (see
        `contact_kernels`). None takes 8, and more under a sharp nose: as many as put them
        panel_arrays.SPACING nose radii apart, at most panel_arrays.MOST_POINTS along an element.
        Points further apart miss the edge: it acts as a rounder or a sharper one, as it lies among
        them
    erosion_gap : length over that at rest at which the gap left by failed yarns of one family takes
        its element out of contact (thesis section 4.3.3): two neighbours' worth
    clear_time : [s] with next to no push and with nothing ahead, after which the panel counts as
        perforated
    block : elements worked on together, six rows at least: more share the cost of a block and of
        the rows about it, fewer keep its scratch in cache
    threads : that share the plies of a pack, at most one a ply, and the bricks of a block. None
        takes all that the process may use where it pays (`barrier`), and goes on with one for the
        plies where other processes use the processor (`loop.driver`). No result depends on it
    """

    clear_time: Annotated[float, finite(gt=0.0)] = 2e-6
    block: Annotated[int, finite(gt=0.0)] = 2000

    @property
    def settings(self) -> dict[str, Any]:
        """{name: value} of all."""
        return {entry.name: getattr(self, entry.name) for entry in fields(self)}

    def __post_init__(self):
        check_fields(self)
