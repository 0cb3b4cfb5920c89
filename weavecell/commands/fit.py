"""Parameters of an input file or fabric fitted to a measured curve: `weavecell fit`.

| FILE | DATA, a CSV file with units in its heading | computed |
| --- | --- | --- |
| input file of a shot | time [us], velocity [m/s] of the projectile | velocity over time |
| input file of a shot, or a fabric | velocity [m/s], outcome, residual velocity [m/s] | residual velocities |
| input file of a coupon | what the test prescribes, and loads (`COLUMNS`) | loads over it |
| fabric | pressure [MPa], thickness [mm] or closure [um] of a ply between platens | E_c, V_c, K_r of its 3D yarns |

The folder of `weavecell fit`
    fit.json            parameters with intervals, what the data leave open, misfits, provenance
    fit.csv             every point: measured, computed with the values of the file, computed with the fitted ones
    fit.svg             the same as a plot
    fitted.toml         the input file with the fitted values; fabric.toml its fabric, where that was fitted
    scene.toml          the input file as it was
    runs/               finished runs, from which --resume goes on
Of platens: solid.json, fit.svg and fabric.toml.
"""

from __future__ import annotations

import csv
import os
from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from pathlib import Path
from typing import Annotated, Any

import typer

from fabrics import lazy
from fabrics.errors import InputError
from weavecell.commands import options

with lazy.imports():
    from fabrics import assumed, catalogue, executors, files, plate_curve, run_cache
    from fabrics import fabric as fabrics_fabric
    from weavecell.analysis import fit as fit_of
    from weavecell.analysis.uncertainty import inputs
    from weavecell.commands import fit_model, mesh
    from weavecell.report import pictures
    from weavecell.results import json_file, out_folder, progress, provenance
    from weavecell.scenes import target


@options.example("weavecell fit examples/S-720-stops.toml radar.csv --free modulus --free crimp_warp")
def fit(
    name: Annotated[
        str, typer.Argument(metavar="FILE|FABRIC", help="An input file of a shot or a coupon, a fabric's name or file.")
    ],
    data: Annotated[Path, typer.Argument(metavar="DATA", help="Measured curve (*.csv), units in its heading.")],
    free: Annotated[
        list[str] | None,
        typer.Option(
            help="What is fitted; may be given again. Without a range: half to twice what the file has.",
            metavar="NAME[=LOW..HIGH]",
        ),
    ] = None,
    jobs: options.JobsOption = options.CORES,
    executor: options.ExecutorOption = "local",
    resume: options.ResumeOption = False,
    out: options.OutOption = None,
) -> None:
    r"""Fit numbers of a fabric or an input file to a measured curve, with intervals and what the curve leaves open.

    DATA has the columns time and velocity of a projectile; or velocity, outcome and residual velocity of shots, as of
    `weavecell compare`; or what a coupon is prescribed and its loads; or pressure and thickness or closure of a ply
    between platens. Each has its unit in the heading: "time \[us], velocity \[m/s]".

    NAME is a key of the input file that holds a number, such as panel.crossover_friction, or a factor on the fabric:
    modulus, failure_strain, crimp_warp, crimp_weft, compression_a, compression_b, trellis_stiffness, trellis_angles.
    Platens give E_c, V_c and K_r of the yarns in 3D, without --free.

    Ignored keys of the input file: title, run.snapshot_interval, run.checkpoint_interval, run.outputs, and with shots
    projectile.strike_velocity, run.end_time and backing.after_stop; \[history] and \[accuracy] are rejected.

    The folder then holds fit.json, fit.csv, fit.svg, scene.toml, and with fitted values fitted.toml and fabric.toml.
    """
    run(
        name,
        data,
        out or options.RESULTS / f"fit-{Path(name).stem}",
        free or (),
        jobs=jobs,
        executor=executor,
        resume=resume,
    )


