"""One impact on a pack of plies, from its scene to its folder of results.

The folder of `weavecell impact` where panel.plies is above 1
    scene.toml      the scene as it was given
    histories.h5    scalars, histories, every ply at the end (`results.pack.PackRecord`)
    summary.json    outcome, energies, what each ply bore, provenance
    pack.pvd        the ParaView series of pack/pack-*.vtu: all plies, distinguished by "ply"
    pictures/       velocity, energies, cuts, plies and pushes (.svg), rear ply (.png)
    report.html     all of it on one page
    checkpoint.h5   only while the run goes on, or after it was interrupted
"""

from __future__ import annotations

import shutil
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

import weavecell
from fabrics.errors import InputError, UnstableError
from weavecell.commands import fidelity
from weavecell.report import (
    chapters,
    chapters_discretisation,
    chapters_impact,
    checks,
    pictures,
    pictures3d,
    pictures_pack,
)
from weavecell.report import page as report_page
from weavecell.report.page import Report, Section
from weavecell.results import paraview, progress, provenance, run_folder
from weavecell.results.pack import PackRecord
from weavecell.scenes import build, words
from weavecell.scenes.build import Case
from weavecell.scenes.impact import Scene
from weavecell.scenes.supported import Support, of

if TYPE_CHECKING:
    from shellfabric.cell.model import CellTable
    from shellfabric.impact.pack import PackSetup
    from shellfabric.impact.single_ply import ImpactSetup
    from weavecell.analysis.discretisation import Discretisation
    from weavecell.analysis.fidelity.select import Answer

SUPPORT = Support(
    "weavecell impact",
    Scene,
    (
        "title", *build.SHOT, "projectile.strike_velocity", "panel.plies", *build.OF_A_PACK, "panel.grading",
        *build.CROSSOVERS,
        *of("history", "interval warp weft report_positions"),
        *of("run", "end_time snapshot_interval checkpoint_interval outputs"),
        *of("accuracy", "residual_velocity absorbed_energy deflection peak_tension"),
    ),
    rejected=build.NO_SLACK,
    rules=build.PACK_RULES,
)  # fmt: skip
_OF_PANEL = ("plies", "stacking", "gap", "ply_friction")


def impact(
    this: Case, setup: ImpactSetup, path: Path, text: str, out: Path, *, resume: bool = False, strict: bool = False,
    uncertainty: bool = False,
) -> None:  # fmt: skip
    """Run the scene and write its results to the folder `out`.

    Parameters
    ----------
    this : build.Case of the scene
    setup : shellfabric.impact.single_ply.ImpactSetup of one ply
    path, text : of the scene file
    resume : whether to go on from the checkpoint in `out`
    strict : whether a doubtful result is an error
    uncertainty : whether the scene is run on a finer mesh too, for the discretisation uncertainty of its results

    Raises
    ------
    InputError : what the scene describes cannot be computed; nothing has been written
    UnstableError : the run became unstable; what it had computed has been written
    DoubtfulError : a quality indicator is beyond its limit, and `strict`; all results have been written
    """
    scene = this.scene
    title = scene.title or f"{scene.panel.plies} x {this.fabric.name}, {scene.projectile.strike_velocity:g} m/s"

    def shoot(setup, table=None, model=""):
        checkpoint = out / f"checkpoint{'-' + model.replace(' ', '-') if model else ''}.h5"
        return fire(this, setup, title, checkpoint=checkpoint, resume=resume and checkpoint.exists(), table=table)

    try:
        pack = build.pack_setup(setup, scene.panel)
        (record, snapshots, failure), choice, pair = fidelity.run(scene, pack, shoot, uncertainty)
    except InputError as problem:
        raise in_file(problem, path) from None
    with progress.bar("Writing results") as advance:
        write(out, this, record, snapshots, text, advance, choice, pair)
    for checkpoint in out.glob("checkpoint*.h5"):
        checkpoint.unlink()
    _tell(record, out)
    if choice is not None:
        fidelity.tell(choice)
    if pair is not None:
        print(chapters_discretisation.words(pair))
    if failure is not None:
        raise failure
    checks.report(record.checks, strict)


def fire(
    this: Case, setup: PackSetup, title: str, *, checkpoint: Path, resume: bool = False, table: CellTable | None = None
) -> tuple[PackRecord, tuple[Any, ...], UnstableError | None, Any]:
    """Run it under a progress bar: (PackRecord, snapshots, the UnstableError that ended it or None, PackResult)."""
    from shellfabric.impact import pack as impact_pack
    from shellfabric.output.checkpoint import Checkpoints

    hooks = (Checkpoints(checkpoint, this.scene.run.checkpoint_interval),)
    result, failure = progress.watched(
        lambda hooks: impact_pack.run(setup, hooks=hooks, resume=checkpoint if resume else None, table=table),
        title, hooks,
    )  # fmt: skip
    return PackRecord.of(result, title, this.law_name, str(failure or "")), result.snapshots, failure, result


