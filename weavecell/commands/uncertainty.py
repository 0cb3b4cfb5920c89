"""Scatter of the input from the command line: Sobol indices, and the ballistic limit as a probability.

Folder of `weavecell sensitivity`: sobol.csv, sobol.json, sobol.png, sobol.html, scene.toml
Folder of `weavecell v50`: v50.csv (curves), shots.csv, v50.json, v50.png, v50.html, scene.toml
Folder of `weavecell impact --draws`: draws.csv, summary.csv (means), .json, .png, .html, scene.toml
All keep runs/, a file for each run, from which --resume goes on, also to more draws.
"""

from __future__ import annotations

import csv
import time
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fabrics import lazy
from fabrics.errors import InputError, UnstableError
from weavecell.commands import options

with lazy.imports():
    from fabrics import files, run_cache, units
    from shellfabric.panel import grading as panel_grading
    from weavecell.analysis.uncertainty import draws as draws_of
    from weavecell.analysis.uncertainty import inputs, protocol, sobol
    from weavecell.analysis.uncertainty import v50 as v50_of
    from weavecell.commands import critical_velocity
    from weavecell.report import pictures_uncertainty
    from weavecell.results import json_file, out_folder, progress, provenance
    from weavecell.scenes import build, of_commands, schema, target
    from weavecell.scenes import impact as impact_scenes

if TYPE_CHECKING:
    from shellfabric.impact.simulation import ImpactSetup

STRIKES = 92.5, 170.0  # [m/s] of a fabric's sensitivities


OpeningOption = Annotated[
    str | None,
    typer.Option(help="Side of a fabric's square panel, 203 mm; an input file has its own.", metavar="LENGTH"),
]
GradingOption = Annotated[
    str | None,
    typer.Option(
        help="Sides of a fabric's elements by distance from the impact point, as panel.grading of an input file. If "
        "not given, one crossover near the impact point and up to four far off.",
        metavar="ZONES",
    ),
]


@options.example("weavecell sensitivity S-720 --samples 64")
def sensitivity(
    name: options.TargetArgument,
    velocity: Annotated[
        list[str] | None, typer.Option(help="Strike velocity; may be given again.", metavar="VELOCITY")
    ] = None,
    samples: Annotated[int, typer.Option(min=2, help="N, a power of 2; N (inputs + 2) rows are run.")] = 64,
    seed: options.SeedOption = 1,
    jobs: options.JobsOption = options.CORES,
    executor: options.ExecutorOption = "local",
    opening: OpeningOption = None,
    resume: options.ResumeOption = False,
    out: options.OutOption = None,
) -> None:
    """Sobol indices of the velocity after 200 us and of the peak tension over the uncertainties of the input.

    Where no strike velocity is given it is that of the input file, or 92.5 and 170 m/s at a fabric. A fabric is shot at
    as in the tests of the thesis: one ply, and a flat cylinder of 3 g and 5.5 mm. Of an input file these keys are
    ignored: title, run.snapshot_interval, run.checkpoint_interval, run.outputs; \\[history] and \\[accuracy] are
    rejected. The folder then holds sobol.html, .csv, .json, .png and scene.toml.
    """
    velocities = [units.si(text, "m/s", key="--velocity") for text in velocity or ()]
    out, began = out or options.RESULTS / f"sensitivity-{Path(name).stem}", time.perf_counter()
    this = _begin(name, out, resume, of_commands.SENSITIVITY, opening=opening)
    velocities = velocities or list((this.setup.strike_velocity,) if this.from_file else STRIKES)
    try:
        with progress.bar(f"{this.title}, sensitivities") as advance:
            found = sobol.study(
                this.setup, velocities, samples=samples, seed=seed, folder=out / options.RUNS, jobs=jobs,
                executor=executor, report=lambda done, total: advance(done / total, f"{done} of {total} rows"),
            )  # fmt: skip
    except InputError as problem:
        raise this.in_file(problem) from None
    files.write(out / "scene.toml", this.text)
    head = [
        "strike velocity [m/s]", "quantity", "input", "range [%]", "status of the range", "first order", "± 95 %",
        "total order", "± 95 %",
    ]  # fmt: skip
    entries = inputs.table("range")
    rows = [
        [f"{one.velocity:g}", one.quantity, pictures_uncertainty.LABELS.get(name, name),
         f"±{100 * entries[name].value:g}", entries[name].status,
         *(f"{values[k]:.3f}" for values in (one.first, one.first_half, one.total, one.total_half))]
        for one in found
        for k, name in enumerate(one.names)
    ]  # fmt: skip
    remarks = [
        f"{one.quantity}, struck at {one.velocity:g} m/s: {one.mean:.1f} ± {one.deviation:.1f} "
        f"{sobol.QUANTITIES[one.quantity]} (mean and standard deviation); {100 * one.perforated:.0f} % perforated"
        for one in found
    ]
    count = samples * (len(entries) + 2)
    remarks.append(f"{samples} base samples, {count} rows of {len(velocities)} shots, seed {seed}.")
    command = f"weavecell sensitivity {name} --samples {samples} --seed {seed}"
    title = f"{this.title}: Sobol indices, {count} rows"
    content = {"indices": [_plain(one) for one in found], "inputs": [asdict(one) for one in entries.values()]}
    _finish(out, "sobol", title, head, rows, remarks, command, content, began, this.setup,
            lambda path: pictures_uncertainty.indices(found, path, title))  # fmt: skip