def run(
    name: str, data: Path, out: Path, free: Sequence[str], *, jobs: int, executor: str | Executor, resume: bool
) -> fit_of.Fit | None:  # fmt: skip
    """Fit what `free` names to the data, write and print what is found; as `weavecell.fit`."""
    if _is_platens(data):
        _platens(name, data, out, free, resume)
        return None
    points = fit_model.read(name, data)
    model = fit_model.Model(name, points, out)
    out_folder.claim(out, resume)
    if not resume:
        run_cache.RunCache(out / options.RUNS).clear()
    with (
        progress.bar(f"{model.title}, fit of {', '.join(free)}") as advance,
        executors.open_executor(executor, jobs) as pool,
    ):

        def report(trials, rms):
            advance(1 - 0.8 ** (trials / (2 * len(free) + 1)), f"misfit {100 * rms:.2f} %")

        try:
            found = fit_model.solve(model, free, report, folder=out / options.RUNS, executor=pool, jobs=jobs)
        except InputError as problem:
            if problem.key == "points":
                raise InputError(file=data, key="rows", value=problem.value, allowed=problem.allowed) from None
            raise
    _write(out, model, found)
    _tell(found, points, out)
    return found


def _is_platens(data):
    """Whether a table is of a compression between platens."""
    return any(name.partition("[")[0].strip() == "pressure" for name in fit_model.heading_of(data))


def _platens(name, data, out, free, resume):
    """Fit the solid yarns of a fabric to a compression between platens."""
    from weavecell.commands import calibrate_solid

    for text in free:
        raise InputError(key="--free", value=text, allowed="left out: a platen curve gives E_c, V_c and K_r")
    curve = plate_curve.PlateCurve.read(data)
    fabric = mesh.with_3d_data(name)
    out_folder.claim(out, resume)
    found = calibrate_solid.fit(fabric, curve, out, resume=resume)
    chapter = calibrate_solid.chapter(found, {})
    files.write(out / "fit.svg", chapter.figures[0].content)
    solids = found.fabric.solid_laws
    units = {"E_a": "Pa", "E_c": "Pa", "K_r": "", "K_G": "", "V_c": "", "Vf0": ""}
    entries = {
        f"solid.{yarn}.{key}": (getattr(solid, key), unit)
        for yarn, solid in zip(fit_model.YARNS, solids) for key, unit in units.items()
    }  # fmt: skip
    fitted = {f"solid.{yarn}.{key}" for yarn in fit_model.YARNS for key in ("E_c", "V_c", "K_r")}
    _write_fabric(out, _fabric_text(name), entries, fitted, Path(data).name)
    print(f"written to {out}")


def _fabric_text(name):
    """The file of a fabric of the catalogue, or a user's."""
    path = Path(catalogue.__file__).parent / f"{name}.toml" if name in catalogue.list_names() else Path(name)
    return path.read_text("utf-8")


def _write_fabric(out, text, entries, fitted, source):
    """Write fabric.toml: a fabric's file with {dotted key: (value, unit)} in place of its own.

    Parameters
    ----------
    fitted : the keys of `entries` that were fitted; the others, assumed, belong to them and are written where missing
    source : name of the data
    """
    import tomlkit

    table = tomlkit.parse(text)
    for key, (value, unit) in entries.items():
        *parts, last = key.split(".")
        inner: Any = table
        for part in parts:
            inner = inner.setdefault(part, tomlkit.table())
        row = tomlkit.inline_table()
        row["value"] = f"{value:.6g} {unit}".strip()
        row["source"] = f"fitted to {source}" if key in fitted else "assumed by fibre family"
        row["status"] = "fitted" if key in fitted else "assumed"
        if key in fitted or last not in inner:
            inner[last] = row
        if last == "failure_strain":  # the same, in other words
            for other in {"strength", "tenacity"} & set(inner):
                inner.remove(other)
    files.write(out / "fabric.toml", tomlkit.dumps(table))


