"""Every fabric of the catalogue calibrated unattended, its laws beside those that the thesis prints.

Folder of `python -m validation calibration`
    summary.csv, summary.png, report.html   all fabrics side by side
    <fabric>/       law.json, law-warp.json, law-weft.json, calibration.json, histories of its paths (.h5)
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from fabrics import catalogue
from fabrics.errors import UnstableError
from fabrics.files import write, write_csv
from validation.published import pictures_calibration
from weavecell.report import chapters, pictures
from weavecell.report import page as report_page
from weavecell.report.page import Card, Figure, Section, Table
from weavecell.results import out_folder, progress, provenance

if TYPE_CHECKING:
    from fabrics.fabric import Fabric

COLUMNS = (
    "fabric", "a [mm]", "95 %", "paths", "published a [mm]", "a / published", "b [mm N^(1/3)]", "95 %", "paths",
    "published b", "b / published", "rms [µm]", "by tension [µm]", "chosen", "warp alone a, b", "weft alone a, b",
    "wall [s]", "ended",
)  # fmt: skip


def command(out: Path, *, size: str, jobs: int, executor: str, resume: bool, friction: float = 0.0) -> None:
    """Calibrate the whole catalogue, write the summary and print it."""
    from unitcell3d.identify.calibrate import CASES, calibrate_all

    out_folder.claim(out, resume)
    fabrics = [fabric for fabric in map(catalogue.load, catalogue.list_names()) if fabric.solid_laws is not None]
    with progress.bar(f"Calibration of {len(fabrics)} fabrics") as advance:
        found = calibrate_all(
            fabrics,
            size=size,
            friction=friction,
            folder=lambda name: out / name,
            resume=resume,
            jobs=jobs,
            executor=executor,
            on_progress=progress.by_path(advance, len(fabrics) * CASES),
        )
    rows = [row(fabric, found[fabric.name]) for fabric in fabrics]
    write_csv(out / "summary.csv", [COLUMNS, *rows])
    done = {name: each for name, each in found.items() if not isinstance(each, Exception)}
    picture = pictures.render(pictures_calibration.laws, done, kind="png")
    write(out / "summary.png", picture)
    _report(out, fabrics, rows, picture, size, friction)
    for line in rows:
        print(
            f"{line[0]:<18}a {line[1]:>7} ({line[5]:>5} of published)   b {line[6]:>7} ({line[10]:>5})   "
            f"rms {line[11]:>5} um   {line[13]}{'' if line[17] == 'at fibre failure' else '   ' + line[17]}"
        )
    print(f"written to {out}")
    failed = [f"{name}: {each}" for name, each in found.items() if isinstance(each, Exception)]
    if failed:
        raise UnstableError("; ".join(failed))


def row(fabric: Fabric, found: Any) -> tuple[str, ...]:
    """One fabric's line, as texts."""
    if isinstance(found, Exception):
        return (fabric.name, *[""] * (len(COLUMNS) - 2), str(found))
    law, published, ratio = found.law, found.published, found.comparison
    ended = [f"{name} at {100 * h.path[-1]:.1f} % of its path" for name, h in found.histories.items() if h.failed]
    return (
        fabric.name,
        *_parameter(law.a, law.a_interval, found.spread.get("a"), published and published.a, ratio.get("a_ratio")),
        *_parameter(law.b, law.b_interval, found.spread.get("b"), published and published.b, ratio.get("b_ratio")),
        f"{1e6 * law.residual_rms:.2f}",
        "" if found.ratio_law is None else f"{1e6 * found.ratio_law.residual_rms:.2f}",
        found.chosen,
        *("" if own is None else f"{1e3 * own.a:.4f}, {1e3 * own.b:.4f}" for own in found.yarn_laws),
        f"{sum(s for name, s in found.seconds.items() if name != 'all'):.0f}",
        "; ".join(ended) or "at fibre failure",
    )


def _parameter(value, interval, spread, published, ratio):
    """Value, interval, spread over the paths, published value and ratio to it."""
    return (
        f"{1e3 * value:.4f}",
        *("" if pair is None else f"{1e3 * pair[0]:.4f} .. {1e3 * pair[1]:.4f}" for pair in (interval, spread)),
        "" if published is None else f"{1e3 * published:.4f}",
        "" if ratio is None else f"{ratio:.2f}",
    )


def _report(out, fabrics, rows, picture, size, friction):
    stamp = provenance.stamp()
    figure = Figure(
        picture, "png", "a and b fitted to the 3D crossover over those that the thesis prints (Tables 5-1 and 5-4); "
        "bars: from the least to the greatest of the paths alone.", "laws",
    )  # fmt: skip
    numeric = tuple(name for name in COLUMNS if name not in ("fabric", "chosen", "ended"))
    content = report_page.Report(
        "Compression laws of the catalogue from the 3D crossover",
        f"Every fabric is stretched along several biaxial paths until its fibres fail, on the {size} mesh, and one law "
        "fitted to each. The law here is that of one yarn; whether the printed values are of one yarn or of the "
        "crossing is open (erratum E-40)."
        + (f" Coulomb friction between the yarns: {friction:g}." if friction else ""),
        ((Card("Fabrics", f"{len(rows)}", ("six Kevlar 129 weaves, two of glass",)),),),
        (
            Section("laws", "Laws", "", (figure,), (Table(COLUMNS, tuple(rows), numeric=numeric),)),
            *(chapters.sources(fabric) for fabric in fabrics[:1]),
            chapters.making(stamp, {}),
        ),
        f"weavecell {stamp['weavecell']}, {stamp['date']}",
    )
    report_page.write(content, out / "report.html")
