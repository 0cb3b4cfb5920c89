"""Shots at drawn panels from the command line (`weavecell impact --draws`).

The folder: draws.csv, summary.csv (means), .json, .png, .html, scene.toml, and runs/, a file for each run, from which
--resume goes on, also to more draws.
"""

from __future__ import annotations

import time
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from fabrics import lazy
from fabrics.errors import InputError, UnstableError
from weavecell.commands import options

with lazy.imports():
    from fabrics import files
    from weavecell.analysis.uncertainty import draws as draws_of
    from weavecell.analysis.uncertainty import inputs
    from weavecell.report import pictures_uncertainty, study_page
    from weavecell.results import out_folder, progress
    from weavecell.scenes import build, of_commands
    from weavecell.scenes import impact as impact_scenes

if TYPE_CHECKING:
    from pandas import DataFrame


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
    table, remarks = draws_table(study)
    title = f"{title}: {count} draws of yarn strength"
    remarks += [f"Note: {note}." for note in setup.notes]
    study_page.write(
        out, "summary", title, table, remarks, study.summary(),
        lambda pyplot: pictures_uncertainty.draws(pyplot, study, title), setup, time.perf_counter() - began,
    )  # fmt: skip
    print(*remarks, f"written to {out}", sep="\n")
    unstable = len(study.draws) - len(study.counted)
    if unstable:
        raise UnstableError(f"{unstable} of {count} draws became unstable and count in no estimate")


_HEADS = {"number": "number", "outcome": "outcome", "residual velocity [m/s]": "residual_velocity",
    "absorbed energy [J]": "absorbed_energy", "peak tension, warp [N]": "peak_tension_warp",
    "peak tension, weft [N]": "peak_tension_weft", "failed yarn segments": "failed", "end [s]": "time",
    "factor on the weakest yarn": "weakest", "energy balance [-]": "balance",
}  # fmt: skip


def draws_table(study: draws_of.Draws) -> tuple[DataFrame, list[str]]:
    """(table of the quantities, remarks) of a study."""
    from pandas import DataFrame

    rows = []
    for name, (unit, words) in draws_of.QUANTITIES.items():
        of = study.estimate(name)
        rows.append((words, unit, of.mean, of.error, of.deviation))
    share, low, high = study.probability()
    counts = ", ".join(f"{n} {name}" for name, n in study.outcomes.items() if n)
    remarks = [
        f"{words}: {mean:.4g} ± {error:.4g} {unit} (mean and standard error), scatter {deviation:.4g}"
        for words, unit, mean, error, deviation in rows
    ]
    remarks += [
        f"probability of perforation {share:.2f}, {low:.2f} to {high:.2f} with {100 * draws_of.CONFIDENCE:g} % "
        f"confidence (Wilson); {counts}",
        f"Weibull shape {study.scatter.shape:g} at {1e3 * study.scatter.gauge_length:g} mm, seed {study.seed}; every "
        f"yarn of every ply is drawn and the whole panel computed; worst energy balance "
        f"{100 * max(one.balance for one in study.draws):.2g} %",
    ]
    return DataFrame(rows, columns=["quantity", "unit", "mean", "standard error", "standard deviation"]), remarks