def in_file(problem: InputError, path: Path) -> InputError:
    """An InputError of the pack, with the scene's file and key in it."""
    if problem.file is None and problem.key in _OF_PANEL:
        key = {"gap": "ply_gap"}.get(problem.key, problem.key)
        return InputError(file=path, key=f"panel.{key}", value=problem.value, allowed=problem.allowed)
    return build.in_file(problem, path)


def write(
    out: Path, this: Case, record: PackRecord, snapshots: Sequence[Any], text: str, advance: Callable[..., object],
    choice: Answer | None = None, pair: Discretisation | None = None,
) -> None:  # fmt: skip
    """Write everything but the checkpoint."""
    outputs, stamp = this.scene.run.outputs, provenance.stamp(text, this.fabric)
    content = checks.summary(record.checks) | fidelity.summary(choice) | chapters_discretisation.summary(pair)
    run_folder.write(out, text, record, content, stamp)
    advance(0.1)
    shutil.rmtree(out / "pack", ignore_errors=True)
    if "paraview" in outputs:
        write_series(out, record, snapshots)
    advance(0.4)
    if not {"pictures", "report"} & set(outputs):
        return
    sections = [chapter(record)]
    if choice is not None:
        sections.append(fidelity.chapter(choice))
    if pair is not None:
        sections.append(chapters_discretisation.section(pair))
    if record.slips:
        sections.append(chapters_impact.slips(record))
    ends = dict.fromkeys((0, record.count - 1)) if record.measured else ()  # the ply that is struck, and the rear one
    sections += [
        chapters_impact.measures(record.measured[ply], this.scene.history.report_positions, ply + 1) for ply in ends
    ]
    if "pictures" in outputs:
        report_page.write_pictures(sections, out / "pictures")
    advance(0.9)
    if "report" in outputs:
        report_page.write(page(this, record, sections, stamp), out / "report.html")


