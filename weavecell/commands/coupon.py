"""One test on one coupon from its scene to its folder of results.

The folder of `weavecell coupon`
    scene.toml      the input file as it was given
    histories.h5    measures, nodes and shear after every step, tensions at the end (`results.coupon.CouponRecord`)
    summary.json    outcome, measures at the end, provenance
    pictures/       coupon.png, and curves (.svg)
    report.html     all of it on one page
    checkpoint.h5   only while the run goes on, or after it was interrupted: `--resume` goes on from it

A pull-out is dynamic: it has no load steps and no checkpoint, its histories.h5 holds the samples of the load
(`results.pull_out.PullOutRecord`), and load.csv holds them as text.

Everything but the checkpoint is written when the run has ended, also if it ended by becoming unstable.
"""

from __future__ import annotations

import time
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fabrics import lazy
from fabrics.errors import InputError, UnstableError
from weavecell.commands.options import RESULTS, OutOption, ResumeOption, StrictOption, example

with lazy.imports():
    from fabrics import run_cache
    from weavecell.commands import impact
    from weavecell.report import chapters, checks, pictures, pictures_coupon
    from weavecell.report import page as report_page
    from weavecell.results import coupon as results_coupon
    from weavecell.results import coupon_measures, out_folder, progress, provenance, pull_out, run_folder
    from weavecell.scenes import build, of_commands
    from weavecell.scenes import coupon as scenes_coupon

if TYPE_CHECKING:
    from shellfabric.cell.model import CellTable
    from shellfabric.coupon.solver import Result
    from weavecell.scenes.schema import FabricTable

TABLE_SIZE = 201  # stretches along each side of the cell's table, as in impacts
WORDS = {
    "bias_extension": "bias extension", "picture_frame": "picture frame", "uniaxial": "uniaxial tension",
    "biaxial": "biaxial tension", "pull_out": "yarn pull-out",
}  # fmt: skip


@example("weavecell coupon examples/coupons/S-728-bias.toml")
def coupon(
    path: Annotated[Path, typer.Argument(metavar="SCENE", help="The scene file of a coupon (*.toml).")],
    out: OutOption = None,
    resume: ResumeOption = False,
    strict: StrictOption = False,
) -> None:
    """Test a piece of fabric quasi-statically: bias extension, picture frame, uniaxial or biaxial tension.

    The folder then holds report.html, summary.json, histories.h5, pictures/ and scene.toml; while the run goes on,
    checkpoint.h5.
    """
    out = out or RESULTS / path.stem
    scene, text = scenes_coupon.load(path, of_commands.COUPON)
    this = build.build(scene, path, path.stem)
    checkpoint = out / "checkpoint.h5"
    code = "shellfabric.coupon.quasistatic", "shellfabric.coupon.pull_out"
    key = run_cache.key((text, this.fabric, this.laws, scene.model_dump()), *code)
    if resume and impact.finished(out, key, strict):
        return
    resume &= checkpoint.exists()
    out_folder.claim(out, resume)
    title = scene.title or f"{this.fabric.name}, {WORDS[scene.test]}"
    if scene.test == "pull_out":
        _pull_out(this, path, title, text, out, strict, key)
        return
    began = time.perf_counter()
    try:
        result, table, failure = _pull(this, title, checkpoint, resume)
    except InputError as problem:
        raise build.in_file(problem, path, {scene.test: type(scene.test_table)}) from None
    except KeyboardInterrupt:
        hint = "; --resume goes on from its last step" if checkpoint.exists() else ""
        raise impact.Interrupted(f"interrupted{hint}") from None
    record = results_coupon.CouponRecord.of(
        result, coupon_measures.measures(scene.test, scene.test_table, result), coupon_measures.PRESCRIBED[scene.test],
        title=title,
        fabric=this.fabric.name, law_name=this.law_name, test=scene.test, failure_message=str(failure or ""),
        wall_time=time.perf_counter() - began, checks=coupon_measures.indicators(result, table, scene.run.tolerance),
    )  # fmt: skip
    with progress.bar("Writing results") as advance:
        _write(out, this, record, text, advance, key)
    checkpoint.unlink(missing_ok=True)
    print(f"{record.title}: {record.outcome}")
    for line in lines(record):
        print(line)
    print(f"written to {out}", flush=True)
    if failure is not None:
        raise failure
    checks.report(record.checks, strict)


