"""The calibration chain of every fabric with a platen law (`python -m validation calibration --fit-solid`).

Platen curve -> E_c, V_c, K_r -> biaxial paths -> (a, b), beside the law with the solid of the fabric's file.

Folder
    solids.csv, laws.csv, platens.png, laws.png, report.html    all fabrics side by side
    <fabric>/                      solid.json, law-interval.json, law.json, calibration.json, histories (.h5)
    <fabric>/solid-of-the-file/    law.json, calibration.json, histories with the solid of the fabric's file
    solid-runs/                    what is kept for --resume
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from fabrics import catalogue
from fabrics.errors import InputError, UnstableError
from fabrics.files import write, write_csv
from validation import marked_page
from validation.published import pictures_calibration
from weavecell.api import calibration, targets
from weavecell.report import chapters, pictures
from weavecell.report import page as report_page
from weavecell.report.page import Card, Figure, Section, Table
from weavecell.results import json_file, out_folder, progress, provenance

if TYPE_CHECKING:
    from fabrics.fabric import Fabric
    from fabrics.plate_curve import PlateCurve
    from unitcell3d.identify.solid_record import SolidFit

SOLID_COLUMNS = (
    "fabric", "misfit before [µm]", "before, of the pressure [%]", "fitted [µm]", "fitted, of the pressure [%]",
    "on the finer mesh [µm]", "of the pressure [%]", "E_c [GPa]", "V_c [-]", "K_r [-]", "K_r E_c [MPa]",
)  # fmt: skip
LAW_COLUMNS = (
    "fabric", "a, b published [mm, mm N^(1/3)]", "a, b with the file's solid", "a / published", "b / published",
    "a with the fitted solid", "95 %", "b with the fitted solid", "95 %", "a / published", "b / published",
    "within 25 % and 30 %",
)  # fmt: skip
A_TARGET, B_TARGET = 0.25, 0.30
MARKS = "<!-- chain -->", "<!-- end of chain -->"
SOLID_OF_THE_FILE = "solid-of-the-file"


def command(
    out: Path, *, size: str, jobs: int, executor: str, resume: bool, friction: float = 0.0, page: Path | None = None
) -> None:
    """Run the chain of the whole catalogue, write the tables and print them."""
    fabrics, skipped = with_curves()
    if page is not None:
        marked_page.split(page, *MARKS)
    out_folder.claim(out, resume)
    with targets.kept_runs(out, resume, calibration.SOLID_RUNS) as runs:
        fits, failed = _fit(fabrics, runs, jobs, executor)
        choices = {"size": size, "friction": friction, "jobs": jobs, "executor": executor}
        before, after = [fit.started for fit in fits], [fit.fabric for fit in fits]
        done = {"file": _laws(before, lambda name: out / name / SOLID_OF_THE_FILE, resume, **choices)}
        done["fitted"] = _laws(after, lambda name: out / name, resume, **choices)
        intervals = _intervals(fits, done["fitted"], runs, out, friction, jobs, executor)
    for fit in fits:
        fit.write(out / fit.fabric.name / "solid.json")
    tables = {
        "solids": [SOLID_COLUMNS, *map(solid_row, fits)],
        "laws": [LAW_COLUMNS, *(law_row(fit.fabric, *(found[fit.fabric.name]  # type: ignore[call-arg]
                                        for found in done.values()),
                                        intervals.get(fit.fabric.name, {})) for fit in fits)],
    }  # fmt: skip
    drawn = {
        "platens": pictures.render(pictures_calibration.platens, fits, kind="png"),
        "laws": pictures.render(pictures_calibration.chain, _ratios(fits, done, intervals), kind="png"),
    }
    remarks = [f"{name}: left out, since {reason}" for name, reason in {**skipped, **failed}.items()]
    _write(out, tables, drawn, remarks, size, friction, page)
    for row in tables["laws"][1:]:
        print(f"{row[0]:<8}a / published {row[3]:>5} -> {row[9]:>5}   b / published {row[4]:>5} -> {row[10]:>5}")
    print("\n".join([*remarks, f"written to {out}"]))
    if failed:
        raise UnstableError("; ".join(f"{name}: {reason}" for name, reason in failed.items()))


def with_curves() -> tuple[list[tuple[Fabric, PlateCurve]], dict[str, str]]:
    """([(Fabric, PlateCurve)], {name: why it has none}) of the catalogue."""
    found, skipped = [], {}
    for fabric in map(catalogue.load, catalogue.list_names()):
        if fabric.solid_laws is None:
            continue
        try:
            found.append((fabric, calibration.curve_of(fabric, None)))
        except InputError as problem:
            skipped[fabric.name] = str(problem)
    return found, skipped


def _fit(fabrics, runs, jobs, executor):
    """The SolidFits, and {name: text} of those that failed."""
    from unitcell3d.identify import chain

    with progress.bar(f"Solids of {len(fabrics)} fabrics from platens") as advance:
        found = chain.fit_solids(
            *zip(*fabrics), folder=runs, jobs=jobs, executor=executor, report=lambda n, of: advance(n / of, f"{n}")
        )
    failed = {f.name: str(each) for (f, _), each in zip(fabrics, found) if isinstance(each, Exception)}
    return [each for each in found if not isinstance(each, Exception)], failed


def _laws(fabrics, folder, resume, **choices):
    """{name: Calibration, or what ended it}."""
    from unitcell3d.identify.calibrate import CASES, calibrate_all

    with progress.bar(f"Calibration of {len(fabrics)} fabrics") as advance:
        on_progress = progress.by_path(advance, len(fabrics) * CASES)
        return calibrate_all(fabrics, folder=folder, resume=resume, on_progress=on_progress, **choices)


def _intervals(fits, laws, runs, out, friction, jobs, executor):
    """{name: {"a", "b": (low, high)}}, each written to the folder of its fabric."""
    from unitcell3d.identify import chain

    with progress.bar("Intervals of a and b") as advance:
        found = chain.law_intervals(
            fits, folder=runs, friction=friction, jobs=jobs, executor=executor,
            report=lambda done, total: advance(done / total, f"{done} of {total} paths"),
        )  # fmt: skip
    around = {}
    for fit, interval in zip(fits, found):
        name = fit.fabric.name
        if not isinstance(interval, Exception) and not isinstance(laws[name], Exception):
            around[name] = interval.around(laws[name].law)
            numbers = calibration.interval_numbers(interval, around[name])
            json_file.write(out / name / "law-interval.json", numbers)
    return around


def solid_row(fit: SolidFit) -> tuple[str, ...]:
    """A fabric's misfits and constants, as texts."""
    checked = fit.misfit_checked
    numbers = [f"{1e6 * fit.misfit_before.closure:.1f}", f"{100 * fit.misfit_before.pressure:.0f}",
               f"{1e6 * fit.misfit.closure:.1f}", f"{100 * fit.misfit.pressure:.0f}"]  # fmt: skip
    numbers += ["-", "-"] if checked is None else [f"{1e6 * checked.closure:.1f}", f"{100 * checked.pressure:.0f}"]
    if checked is not None and len(fit.checked) < len(fit.pressure):  # type: ignore[arg-type]
        numbers[-1] += f", to {1e-6 * fit.pressure[len(fit.checked) - 1]:.2g} MPa"  # type: ignore[arg-type]
    for (name, value), factor in zip(fit.values.items(), (1e-9, 1, 1, 1e-6)):
        low, high = fit.intervals[name]
        known = "" if fit.determined[name] else ", not determined"
        numbers.append(f"{factor * value:.3g} ({factor * low:.2g} .. {factor * high:.2g}{known})")
    return (fit.fabric.name, *numbers)


