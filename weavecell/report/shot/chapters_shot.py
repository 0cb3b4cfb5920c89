"""The chapters of a report that every impact has, on one ply or on a pack: outcome, pictures, results, assumptions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from weavecell.report import pictures, pictures3d
from weavecell.report.page import Card, Figure, Section, Table
from weavecell.report.shot import pictures_pack, pictures_shot
from weavecell.report.shot.tables_shot import percent, ply_table, residual, results
from weavecell.results import vtk

if TYPE_CHECKING:
    from shellfabric.impact.simulation import ImpactSetup
    from weavecell.results.impact import ImpactRecord
    from weavecell.results.impact_shapes import Cut

CLOSE_UP = 0.014  # [m] half the width of the close-up: five radii of the RCC projectile
_HALF_HEIGHT = 0.6 * CLOSE_UP  # [m] of its picture
_SCALE_BAR = 5e-3  # [m]
_STEP = 0.1  # [-] of the strength: the scale of tensions ends at a multiple of it


def outcome(record: ImpactRecord) -> str:
    """The result of an impact in one line."""
    strike, end = f"{record.strike_velocity:g} m/s", f"{1e6 * record.time[-1]:.0f} µs"
    if record.outcome == "unstable":
        return f"UNSTABLE at {strike}: the run was ended after {end} and has no result ({record.failure_message})."
    words = {
        "stopped": f"Stopped: PARTIAL PENETRATION, {strike}",
        "perforated": f"Perforated: COMPLETE PENETRATION, {strike}, {residual(record)}",
        "in flight": f"Not decided: {strike}, still moving with {record.residual_velocity:.1f} m/s at the end, {end}",
    }[record.outcome]
    found = [words]
    if record.outcome != "perforated":
        found.append(f"back-face deflection {1e3 * record.max_deflection:.1f} mm")
    found.append(_load(record))
    doubtful = [one.name for one in record.checks if not one.ok]
    return ", ".join(found) + (f". DOUBTFUL: {', '.join(doubtful)}." if doubtful else ".")


def _load(record):
    """How many yarn segments have failed, or how near to the strength the tension came."""
    count = int(record.failed_segments[-1])
    if count:
        return f"{count} failed yarn segments"
    family, peak = max(record.peaks.items(), key=lambda item: item[1].share)
    return f"peak tension {percent(peak.share)} of the strength ({family})"


def card(record: ImpactRecord) -> Card:
    """What one impact came to."""
    names = {"in flight": "still moving"}
    tone = record.outcome if record.outcome in ("stopped", "perforated", "unstable") else "plain"
    lines = (
        residual(record),
        f"back-face deflection {1e3 * record.max_deflection:.1f} mm",
        f"contact force up to {1e-3 * record.contact_force.max():.2g} kN",
        _load(record),
    )
    return Card(record.title, names.get(record.outcome, record.outcome), lines, tone)


def chapter(records: Sequence[ImpactRecord]) -> Section:
    """Histories, cuts, pictures, energies and results of one impact or of several to be compared."""
    one = len(records) == 1
    figures = [_histories(records), _cuts(records), _panels(records), _energies(records), _edges(records)]
    tables = [results(records)]
    if one and _several_plies(records):
        figures += _of_plies(records[0])
        tables.append(ply_table(records[0]))
    return Section("impact", "Impact" if one else "Impacts", "", tuple(figures), tuple(tables))


def _several_plies(records):
    return records[0].count > 1


def _histories(records):
    """Velocity, deflection and contact force."""
    ply = "last ply" if _several_plies(records) else "ply"
    found = {
        record.title: (record.time, record.velocity, record.deflection, record.nose_position, record.contact_force)
        for record in records
    }
    interval = 1e6 * float(np.median(np.diff(records[0].time)))
    caption = (
        f"Velocity of the projectile; back-face deflection, the largest displacement of the {ply} along the normal; "
        f"contact force on the projectile, mean over {interval:.2g} µs."
    )
    return Figure(pictures.render(pictures_shot.histories, found), "svg", caption, "histories")


def _cuts(records):
    """Cuts through the fabric."""
    caption = (
        "The fabric cut open along x through the impact point, with the projectile (grey). Left: the whole width, "
        "heights stretched. Right: to scale, the fabric as thick as it is; gaps are failed yarns."
    )
    if _several_plies(records):
        caption += " Plies are dark at the front and light at the rear."
    return Figure(pictures.render(pictures_shot.cuts, _cut_views(records), CLOSE_UP), "svg", caption, "cuts")


def _energies(records):
    """Energies over time, and the energy error."""
    runs = {
        record.title: (record.time, parts(record.energies), record.strike_energy, record.energies["error"])
        for record in records
    }
    caption = (
        "Energy of projectile and fabric; dotted: the strike energy. Below, the error of the energy balance in % of "
        "the strike energy (green band: 1 %)."
    )
    picture = pictures.render(pictures_shot.energies, runs)
    return Figure(picture, "svg", caption, "energies", wide=len(records) > 1)


def _edges(records):
    """Tensions at the edges."""
    tensions = [[record.plies[f"reaction_{name}"].sum(axis=1) for name in ("warp", "weft")] for record in records]
    runs = {record.title: (record.time, *both) for record, both in zip(records, tensions)}
    caption = "Tension at the edge of the panel, of the warp and the weft yarn through the impact point"
    caption += ", summed over the plies." if _several_plies(records) else "."
    picture = pictures.render(pictures.reactions, runs)
    return Figure(picture, "svg", caption, "reactions", wide=len(records) > 1)


def parts(energies: Mapping[str, Any]) -> dict[str, Any]:
    """Energies that add up, as drawn: membrane with the work that no yarn stores; all contacts, all friction."""
    found = dict(energies)
    found["yarn_strain"] = energies["yarn_strain"] + energies.get("formulation_residual", 0.0)
    for name in ("contact", "friction"):
        found[name] = energies.get(name, 0.0) + energies.get(f"ply_{name}", 0.0) + 0 * found["yarn_strain"]
    return found


def cut_view(record: ImpactRecord, cut: Cut, title: str) -> pictures_shot.CutView:
    """What `pictures_shot.cuts` draws of a cut of a record."""
    outline = pictures_shot.outline(record.projectile)
    outline[:, 0] += record.nose_place(cut.t)[0]
    return pictures_shot.CutView(title, cut, record.thickness, record.mirror_x, outline)


def _cut_views(records):
    """Three instants of one record, the end of each of several."""
    chosen = []
    for record in records:
        cuts, end = record.cuts, record.cuts[-1].t
        found = (
            [min(cuts, key=lambda cut, at=at: abs(cut.t - at * end)) for at in (0.2, 0.5)] if len(records) == 1 else []
        )
        title = "" if len(records) == 1 else f"{record.title}, "
        for cut in dict.fromkeys((*(cut.t for cut in found), cuts[-1].t)):
            this = next(one for one in cuts if one.t == cut)
            chosen.append(cut_view(record, this, f"{title}{1e6 * cut:.0f} µs"))
    return chosen


def _panels(records):
    """The back face of the last ply and the impact point, all under one scale of tension that ends at the highest."""
    top = max(float(np.max(shape.tension / record.strength[-1])) for record in records for shape in record.rear)
    top = min(1.0, max(_STEP, _STEP * np.ceil(top / _STEP)))
    images = {}
    for record in records:
        views = []
        for shape, close in zip(record.rear, (False, True)):
            body, grid = shape.projectile_position + record.projectile, vtk.panel([shape], record.quads[-1:])
            what = grid, record.strength[-1], body, (record.mirror_x, record.mirror_y)
            if close:
                centre = (*pictures3d.tip(body)[:2], grid.bounds.z_max)
                image = pictures3d.panel(*what, _HALF_HEIGHT, centre, top_share=top, open_quarter=True)
            else:
                half_height = 0.48 * pictures3d.width(shape.nodes, record.mirror_x)
                image = pictures3d.cropped(pictures3d.panel(*what, half_height, top_share=top))
            views.append((f"at {1e6 * shape.t:.0f} µs", image))
        images[record.title] = tuple(views)
    bar = _SCALE_BAR * pictures3d.SIZE[1] / (2 * _HALF_HEIGHT)
    several = _several_plies(records)
    caption = (
        f"The {'last ply' if several else 'ply'} seen from behind, to scale; the colours end at the highest tension of "
        "the pictures, rounded up. Left: the whole panel, at the snapshot at which half of the absorbed energy was "
        "absorbed. Right: the impact point at the end of the run, the quarter in front left out to show the projectile."
    )
    return Figure(pictures.render(pictures.panels, images, top, bar, kind="png"), "png", caption, "panel")


def _of_plies(record):
    """Figures of what each ply of a pack bears."""
    plies = record.plies
    both = zip((plies["peak_warp"], plies["peak_weft"]), record.strength.T)
    tension = np.max([column / strength for column, strength in both], axis=0)
    return [
        Figure(
            pictures.render(
                pictures_pack.shares, record.peak_tension / record.strength, plies["failed_yarns"][-1],
                plies["energy"][-1],
            ), "svg",
            "What each ply bears. The energy of a ply is its kinetic and stored energy and what it has dissipated.",
            "plies",
        ),
        Figure(
            pictures.render(pictures_pack.pushes, record.time, plies["push"], plies["deflection"], tension), "svg",
            "Contact force of the projectile on the plies that it touches, at single steps; deflection of each ply "
            "from its own plane; highest tension of its warp or weft so far, over the strength.", "pushes",
        ),
    ]  # fmt: skip


def assumptions(setup: ImpactSetup, lines: Sequence[str], *, body: str = "") -> Section:
    """What the model assumes in this run.

    Parameters
    ----------
    setup : as it was run
    lines : that name the laws that are assumed (`fabrics.assumed.lines`)
    body : whether a rigid projectile is justified, in words
    """
    each = [(one.name, " / ".join(f"{yarn.strength:.0f}" for yarn in one.weave.yarns)) for one in setup.fabrics]
    strength = ", ".join(f"{words} N ({name}, warp / weft)" for name, words in each)
    if setup.crossovers is None:
        pinned = "Warp and weft are pinned to each other at every crossover: no slip, pull-out or opening of the weave."
        pinned += " In the one pair of tests at hand (S-726) the computed limit is too high."
    else:
        pinned = f"Yarns slide through their crossovers, coefficient of friction {setup.crossovers.mu:g}."
        pinned += "".join(f" {note[0].upper()}{note[1:]}." for note in setup.notes)
    fails = f"A yarn fails at its strength, {strength}, the same for all yarns and at any strain rate."
    shot, between = setup.projectile, setup.ply_friction
    rows = [
        ("crossovers", pinned),
        ("failure of yarns", fails if setup.failure else "Yarns do not fail."),
        ("strain rate", "Stiffness and strength of the yarns do not depend on it."),
        ("projectile", ("Rigid." if shot.body == "rigid" else "Elastic-plastic along its axis.")
         + (f" {body[0].upper()}{body[1:]}." if body else "")
         + (f" Friction on the fabric {shot.friction:g}." if shot.friction else " No friction on the fabric.")),
        *((("between plies", f"Friction {between:g}." if between else "No friction."),) if setup.plies > 1 else ()),
        *(("assumed law", line) for line in lines),
    ]  # fmt: skip
    return Section("assumptions", "Assumptions", tables=(Table(("of", "in this run"), tuple(rows)),))