@options.example("weavecell v50 S-720 --shots 200 --weibull-shape 14.3")
def v50(
    name: options.TargetArgument,
    shots: Annotated[int, typer.Option(min=4, help="Number of shots.")] = 100,
    batch: Annotated[
        int, typer.Option(min=4, help="Shots in a batch; each batch is placed by the results of those before.")
    ] = 10,
    shape: options.WeibullOption = None,
    modulus: Annotated[
        str | None,
        typer.Option(
            "--modulus-cov", help="Coefficient of variation of the modulus between panels.", metavar="FRACTION"
        ),
    ] = None,
    crimp: Annotated[
        str | None,
        typer.Option("--crimp-cov", help="Coefficient of variation of the crimp between panels.", metavar="FRACTION"),
    ] = None,
    seed: options.SeedOption = 1,
    jobs: options.JobsOption = options.CORES,
    executor: options.ExecutorOption = "local",
    opening: OpeningOption = None,
    grading: GradingOption = None,
    resume: options.ResumeOption = False,
    out: options.OutOption = None,
) -> None:
    """V0, V50 and V100 of panels or packs whose yarns differ in strength, by repeated shots, with intervals.

    What is not given of the scatter is taken from weavecell/analysis/uncertainty/inputs.toml. Without scatter V50
    is the critical velocity. A fabric is shot at as in the tests of the thesis: one ply, and a flat cylinder of 3 g
    and 5.5 mm. Of an input file these keys are ignored: title, projectile.strike_velocity, run.end_time,
    backing.after_stop, run.snapshot_interval, run.checkpoint_interval, run.outputs; \\[history] and \\[accuracy]
    are rejected.

    The folder then holds v50.html, .csv, .json, .png, shots.csv and scene.toml.
    """
    own = {"shape": shape}
    for key, text in (("modulus", modulus), ("crimp", crimp)):
        own[key] = None if text is None else units.si(text, "", key=f"--{key}-cov")
    scatter = replace(inputs.published(), **{key: value for key, value in own.items() if value is not None})
    out = out or options.RESULTS / f"v50-{Path(name).stem}"
    sides = None
    if grading is not None:
        import tomllib

        grading_of(grading, "--grading")  # which refuses a wrong one
        sides = tomllib.loads(f"grading = {grading}")["grading"]
    began = time.perf_counter()
    this = _begin(name, out, resume, of_commands.LIMITS, own_mesh=True, opening=opening, grading=sides)
    try:
        with progress.bar(f"{this.title}, repeated shots") as advance:
            study = v50_of.study(
                this.setup, scatter, shots=shots, batch=batch, seed=seed, folder=out / options.RUNS, jobs=jobs,
                executor=executor, report=advance,
            )  # fmt: skip
    except InputError as problem:
        raise this.in_file(problem) from None
    command = f"weavecell v50 {name} --shots {len(study.shots)} --batch {batch} --seed {seed}"
    command += f' --grading "{grading}"' if grading is not None else ""
    _write_v50(out, this, study, scatter, batch, seed, command, began)