def _pull_out(this, path, title, text, out, strict, key):
    """Run a yarn pull-out, write its results and print them."""
    began, scene, failure = time.perf_counter(), this.scene, None
    with progress.bar(title) as advance:
        try:
            hooks = [lambda solver: advance(solver.time / solver.end_time)]
            curve = pull_out.run(_table(this), scene.pull_out, hooks, scene.fabric.bending)
        except InputError as problem:
            raise build.in_file(problem, path, {scene.test: type(scene.test_table)}) from None
        except UnstableError as problem:
            failure, curve = problem, problem.result
    record = pull_out.PullOutRecord.of(
        curve, title=title, law_name=this.law_name, failure_message=str(failure or ""),
        wall_time=time.perf_counter() - began,
    )  # fmt: skip
    stamp = provenance.stamp(text, this.fabric)
    run_folder.write(out, text, record, checks.summary(record.checks) | {"run_key": key}, stamp)
    record.write_csv(out / "load.csv")
    section = _pull_out_chapter(record)
    if "pictures" in scene.run.outputs:
        report_page.write_pictures([section], out / "pictures")
    if "report" in scene.run.outputs:
        lead = f"One yarn of {record.fabric} drawn through {curve.coupon.crossings} held crossovers."
        report_page.write(_page(this, record, section, stamp, lead, record.lines()), out / "report.html")
    print("\n".join([f"{record.title}: {record.outcome}", *record.lines()]))
    print(f"written to {out}", flush=True)
    if failure is not None:
        raise failure
    checks.report(record.checks, strict)


def _pull_out_chapter(record):
    """The chapter of a pull-out: load and crossovers in slip against the displacement, and a table of the results."""
    caption = "Load on the pulled yarn; below: crossovers that it slides through, and those that its end has left."
    content = pictures.render(pictures_coupon.pull_out, record)
    rows = tuple((line[:44].strip(), line[44:].strip()) for line in record.lines())
    lead = f"The run was stopped: {record.failure_message}." if record.failure_message else ""
    table = report_page.Table(("quantity", "value"), rows, "", numeric=("value",))
    return report_page.Section(
        "coupon", WORDS["pull_out"].capitalize(), lead, (report_page.Figure(content, "svg", caption, "load"),), (table,)
    )


def _pull(this, title, checkpoint, resume):
    """(Result, its CellTable, the UnstableError that ended it or None), with a bar and checkpoints."""
    scene, table, failure = this.scene, _table(this), None
    stamp = _stamp(table, scene)
    states = list(results_coupon.read_states(checkpoint, stamp)) if resume else []
    with progress.bar(title) as advance:

        def keep(state):
            states.append(state)
            results_coupon.write_states(checkpoint, stamp, states)
            advance(state.load, f"{state.iterations} iterations")

        try:
            result = relaxed(
                table, scene.test, dict(scene.test_table), **scene.run.model_dump(exclude={"outputs"}), progress=keep,
                done=tuple(states),
            )  # fmt: skip
        except UnstableError as problem:
            failure, result = problem, problem.result
    return result, table, failure


def relaxed(table: CellTable, test: str, inputs: Mapping[str, Any], **options: Any) -> Result:
    """The Result of a quasi-static test: `inputs` by the keys of its table, options as of its function."""
    from shellfabric.coupon import quasistatic

    named = {"cells" if key == "crossovers" else key: value for key, value in inputs.items()}
    return getattr(quasistatic, test)(table, **named, **options)


def cell_of(cloth: FabricTable) -> tuple[Any, ...]:
    """Gap, model, form, profile and slack of the CellModel that a table [fabric] asks for."""
    return cloth.crossover_gap, cloth.cell_model, cloth.cell_formulation, cloth.cell_profile, cloth.fibre_slack


def _table(this):
    """The table of the cell."""
    from shellfabric.cell.model import CellModel

    return CellModel(this.fabric, this.laws, *cell_of(this.scene.fabric)).table(TABLE_SIZE)


def _stamp(table, scene):
    """Digests of all that the states of a run depend on, the code among it."""
    fabric = table.model.fabric
    inputs = (scene.test, scene.test_table.model_dump(), scene.run.model_dump(exclude={"outputs"}))
    inputs += (fabric.weave, fabric.shear, table.model.toes, table.potential)
    return run_cache.stamp(inputs, "shellfabric.coupon.quasistatic")