def _fitted_fabric(model, factors):
    """(entries, fitted) of `_write_fabric` for factors on the fabric."""
    cloth = model.case.scene.fabric
    own = assumed.with_shear(catalogue.load(cloth.file or cloth.name)) if any(
        name.startswith("trellis") for name in factors) else catalogue.load(cloth.file or cloth.name)  # fmt: skip
    fabric: fabrics_fabric.Fabric = inputs.changed(own, **factors)
    entries, fitted = {}, set()
    for name in factors:
        rows = fit_model.NUMBERS[name]
        if name.startswith("trellis"):  # all four belong together
            rows = fit_model.NUMBERS["trellis_stiffness"] + fit_model.NUMBERS["trellis_angles"]
        elif name.startswith("compression"):
            rows = fit_model.NUMBERS["compression_a"] + fit_model.NUMBERS["compression_b"]
        for key, k, attribute, unit in rows:
            if k is not None:
                held: Any = fabric.weave.yarns[k]
            else:
                held = fabric.shear if key.startswith("shear") else (fabric.laws or (None,))[0]
            entries[key] = float(getattr(held, attribute)), unit
        fitted |= {key for key, *_ in fit_model.NUMBERS[name]}
    return entries, fitted


def _write(out, model, found):
    import tomlkit

    points = model.points
    values = {one.name: float(value) for one, value in zip(found.parameters, found.values)}
    factors = {name: value for name, value in values.items() if name in fit_model.NUMBERS}
    table: Any = tomlkit.parse(model.text)
    if model.from_file:  # else they are taken from `out` already
        _move_paths(table, Path(model.name).parent, out)
    if factors:
        cloth = model.case.scene.fabric
        _write_fabric(out, _fabric_text(cloth.file or cloth.name), *_fitted_fabric(model, factors), points.source)
        table["fabric"].pop("name", None)
        table["fabric"]["file"] = "fabric.toml"
    for name, text in (
        ("fitted.toml", tomlkit.dumps(target.changed(table, model.changes(values)))),
        ("scene.toml", model.text),
    ):
        files.write(out / name, text)
    x, unit, at = points.x
    with files.write_whole(out / "fit.csv") as file:
        rows = csv.writer(file)
        heads = [f"{x} [{unit or '1'}]", "quantity", *(f"{name} [{points.unit}]" for name in _LINES)]
        rows.writerow(heads)
        places = [(a, name) for name in points.columns for a in at]
        for place, *row in zip(places, found.measured, found.before, found.computed):
            rows.writerow([f"{place[0]:.9g}", place[1], *(f"{value:.6g}" for value in row)])
    summary = {"format": "weavecell fit 1", "fabric": model.title, "data": points.source}
    stamp = provenance.stamp(model.text, model.fabric)
    json_file.write(out / "fit.json", summary | found.summary() | {"provenance": stamp})
    files.write(out / "fit.svg", pictures.render(pictures.fitted, model.title, points, found))


_LINES = "measured", "computed before", "computed"


def _move_paths(table, folder, out):
    """Take the relative paths of an input file's table from another folder."""
    for name, value in table.items():
        for one in value if isinstance(value, list) else [value]:
            if isinstance(one, Mapping):
                _move_paths(one, folder, out)
        if name in ("file", "law", "surface", "ply_contact") and isinstance(value, str) and (folder / value).is_file():
            table[name] = os.path.relpath(folder / value, out)


def _tell(found, points, out):
    rows = zip(found.parameters, found.values, found.intervals, found.determined, found.at_bound)
    for one, value, (low, high), known, bound in rows:
        says = "" if known else ", not determined by the data"
        says += f", at the end of its range {one.low:g} to {one.high:g}" if bound else ""
        factor = "x " if one.name in fit_model.NUMBERS else ""
        unit = f" {one.unit}" if one.unit else ""
        print(f"{one.name:<28}{factor}{value:.4g}{unit} ({low:.4g} to {high:.4g}, 95 %{says}); from {one.start:.4g}")
    for first, second, r in found.together:
        print(f"{first} and {second}: known only together (correlation {r:.2f})")
    of = "largest value" if len(points.columns) == 1 else "largest value of its column"
    print(
        f"misfit {100 * found.rms(found.computed):.2f} % of the {of} (rms of {len(found.measured)} points), before "
        f"{100 * found.rms(found.before):.2f} %"
    )
    if found.likeness:
        print(
            f"neighbouring misfits are alike (correlation {found.likeness:.2f}): the model does not follow the curve "
            "within its scatter; the intervals are widened for it"
        )
    if not found.met:
        print(f"doubtful: not converged within {fit_of.MOST} evaluations")
    print(f"written to {out}", flush=True)
