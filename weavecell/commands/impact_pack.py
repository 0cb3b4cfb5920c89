"""One impact on a pack of plies, from its scene to its folder of results.

The folder of `weavecell impact` where panel.plies is above 1
    scene.toml      the scene as it was given
    histories.h5    scalars, histories, every ply at the end (`results.pack.PackRecord`)
    summary.json    outcome, energies, what each ply bore, provenance
    pack.pvd        the ParaView series of pack/pack-*.vtu: all plies, distinguished by "ply"
    pictures/       histories, cuts, energies, reactions, plies and pushes (.svg), panel.png of the last ply
    report.html     all of it on one page
    checkpoint.h5   only while the run goes on, or after it was interrupted
"""

from __future__ import annotations

import shutil
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fabrics.errors import InputError, UnstableError
from weavecell.commands import fidelity
from weavecell.report import chapters_discretisation, checks
from weavecell.report import page as report_page
from weavecell.report.shot import shot_page, tables_shot
from weavecell.results import paraview, progress, provenance, run_folder
from weavecell.results.pack import PackRecord
from weavecell.scenes import build
from weavecell.scenes.build import Case
from weavecell.scenes.impact import Scene
from weavecell.scenes.supported import Support, of
from weavecell.scenes.words import shot_in_words

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
        raise build.in_file(problem, path, pack=True) from None
    with progress.bar("Writing results") as advance:
        write(out, this, pack, record, snapshots, text, advance, choice, pair)
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
    from shellfabric.output.checkpoint import LEAST_WALL, Checkpoints

    hooks = (Checkpoints(checkpoint, this.scene.run.checkpoint_interval, LEAST_WALL),)
    result, failure = progress.watched(
        lambda hooks: impact_pack.run(setup, hooks=hooks, resume=checkpoint if resume else None, table=table),
        title, hooks,
    )  # fmt: skip
    return PackRecord.of(result, title, this.law_name, str(failure or "")), result.snapshots, failure, result


def write(
    out: Path, this: Case, setup: PackSetup, record: PackRecord, snapshots: Sequence[Any], text: str,
    advance: Callable[..., object], choice: Answer | None = None, pair: Discretisation | None = None,
) -> None:  # fmt: skip
    """Write everything but the checkpoint."""
    outputs, stamp = this.scene.run.outputs, provenance.stamp(text, this.fabric)
    content = checks.summary(record.checks) | fidelity.summary(choice) | chapters_discretisation.summary(pair)
    content |= {"projectile": shot_in_words(this.scene.projectile)}
    run_folder.write(out, text, record, content, stamp)
    advance(0.1)
    shutil.rmtree(out / "pack", ignore_errors=True)
    if "paraview" in outputs:
        write_series(out, record, snapshots)
    advance(0.4)
    if not {"pictures", "report"} & set(outputs):
        return
    chosen = None if choice is None else fidelity.chapter(choice)
    used = setup if choice is None else choice.final.option.setup
    sections = shot_page.sections(this, used, record, chosen, None, pair)
    if "pictures" in outputs:
        report_page.write_pictures(sections, out / "pictures")
    advance(0.9)
    if "report" in outputs:
        report_page.write(shot_page.page(this, used, record, sections, stamp), out / "report.html")


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


def _tell(record, out):
    print(f"{record.title}: {record.outcome}, {tables_shot.residual(record)}")
    print(record.contact_words)
    failed = ", ".join(f"{count:g}" for count in record.plies["failed_yarns"][-1])
    print(f"failed yarn segments by ply: {failed}")
    print(record.gap_words)
    print(
        f"energy error at most {100 * record.energy_error_max:.3f} % of the strike energy, {record.strike_energy:.2f} J"
    )
    print(f"written to {out}", flush=True)