def law_row(fabric: Fabric, of_file: Any, fitted: Any, around: Any) -> tuple[str, ...]:
    """A fabric's laws, as texts."""
    published = fabric.laws[0] if fabric.laws else None
    ratios = [_ratio(found, published) for found in (of_file, fitted)]
    within = ratios[1] and abs(ratios[1][0] - 1) <= A_TARGET and abs(ratios[1][1] - 1) <= B_TARGET
    return (
        fabric.name,
        "-" if published is None else f"{1e3 * published.a:.4f}, {1e3 * published.b:.4f}",
        "-" if isinstance(of_file, Exception) else f"{1e3 * of_file.law.a:.4f}, {1e3 * of_file.law.b:.4f}",
        *_texts(ratios[0]),
        *_parameter(fitted, around, "a"),
        *_parameter(fitted, around, "b"),
        *_texts(ratios[1]),
        "-" if ratios[1] is None else "yes" if within else "no",
    )


def _ratio(found, published):
    if isinstance(found, Exception) or published is None:
        return None
    return found.law.a / published.a, found.law.b / published.b


def _texts(ratio):
    return ("-", "-") if ratio is None else tuple(f"{value:.2f}" for value in ratio)


def _parameter(found, around, key):
    """Value and interval [mm or mm N^(1/3)], as texts."""
    if isinstance(found, Exception):
        return "-", "-"
    low, high = around.get(key, (None, None))
    return f"{1e3 * getattr(found.law, key):.4f}", "-" if low is None else f"{1e3 * low:.4f} .. {1e3 * high:.4f}"