def _write(out, this, record, text, advance, key):
    """Write everything but the checkpoint."""
    outputs = this.scene.run.outputs
    stamp = provenance.stamp(text, this.fabric)
    run_folder.write(out, text, record, checks.summary(record.checks) | {"run_key": key}, stamp)
    advance(0.2)
    if not outputs:
        return
    section = chapter(record, this.scene.run.tolerance)
    advance(0.7)
    if "pictures" in outputs:
        report_page.write_pictures([section], out / "pictures")
    if "report" in outputs:
        lead = (
            f"A coupon of {record.fabric}, {record.elements} elements, in {len(record.prescribed)} load steps, each "
            f"relaxed to {this.scene.run.tolerance:g} of the reaction."
        )
        report_page.write(_page(this, record, section, stamp, lead, lines(record)[:-1]), out / "report.html")


def chapter(record: results_coupon.CouponRecord, tolerance: float) -> report_page.Section:
    """The chapter of one test: the coupon, its curves, and a table of all steps."""
    figures = [
        report_page.Figure(
            pictures.render(pictures_coupon.cloth, record, kind="png"), "png",
            "The coupon at the end, to scale. Left: shear of the elements. Right: tension of the yarns.", "coupon",
        )
    ]  # fmt: skip
    for name, chosen, label, caption in pictures_coupon.DRAWN[record.test]:
        drawn = tuple(measure for measure in chosen if measure in record.measures)
        content = pictures.render(pictures_coupon.curves, record, drawn, label)
        figures.append(report_page.Figure(content, "svg", caption, name))
    content = pictures.render(pictures_coupon.relaxation, record, tolerance)
    caption = "Dynamic relaxation: out-of-balance force on the free nodes over the reaction; lines end the load steps."
    figures.append(report_page.Figure(content, "svg", caption, "relaxation"))
    columns = (
        _headed(record.prescribed_name, record.prescribed_unit),
        *(_headed(n, u) for n, (u, _) in record.measures.items()),
    )
    columns += ("residual", "iterations")
    rows = tuple(
        (
            _as_text(record.prescribed_name, record.prescribed_unit, record.prescribed[k]),
            *(_as_text(name, unit, values[k]) for name, (unit, values) in record.measures.items()),
            f"{record.residual[k]:.1e}",
            f"{record.iterations[k]}",
        )
        for k in range(len(record.prescribed))
    )
    lead = f"The run was stopped: {record.failure_message}." if record.failure_message else ""
    table = report_page.Table(columns, rows, "After each load step", numeric=columns)
    return report_page.Section("coupon", WORDS[record.test].capitalize(), lead, tuple(figures), (table,))


def _headed(name, unit):
    shown = pictures_coupon.axis(name, unit)[1]
    return f"{name} [{shown}]" if shown else name


def _as_text(name, unit, value):
    """A value as text, without its unit."""
    return f"{pictures_coupon.axis(name, unit)[0] * value:.4g}"


def lines(record: results_coupon.CouponRecord) -> list[str]:
    """What a test came to, in a few lines."""
    found, moved = [], (record.prescribed_unit, record.prescribed)
    for name, (unit, values) in {record.prescribed_name: moved, **record.measures}.items():
        found.append(f"{name:<34}{_as_text(name, unit, values[-1])} {pictures_coupon.axis(name, unit)[1]}".rstrip())
    found.append(
        f"{record.elements} elements, {int(record.iterations.sum())} iterations, residual {record.residual.max():.1e} "
        f"at most, {record.wall_time:.1f} s"
    )
    return found


def _page(this, record, section, stamp, lead, shown):
    """The report of one test."""
    model = this.scene.fabric.cell_model
    tone = "unstable" if record.outcome == "unstable" else "stopped"
    cards = (
        chapters.fabric_card(this.fabric),
        chapters.law_card(this.laws[0], source=this.law_name if model == "compressible" else model),
        report_page.Card(WORDS[record.test], record.outcome, tuple(" ".join(line.split()) for line in shown), tone),
    )
    return report_page.Report(
        record.title,
        lead,
        (cards,),
        (
            section,
            chapters.cell(this.fabric, {this.law_name: this.laws}, model, **chapters.options(this.scene.fabric)),
            checks.section(record.checks),
            chapters.sources(this.fabric),
            chapters.making(stamp, {"test": record.wall_time}),
        ),
        f"weavecell {stamp['weavecell']}, {stamp['date']}",
    )