def _write_v50(out, this, study, scatter, batch, seed, command, began):
    files.write(out / "scene.toml", this.text)
    _write_shots(study, out / "shots.csv")
    for link, curve in study.curves.items():
        interval = "{:.1f} to {:.1f} m/s".format(*curve.intervals["V50"])
        print(f"V50 ({link}) {curve.V50:.1f} m/s, {interval} with {100 * curve.confidence:g} % confidence")
    title = f"{this.title}: probability of perforation, {len(study.shots)} shots"
    zones = v50_of.graded(this.setup).grading
    content = {
        **study.summary(), "plies": this.case.scene.panel.plies, "projectile": this.projectile,
        "deterministic": study.deterministic, "series": asdict(study.series),
        "lambert_jonas": study.fit and asdict(study.fit), "scatter": asdict(scatter),
        "grading": zones and grading_text(zones),
        "curves": {link: asdict(curve) | {"V0": curve.V0, "V100": curve.V100} for link, curve in study.curves.items()},
        "inputs": [asdict(one) for name in ("weibull", "spread") for one in inputs.table(name).values()],
    }  # fmt: skip
    head, rows = _curves_table(study)
    remarks = _v50_remarks(study, scatter, batch, seed, zones)
    _finish(out, "v50", title, head, rows, remarks, command, content, began, this.setup,
            lambda path: pictures_uncertainty.save(pictures_uncertainty.perforation, path, study, title))  # fmt: skip


def _curves_table(study):
    """(heads, rows) of the fitted curves as texts."""
    rows = []
    for link, curve in study.curves.items():
        for name in ("V0", "V50", "V100"):
            rows.append([link, name, *(f"{v:.1f}" for v in (getattr(curve, name), *curve.intervals[name]))])
        scale = curve.deviation / curve.s if curve.s else 1.0
        values = (curve.deviation, *(scale * v for v in curve.intervals["s"]))
        rows.append([link, "standard deviation", *(f"{v:.2f}" for v in values)])
    return ["curve", "quantity", "value [m/s]", "low, 95 %", "high, 95 %"], rows


def _v50_remarks(study, scatter, batch, seed, zones):
    through = [s for s in study.shots if s.perforated]
    stopped = [s for s in study.shots if not s.perforated]
    low, high = study.deterministic
    remarks = [
        f"Without scatter the limit is between {low:.1f} and {high:.1f} m/s.",
        f"{len(study.shots)} shots in rounds of {batch}, {len(through)} perforated, seed {seed}; slowest perforation "
        f"{min(s.velocity for s in through):.1f} m/s, fastest stop {max(s.velocity for s in stopped):.1f} m/s; worst "
        f"energy balance {100 * max(s.balance for s in study.shots):.2g} %.",
        f"Weibull shape {scatter.shape:g} at {1e3 * scatter.gauge_length:g} mm; standard deviation of the modulus "
        f"{100 * scatter.modulus:g} %, of either crimp {100 * scatter.crimp:g} %, from panel to panel.",
        "V0 and V100 are where 1 % and 99 % perforate.",
        _series_words(study.series),
    ]
    if study.curves["probit"].separated:
        remarks.append("No stop is faster than a perforation: the shots are too few to tell the scatter of the limit.")
    if study.doubtful:
        remarks.append(_doubts(study.shots))
    if study.fit is not None:
        remarks.append(f"Residual velocities, Lambert-Jonas: {critical_velocity.parameters(study.fit)}.")
    if zones is not None:
        text = grading_text(zones)
        remarks.append(f"Sides of the elements, (until, side) in crossovers from the impact point: {text}.")
    return remarks


def _doubts(shots):
    """How many shots are doubtful, and by which checks."""
    counts = Counter(name for shot in shots for name in shot.doubtful)
    checks = ", ".join(f"{name} in {count}" for name, count in counts.most_common())
    some = sum(bool(shot.doubtful) for shot in shots)
    return f"{some} of {len(shots)} shots are doubtful; checks beyond their limits: {checks}."


