"""One impact on one ply or several, from its scene to its folder of results.

The folder of `weavecell impact`
    scene.toml      the input file as it was given
    projectile.stl  a copy of the STL file of the projectile, where the input file names one
    histories.h5    scalars, histories, every ply at the end (`results.impact.ImpactRecord`)
    summary.json    outcome, energies, provenance
    panel.pvd       the ParaView series of panel/panel-*.vtu: all plies, distinguished by "ply"
    pictures/       histories, cuts, energies, reactions, of several plies their shares (.svg), panel.png
    report.html     all of it on one page
    checkpoint.h5   only while the run goes on, or after it was interrupted: `--resume` goes on from it

Where the scene says how accurate its results are to be, finer and finer meshes are run (`analysis.discretisation`):
summary.json and the report then tell which, and whether the targets were met.

Where a law of the fabric is assumed, the shot is repeated with both ends of its range, and the range of the residual
velocity is stated (`analysis.assumed_range`); not for packs and not for scenes with [accuracy].

Everything but the checkpoint is written when the run has ended, also if it ended by becoming unstable.
"""

from __future__ import annotations

import shutil
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fabrics import lazy
from fabrics.errors import DoubtfulError, InputError, UnstableError, WeavecellError
from weavecell.commands import options

with lazy.imports():
    from fabrics import run_cache
    from weavecell.analysis import assumed_range as over_assumed
    from weavecell.analysis import discretisation
    from weavecell.commands import uncertainty as scatter
    from weavecell.report import chapters_assumed, chapters_discretisation, checks
    from weavecell.report import page as report_page
    from weavecell.report.shot import shot_page, tables_shot
    from weavecell.results import impact as results_impact
    from weavecell.results import impact_shapes, json_file, out_folder, paraview, progress, provenance, run_folder
    from weavecell.scenes import build, of_commands, words
    from weavecell.scenes import impact as scenes_impact

if TYPE_CHECKING:
    from shellfabric.cell.model import CellTable
    from shellfabric.impact.simulation import ImpactResult, ImpactSetup
    from shellfabric.output.snapshots import Snapshot
    from weavecell.analysis.discretisation import Discretisation
    from weavecell.results.impact import ImpactRecord

_OF_DRAWS = ("draws", "shape", "seed", "jobs", "executor")


class Interrupted(WeavecellError):
    """The user stopped a run that can be gone on with."""

    exit_code = 130


@options.example("weavecell impact examples/S-720-stops.toml")
def impact(
    context: typer.Context,
    scene: Annotated[Path, typer.Argument(metavar="SCENE", help="A scene file (*.toml).")],
    out: options.OutOption = None,
    resume: options.ResumeOption = False,
    strict: options.StrictOption = False,
    assumed_range: options.AssumedRangeOption = True,
    uncertainty: Annotated[
        bool,
        typer.Option(
            "--uncertainty", help="Run a finer mesh too, and report the discretisation uncertainty of each result."
        ),
    ] = False,
    draws: Annotated[
        int | None,
        typer.Option(
            min=2, metavar="N", help="Shoot at N panels whose yarns differ in strength (Weibull), and report the mean."
        ),
    ] = None,
    shape: options.WeibullOption = None,
    seed: options.SeedOption = 1,
    jobs: options.JobsOption = options.CORES,
    executor: options.ExecutorOption = "local",
) -> None:
    """Fire the projectile of a scene at its panel: histories, ParaView series, pictures and a report.

    The folder then holds report.html, summary.json, histories.h5, panel.pvd with panel/*.vtu, pictures/ and scene.toml;
    while the run goes on, checkpoint.h5. A scene with a table \\[accuracy] says how well it wants to know something:
    it is run on finer and finer meshes, until two of them agree so far. A key of the scene that cannot be honoured is
    rejected.

    --draws N computes the whole panel N times, each yarn of each ply with a strength of its own, and writes mean,
    scatter and probability of perforation: summary.json, summary.html, draws.csv and runs/, from which --resume goes
    on, also to more draws. --weibull-shape, --seed, --jobs and --executor are of --draws alone. It ignores
    panel.symmetry, run.snapshot_interval, run.checkpoint_interval, run.outputs, history.interval, history.warp,
    history.weft and history.report_positions.
    """
    if draws is not None:
        options.refuse_others(context, ("scene", "out", "resume", *_OF_DRAWS), "with --draws")
        folder = out or options.RESULTS / f"{scene.stem}-draws"
        scatter.draws(scene, folder, count=draws, shape=shape, seed=seed, jobs=jobs, executor=executor, resume=resume)
    else:
        options.refuse_others(context, set(context.params) - set(_OF_DRAWS), "without --draws")
        run(scene, out or options.RESULTS / scene.stem, resume, strict, assumed_range, uncertainty)


