"""Every key of the result files of impacts and coupons, from which docs/reference/input.md is made.

One convention: name_unit in summary.json and in attributes; a dataset has the attribute "unit". `*` stands for a number
or a name that the run gives.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple


class Key(NamedTuple):
    """A key of a result file, with its unit ("1": a number without) and its meaning."""

    name: str
    unit: str
    meaning: str


def keys(*rows: tuple[str, str, str]) -> tuple[Key, ...]:
    """Keys from rows (name, unit, meaning)."""
    return tuple(Key(*row) for row in rows)


ENERGIES = keys(
    ("kinetic_fabric", "J", "kinetic energy of the fabric"),
    ("kinetic_projectile", "J", "kinetic energy of the projectile"),
    ("elastic_projectile", "J", "elastic energy of an elastic projectile"),
    ("plastic_projectile", "J", "plastic work in an elastic projectile"),
    ("yarn_strain", "J", "strain energy of the yarns, from their stretches"),
    ("formulation_residual", "J", "equilibrium form: work of the cell's forces less what the yarns store; else 0"),
    ("shear", "J", "trellis shear"),
    ("bending", "J", "bending of the yarns"),
    ("jamming", "J", "jamming of bunched yarns"),
    ("viscous", "J", "dissipated by stretch viscosity"),
    ("contact", "J", "penalty springs and damping of the contact with the projectile"),
    ("friction", "J", "friction between projectile and fabric"),
    ("failure_dissipation", "J", "lost at the failure of yarns"),
    ("clamp_friction", "J", "friction of yarns that slip in the clamps"),
    ("boundary_work", "J", "work of prescribed pull-ins, negative where done on the fabric"),
    ("backing_*", "J", "parts of the backing block: kinetic, elastic, plastic, eroded, absorbed, viscous, hourglass, "
     "contact, damped"),
    ("ply_contact", "J", "contact between plies"),
    ("ply_friction", "J", "friction between plies"),
    ("crossover_friction", "J", "sliding crossovers: friction of yarns at the crossovers and in gripping clamps"),
    ("crossover_stops", "J", "sliding crossovers: fluxes ended where a segment between touching yarns gives no more"),
    ("slip_residual", "J", "sliding crossovers: left by the iteration of the two fluxes of a node"),
    ("error", "J", "sum of all entries less the energy at the start"),
)  # fmt: skip
SHARED = keys(
    ("format", "", "format of the file"),
    ("title", "", "title of the input file"),
    ("fabric", "", "name of the fabric"),
    ("law_name", "", "origin of the compression law"),
    ("outcome", "", 'impacts: "stopped", "perforated", "in flight", "unstable"; coupons: "complete", '
     '"yarn at its strength", "unstable"'),
    ("failure_message", "", "why an unstable run was ended; empty for others"),
    ("wall_time_s", "s", "wall time of the run"),
    ("elements", "1", "number of elements"),
    ("steps", "1", "number of time steps; of a coupon, of load steps"),
    ("checks.status", "", '"ok", "noted" or "doubtful"'),
    ("checks.indicators", "", "quality indicators: name, value, limit, note (noted above it), status"),
    ("run_key", "", "digest of the input and the code: `--resume` computes nothing where it is the same"),
    ("assumed_range.*", "", "residual or critical velocity over the ranges of assumed laws: low_m_s, high_m_s, runs"),
    ("provenance.*", "", "versions, commit, date, machine, threads, text of the input file, assumed tables, notes, "
     "digest, unit and edge radius of an STL file"),
)  # fmt: skip
PACK = keys(
    ("stacking", "", 'pack: "aligned", "alternating" or "lay-up"'),
    ("ply_fabrics", "", "pack: name of the fabric of each ply"),
    ("ply_angles_deg", "", "pack: angle of each ply's warp, above -90 and at most 90"),
    ("ply_contact_source", "", "pack: where the contact law of plies comes from"),
    ("ply_contact_status", "", "pack: its status, such as computed, fitted or assumed"),
    ("ply_contact_travel_m", "m", "pack: its closure before solid fibre is pressed"),
    ("ply_gap_low_m", "m", "pack: low end of the range of an assumed gap; the gap itself where it is given"),
    ("ply_gap_high_m", "m", "pack: high end of that range"),
    ("ply_gap_source", "", "pack: where the gap comes from"),
)
FAILURE = keys(
    ("tension_at_failure_over_strength", "1", "rate_dependence: tension of the segments that have failed "
     "over the strength of their yarn, mean; null without failures"),
)  # fmt: skip
IMPACT = keys(
    ("strike_velocity_m_s", "m/s", "strike velocity along the line of flight"),
    ("residual_velocity_m_s", "m/s", "velocity at the end along the normal; 0 of a projectile that has stopped"),
    ("projectile", "", "the projectile in words, with its name where it has one"),
    ("projectile_mass_kg", "kg", "mass of the projectile"),
    ("mirror_x", "", "whether the panel of the file continues mirrored at x = 0"),
    ("mirror_y", "", "whether the panel of the file continues mirrored at y = 0"),
    ("element_step_time_ns", "ns", "wall time for an element and a step"),
    ("end_time_s", "s", "time at the end of the run"),
    ("stop_time_s", "s", "time at which the projectile stopped; null if it did not"),
    ("max_deflection_m", "m", "largest deflection of the back face: of the history `deflection`"),
    ("peak_contact_force_N", "N", "highest value of the history `contact_force`"),
    *(row for family in ("warp", "weft") for row in (
        (f"peak_tension_{family}_N", "N", f"peak tension of a {family} yarn, mean over a segment between crossovers"),
        (f"peak_tension_{family}_over_strength", "1", "the same over the strength"),
        (f"peak_tension_{family}_time_s", "s", "its time"),
        (f"peak_tension_{family}_place_m", "m", "middle of the segment at rest: along warp, along weft, from the "
         "impact point"),
        (f"peak_tension_{family}_ply", "1", "its ply, the first is 1"))),
    ("plies", "1", "number of plies"),
    ("failed_yarn_segments", "1", "failed segments of yarns of all plies"),
    ("ply_failed_yarn_segments", "1", "the same of each ply"),
    ("ply_peak_tension_over_strength", "1", "highest tension over strength in each ply"),
    ("ply_energies_J", "J", "energy at the end that each ply moves with, stores and has lost"),
    ("strike_energy_J", "J", "kinetic energy of the projectile at the start"),
    ("absorbed_energy_J", "J", "kinetic energy that the projectile has lost"),
    ("energy_error_max", "1", "largest error of the energy balance over the strike energy"),
    ("viscous_energy_fraction", "1", "viscous energy at the end over the energy absorbed"),
    ("energies_at_end_J.*", "J", "energies of the balance at the end, by name"),
    ("rigid_check", "", "whether a rigid projectile is justified, in words"),
    ("plastic_shortening_m", "m", "elastic projectile: shortening by plastic strain"),
    ("bar_period_s", "s", "elastic projectile: period of the first axial mode"),
    ("crater_depth_m", "m", "backing: depth of the crater"),
    ("back_face_signature_mm", "mm", "backing: depth of the deepest point of its face at the end"),
    ("dent_volume_m3", "m3", "backing: volume of the dent below the face at rest, at the end"),
    ("crater_wall_angle_rad", "rad", "backing: angle of the crater's wall to the face"),
    ("pulled_out_length_m", "m", "sliding crossovers: longest length of yarn that has passed through a crossover"),
    ("largest_window_m", "m", "sliding crossovers: widest distance between neighbouring yarns of a ply at the end"),
    ("pulled_out_segments", "1", "sliding crossovers: segments whose yarn has left a crossover without failure"),
    ("crossover_friction_work_J", "J", "sliding crossovers: work of friction"),
    *FAILURE,
    *PACK,
    ("ply_gap_m", "m", "pack: gap between the first two plies at rest"),
    ("max_penetration_ratio", "1", "pack: deepest penetration of a ply into the next, over the thickness"),
    ("torn_corrections", "1", "pack: impulses that kept torn fabric from passing through another ply"),
    ("torn_unresolved", "1", "pack: how often torn fabric came through another ply all the same"),
    ("accuracy.targets", "1", "targets of [accuracy]: {quantity: error at most}"),
    ("accuracy.model", "", "the mesh of the results, in words"),
    ("accuracy.symmetry", "", "its part of the panel"),
    ("accuracy.compared_with", "", "the coarser mesh that it was compared with"),
    ("accuracy.estimated_errors", "1", "uncertainty of each result with a target; null if not known"),
    ("accuracy.projectile", "", '"rigid" or "elastic_bar"'),
    ("accuracy.confirmed", "", "whether the estimated errors meet the targets"),
    ("accuracy.models_run", "", "meshes that were run, in order"),
    ("discretisation.meshes", "", "with --uncertainty: the mesh of the input file and the finer one, in words; with "
     "[accuracy] all that were run"),
    ("discretisation.outcomes", "", "outcome on each of these meshes"),
    ("discretisation.results", "", "of each result its unit, its value on the last two meshes and its uncertainty"),
)  # fmt: skip
COUPON = keys(
    ("test", "", "name of the test"),
    ("crossings", "1", "pull-out: crossovers that the yarn is pulled through"),
    ("velocity_m_s", "m/s", "pull-out: velocity of the crosshead"),
    ("pre_tension_N", "N", "pull-out: tension of the crossing yarns before the pull"),
    ("crossover_friction", "1", "pull-out: Coulomb coefficient of yarn on yarn"),
    ("crossover_cohesion_N", "N", "pull-out: friction of a crossover without contact force"),
    ("yarn_bending_N_m2", "N m^2", "pull-out: bending stiffness of the yarns in the contact force of the threshold"),
    ("displacement_m", "m", "pull-out: displacement of the crosshead at the end"),
    ("peak_load_N", "N", "pull-out: highest load on the yarn"),
    ("plateau_load_N", "N", "pull-out: mean load while all crossovers slide; null where they never all do"),
    ("slip_length_m", "m", "pull-out: length of yarn that slides at the peak load"),
    ("crossovers_left", "1", "pull-out: crossovers that the end of the yarn has left"),
    ("crossover_friction_work_J", "J", "pull-out: work of friction at the crossovers"),
    ("energy_error_max", "1", "pull-out: largest error of the energy balance over the work of the crosshead"),
    ("prescribed_name", "", "name of the prescribed quantity"),
    ("prescribed_unit", "", "its unit"),
    ("iterations", "1", "iterations of dynamic relaxation, all load steps"),
    ("residual_max", "1", "largest residual of a load step: out-of-balance force over the reaction"),
    ("at_end.*.value", "", "measures of the last load step, by name"),
    ("at_end.*.unit", "", "their units"),
)
CRITICAL_VELOCITY = keys(
    ("plies", "1", "number of plies"),
    ("projectile", "", "the projectile in words"),
    ("critical_velocity_m_s", "m/s", "middle of the bracket; null where there is no single limit"),
    ("bracket_m_s", "m/s", "stop and perforation between which the bisection ended"),
    ("single_limit", "", "whether no shot stopped that was faster than one that perforated"),
    ("highest_stop_m_s", "m/s", "strike velocity of the fastest shot that stopped"),
    ("lowest_perforation_m_s", "m/s", "strike velocity of the slowest shot that perforated"),
    ("mixed_zone_m_s", "m/s", "lowest perforation and highest stop; null where there is a single limit"),
    ("scan.above", "1", "range above the highest stop that was scanned, over that velocity; 0 without a scan"),
    ("scan.below", "1", "range below the lowest perforation that was scanned, over that velocity; 0 without a scan"),
    ("scan.step", "1", "between shots of the scan, over the upper end of the bracket"),
    (
        "lambert_jonas.*",
        "",
        "parameters of the fit of residual velocities, intervals of 95 %; null without a fit",
    ),
    ("shots.strike_velocity_m_s", "m/s", "strike velocity of a shot; `shots` is a list"),
    ("shots.residual_velocity_m_s", "m/s", "residual velocity, 0 of a projectile that stops"),
    ("shots.outcome", "", '"stopped" or "perforated"'),
    ("shots.end_time_s", "s", "time from strike to stop or perforation"),
    ("shots.failed_yarn_segments", "1", "failed segments of yarns of the whole panel"),
    ("shots.peak_tension_N", "N", "peak tension of warp and weft"),
    ("shots.energy_error_max", "1", "largest error of the energy balance over the strike energy"),
    ("shots.wall_time_s", "s", "wall time of the shot"),
    ("bracket_checks", "", '"ok", or which end of bracket or mixed zone is a doubtful shot, and why'),
    ("shots.checks", "", '"ok", "noted" or "doubtful"'),
)
SHAPE = keys(
    ("time", "s", "time"),
    ("nose_position", "m", "foremost point of the projectile, along z"),
    ("projectile_position", "m", "position of the nose"),
    ("nodes", "m", "positions of the nodes"),
    ("tension", "N", "tension of each element's warp and weft"),
    ("failed", "1", "warp failed, weft failed, element eroded"),
    ("pressure", "Pa", "contact pressure on each node: from the projectile; in a pack or before a block also from "
     "the ply in front and from the ply or block behind; in a pack also from the constraint of torn fabric"),
    ("area", "m^2", "area of each node at rest"),
    ("failed_segments", "1", "failed segments of warp and weft that begin at each node, of the modelled part"),
    ("slip", "m", "sliding crossovers: length of warp and weft that has passed through each node"),
)  # fmt: skip
HISTORIES = keys(
    ("time", "s", "times of the energy audits"),
    ("velocity", "m/s", "velocity of the projectile along the normal"),
    ("nose_position", "m", "foremost point of the projectile"),
    ("contact_force", "N", "force on the projectile along the normal, against its flight, from plies and block: "
     "the mean since the time before, so that force times interval is the loss of momentum"),
    ("deflection", "m", "largest displacement along the normal, of the last ply (back face), as far as it is "
     "connected to the edges"),
    ("failed_segments", "1", "failed segments of yarns"),
)  # fmt: skip
BAR = keys(
    ("time", "s", "time"),
    *((f"{part}", "m", f"displacement of the {words}") for part, words in (
        ("tip", "tip"), ("tail", "tail"), ("centre", "centre of mass"))),
    *((f"{part}_velocity", "m/s", f"velocity of the {words}") for part, words in (
        ("tip", "tip"), ("tail", "tail"), ("centre", "centre of mass"))),
)  # fmt: skip
BACKING = keys(
    ("crater", "m", "radius and depth of the crater along the warp"),
    ("crater_weft", "m", "the same along the weft"),
    ("depth_map", "m", "x, y and depth of the nodes of its face, by rows along x: the shape of the dent"),
    ("nodes", "m", "nodes of the part that is modelled"),
    ("bricks", "1", "node numbers of its bricks"),
    ("plastic", "1", "effective plastic strain"),
    ("eroded", "1", "whether a brick is eroded"),
)
PLY_HISTORIES = keys(
    ("failed_yarns", "1", "failed segments of yarns"),
    ("reaction_warp", "N", "tension at the boundary of the warp nearest the impact point"),
    ("reaction_weft", "N", "the same of the weft"),
    ("push", "N", "force of the nose on the ply"),
    ("deflection", "m", "largest displacement along the normal, of fabric connected to the edges"),
    ("energy", "J", "energy that the ply moves with, stores and has lost"),
    ("peak_warp", "N", "highest tension of its warp so far, mean over a segment between crossovers"),
    ("peak_weft", "N", "the same of its weft"),
    ("pull_in", "m", "edges that slip: largest way of a yarn's end out of its clamp"),
    ("slip", "m", "sliding crossovers: longest piece of yarn that has passed through one"),
)
PLIES = keys(
    ("z_rest", "m", "middle surface of each ply at rest"),
    ("thickness", "m", "thickness of each ply"),
    ("gaps", "m", "gaps between neighbouring plies at rest"),
    ("strength", "N", "strength of each ply's warp and weft"),
    ("peak_tension", "N", "peak tension of each ply's warp and weft"),
    ("peak_tension_time", "s", "their times"),
    ("peak_tension_place", "m", "their places at rest: along warp, along weft, from the impact point"),
    ("max_penetration_ratio", "1", "deepest penetration into the next ply, over the thickness"),
    ("torn_contact", "1", "torn_corrections and torn_unresolved, see summary.json"),
)
YARN_DATA = keys(
    ("family", "", "warp or weft"),
    ("offset", "", "[m] distance from the impact point, across the family"),
    ("EA", "", "[N] stiffness"),
    ("strength", "", "[N]"),
    ("crimp", "", "[-]"),
)
YARN = keys(
    ("X", "m", "middles of the elements at rest, from the impact point"),
    ("tension", "N", "tension"),
    ("position", "m", "positions of the nodes along the family"),
    ("deflection", "m", "deflection of the nodes"),
)
COUPON_MESH = keys(
    ("points", "m", "nodes at rest"),
    ("quads", "1", "node numbers of the elements"),
    ("warp", "1", "node numbers of the warp's edges"),
    ("weft", "1", "node numbers of the weft's edges"),
    ("grips", "1", "grip of each node, 0: none"),
)


def _under(group, keys):
    return tuple(Key(f"{group}/{key.name}", *key[1:]) for key in keys)


MEASURED = (
    *keys(("time", "s", "times of the samples of [history]")),
    *_under("yarns/*", YARN),
    *keys(
        ("yarns/*/strain", "1", "strain of the fibres"),
        ("edges/*", "N", "in-plane and normal reaction of an edge of the panel"),
        ("fronts/*/time", "s", "arrival times of a wave front"),
        ("fronts/*/position", "m", "where it arrived"),
    ),
)
MEASURED_ATTRIBUTES = (
    *_under("yarns/*", YARN_DATA),
    *keys(
        ("fronts/*/speed", "", "[m/s] speed of a wave front in the fabric"),
        ("fronts/*/interval", "", "[m/s] its interval of 95 %"),
        ("fronts/*/start", "", "[s] start of the fitted line"),
    ),
)
DATASETS = (
    *_under("histories", HISTORIES),
    *_under("energies", ENERGIES),
    *_under("plies", PLIES),
    *_under("plies/histories", PLY_HISTORIES),
    *keys(("projectile", "m", "surface of the projectile about its nose")),
    *_under("half_energy/*", SHAPE),
    *_under("final/*", SHAPE),
    *_under("measured/*", MEASURED),
    *_under("bar", BAR),
    *_under("backing", BACKING),
    *keys(
        ("quads/*", "1", "node numbers of a ply's elements"),
        ("cuts/*/time", "s", "time of a section through the impact point"),
        ("cuts/*/nose_position", "m", "foremost point of the projectile"),
        ("cuts/*/lines/*", "m", "x and z of a ply's middle surface, NaN where its yarn has failed"),
    ),
)
COUPON_DATASETS = (
    *keys(
        ("histories/energy of the *", "J", "strain energy of yarns, of trellis shear"),
        ("histories/time", "s", "pull-out: time"),
        ("histories/displacement of the crosshead", "m", "pull-out: displacement of the crosshead"),
        ("histories/load", "N", "load; of a pull-out, on the pulled yarn"),
        ("histories/crossovers in slip", "1", "pull-out: crossovers that the yarn slides through"),
        ("histories/crossovers left", "1", "pull-out: crossovers that the end of the yarn has left"),
        ("histories/work of friction", "J", "pull-out: work of friction at the crossovers"),
        ("histories/residual", "1", "out-of-balance force over the reaction"),
        ("histories/iterations", "1", "iterations of dynamic relaxation"),
        ("histories/*", "", "the prescribed quantity and the measures of the test, by name"),
    ),
    *_under("coupon", COUPON_MESH),
    *keys(
        ("states/x", "m", "nodes after every load step"),
        ("states/shear", "rad", "shear angles of the elements after every load step"),
        ("final/tension_*", "N", "tension of each family's edges at the end"),
        ("relaxation", "N", "out-of-balance force and reaction of every iteration"),
    ),
)
ATTRIBUTES = (
    *keys(
        ("checks", "", "quality indicators as JSON"),
        ("pack", "", "what is stacked, as JSON; empty of one ply"),
        ("failure", "", "what the strength came to at failures, as JSON; empty where it is constant"),
    ),
    *_under("measured/*", MEASURED_ATTRIBUTES),
    *keys(
        ("bar/period", "", "[s] period of the first axial mode"),
        ("bar/shortening", "", "[m] shortening by plastic strain"),
        ("backing/face", "", "[m] position of the block's face at rest"),
        ("backing/share", "", "[-] part of the block that is modelled"),
        ("slip/*/pulled_out_length", "", "[m] longest length of yarn that has passed through a crossover"),
        ("slip/*/largest_window", "", "[m] widest distance between neighbouring yarns at the end"),
        ("slip/*/pulled_out_segments", "", "segments whose yarn has left a crossover without failure"),
        ("slip/*/friction_work", "", "[J] work of friction at the crossovers"),
    ),
)
SUMMARY_FORMAT = "weavecell summary 2"


def units(table: Iterable[Key]) -> dict[str, str]:
    """{name: unit} of keys."""
    return {key.name: key.unit for key in table}