def write_series(out: Path, record: PackRecord, snapshots: Sequence[Any]) -> None:
    """Write the plies' shapes as pack.pvd and pack/*.vtu in the folder `out`."""
    times = {}
    instants = [shots for shots in snapshots if shots[0].t < record.shapes[0].t]
    first_nodes = np.cumsum([0, *(shot.nodes.size // 3 for shot in record.shapes)])
    cells = paraview.topology(np.concatenate([quads + first for quads, first in zip(record.quads, first_nodes)]))
    plies = np.concatenate([np.full(len(quads), ply, np.int8) for ply, quads in enumerate(record.quads, 1)])
    for number, shots in enumerate([*instants, record.shapes]):
        nodes, tension, failed = (
            np.concatenate([getattr(shot, field).reshape(-1, width) for shot in shots])
            for field, width in (("nodes", 3), ("tension", 2), ("failed", 3))
        )
        name, values = f"pack/pack-{number:04d}.vtu", paraview.cell_values(tension, failed) | {"ply": plies}
        paraview.write_grid(out / name, nodes, cells, values, shots[0].nose_position)
        times[name] = float(shots[0].t)
    paraview.write_series(out / "pack.pvd", times)


def chapter(record: PackRecord) -> Section:
    """The impact: velocity, cuts, what the plies bear, energies, and the rear ply."""
    figure, render = report_page.Figure, pictures.render
    energies = record.energies | {
        "yarn_strain": record.energies["yarn_strain"] + record.energies["formulation_residual"],
        "contact": record.energies["contact"] + record.energies["ply_contact"],
        "friction": record.energies["friction"] + record.energies.get("ply_friction", 0.0),
    }
    last, rear = record.shapes[-1], record.quads[-1]
    share = np.max(last.tension / record.strength[-1], axis=1)
    body, mirrors = last.projectile_position + record.projectile, (record.mirror_x, record.mirror_y)
    failed = paraview.failed_yarns(last.failed)
    images = [(f"at {1e6 * last.t:.0f} µs", pictures3d.panel(last.nodes, rear, share, failed, body, mirrors, reach))
              for reach in (None, chapters.CLOSE_UP)]  # fmt: skip
    figures = (
        figure(render(pictures.velocity, {record.title: (record.time, record.velocity)}), "svg",
               "Velocity of the projectile from strike to the end of the run.", "velocity"),
        figure(render(pictures_pack.cuts, _chosen(record.cuts), record.thickness, record.mirror_x, _outline(record),
                      chapters.CLOSE_UP), "svg",
               "The pack cut open along x through the impact point, plies dark at the front to light at the rear. "
               "Left: the whole width, heights stretched. Right: to scale, plies as bands of their thickness.", "cuts"),
        figure(render(pictures_pack.shares, record.peak_tension / record.strength, record.plies["failed_yarns"][-1],
                      record.plies["energy"][-1]), "svg",
               "What each ply bears; a ply's energy is what it moves with, stores and has lost.", "plies"),
        figure(render(pictures_pack.pushes, record.time, record.plies["push"], record.plies["deflection"]), "svg",
               "Left: the nose pushes on the plies that it touches; the others are pushed by the one before them.",
               "pushes"),
        figure(render(pictures.energies, record.time, energies, record.strike_energy, record.energies["error"],
                      record.title), "svg",
               "Where the strike energy is; below, what the balance misses (green band: 1 %). Contact is that of the "
               "nose and that between plies, and so is friction.", "energies", wide=False),
        figure(render(pictures.panels, {"rear ply": tuple(images)}, kind="png"), "png",
               "The rear ply, seen from behind, to scale; right, the impact point.", "panel"),
    )  # fmt: skip
    lead = (
        f"{record.title} became unstable and was stopped: {record.failure_message}." if record.failure_message else ""
    )
    return report_page.Section("impact", "Impact", lead, figures, (chapters.impact_table([record]), _ply_table(record)))


def _chosen(cuts):
    """Three instants: the snapshots nearest to a fifth and a half of the time, and the end."""
    end = cuts[-1].t
    return [min(cuts, key=lambda cut, at=at: abs(cut.t - at * end)) for at in (0.2, 0.5)] + [cuts[-1]]


def _outline(record):
    """(n, 2) [m] of the projectile's surface as it is seen from the side, the foremost point at height 0."""
    x, z = record.projectile[..., 0].ravel(), record.projectile[..., 2].ravel()
    heights = np.unique(np.round(z, 7))
    low = [x[np.abs(z - height) < 1e-6].min() for height in heights]
    high = [x[np.abs(z - height) < 1e-6].max() for height in heights]
    outline = np.concatenate([np.column_stack([low, heights]), np.column_stack([high, heights])[::-1]])
    outline[:, 1] -= outline[:, 1].max()
    return outline


def _ply_table(record):
    """One row a ply."""
    columns = ("ply", "failed yarn segments", "highest tension / strength, warp", "weft", "energy at the end [J]")
    peaks = record.peak_tension / record.strength
    rows = tuple(
        (str(p + 1), f"{record.plies['failed_yarns'][-1, p]:g}", f"{peaks[p, 0]:.2f}", f"{peaks[p, 1]:.2f}",
         f"{record.plies['energy'][-1, p]:.2f}")
        for p in range(record.count)
    )  # fmt: skip
    deepest = 100 * record.max_penetration_ratio.max()
    caption = f"Warp and weft are each ply's own. Deepest contact: {deepest:.0f} % of a thickness."
    held, missed = record.torn_contact
    if held or missed:
        caption += f" Torn cloth was kept from going through other plies {held:g} times, {missed:g} times in vain."
    return report_page.Table(columns, rows, caption=caption, numeric=columns[1:])


def page(this: Case, record: PackRecord, sections: Sequence[Section], stamp: dict[str, Any]) -> Report:
    """The report of one impact on a pack; `sections` are its chapters."""
    model, panel = this.scene.fabric.cell_model, this.scene.panel
    source = this.law_name if model == "compressible" else model
    laws = (chapters.law_card(this.laws[0], source=source),) if this.surface is None else ()
    cards = (chapters.fabric_card(this.fabric), *laws, chapters.impact_card(record))
    shot = this.scene.projectile
    return report_page.Report(
        record.title,
        f"{record.count} plies of {record.fabric}, {record.stacking}, {words.panel_in_words(panel)}, struck at "
        f"{shot.strike_velocity:g} m/s by {words.shot_in_words(shot)}. At rest: {record.gap_words}. "
        f"{_contact(record)}.",
        (cards,),
        (
            *sections,
            checks.section(record.checks),
            chapters.sources(this.fabric),
            chapters.making(stamp, {"marching": record.wall_time}),
        ),
        f"weavecell {weavecell.__version__}, {stamp['date']}",
    )


def _contact(record):
    """The contact law of plies in words."""
    travel = f"travel {1e6 * record.ply_contact_travel:.3g} um, then solid fibre"
    return f"Contact of plies: {record.ply_contact_source} ({record.ply_contact_status}), {travel}"


def _tell(record, out):
    print(f"{record.title}: {record.outcome}, {chapters.residual(record)}")
    print(_contact(record))
    failed = ", ".join(f"{count:g}" for count in record.plies["failed_yarns"][-1])
    print(f"failed yarn segments by ply: {failed}")
    print(record.gap_words)
    print(
        f"energy error at most {100 * record.energy_error_max:.3f} % of the strike energy, {record.strike_energy:.2f} J"
    )
    print(f"written to {out}", flush=True)