def draws(
    path: Path, out: Path, *, count: int, shape: float | None, seed: int, jobs: int, executor: str, resume: bool
) -> None:
    """Shoot at `count` drawn panels of the scene at `path`; print and write what they come to.

    Parameters
    ----------
    shape : Weibull shape of the strengths; None takes that of inputs.toml
    seed, jobs, executor : as of `draws.study`
    resume : whether to take the draws that the folder holds

    Raises
    ------
    InputError : the scene or what it names is wrong; nothing has been written
    UnstableError : a draw became unstable; all results have been written
    """
    began = time.perf_counter()
    scene, text = impact_scenes.load(path, of_commands.DRAWS)
    this = build.build(scene, path, path.stem)
    setup = build.setup(this, path)
    scatter = inputs.published() if shape is None else replace(inputs.published(), shape=shape)
    title = scene.title or f"{setup.title}, {scene.projectile.strike_velocity:g} m/s"
    out_folder.claim(out, resume)
    try:
        with progress.bar(f"{title}, draws") as advance:
            study = draws_of.study(
                setup, scatter, count, folder=out / options.RUNS, seed=seed, jobs=jobs, executor=executor,
                resume=resume, report=lambda done, total: advance(done / total, f"{done} of {total} draws"),
            )  # fmt: skip
    except InputError as problem:
        raise build.in_file(problem, path) from None
    files.write(out / "scene.toml", text)
    columns = study.columns()
    files.write_csv(out / "draws.csv", [_HEADS, *zip(*(columns[name] for name in _HEADS.values()))])
    head, rows, remarks = draws_table(study)
    title = f"{title}: {count} draws of yarn strength"
    done = f"weavecell impact {path.name} --draws {count} --seed {seed}"
    _finish(out, "summary", title, head, rows, remarks, done, study.summary(), began, setup,
           lambda file: pictures_uncertainty.draws(study, file, title))  # fmt: skip
    unstable = len(study.draws) - len(study.counted)
    if unstable:
        raise UnstableError(f"{unstable} of {count} draws became unstable and count in no estimate")


_HEADS = {"number": "number", "outcome": "outcome", "residual velocity [m/s]": "residual_velocity",
    "absorbed energy [J]": "absorbed_energy", "peak tension, warp [N]": "peak_tension_warp",
    "peak tension, weft [N]": "peak_tension_weft", "failed yarn segments": "failed", "end [s]": "time",
    "factor on the weakest yarn": "weakest", "energy balance [-]": "balance",
}  # fmt: skip


def draws_table(study: draws_of.Draws) -> tuple[list[str], list[list[str]], list[str]]:
    """(heads, rows, remarks) of a study as texts."""
    head = ["quantity", "unit", "mean", "standard error", "standard deviation"]
    rows = []
    for name, (unit, words) in draws_of.QUANTITIES.items():
        found = study.estimate(name)
        rows.append([words, unit, *(f"{value:.4g}" for value in (found.mean, found.error, found.deviation))])
    share, low, high = study.probability()
    counts = ", ".join(f"{n} {name}" for name, n in study.outcomes.items() if n)
    remarks = [f"{row[0]}: {row[2]} ± {row[3]} {row[1]} (mean and standard error), scatter {row[4]}" for row in rows]
    remarks += [
        f"probability of perforation {share:.2f}, {low:.2f} to {high:.2f} with {100 * draws_of.CONFIDENCE:g} % "
        f"confidence (Wilson); {counts}",
        f"Weibull shape {study.scatter.shape:g} at {1e3 * study.scatter.gauge_length:g} mm, seed {study.seed}; every "
        f"yarn of every ply is drawn and the whole panel computed; worst energy balance "
        f"{100 * max(one.balance for one in study.draws):.2g} %",
    ]
    return head, rows, remarks


def grading_of(text: str, key: str = "grading") -> tuple[tuple[float, float], ...]:
    """Zones (until, side) [crossovers] of a grading, from a text as it stands in a scene file.

    Raises
    ------
    InputError : another text, or zones that do not go together
    """
    import tomllib

    try:
        zones = schema.zones(tomllib.loads(f"grading = {text}")["grading"])
    except (tomllib.TOMLDecodeError, ValueError, ZeroDivisionError):
        zones = None
    if zones is None:
        allowed = 'zones [until, side] in crossovers, such as [[10, "1/2"], [20, 1], [inf, 2]]'
        raise InputError(key=key, value=text, allowed=allowed)
    panel_grading.check(zones)
    return zones


