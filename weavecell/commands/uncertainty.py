"""Scatter of the input from the command line: Sobol indices, and the ballistic limit as a probability.

Folder of `weavecell sensitivity`: sobol.csv, sobol.json, sobol.png, sobol.html
Folder of `weavecell v50`: v50.csv (curves), shots.csv, v50.json, v50.png, v50.html
Both keep runs/, a file for each run, from which --resume goes on.
"""

from __future__ import annotations

import csv
import time
import tomllib
from collections.abc import Callable, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fabrics import assumed, catalogue, run_cache, variants
from fabrics.errors import InputError
from fabrics.files import write_whole
from shellfabric.panel import grading as panel_grading
from weavecell.analysis.uncertainty import inputs, sobol, v50
from weavecell.report import marked_page, pictures_uncertainty
from weavecell.results import json_file, progress, provenance
from weavecell.scenes import impact

if TYPE_CHECKING:
    from fabrics.fabric import Fabric

RUNS = "runs"


def sensitivity(
    fabric: str, out: Path, *, velocities: Sequence[float], samples: int, seed: int, jobs: int, executor: str,
    opening: Any, resume: bool, page: Path | None = None,
) -> None:  # fmt: skip
    """Sobol indices of a fabric; see `sobol.study`. `page` is a Markdown file to put table and picture into."""
    cloth, began = _begin(fabric, out, page, "sobol", resume), time.perf_counter()
    with progress.bar(f"{cloth.name}, sensitivities") as advance:
        found = sobol.study(
            cloth, velocities, samples=samples, seed=seed, opening=opening, folder=out / RUNS, jobs=jobs,
            executor=executor, report=lambda done, total: advance(done / total, f"{done} of {total} rows"),
        )  # fmt: skip
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
    command = f"weavecell sensitivity {fabric} --samples {samples} --seed {seed}"
    title = f"{cloth.name}: Sobol indices, {count} rows"
    content = {"indices": [_plain(one) for one in found], "inputs": [asdict(one) for one in entries.values()]}
    finish(out, page, "sobol", title, head, rows, remarks, command, content, began, cloth,
            lambda path: pictures_uncertainty.indices(found, path, title))  # fmt: skip


def probabilistic(
    fabric: str, out: Path, *, shots: int, batch: int, seed: int, scatter: Any, jobs: int, executor: str,
    opening: Any, resume: bool, grading: tuple | None = None, page: Path | None = None,
) -> None:  # fmt: skip
    """The curve of perforation of a fabric; see `v50.study`."""
    cloth, began = _begin(fabric, out, page, "v50", resume), time.perf_counter()
    with progress.bar(f"{cloth.name}, repeated shots") as advance:
        study = v50.study(
            cloth, scatter, shots=shots, batch=batch, seed=seed, opening=opening, grading=grading, folder=out / RUNS,
            jobs=jobs, executor=executor, report=advance,
        )  # fmt: skip
    head = ["curve", "quantity", "value [m/s]", "low, 95 %", "high, 95 %"]
    rows = []
    for link, curve in study.curves.items():
        for name in ("V0", "V50", "V100"):
            rows.append([link, name, *(f"{v:.1f}" for v in (getattr(curve, name), *curve.intervals[name]))])
        scale = curve.deviation / curve.s if curve.s else 1.0
        values = (curve.deviation, *(scale * v for v in curve.intervals["s"]))
        rows.append([link, "standard deviation", *(f"{v:.2f}" for v in values)])
    _write_shots(study, out / "shots.csv")
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
    ]
    if grading is not None:
        remarks.append(
            f"Sides of the elements, (until, side) in crossovers from the impact point: {grading_text(grading)}."
        )
    for link, curve in study.curves.items():
        interval = "{:.1f} to {:.1f} m/s".format(*curve.intervals["V50"])
        print(f"V50 ({link}) {curve.V50:.1f} m/s, {interval} with {100 * curve.confidence:g} % confidence")
    command = f"weavecell v50 {fabric} --shots {len(study.shots)} --batch {batch} --seed {seed}"
    command += f' --grading "{grading_text(grading)}"' if grading is not None else ""
    title = f"{cloth.name}: probability of perforation, {len(study.shots)} shots"
    content = {
        "deterministic": study.deterministic, "scatter": asdict(scatter), "grading": grading and grading_text(grading),
        "curves": {link: asdict(curve) | {"V0": curve.V0, "V100": curve.V100} for link, curve in study.curves.items()},
        "inputs": [asdict(one) for name in ("weibull", "spread") for one in inputs.table(name).values()],
    }  # fmt: skip
    finish(out, page, "v50", title, head, rows, remarks, command, content, began, cloth,
            lambda path: pictures_uncertainty.perforation(study, path, title))  # fmt: skip


