"""The chapters of the report of an impact, on one ply or on a pack: outcome, pictures, tables,
mesh, assumptions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from fabrics.base.checks import FloatArray
from fabrics.base.counted import counted
from fabrics.base.door import option
from weavecell.report import (
    chapters,
    pictures,
    pictures_body,
    pictures_histories,
    pictures_uncertainty,
)
from weavecell.report.page import Figure, Section, Table
from weavecell.report.shot import pictures_shot
from weavecell.results import display, finding, keys
from weavecell.results.display import text
from weavecell.results.finding import Answer
from weavecell.studies.energy_map import map_energy
from weavecell.studies.unknown import FRICTIONS

if TYPE_CHECKING:
    from shellfabric.impact.setup import ImpactSetup
    from shellfabric.loop.histories import Histories
    from weavecell.results.impact import ImpactRecord
    from weavecell.results.impact_shapes import Cut
    from weavecell.runs.passing import Passing
    from weavecell.studies.inputs import Scatter

# stands beside a number of cut yarns that is not whole
PARTS = "a grid line counts as the yarns that it stands for, which need not be a whole number"
# results that a designer looks for, by key of summary.json, with a short name for each
OF_A_DESIGNER = {
    "strike_velocity_m_s": "strike velocity",
    "residual_velocity_m_s": "residual velocity",
    "strike_energy_J": "strike energy",
    "absorbed_energy_J": "energy that the projectile lost",
    "max_deflection_m": "deflection of the back face",
    "deepest_dent_mm": "deepest dent in the block",
    "peak_contact_force_N": "peak contact force",
    "peak_tension_warp_over_strength": "peak tension of the warp, of its strength",
    "peak_tension_weft_over_strength": "peak tension of the weft, of its strength",
    "cut_yarns": "cut yarns",
}
# [m] half the width of the close-up: five radii of the RCC projectile
CLOSE_UP = 0.014
LEAST_OF_A_CURVE = 3  # points
# shares of the run at which the fabric is shown cut open
CUT_INSTANTS = (0.2, 0.5, 1.0)


def outcome(record: ImpactRecord) -> str:
    """Say what came of one run."""
    if record.outcome == "unstable":
        return f"UNSTABLE, and no result: {record.failure_message}"
    facts = []
    if record.outcome == "perforated":
        facts.append(f"perforates, {record.residual_velocity:.3g} m/s left")
    elif record.outcome == "stopped":
        facts.append("stops")
    else:
        end = text(record.time[-1], "s", form=".3g")
        facts.append(f"not decided: {record.residual_velocity:.3g} m/s at the end, {end}")
    facts += _dent(record)
    if record.outcome != "perforated":
        facts.append(f"the back face moves {text(record.max_deflection, 'm', form='.3g')}")
    return "; ".join(facts)


def find(record: ImpactRecord) -> Answer:
    """Return what one run came to, with what is doubtful of it."""
    doubts = finding.list_doubts(record.checks)
    return Answer(record.title, outcome(record), doubts, record.outcome)


def instant(record: ImpactRecord, t: float) -> str:
    """Write time and velocity of an instant [s]; of a pack that had left a block by then, when it
    did."""
    shown = record.time_of_pack(t)
    velocity = round(float(np.interp(shown, record.time, record.velocity)))
    words = f"{1e6 * shown:.0f} µs after the strike, projectile at {velocity} m/s"
    if shown < t:
        words = f"{words}; from here on the block goes on alone"
    return words


def _dent(record):
    """The depth of the dent, in a list that is empty without a block."""
    if record.backing is None:
        return []
    return [dent(record)]


def cut(counts: Sequence[float]) -> str:
    """Write the numbers of cut yarns, with what they count if one is not whole."""
    numbers = [f"{count:.1f}".removesuffix(".0") for count in counts]
    words = f"{', '.join(numbers)} cut yarns of warp and weft"
    # sums of whole yarns have noise in their last digits
    if all(float(count).is_integer() for count in np.round(counts, 6)):
        return words
    return f"{words} ({PARTS})"


def chapter(record: ImpactRecord, panel: tuple[Figure, ...] = (), lead: str = "") -> Section:
    """Build the chapter of one impact: histories, energies, cuts, pictures of the panel and
    results."""
    figures: tuple[Figure, ...] = (_histories(record), _energies(record), _cuts(record), *panel)
    # where yarns were recorded the cone is drawn with them, finer in time; two points are no curve
    known = np.count_nonzero(np.isfinite(record.cone_radius))
    if not record.measured and known >= LEAST_OF_A_CURVE:
        figures += (_cone({"along x, of the last ply": (record.cut_times, record.cone_radius)}),)
    tables = [results(record)]
    if record.count > 1:
        figures += (_plies(record),)
        tables.append(ply_table(record))
    return Section("impact", "The shot in the pictures", lead, figures, tuple(tables))


def critical(record: ImpactRecord, setup: ImpactSetup) -> Section:
    """Show how near the fabric came to its strength: the path of its most critical element over the
    energy that a crossover can store (thesis Figure 5-54).

    `setup` is what was run, with pinned crossovers: resolved yarns slip, and have no such map.
    """
    ply = int(np.argmax(record.ply_shares))
    kind = setup.kind_of(ply)
    # where yarns do not fail the cell reaches far beyond their strength
    found = map_energy(replace(kind, yarn_failure=True).cell())
    path = critical_path(record, ply)
    family = int(np.argmax(record.peak_tension[ply] / record.strength[ply]))
    times = record.time[: len(path[0])]
    nearest = int(np.argmin(np.abs(times - record.peak_tension_time[ply, family])))
    if setup.is_turned(ply):
        path = path[::-1]
    whose = "the most critical element"
    if record.count > 1:
        whose += f" of {record.ply_name(ply)}"
    more = (
        f"Black: strains of {whose}, the one whose yarn is at each instant nearest to its strength; it need not be "
        "the same one all the time, until a yarn has failed; the mark is the instant of the highest tension. A yarn "
        "fails by a mean of its tension over the failure length, so that the path may run a little beyond the edge."
    )
    picture = chapters.energy(found, {whose: (*path, nearest)}, more)
    title = "How near the fabric came to its strength"
    # a pack has so many pictures that its page would be twice as long
    return Section("critical", title, "", (picture,), folded=record.count > 1)


def critical_path(record: ImpactRecord, ply: int) -> tuple[FloatArray, FloatArray]:
    """Return the strains (warp, weft) (n,) [-] of the most critical element of a ply, the first is
    0, from the strike until a yarn of it has failed."""
    cut = record.plies["cut_yarns"][:, ply] > 0
    end = len(cut)
    if cut.any():
        end = int(np.argmax(cut))
    names = ("critical_strain_warp", "critical_strain_weft")
    warp, weft = (record.plies[name][:end, ply] for name in names)
    return warp, weft


def results(record: ImpactRecord) -> Table:
    """Tabulate what a designer asks of a shot, in ten rows at most."""
    facts = record.facts()
    units = {key.name: key.unit for key in keys.table("impact", *keys.OF_SOME.values())}
    rows = [("outcome", record.outcome)]
    for name, label in OF_A_DESIGNER.items():
        if facts.get(name) is not None and name in units:
            heading = display.heading(label, units[name])
            rows.append((heading, display.number(facts[name], units[name])))
    return Table(("result", "value"), tuple(rows), "Results", ("value",))


def ply_table(record: ImpactRecord) -> Table:
    """Tabulate the plies of a pack, one row each."""
    shares = record.peak_tension / record.strength
    columns = {"ply": ("", np.arange(1, record.count + 1))}
    if record.ply_fabrics:
        columns["fabric"] = ("", np.array(record.ply_fabrics))
    columns |= {
        "cut yarns": ("", np.round(record.plies["cut_yarns"][-1], 1)),
        "peak tension / strength, warp": ("%", shares[:, 0]),
        "peak tension / strength, weft": ("%", shares[:, 1]),
        "energy at the end": ("J", record.plies["energy"][-1]),
    }
    table = display.frame(columns)
    deepest = text(record.max_penetration_ratio.max(), "%", ".0f")
    caption = (
        f"Plies, from the front. Cut yarns: {PARTS}. The energy of a ply is its kinetic and stored energy and what it "
        f"has dissipated. A ply was pressed into the next by at most {deepest} of its thickness. Tensions "
        "over time are in histories.h5 under /plies."
    )
    if record.guard_impulses:
        caption += f" Plies were kept from passing through each other by {record.guard_impulses:g} impulses."
    return Table.from_frame(table, caption)


def settings(setup: ImpactSetup) -> Table:
    """Tabulate settings of the solver, for those who develop the code."""
    from shellfabric.impact import in_words

    found = in_words.list_settings(setup).items()
    rows = [(name, in_words.say(value)) for name, value in found]
    return Table(("setting, in SI units", "value"), tuple(rows), "Settings of the solver")


def _histories(record):
    """Velocity, deflection and contact force."""
    interval = text(float(np.median(np.diff(record.time))), "s", form=".2g")
    caption = (
        "Velocity of the projectile; back-face deflection, the largest displacement of the last ply along the normal; "
        f"contact force on the projectile, mean over {interval}."
    )
    return pictures.draw_figure(
        "histories", caption, pictures_shot.histories, record, wide=False, tall=True
    )


def _cone(radii, of_ply=""):
    """How far the transverse wave has come."""
    caption = (
        "Radius of the cone about the nose: how far the transverse wave has come from the impact point. The foot of "
        "the cone is where its side, drawn as a straight line through 3/4 and 1/4 of its height, meets the flat "
        "fabric. It grows until it is at the edge of the panel, or until the fabric springs back."
    )
    draw = pictures_histories.cone
    return pictures.draw_figure(f"cone{of_ply}", caption, draw, radii, wide=False)


def _plies(record):
    """What each ply of a pack does over time."""
    caption = (
        f"Each ply over time, {_shading(record)}. Its largest deflection; force of the projectile on it; energy that "
        "it moves with, stores and has lost."
    )
    return pictures.draw_figure("plies", caption, pictures_shot.plies, record, wide=False)


def _cuts(record):
    """Cuts through the fabric."""
    caption = (
        "The fabric cut open along x through the impact point, with the projectile (grey). Left: the whole width, "
        "heights stretched. Right: to scale, the fabric as thick as it is; gaps are failed yarns."
    )
    if record.backing is not None:
        caption += " The block behind is brown."
    if record.count > 1:
        caption += f" Plies are {_shading(record)}."
    views = _cut_views(record)
    return pictures.draw_figure("cuts", caption, pictures_shot.cuts, views, CLOSE_UP, wide=False)


def _energies(record):
    """Energies over time, and the energy error."""
    caption = (
        "Energy of projectile and fabric; dotted: the strike energy. Below, the error of the energy balance in % of "
        "the strike energy (green band: 1 %)."
    )
    if record.viscous_note:
        caption += f" Note: {record.viscous_note}."
    return pictures.draw_figure("energies", caption, pictures_shot.energies, record, wide=False)


def _shading(record):
    """How a picture colours the plies of a pack, in words."""
    words = "dark at the front and light at the rear"
    if record.ply_fabrics:
        words += f", in one colour for each fabric ({record.which_fabric})"
    return words


def cut_view(record: ImpactRecord, cut: Cut, title: str) -> pictures_shot.CutView:
    """Return what `pictures_shot.cuts` draws of a cut of a record."""
    outline = pictures_shot.outline(record.projectile)
    if record.metal is not None:
        half = cut.body[record.metal.outline]
        outline = np.concatenate([half, half[::-1] * [-1, 1]])
    outline[:, 0] += record.nose_place(cut.time)[0]
    return pictures_shot.CutView(
        title, cut, record.thickness, record.mirror_x, outline, record.ply_fabrics
    )


def _cut_views(record):
    """The cuts nearest to the instants that are shown, each once."""
    times = np.array([cut.time for cut in record.cuts])
    views = {}
    for share in CUT_INSTANTS:
        nearest = int(np.argmin(np.abs(times - share * times[-1])))
        title = text(times[nearest], "s", form=".0f")
        views[nearest] = cut_view(record, record.cuts[nearest], title)
    return list(views.values())


def assumptions(
    setup: ImpactSetup, lines: Sequence[str], *, body: str = "", drawn: bool = False
) -> Section:
    """Tabulate what the model assumes in this run.

    Parameters
    ----------
    setup : as it was run
    lines : that name the laws that are assumed (`fabrics.assumed.lines`)
    body : whether a rigid projectile is justified, in words
    drawn : whether each yarn has a strength of its own
    """
    from shellfabric.impact import in_words

    rows = in_words.list_assumptions(setup, body=body, drawn=drawn)
    rows += [("assumed law", line) for line in lines]
    table = Table(("of", "in this run"), tuple(rows))
    return Section("assumptions", "Assumptions", tables=(table,), folded=True)


def mesh(record: ImpactRecord, setup: ImpactSetup) -> Section:
    """Describe the mesh, of a set-up with the mesh that was used."""
    weave = setup.fabric.weave
    if setup.grading is None:
        side = 1 / (setup.mesh.elements_per_crossover or 1)  # [crossovers]
        where = ""
    else:
        side = setup.grading[0][1]
        where = " about the impact point, fewer outside"
    sides = [display.number(2 * spacing * side, "m", form=".2f") for spacing in weave.w]
    longest = 2 * max(weave.w) * side
    step = record.time[-1] / record.steps
    rows = (
        ("elements per crossover, along each side", f"{1 / side:.3g}{where}"),
        ("smallest element [mm]", " x ".join(sides)),
        ("projectile radius / longest side of it", f"{setup.projectile.radius / longest:.2g}"),
        ("elements of the modelled part", f"{record.elements}"),
        ("modelled part of the panel", setup.symmetry),
        ("time steps", f"{record.steps} of {1e9 * step:.3g} ns"),
    )
    lead = f"{option('uncertainty')} runs a second mesh. Near the critical velocity the outcome depends on the mesh."
    if setup.stops_a_bullet:
        lead += f" It has {setup.mesh_in_words}."
    table = Table(("mesh", "value"), rows, numeric=("value",))
    return Section("panel-mesh", "Mesh", lead, tables=(table,), folded=True)


def describe_unknown(setup: ImpactSetup, scatter: Scatter | None = None) -> Section:
    """Tabulate what drawn shots draw, and from where.

    Parameters
    ----------
    scatter : of panels; None takes that of the data files
    """
    from weavecell.studies import inputs, unknown

    lead = (
        "What is given without a range is not drawn. Of a range half of the draws lie on either side of its value; "
        "± is one standard deviation."
    )
    columns = ("what", "range", "known from", "source")
    rows = unknown.list_drawn(setup, scatter or inputs.read_scatter())
    return Section(
        "drawn", "What is drawn", lead, tables=(Table(columns, tuple(rows)),), folded=True
    )


def measures(
    recorded: Histories, places: Sequence[float], ply: int | None = None, fabric: str = ""
) -> Section:
    """Show what was recorded along yarns.

    Parameters
    ----------
    recorded : shellfabric.loop.histories.Histories of at least one yarn
    places : [m] along the yarns whose histories are drawn
    ply : number of the ply in a pack, the first is 1; None of a single panel
    fabric : of this ply, in a pack of several
    """
    from weavecell.results.wave_fronts import fronts

    waves = fronts(recorded)
    of_ply = ""
    title = "Along the yarns"
    if ply is not None:
        of_ply = f"-ply-{ply}"
        title += f", ply {ply}" + (f", {fabric}" if fabric else "")
    reach = max(yarn.X[-1] for yarn in recorded.yarns)
    within = [place for place in places if place <= reach]
    nearest = [recorded.through(family) for family in ("warp", "weft")]
    through = [yarn for yarn in nearest if yarn is not None]
    tensions = pictures.draw_figure(
        f"tensions{of_ply}",
        "Tension and fibre strain of the yarns that were followed.",
        pictures_histories.tensions,
        recorded.t,
        recorded.yarns,
        within,
    )
    strains = pictures.draw_figure(
        f"strains{of_ply}",
        "Strain of the fibres along the yarns through the impact point, later instants darker, with the foot of the "
        "cone at each instant. /measured in histories.h5 has both as strain and cone_radius.",
        pictures_histories.strains,
        recorded.t,
        through,
    )
    radii = {yarn.family: (recorded.t, yarn.cone_radius) for yarn in through}
    arrivals = pictures.draw_figure(
        f"fronts{of_ply}",
        "Tension over place and time, with the longitudinal front (dark: tension arrives) and the transverse one "
        "(orange: the foot of the cone); the lines are fitted. Deflections along the yarns and the forces on the edges "
        "of the panel are in histories.h5 under /measured.",
        pictures_histories.fronts,
        recorded.t,
        through,
        waves,
    )
    columns = (
        "front",
        "yarn",
        "speed in the fabric [m/s]",
        "95 % interval [m/s]",
        "speed along the yarn [m/s]",
    )
    tables: tuple[Table, ...] = ()
    if waves:
        rows = [_front_row(wave, recorded) for wave in waves]
        tables = (Table(columns, tuple(rows), numeric=columns[2:]),)
    return Section(
        f"measures{of_ply}",
        title,
        "",
        (tensions, strains, _cone(radii, of_ply), arrivals),
        tables,
        folded=ply is not None,
    )


def body(record: ImpactRecord) -> list[Section]:
    """Build the sections of a projectile that deforms and of a block behind the panel, if the run
    has them."""
    sections = []
    if record.bar is not None:
        sections.append(_bar(record))
    if record.metal is not None:
        sections.append(_metal(record))
    if record.backing is not None:
        sections.append(_block(record))
    return sections


def _metal(record):
    """Section of a projectile of metal."""
    body = record.metal
    lead = (
        f"It is {text(body.width, 'm', form='.3g')} wide and {text(body.length, 'm', form='.3g')} long at the end, "
        f"from {text(body.width_at_rest, 'm', form='.3g')} and {text(body.length_at_rest, 'm', form='.3g')} at rest; "
        f"plastic work has taken {text(body.plastic_energy, 'J', form='.3g')}."
    )
    if body.jacket_strain:
        lead += (
            f" The jacket is strained by {body.jacket_strain:.2g}; that it tears is not computed."
        )
    caption = (
        "The projectile at rest and at the end, cut along its axis, coloured by effective plastic strain; and the "
        "velocities of tip, tail and centre of mass."
    )
    figure = pictures.draw_figure("mushroom", caption, pictures_body.mushroom, body)
    return Section("metal", "The projectile of metal", lead, (figure,))


def _bar(record):
    """Section of an elastic projectile."""
    bar = record.bar
    lead = f"Plastic strain has shortened it by {text(bar.shortening, 'm', form='.3g')}."
    if record.rigid_check:
        lead = f"{record.rigid_check}. {lead}"
    caption = (
        "Tip, tail and centre of mass of the projectile; the first mode has "
        f"{text(bar.period, 's', form='.3g')}."
    )
    if np.isfinite(bar.swing):
        caption += f" Their period is {text(bar.swing, 's', form='.3g')}."
    figure = pictures.draw_figure("bar", caption, pictures_body.bar, bar)
    return Section("bar", "The projectile as a bar", lead, (figure,), folded=record.count > 1)


def _block(record):
    """Section of a block behind the panel."""
    block = record.backing
    lead = f"{dent(record).capitalize()}. "
    if not record.block_moves:
        lead += (
            f"The crater is {text(block.depth, 'm', form='.1f')} deep and "
            f"{text(2 * block.half_width, 'm', form='.1f')} wide at half of that; its wall stands at "
            f"{display.number(block.steepness, 'rad', form='.0f')}° to the face. "
        )
    part = "its modelled part"
    if block.share == 1:
        part = "the block"
    lead += f"{counted(int(block.gone.sum()), 'brick')} of {part} are eroded."
    caption = (
        "The block cut along the warp through the impact point, at the end of the run, to scale. The depth of every "
        "node of its face is in histories.h5 under /backing/depth_map."
    )
    blocks = {record.title: block}
    figure = pictures.draw_figure("crater", caption, pictures_body.crater, blocks, kind="png")
    return Section("backing", "The block behind", lead, (figure,), folded=record.count > 1)


def dent(record: ImpactRecord) -> str:
    """Write the back-face signature, with the deepest that the dent has been; of a block that still
    moves at the end, that it has no signature yet, and why."""
    assert record.backing is not None
    deepest = f"{record.deepest_dent_mm:.3g} mm at {text(record.backing.deepest_dent_time, 's')}"
    if not record.block_moves:
        signature = f"back-face signature {record.back_face_signature_mm:.3g} mm"
        size = f"{text(record.backing.volume, 'm3', form='.3g')}, radius at half depth "
        size += text(record.backing.half_width, "m", form=".1f")
        return f"{signature} (dent in the block at rest, of {size}; deepest {deepest})"
    moves = text(record.block_motion, "%", ".2g")
    longer = "backing.after_stop lets it come to rest"
    if record.outcome == "in flight":  # the time after the stop has not begun
        longer = "a longer run.end_time, and backing.after_stop, let it come to rest"
    return (
        f"no back-face signature yet: the block moves with {moves} of the strike energy or its dent "
        f"still changes (deepest so far {deepest}); {longer}"
    )


def _front_row(wave, recorded):
    """Kind, yarn and speeds of a front; dashes if it has none."""
    if not np.isfinite(wave.speed):
        return wave.kind, wave.family, "-", "-", "-"
    along = "-"
    if wave.kind == "longitudinal":
        # along the yarn the wave has further to go, by the crimp
        along = f"{wave.speed * (1 + recorded.through(wave.family).crimp):.0f}"
    low, high = wave.interval
    return wave.kind, wave.family, f"{wave.speed:.0f}", f"{low:.0f} to {high:.0f}", along


def draw_draws(found: Passing) -> Figure:
    """Draw the drawn shots of a velocity."""
    caption = (
        "The drawn shots by the frictions that nobody gave; place and strengths are drawn too."
    )
    return pictures.draw_figure("draws", caption, pictures_uncertainty.draw_passing, found)


def describe_draws(found: Passing) -> Section:
    """Tabulate the drawn shots of a velocity."""
    rows = [
        (
            str(shot.number),
            shot.outcome,
            f"{shot.residual:.1f}" if shot.perforated else "",
            display.text(shot.deflection, "m", form=".3g").removesuffix(" mm"),
            *(f"{shot.drawn[FRICTIONS[name].column]:.3f}" for name in found.unknown),
            " ".join(f"{1e3 * x:.2f}" for x in shot.impact_point),
            shot.checks,
        )
        for shot in found.shots
    ]
    numbers = (
        "residual velocity [m/s]",
        "deflection [mm]",
        *(FRICTIONS[name].words for name in found.unknown),
    )
    table = Table(("draw", "outcome", *numbers, "x and y [mm]", "checks"), tuple(rows), "", numbers)
    return Section("draws", "The drawn shots", tables=(table,), folded=True)