def _ratios(fits, done, intervals):
    """{name: {"a", "b": (with the file's solid, with the fitted one, low, high)}} over the published values."""
    found = {}
    for fit in fits:
        name, published = fit.fabric.name, fit.fabric.laws[0] if fit.fabric.laws else None
        laws = [each[name] for each in done.values()]
        if published is None or name not in intervals or any(isinstance(law, Exception) for law in laws):
            continue
        found[name] = {
            key: tuple(
                value / getattr(published, key)
                for value in (*(getattr(law.law, key) for law in laws), *intervals[name][key])
            )
            for key in "ab"
        }
    return found


def _write(out, tables, drawn, remarks, size, friction, page):
    stamp = provenance.stamp()
    for name, rows in tables.items():
        write_csv(out / f"{name}.csv", rows)
    for name, picture in drawn.items():
        write(out / f"{name}.png", picture)
    captions = {
        "platens": "Closure against pressure: the platen law, and the crossover before and after the fit.",
        "laws": "a and b over the published values; bars: 95 % of the fitted constants.",
    }
    sections = [
        Section(name, title, "", (Figure(drawn[picture], "png", captions[picture], name),),
                (Table(tables[name][0], tuple(tables[name][1:]), numeric=tables[name][0][1:]),))
        for name, title, picture in (("solids", "Solids", "platens"), ("laws", "Laws", "laws"))
    ]  # fmt: skip
    content = report_page.Report(
        "Calibration chain: platen curve, solid, compression law",
        "E_c, V_c and K_r of each fabric are fitted to its platen curve; the crossover of the fitted solid is "
        f"stretched on the {size} mesh, and one law fitted. " + " ".join(f"{line}." for line in remarks)
        + (f" Coulomb friction between the yarns: {friction:g}." if friction else ""),
        ((Card("Fabrics", f"{len(tables['laws']) - 1}", ("with a platen law",)),),),
        (*sections, chapters.making(stamp, {})),
        f"weavecell {stamp['weavecell']}, {stamp['date']}",
    )  # fmt: skip
    report_page.write(content, out / "report.html")
    if page is not None:
        _write_page(page, tables, drawn, captions, remarks, size, stamp)


def _write_page(page, tables, drawn, captions, remarks, size, stamp):
    """Put tables and pictures between the marks of a page."""
    for name, picture in drawn.items():
        write(page.parent / "figures" / f"calibration-chain-{name}.png", picture)
    lines = [
        f"Made by `python -m validation calibration --fit-solid --mesh {size}`, commit {stamp['commit']}, "
        f"{stamp['date']}."
    ]
    lines += remarks
    parts = ["\n".join(f"- {line}" for line in lines)]
    for name, picture in (("solids", "platens"), ("laws", "laws")):
        parts += [
            marked_page.markdown(tables[name]),
            f"![{captions[picture]}](figures/calibration-chain-{picture}.png)",
        ]
    marked_page.put(page, *MARKS, "\n\n" + "\n\n".join(parts) + "\n\n")