def grading_of(text: str, key: str = "grading") -> tuple[tuple[float, float], ...]:
    """Zones (until, side) [crossovers] of a grading, from a text as it stands in a scene file.

    Raises
    ------
    InputError : another text, or zones that do not go together
    """
    try:
        zones = impact.zones(tomllib.loads(f"grading = {text}")["grading"])
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


def _begin(fabric, out, page, name, resume):
    """The fabric, with the folder made ready; InputError before anything is written."""
    cloth = assumed.with_shear(catalogue.load(fabric))
    for line in assumed.lines(cloth):
        print(line)
    cloth = variants.with_linear_density(cloth)
    if page is not None:
        marked_page.split(page, *_marks(name))
    if not resume:
        run_cache.RunCache(out / RUNS).clear()
    return cloth


def finish(
    out: Path, page: Path | None, name: str, title: str, head: Sequence[str], rows: Sequence[Sequence[str]],
    remarks: Sequence[str], command: str, content: dict[str, Any], began: float, cloth: Fabric,
    draw: Callable[[Path], object],
) -> None:  # fmt: skip
    """Write table, record, picture and page of a study, and print its remarks.

    Parameters
    ----------
    page : Markdown page to put table and picture into, or None
    name : of the files; head, rows : of the table; remarks : lines
    command : that made it; content : of the record; began : perf_counter() at the start
    draw : called with the path of the picture
    """
    stamp = provenance.stamp(fabric=cloth)
    with write_whole(out / f"{name}.csv") as file:
        csv.writer(file).writerows([head, *rows])
    record = {**_finite(content), "wall_time": time.perf_counter() - began, "provenance": stamp}
    json_file.write(out / f"{name}.json", record)
    draw(out / f"{name}.png")
    made = f"Version {stamp['weavecell']}, commit {stamp['commit']}, {stamp['date']}, {stamp['processor']}."
    _write_html(out / f"{name}.html", name, title, head, rows, remarks, f"{command}. {made} {stamp['packages']}.")
    if page is not None:
        draw(page.parent / "figures" / f"scatter-{name}.png")
        _write_page(page, name, title, head, rows, remarks, f"Made by `{command}`. {made}")
    for line in remarks:
        print(line)
    print(f"written to {out}")


def _marks(name):
    return f"<!-- {name} -->", f"<!-- end of {name} -->"


def _write_page(page, name, title, head, rows, remarks, made):
    """Put a study between its marks of a Markdown page."""
    lines, table = "\n".join(f"- {line}" for line in remarks), marked_page.markdown([head, *rows])
    content = f"\n\n![{title}](figures/scatter-{name}.png)\n\n{lines}\n\n{table}\n{made}\n\n"
    marked_page.put(page, *_marks(name), content)


def _write_html(path, name, title, head, rows, remarks, footer):
    """One page: picture, remarks, table."""
    from importlib import resources

    import jinja2

    text = (resources.files("weavecell.report") / "templates" / "scatter.html.j2").read_text("utf-8")
    template = jinja2.Environment(autoescape=True, undefined=jinja2.StrictUndefined).from_string(text)
    with write_whole(path) as file:
        file.write(template.render(name=name, title=title, head=head, rows=rows, remarks=remarks, footer=footer))


def _write_shots(study, path):
    """One row a shot, by number."""
    head = [
        "number", "strike velocity [m/s]", "outcome", "residual velocity [m/s]", "factor on modulus", "on warp crimp",
        "on weft crimp", "on the weakest warp", "on the weakest weft", "energy balance [-]",
    ]  # fmt: skip
    with write_whole(path) as file:
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