def run(
    path: Path, out: Path, resume: bool = False, strict: bool = False, with_range: bool = True,
    uncertainty: bool = False,
) -> None:  # fmt: skip
    """Run the scene at `path` and write its results to the folder `out`; the others are options of `impact`.

    Raises
    ------
    InputError : the scene or what it names is wrong; nothing has been written
    UnstableError : the run became unstable; what it had computed has been written
    DoubtfulError : a quality indicator is beyond its limit, and `strict`; all results have been written
    Interrupted : by the user; the last checkpoint has been kept
    """
    scene, text = scenes_impact.load(path, of_commands.impact)
    this = build.build(scene, path, path.stem)
    setup = build.setup(this, path)
    key = run_cache.key((text, setup, with_range, uncertainty), "shellfabric.impact.simulation")
    if resume and finished(out, key, strict):
        return
    out_folder.claim(out, resume and bool(checkpoints(out)))
    title = scene.title or f"{setup.title}, {scene.projectile.strike_velocity:g} m/s"

    def shoot(setup, table=None, model=""):
        checkpoint = out / f"checkpoint{'-' + model.replace(' ', '-') if model else ''}.h5"
        every, again = scene.run.checkpoint_interval, resume and checkpoint.exists()
        return fire(this, setup, title, checkpoint=checkpoint, every=every, resume=again, table=table)

    try:
        (record, snapshots, failure), pair = _shots(scene, setup, shoot, uncertainty)
    except InputError as problem:
        raise build.in_file(problem, path) from None
    except KeyboardInterrupt:
        hint = "; --resume goes on from its last checkpoint" if checkpoints(out) else ""
        raise Interrupted(f"interrupted{hint}") from None
    plain = with_range and scene.accuracy is None and failure is None and setup.plies == 1
    around = _range(setup, record) if plain else None
    with progress.bar("Writing results") as advance:
        write(out, this, setup, record, snapshots, text, advance, around, pair, key)
    for checkpoint in checkpoints(out):
        checkpoint.unlink()
    _tell(record, out, around, pair)
    if failure is not None:
        raise failure
    checks.report(record.checks, strict)


# keys of a scene that [accuracy] would change; what is given there stays
_BY_HAND = {("panel", "symmetry"): "symmetry", ("projectile", "body"): "projectile"}


def _shots(scene, setup, shoot, uncertainty):
    """((record, snapshots, failure) of the run that counts, Discretisation or None)."""
    if scene.accuracy is None:
        return discretisation.run_pair(setup, shoot) if uncertainty else (shoot(setup)[:3], None)
    if uncertainty:
        allowed = "left out for a scene with [accuracy], which compares its meshes"
        raise InputError(key="--uncertainty", value="given", allowed=allowed)
    fixed = {field for (table, key), field in _BY_HAND.items() if key in getattr(scene, table).model_fields_set}
    return discretisation.climb(setup, scene.accuracy.targets, shoot, fixed=fixed)


def _range(setup, record):
    """The AssumedRange of a shot; None where nothing is assumed, or where the user interrupts it."""
    if not over_assumed.corners(setup.fabric, setup.laws):
        return None
    try:
        with progress.bar("Range over the assumed laws") as advance:
            return over_assumed.residual_velocity(setup, record.outcome, record.residual_velocity, advance)
    except KeyboardInterrupt:
        return None


def finished(out: Path, key: str, strict: bool) -> bool:
    """Whether a folder holds the results of the run with a `run_cache.key`, which is then printed.

    Raises
    ------
    DoubtfulError : they are doubtful, and `strict`
    """
    file = out / "summary.json"
    found = json_file.read_summary(file) if file.exists() and not checkpoints(out) else {}
    if found.get("run_key") != key or found["outcome"] == "unstable":
        return False
    print(f"{found['title']}: {found['outcome']}; done before with the same input and code, in {out}")
    if strict and found["checks"]["status"] == checks.DOUBTFUL:
        raise DoubtfulError("the result is doubtful")
    return True


