"""One scene at panels whose yarns differ in strength (`weavecell impact SCENE --draws N`).

The folder of `weavecell impact --draws`
    scene.toml      the scene as it was given
    draws.csv       one row a draw: outcome, residual velocity, absorbed energy, peak tensions, weakest yarn
    summary.json    mean, standard deviation and standard error of each, probability of perforation, provenance
    summary.csv     the same as a table
    summary.png     residual velocities of the draws, and their mean over the number of draws
    summary.html    all of it on one page
    runs/           a file for each finished draw, from which --resume goes on, also to more draws
"""

from __future__ import annotations

import csv
import time
from dataclasses import replace
from pathlib import Path

from fabrics.errors import InputError, UnstableError
from fabrics.files import write_whole
from weavecell.analysis.uncertainty import draws, inputs
from weavecell.commands import impact, impact_pack
from weavecell.commands.uncertainty import RUNS, finish
from weavecell.report import pictures_uncertainty
from weavecell.results import progress
from weavecell.scenes import build
from weavecell.scenes import impact as scenes_impact
from weavecell.scenes.supported import of

_IGNORED = (
    "panel.symmetry", *of("run", "snapshot_interval checkpoint_interval outputs"),
    *of("history", "interval warp weft report_positions"),
)  # fmt: skip
SUPPORT, PACK_SUPPORT = (
    replace(
        support, command="weavecell impact --draws", ignored=_IGNORED,
        supported=tuple(key for key in support.supported if key not in _IGNORED and not key.startswith("accuracy.")),
        rejected={**support.rejected, "accuracy": "left out with --draws, which runs the mesh of the scene"},
    )
    for support in (impact.SUPPORT, impact_pack.SUPPORT)
)  # fmt: skip


def command(
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
    scene, text = scenes_impact.load(path, lambda scene: PACK_SUPPORT if scene.panel.plies > 1 else SUPPORT)
    this = build.build(scene, path, path.stem)
    setup = build.setup(this, path)
    scatter = inputs.published() if shape is None else replace(inputs.published(), shape=shape)
    title = scene.title or f"{this.fabric.name}, {scene.projectile.strike_velocity:g} m/s"
    shot = setup if scene.panel.plies == 1 else build.pack_setup(setup, scene.panel)
    try:
        with progress.bar(f"{title}, draws") as advance:
            study = draws.study(
                shot, scatter, count, folder=out / RUNS, seed=seed, jobs=jobs, executor=executor, resume=resume,
                report=lambda done, total: advance(done / total, f"{done} of {total} draws"),
            )  # fmt: skip
    except InputError as problem:
        raise impact_pack.in_file(problem, path) from None
    with write_whole(out / "scene.toml") as file:
        file.write(text)
    columns = study.columns()
    with write_whole(out / "draws.csv") as file:
        csv.writer(file).writerows([_HEADS, *zip(*(columns[name] for name in _HEADS.values()))])
    head, rows, remarks = table(study)
    title = f"{title}: {count} draws of yarn strength"
    done = f"weavecell impact {path.name} --draws {count} --seed {seed}"
    finish(out, None, "summary", title, head, rows, remarks, done, study.summary(), began, this.fabric,
           lambda file: pictures_uncertainty.draws(study, file, title))  # fmt: skip
    unstable = len(study.draws) - len(study.counted)
    if unstable:
        raise UnstableError(f"{unstable} of {count} draws became unstable and count in no estimate")


_HEADS = {
    "number": "number", "outcome": "outcome", "residual velocity [m/s]": "residual_velocity",
    "absorbed energy [J]": "absorbed_energy", "peak tension, warp [N]": "peak_tension_warp",
    "peak tension, weft [N]": "peak_tension_weft", "failed yarn segments": "failed", "end [s]": "time",
    "factor on the weakest yarn": "weakest", "energy balance [-]": "balance",
}  # fmt: skip


def table(study: draws.Draws) -> tuple[list[str], list[list[str]], list[str]]:
    """(heads, rows, remarks) of a study as texts."""
    head = ["quantity", "unit", "mean", "standard error", "standard deviation"]
    rows = []
    for name, (unit, words) in draws.QUANTITIES.items():
        found = study.estimate(name)
        rows.append([words, unit, *(f"{value:.4g}" for value in (found.mean, found.error, found.deviation))])
    share, low, high = study.probability()
    counts = ", ".join(f"{n} {name}" for name, n in study.outcomes.items() if n)
    remarks = [f"{row[0]}: {row[2]} ± {row[3]} {row[1]} (mean and standard error), scatter {row[4]}" for row in rows]
    remarks += [
        f"probability of perforation {share:.2f}, {low:.2f} to {high:.2f} with {100 * draws.CONFIDENCE:g} % confidence "
        f"(Wilson); {counts}",
        f"Weibull shape {study.scatter.shape:g} at {1e3 * study.scatter.gauge_length:g} mm, seed {study.seed}; every "
        f"yarn of every ply is drawn and the whole panel computed; worst energy balance "
        f"{100 * max(one.balance for one in study.draws):.2g} %",
    ]
    return head, rows, remarks
