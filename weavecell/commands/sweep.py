"""An input file over values of its keys: `weavecell sweep`, a row for each combination.

The folder: sweep.csv, sweep.json, sweep.png, scene.toml, and runs/, a file for each finished run. A sweep that was
interrupted goes on from them when it is called with --resume.
"""

from __future__ import annotations

import io
import itertools
from contextlib import nullcontext, redirect_stdout
from pathlib import Path
from typing import Annotated, Any

import typer

from fabrics import lazy
from fabrics.errors import InputError
from weavecell.commands import options

with lazy.imports():
    from fabrics import files, run_cache
    from weavecell.analysis import sweep as analysis
    from weavecell.analysis.uncertainty import inputs
    from weavecell.report import pictures_uncertainty
    from weavecell.results import json_file, out_folder, progress, provenance
    from weavecell.scenes import impact as scenes
    from weavecell.scenes import of_commands, schema, supported, target


@options.example("weavecell sweep pack.toml --over panel.plies=2,4,8 --quantity critical-velocity")
def sweep(
    name: options.TargetArgument,
    over: Annotated[
        list[str],
        typer.Option(
            help="A key of the input file and its values; may be given again, for all combinations.",
            metavar="KEY=VALUE,VALUE,...",
        ),
    ],
    quantity: Annotated[
        str, typer.Option(help="What is computed of each: one shot, its ballistic limit, or its V50.",
                          metavar="shot|critical-velocity|v50")
    ] = "shot",
    tolerance: Annotated[
        str, typer.Option(help="Of a critical velocity: between stop and perforation.", metavar="VELOCITY")
    ] = "1 m/s",
    shots: Annotated[int, typer.Option(min=4, help="Of a V50.")] = 60,
    seed: options.SeedOption = 1,
    jobs: options.JobsOption = options.CORES,
    executor: options.ExecutorOption = "local",
    resume: options.ResumeOption = False,
    out: options.OutOption = None,
) -> None:  # fmt: skip
    """Repeat an input file over values of its keys, and compute a shot, the ballistic limit or V50 of each.

    All combinations are checked before the first is computed. Ignored keys of the input file: title,
    run.snapshot_interval, run.checkpoint_interval, run.outputs, and for a limit or V50 projectile.strike_velocity,
    run.end_time and backing.after_stop; \\[history] and \\[accuracy] are rejected.

    The folder then holds sweep.csv, sweep.json, sweep.png (against areal density, of numbers of plies), and scene.toml.
    """
    width = options.above_zero(tolerance, "m/s", "--tolerance")
    try:
        wanted = analysis.Wanted(quantity, width, shots, seed)
    except InputError as problem:
        raise InputError(key=f"--{problem.key}", value=problem.value, allowed=problem.allowed) from None
    out = out or options.RESULTS / f"sweep-{Path(name).stem}"
    keys = [parse(text) for text in over]
    check = of_commands.SWEEP if wanted.quantity == "shot" else of_commands.LIMITS
    combinations = [dict(zip((key for key, _ in keys), values)) for values in itertools.product(*(v for _, v in keys))]
    targets, own = [], wanted.quantity == "v50"
    for number, changes in enumerate(combinations):
        with redirect_stdout(io.StringIO()) if number else nullcontext():  # what is assumed is printed once
            targets.append(target.read(name, out, check, changes=changes, own_mesh=own))
    out_folder.claim(out, resume)
    rows = _rows(targets, wanted, out / options.RUNS, jobs, executor, resume)
    table = [
        changes | {"areal_density_kg_m2": one.setup.areal_density} | row
        for changes, one, row in zip(combinations, targets, rows)
    ]
    _write(out, targets, [key for key, _ in keys], table, wanted)


def parse(text: str) -> tuple[str, list[Any]]:
    """(key, values) of a text such as "panel.plies=2,4,8" or "projectile.strike_velocity=100 m/s,150 m/s".

    Raises
    ------
    InputError : a text of another form
    """
    key, mark, values = text.partition("=")
    if not mark or not key.strip() or not all(value.strip() for value in values.split(",")):
        raise InputError(key="--over", value=text, allowed='KEY=VALUE,VALUE,... such as "panel.plies=2,4,8"')
    return key.strip(), [_value(value.strip()) for value in values.split(",")]


def _value(text):
    """A number or a truth value as in TOML; any other text as it is."""
    import tomllib

    try:
        found = tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        return text
    return found if isinstance(found, (bool, int, float, str)) else text


def _rows(targets, wanted, folder, jobs, executor, resume):
    """A row of each target; errors name the input file."""
    runs: dict[str, Any] = {"folder": folder, "executor": executor, "jobs": jobs}
    if not resume:
        run_cache.RunCache(folder).clear()
    try:
        with progress.bar(f"{len(targets)} x {wanted.quantity}") as advance:
            if wanted.quantity == "v50":
                found = []
                for number, one in enumerate(targets):
                    report = lambda share, words, n=number: advance((n + share) / len(targets), words)  # noqa: E731
                    found.append(analysis.v50_of(one.setup, wanted, report=report, **runs))
                return found
            return run_cache.results(
                analysis.point, [(inputs.alone(one.setup), wanted) for one in targets],
                report=lambda done, total: advance(done / total, f"{done} of {total}"), **runs,
            )  # fmt: skip
    except InputError as problem:
        raise targets[0].in_file(problem) from None


def _write(out, targets, keys, table, wanted):
    columns = list(dict.fromkeys(name for row in table for name in row))
    files.write(out / "scene.toml", targets[0].text)
    files.write_csv(out / "sweep.csv", [columns, *([row.get(name, "") for name in columns] for row in table)])
    stamp = provenance.stamp(targets[0].text, setup=targets[0].setup)
    json_file.write(out / "sweep.json", {"quantity": wanted.quantity, "rows": table, "provenance": stamp})
    column, ends, label = analysis.QUANTITIES[wanted.quantity]
    x, words = _abscissa(targets, keys[0], table)
    pictures_uncertainty.save(
        pictures_uncertainty.sweep, out / "sweep.png", x, words, table, keys[1:], (column, ends, label)
    )
    for row in table:
        value = row.get(column)
        words = row["outcome"] if value is None else f"{value:.1f} m/s, {row['outcome']}"
        if row["outcome"] == analysis.MIXED:
            words += f" from {row[ends[0]]:.1f} to {row[ends[1]]:.1f} m/s"
        doubt = ", doubtful" if row.get("checks") == "doubtful" else ""
        print(f"{', '.join(f'{key} = {row[key]}' for key in keys)}: {words}{doubt}")
    print(f"written to {out}")


def _abscissa(targets, key, table):
    """(values, words) of the first key: numbers with their unit, areal density for the number of plies, or texts."""
    if key == "panel.plies":
        return [row["areal_density_kg_m2"] for row in table], "areal density [kg/m²]"
    values = []
    for one in targets:
        value = one.case.scene
        for part in key.split("."):
            value = getattr(value, part)
        values.append(value)
    if not all(isinstance(value, (int, float)) and not isinstance(value, bool) for value in values):
        return [str(row[key]) for row in table], key
    unit = schema.unit_of(supported.entries(scenes.Scene)[key])
    return values, f"{key} [{unit}]" if unit not in (None, "1") else key