def checkpoints(out: Path) -> list[Any]:
    """The checkpoints in a folder: one, or one for each model that has been tried."""
    return sorted(out.glob("checkpoint*.h5"))


def fire(
    this: build.Case, setup: ImpactSetup, title: str, *, checkpoint: Path | None = None, every: float | None = None,
    resume: bool = False, table: CellTable | None = None,
) -> tuple[ImpactRecord, tuple[tuple[Snapshot, ...], ...], UnstableError | None, ImpactResult]:  # fmt: skip
    """Run an impact under a progress bar, with checkpoints if a path for them is given.

    Returns
    -------
    record : ImpactRecord
    snapshots : of each instant the tuple of the plies' shellfabric.output.snapshots.Snapshot
    failure : the UnstableError that ended the run, or None
    result : ImpactResult
    """
    from shellfabric.impact import simulation
    from shellfabric.output.checkpoint import LEAST_WALL, Checkpoints
    from shellfabric.plies import memory

    table = table or setup.table(kept=True)
    memory.check([setup.panel(table)] * setup.plies, setup.snapshots, written=True)
    hooks = () if checkpoint is None else (Checkpoints(checkpoint, every, LEAST_WALL),)  # type: ignore[arg-type]
    result, failure = progress.watched(
        lambda hooks: simulation.run(setup, hooks=hooks, resume=checkpoint if resume else None, table=table),
        title,
        hooks,
    )
    return (
        results_impact.ImpactRecord.of(result, title, this.law_name, str(failure or "")),
        result.snapshots,
        failure,
        result,
    )


def write(
    out: Path, this: build.Case, setup: ImpactSetup, record: ImpactRecord, snapshots: Sequence[tuple[Snapshot, ...]],
    text: str, advance: Callable[..., object], around: Any = None, pair: Discretisation | None = None, key: str = "",
) -> None:  # fmt: skip
    """Write everything but the checkpoint; `key` is that of the run, for `finished`."""
    outputs = this.scene.run.outputs
    stamp = provenance.stamp(text, setup=setup)
    more = checks.summary(record.checks) | chapters_assumed.summary(around)
    more |= chapters_discretisation.summary(pair) | {"projectile": words.shot_in_words(this.scene.projectile)}
    more |= {"run_key": key}
    run_folder.write(out, text, record, more, stamp)
    if this.scene.projectile.stl is not None:
        shutil.copyfile(this.scene.projectile.stl, out / "projectile.stl")
    advance(0.1)
    shutil.rmtree(out / "panel", ignore_errors=True)  # of an earlier run, whose series may have been longer
    if "paraview" in outputs:
        before = [tuple(map(impact_shapes.Shape.of, shots)) for shots in snapshots if shots[0].t < record.final[0].t]
        paraview.write_panel(out, [*before, record.final], record.quads)
    advance(0.4)
    if not {"pictures", "report"} & set(outputs):
        return
    used = setup if pair is None else pair.setup
    sections = shot_page.sections(this, used, record, around, pair)
    if "pictures" in outputs:
        report_page.write_pictures(sections, out / "pictures")
    advance(0.9)
    if "report" in outputs:
        report_page.write(shot_page.page(this, used, record, sections, stamp), out / "report.html")


def _tell(record, out, around, pair):
    print(f"{record.title}: {record.outcome}, {tables_shot.residual(record)}")
    if record.pack:
        print(record.contact_words)
        print(f"failed yarn segments by ply: {', '.join(f'{n:g}' for n in record.plies['failed_yarns'][-1])}")
        print(record.gap_words)
    print(
        f"energy error at most {100 * record.energy_error_max:.3f} % of the strike energy, {record.strike_energy:.2f} J"
    )
    if record.rigid_check:
        print(record.rigid_check)
    if record.backing is not None:
        moving = 100 * record.energies["backing_kinetic"][-1] / record.strike_energy
        signature = 1e3 * record.backing.back_face_signature
        print(f"back-face signature {signature:.3g} mm; the block still moves with {moving:.2g} % of the strike energy")
    print(f"viscous energy {100 * record.viscous_energy_fraction:.1f} % of the {record.absorbed_energy:.2f} J absorbed")
    print(f"written to {out}", flush=True)
    if around is not None:
        print(f"assumed laws: {around.words()}")
    if pair is not None:
        print(chapters_discretisation.words(pair))