def grading_text(zones: tuple[tuple[float, float], ...]) -> str:
    """The zones of a grading as `grading_of` reads them."""
    sides = [side if side >= 1 else f"'1/{round(1 / side)}'" for _, side in zones]
    return "[" + ", ".join(f"[{until:g}, {side:g}]" if isinstance(side, float) else f"[{until:g}, {side}]"
                           for (until, _), side in zip(zones, sides)) + "]"  # fmt: skip


def _begin(name, out, resume, support, **panel):
    """The target, with the folder made ready; InputError before anything is written."""
    this = target.read(name, out, support, **panel)
    out_folder.claim(out, resume)
    if not resume:
        run_cache.RunCache(out / options.RUNS).clear()
    return this


def _finish(
    out: Path, name: str, title: str, head: Sequence[str], rows: Sequence[Sequence[str]],
    remarks: Sequence[str], command: str, content: dict[str, Any], began: float, setup: ImpactSetup,
    draw: Callable[[Path], object],
) -> None:  # fmt: skip
    """Write table, record, picture and page of a study, and print its remarks.

    Parameters
    ----------
    name : of the files; head, rows : of the table; remarks : lines
    command : that made it; content : of the record; began : perf_counter() at the start
    draw : called with the path of the picture
    """
    stamp, remarks = provenance.stamp("", setup=setup), [*remarks, *(f"Note: {note}." for note in setup.notes)]
    files.write_csv(out / f"{name}.csv", [head, *rows])
    record = {**_finite(content), "wall_time": time.perf_counter() - began, "provenance": stamp}
    json_file.write(out / f"{name}.json", record)
    draw(out / f"{name}.png")
    made = f"Version {stamp['weavecell']}, commit {stamp['commit']}, {stamp['date']}, {stamp['processor']}."
    _write_html(out / f"{name}.html", name, title, head, rows, remarks, f"{command}. {made} {stamp['packages']}.")
    for line in remarks:
        print(line)
    print(f"written to {out}")


def _series_words(found):
    """What short series of tests find."""
    if not found.share:
        return "No short series of tests has a result: the zone of mixed outcomes is too wide."
    return (
        f"A series of tests up and down, at most {protocol.MOST} shots, V50 of the {protocol.PAIRS} fastest stops and "
        f"{protocol.PAIRS} slowest perforations within {protocol.SPAN:g} m/s, finds {found.mean:.1f} m/s, standard "
        f"deviation {found.deviation:.1f}, 95 % of them between {found.low:.1f} and {found.high:.1f}; "
        f"{100 * found.share:.0f} % have a result, after {found.shots:.1f} shots."
    )


def _write_html(path, name, title, head, rows, remarks, footer):
    """One page: picture, remarks, table."""
    from importlib import resources

    import jinja2

    text = (resources.files("weavecell.report") / "templates" / "scatter.html.j2").read_text("utf-8")
    template = jinja2.Environment(autoescape=True, undefined=jinja2.StrictUndefined).from_string(text)
    files.write(path, template.render(name=name, title=title, head=head, rows=rows, remarks=remarks, footer=footer))


def _write_shots(study, path):
    """One row a shot, by number."""
    head = [
        "number", "strike velocity [m/s]", "outcome", "residual velocity [m/s]", "factor on modulus", "on warp crimp",
        "on weft crimp", "on the weakest warp", "on the weakest weft", "energy balance [-]",
    ]  # fmt: skip
    with files.write_whole(path) as file:
        rows = csv.writer(file)
        rows.writerow(head)
        for s in study.shots:
            numbers = (s.residual, s.modulus, s.crimp_warp, s.crimp_weft, *s.weakest)
            outcome = "perforated" if s.perforated else "stopped"
            rows.writerow([s.number, s.velocity, outcome, *(f"{x:.5g}" for x in numbers), f"{s.balance:.3e}"])


def _plain(one):
    """Indices as JSON can hold them."""
    return _finite({name: value.tolist() if hasattr(value, "tolist") else value for name, value in asdict(one).items()})


def _finite(content):
    """The same without infinities and NaN, which JSON has not: null."""
    if isinstance(content, dict):
        return {key: _finite(value) for key, value in content.items()}
    if isinstance(content, (list, tuple)):
        return [_finite(value) for value in content]
    return None if isinstance(content, float) and not abs(content) < float("inf") else content
