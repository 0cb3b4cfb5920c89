"""The chapters of the report of an impact, on one ply or on a pack: outcome, pictures, tables, mesh, assumptions."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from fabrics import backings
from weavecell.report import pictures, pictures_body, pictures_histories, pictures_uncertainty
from weavecell.report.page import Card, Figure, Section, Table
from weavecell.report.shot import pictures_shot
from weavecell.results import display, keys
from weavecell.results.display import text

if TYPE_CHECKING:
    from shellfabric.impact.simulation import ImpactSetup
    from shellfabric.output.histories import Histories
    from weavecell.results.impact import ImpactRecord
    from weavecell.results.impact_shapes import Cut
    from weavecell.studies.assumed_range import AssumedRange

# beside a number of cut yarns that is not whole
PARTS = "a grid line counts as the yarns that it stands for, which need not be a whole number"
CLOSE_UP = 0.014  # [m] half the width of the close-up: five radii of the RCC projectile


def outcome(record: ImpactRecord) -> str:
    """The result of an impact in one line."""
    strike, end = f"{record.strike_velocity:g} m/s", text(record.time[-1], "s", form=".0f")
    if record.outcome == "unstable":
        return f"UNSTABLE at {strike}: the run was ended after {end} and has no result ({record.failure_message})."
    words = {
        "stopped": f"Stopped at {strike}",
        "perforated": f"Perforated at {strike}",
        "in flight": f"Not decided at {strike}, in flight at the end, {end}",
    }[record.outcome]
    velocity = [] if record.outcome == "stopped" else [residual(record)]
    deflection = [] if record.outcome == "perforated" else [_deflection(record)]
    doubtful = [check.name for check in record.checks if not check.ok]
    end = f". DOUBTFUL: {', '.join(doubtful)}." if doubtful else "."
    return f"{words}: {', '.join([*velocity, *_dent(record), *deflection, _load(record)])}{end}"


def residual(record: ImpactRecord) -> str:
    """Velocity at the end, as text."""
    name = (
        "velocity at the end"
        if record.outcome in ("in flight", "unstable")
        else "residual velocity"
    )
    return f"{name} {record.residual_velocity:.1f} m/s".replace(" 0.0 m/s", " 0 m/s")


def instant(record: ImpactRecord, t: float) -> str:
    """Time and velocity of an instant [s]."""
    velocity = np.interp(t, record.time, record.velocity)
    return f"{1e6 * t:.0f} µs after the strike, projectile at {round(float(velocity))} m/s"


def _deflection(record):
    return f"back-face deflection {text(record.max_deflection, 'm', form='.1f')}"


def _dent(record):
    """The depth of the dent in the block, where there is one."""
    return [] if record.backing is None else [dent(record)]


def _load(record):
    """How many yarns are cut, or how near to the strength the tension came."""
    if record.cut_yarns[-1]:
        return cut(record.cut_yarns[-1:])
    family, peak = max(record.peaks.items(), key=lambda item: item[1].share)
    return f"peak tension {text(peak.share, '1', 'share', '.3g')} of the strength ({family})"


def cut(counts: Sequence[float]) -> str:
    """Numbers of cut yarns, with what they count where one is not whole."""
    numbers = ", ".join(f"{count:.1f}".removesuffix(".0") for count in counts)
    whole = all(float(count).is_integer() for count in counts)
    return f"{numbers} cut yarns of warp and weft" + ("" if whole else f" ({PARTS})")


def card(record: ImpactRecord) -> Card:
    """What one impact came to."""
    tone = record.outcome if record.outcome in ("stopped", "perforated", "unstable") else "plain"
    force = f"contact force up to {1e-3 * record.contact_force.max():.2g} kN"
    lines = (residual(record), *_dent(record), _deflection(record), force, _load(record))
    return Card(
        record.title,
        "still moving" if record.outcome == "in flight" else record.outcome,
        lines,
        tone,
    )


def chapter(record: ImpactRecord, panel: Figure) -> Section:
    """Histories, energies, cuts, the picture of the panel and results of one impact."""
    figures = [_histories(record), _energies(record), _edges(record), _cuts(record), panel]
    tables = [results(record)]
    if record.count > 1:
        figures += _of_plies(record)
        tables.append(ply_table(record))
    return Section("impact", "Impact", "", tuple(figures), tuple(tables))


def results(record: ImpactRecord) -> Table:
    """Every number of the summary but the energies."""
    facts, rows = record.facts(), [("outcome", record.outcome)]
    for key in keys.table("impact", *keys.OF_SOME.values(), "failure"):
        if key.unit and key.name in facts:
            rows.append((key.label, display.number(facts[key.name], key.unit, key.name)))
    return Table(("result", "value"), tuple(rows), "Results", ("value",))


def ply_table(record: ImpactRecord) -> Table:
    """One row a ply of a pack."""
    shares = record.peak_tension / record.strength
    table = display.frame(
        {
            "ply": ("", np.arange(1, record.count + 1)),
            "cut yarns": ("", np.round(record.plies["cut_yarns"][-1], 1)),
            "peak tension / strength, warp": ("1", shares[:, 0]),
            "peak tension / strength, weft": ("1", shares[:, 1]),
            "energy at the end": ("J", record.plies["energy"][-1]),
        }
    )
    deepest = text(record.max_penetration_ratio.max(), "1", "share", ".0f")
    caption = (
        f"Plies, from the front. Cut yarns: {PARTS}. A ply was pressed into the next by at most {deepest} of its "
        "thickness."
    )
    if record.guard_impulses:
        caption += f" Plies were kept from passing through each other by {record.guard_impulses:g} impulses."
    return Table.of(table, caption)


def cost(record: ImpactRecord, setup: ImpactSetup) -> tuple[Table, ...]:
    """Tables for those who develop the code: cost of the time integration, and settings of the model."""
    unstored = np.atleast_1d(record.energies.get("formulation_residual", 0.0))[-1]
    rows = (
        ("elements", f"{record.elements}"),
        ("steps", f"{record.steps}"),
        ("factor on the time step, below 1 of a run made again", f"{record.step_factor:g}"),
        ("time integration [s]", f"{record.wall_time:.4g}"),
        ("ns per element and step", f"{record.ns_per_element_step:.4g}"),
        ("formulation residual [%]", f"{100 * unstored / record.strike_energy:.4g}"),
    )
    caption = "Cost. Formulation residual: work of the cell's forces that the yarns do not store, of the strike energy."
    settings = {
        "cell model": setup.cell_model,
        "cell formulation": setup.form,
        "stretches along each side of the cell table": setup.table_size,
        "time between energy audits": text(setup.audit_interval, "s"),
        **{name.replace("_", " "): value for name, value in vars(setup.numerics).items()},
    }
    return (
        Table(("quantity", "value"), rows, caption, ("value",)),
        Table(
            ("setting", "value"),
            tuple((k, f"{v}") for k, v in settings.items()),
            "Settings of the solver",
        ),
    )


def _histories(record):
    """Velocity, deflection and contact force."""
    interval = text(float(np.median(np.diff(record.time))), "s", form=".2g")
    caption = (
        "Velocity of the projectile; back-face deflection, the largest displacement of the last ply along the normal; "
        f"contact force on the projectile, mean over {interval}."
    )
    content = pictures.render(pictures_shot.histories, record)
    return Figure(content, "svg", caption, "histories", wide=False, tall=True)


def _cuts(record):
    """Cuts through the fabric."""
    caption = (
        "The fabric cut open along x through the impact point, with the projectile (grey). Left: the whole width, "
        "heights stretched. Right: to scale, the fabric as thick as it is; gaps are failed yarns."
    )
    if record.count > 1:
        caption += " Plies are dark at the front and light at the rear."
    return Figure(
        pictures.render(pictures_shot.cuts, _cut_views(record), CLOSE_UP), "svg", caption, "cuts"
    )


def _energies(record):
    """Energies over time, and the energy error."""
    caption = (
        "Energy of projectile and fabric; dotted: the strike energy. Below, the error of the energy balance in % of "
        "the strike energy (green band: 1 %)."
    )
    caption += f" Note: {record.viscous_note}." if record.viscous_note else ""
    return Figure(
        pictures.render(pictures_shot.energies, record), "svg", caption, "energies", wide=False
    )


def _edges(record):
    """Tensions at the edges."""
    caption = (
        "Tension at the edge of the panel, of the warp and the weft yarn through the impact point"
    )
    caption += ", summed over the plies." if record.count > 1 else "."
    return Figure(
        pictures.render(pictures_shot.reactions, record), "svg", caption, "reactions", wide=False
    )


def cut_view(record: ImpactRecord, cut: Cut, title: str) -> pictures_shot.CutView:
    """What `pictures_shot.cuts` draws of a cut of a record."""
    outline = pictures_shot.outline(record.projectile)
    outline[:, 0] += record.nose_place(cut.time)[0]
    return pictures_shot.CutView(title, cut, record.thickness, record.mirror_x, outline)


def _cut_views(record):
    """Three instants."""
    times = np.array([cut.time for cut in record.cuts])
    numbers = dict.fromkeys(
        int(np.argmin(np.abs(times - share * times[-1]))) for share in (0.2, 0.5, 1.0)
    )
    return [cut_view(record, record.cuts[n], text(times[n], "s", form=".0f")) for n in numbers]


def _of_plies(record):
    """Figures of what each ply of a pack bears."""
    plies = record.plies
    both = zip((plies["peak_warp"], plies["peak_weft"]), record.strength.T)
    tension = np.max([column / strength for column, strength in both], axis=0)
    peaks, cut, energy = (
        record.peak_tension / record.strength,
        plies["cut_yarns"][-1],
        plies["energy"][-1],
    )
    bears = "What each ply bears. The energy of a ply is its kinetic and stored energy and what it has dissipated."
    pushes = (
        "Contact force of the projectile on the plies that it touches, at single steps; deflection of each ply "
        "from its own plane; highest tension of its warp or weft so far, over the strength."
    )
    shares = pictures.render(pictures_shot.shares, peaks, cut, energy)
    histories = pictures.render(
        pictures_shot.pushes, record.time, plies["push"], plies["deflection"], tension
    )
    return [Figure(shares, "svg", bears, "plies"), Figure(histories, "svg", pushes, "pushes")]


def assumptions(
    setup: ImpactSetup, lines: Sequence[str], *, body: str = "", drawn: bool = False
) -> Section:
    """What the model assumes in this run.

    Parameters
    ----------
    setup : as it was run
    lines : that name the laws that are assumed (`fabrics.assumed.lines`)
    body : whether a rigid projectile is justified, in words
    drawn : whether each yarn has a strength of its own
    """
    strengths = [
        (fabric.name, [f"{yarn.strength:.0f}" for yarn in fabric.weave.yarns])
        for fabric in setup.fabrics
    ]
    strength = ", ".join(
        f"{' / '.join(words)} N ({name}, warp / weft)" for name, words in strengths
    )
    pinned = "Warp and weft are pinned to each other at every crossover: no slip, pull-out or opening of the weave."
    pinned += " In the one pair of tests at hand (S-726) the computed limit is too high."
    if setup.plies == 1:
        pinned += " A nose may push slippery yarns aside and pass far below this limit."
    pinned += "".join(f" {note[0].upper()}{note[1:]}." for note in setup.notes)
    fails = f"A yarn fails at its strength, {strength}, at any strain rate; "
    fails += (
        "each yarn's is drawn about that."
        if drawn or setup.strength
        else "it is the same for all yarns."
    )
    shot, between = setup.projectile, setup.ply_friction
    projectile = "Rigid." if shot.body == "rigid" else "Elastic-plastic along its axis."
    projectile += f" {body[0].upper()}{body[1:]}." if body else ""
    projectile += (
        f" Friction on the fabric {shot.friction:g}."
        if shot.friction
        else " No friction on the fabric."
    )
    rows = [
        ("crossovers", pinned),
        ("failure of yarns", fails if setup.failure else "Yarns do not fail."),
        ("strain rate", "Stiffness and strength of the yarns do not depend on it."),
        ("projectile", projectile),
    ]
    if setup.plies > 1:
        rows.append(("between plies", f"Friction {between:g}." if between else "No friction."))
    if setup.backing is not None:
        rows.append(
            ("block behind", backings.assumed_line(setup.backing.name, setup.backing.material))
        )
    rows += [("assumed law", line) for line in lines]
    return Section(
        "assumptions", "Assumptions", tables=(Table(("of", "in this run"), tuple(rows)),)
    )


def mesh(record: ImpactRecord, setup: ImpactSetup) -> Section:
    """The mesh, of a set-up with the mesh that was used."""
    weave = setup.fabric.weave
    side = (
        1 / setup.resolved_elements_per_crossover if setup.grading is None else setup.grading[0][1]
    )  # [crossovers]
    fewer = "" if setup.grading is None else " about the impact point, fewer outside"
    step = record.time[-1] / record.steps
    rows = (
        ("elements per crossover, along each side", f"{1 / side:.3g}{fewer}"),
        (
            "smallest element [mm]",
            " x ".join(display.number(2 * w * side, "m", form=".2f") for w in weave.w),
        ),
        (
            "projectile radius / longest side of it",
            f"{setup.projectile.radius / (2 * max(weave.w) * side):.2g}",
        ),
        ("elements of the modelled part", f"{record.elements}"),
        ("modelled part of the panel", setup.symmetry),
        ("time steps", f"{record.steps} of {1e9 * step:.3g} ns"),
    )
    lead = (
        "The option --uncertainty of weavecell impact computes what the results change on a second mesh; a table "
        "[accuracy] in the input file finds the mesh that they need. Near the critical velocity the outcome itself "
        "depends on the mesh."
    )
    return Section(
        "panel-mesh", "Mesh", lead, tables=(Table(("mesh", "value"), rows, numeric=("value",)),)
    )


def assumed(around: AssumedRange) -> Section:
    """The range of a velocity over assumed laws, and the runs that it consists of."""
    lead = (
        f"{around.words().capitalize()}. The run was repeated with each end of each assumed range, one at a time, and "
        "with those together that lower the velocity, or raise it. The range is that of these runs and no bound. A "
        "share is the width of one assumption alone over the sum of these widths."
    )
    figures: tuple[Figure, ...] = ()
    if around.high > around.low:
        caption = "What each assumption changes alone, and all runs together."
        picture = pictures.render(pictures_uncertainty.tornado, around, "")
        figures = (Figure(picture, "svg", caption, "assumed-range"),)
    runs = [
        (run.laws, run.outcome or "-", display.number(run.velocity, "m/s")) for run in around.rows
    ]
    columns = ("laws", "outcome", f"{around.quantity} [m/s]")
    table = Table(columns, tuple(runs), numeric=columns[2:])
    return Section("assumed", "What the assumed laws leave open", lead, figures, (table,))


def measures(recorded: Histories, places: Sequence[float], ply: int | None = None) -> Section:
    """What was recorded along yarns and at the edges.

    Parameters
    ----------
    recorded : shellfabric.output.histories.Histories
    places : [m] along the yarns whose histories are drawn
    ply : number of the ply in a pack, the first is 1; None of a single panel
    """
    from weavecell.results.wave_fronts import fronts

    t, waves = recorded.t, fronts(recorded)
    through = [
        yarn for yarn in (recorded.through("warp"), recorded.through("weft")) if yarn is not None
    ]
    drawn: list[tuple[str, str, tuple[Any, ...]]] = []
    of_ply = f"-ply-{ply}" if ply else ""
    if recorded.yarns:
        within = [place for place in places if any(place <= yarn.X[-1] for yarn in recorded.yarns)]
        drawn = [
            (
                "tensions",
                "Tension and fibre strain of the yarns that were followed.",
                (recorded.yarns, within),
            ),
            (
                "fronts",
                "Tension over place and time, with the longitudinal front (dark: tension arrives) and the transverse "
                "one (red: the foot of the pyramid); the lines are fitted.",
                (through, waves),
            ),
            ("profiles", "Deflection along the yarns nearest the impact point.", (through,)),
        ]
    drawn.append(
        ("edges", "Force of the fabric on the edges of the whole panel.", (recorded.edges,))
    )
    figures = tuple(
        Figure(
            pictures.render(getattr(pictures_histories, name), t, *arguments),
            "svg",
            caption,
            name + of_ply,
        )
        for name, caption, arguments in drawn
    )
    title = f"Along the yarns and at the edges{f', ply {ply}' if ply else ''}"
    columns = (
        "front",
        "yarn",
        "speed in the fabric [m/s]",
        "95 % interval [m/s]",
        "speed along the yarn [m/s]",
    )
    table = (
        (Table(columns, tuple(_front_row(wave, recorded) for wave in waves), numeric=columns[2:]),)
        if waves
        else ()
    )
    return Section(f"measures{of_ply}", title, "", figures, table)


def body(record: ImpactRecord) -> list[Section]:
    """Sections of an elastic projectile and of a block behind the panel, where there are any."""
    sections = []
    if record.bar is not None:
        bar = record.bar
        lead = f"{record.rigid_check}. " if record.rigid_check else ""
        lead += f"Plastic strain has shortened it by {text(bar.shortening, 'm', form='.3g')}."
        swing = (
            f" They swing in {text(bar.swing, 's', form='.3g')}." if np.isfinite(bar.swing) else ""
        )
        caption = (
            "Tip, tail and centre of mass of the projectile; the first mode has "
            f"{text(bar.period, 's', form='.3g')}.{swing}"
        )
        figure = Figure(pictures.render(pictures_body.bar, bar), "svg", caption, "bar")
        sections.append(Section("bar", "The projectile as a bar", lead, (figure,)))
    if record.backing is not None:
        block = record.backing
        lead = f"{dent(record).capitalize()}. "
        if not record.block_moves:
            lead += (
                f"Volume of the dent {text(block.volume, 'm3', form='.3g')}. "
                f"The crater is {text(block.depth, 'm', form='.1f')} deep and "
                f"{text(2 * block.half_width, 'm', form='.1f')} wide at half of that; its wall stands at "
                f"{display.number(block.steepness, 'rad', form='.0f')}° to the face. "
            )
        part = "the block" if block.share == 1 else "its modelled part"
        lead += f"{int(block.gone.sum())} bricks of {part} are eroded."
        picture = pictures.render(pictures_body.crater, {record.title: block}, kind="png")
        caption = "The block cut along the warp through the impact point, at the end of the run, to scale."
        deep = pictures.render(pictures_body.depth_map, block, kind="png")
        seen = "Depth of the face of the block at the end of the run, seen along the flight; lines every fifth of it."
        figures = (
            Figure(picture, "png", caption, "crater"),
            Figure(deep, "png", seen, "depth-map"),
        )
        sections.append(Section("backing", "The block behind", lead, figures))
    return sections


def dent(record: ImpactRecord) -> str:
    """The back-face signature; of a block that still moves at the end, that there is none yet."""
    if record.block_moves:
        moves = text(record.block_motion, "1", "share", ".2g")
        return f"no back-face signature yet: the block moves with {moves} of the strike energy"
    return f"back-face signature {record.back_face_signature_mm:.3g} mm (dent in the block)"


def _front_row(wave, recorded):
    if not np.isfinite(wave.speed):
        return wave.kind, wave.family, "-", "-", "-"
    along = (
        f"{wave.speed * (1 + recorded.through(wave.family).crimp):.0f}"
        if wave.kind == "longitudinal"
        else "-"
    )
    low, high = wave.interval
    return wave.kind, wave.family, f"{wave.speed:.0f}", f"{low:.0f} to {high:.0f}", along
