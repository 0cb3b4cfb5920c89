"""The report of a test on a coupon: its chapter, and what it came to in a few lines."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from weavecell.report import chapters, checks, pictures, pictures_coupon
from weavecell.report import page as report_page

if TYPE_CHECKING:
    from weavecell.results.coupon import CouponRecord

WORDS = {
    "bias_extension": "bias extension",
    "picture_frame": "picture frame",
    "uniaxial": "uniaxial tension",
    "biaxial": "biaxial tension",
    "pull_out": "yarn pull-out",
}


def chapter(record: CouponRecord, tolerance: float) -> report_page.Section:
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


def pull_out_chapter(record: Any) -> report_page.Section:
    """The chapter of a pull-out: load and crossovers in slip against the displacement, and a table of the results."""
    caption = "Load on the pulled yarn; below: crossovers that it slides through, and those that its end has left."
    content = pictures.render(pictures_coupon.pull_out, record)
    rows = tuple((line[:44].strip(), line[44:].strip()) for line in record.lines())
    lead = f"The run was stopped: {record.failure_message}." if record.failure_message else ""
    table = report_page.Table(("quantity", "value"), rows, "", numeric=("value",))
    return report_page.Section(
        "coupon", WORDS["pull_out"].capitalize(), lead, (report_page.Figure(content, "svg", caption, "load"),), (table,)
    )


def _headed(name, unit):
    shown = pictures_coupon.axis(name, unit)[1]
    return f"{name} [{shown}]" if shown else name


def _as_text(name, unit, value):
    """A value as text, without its unit."""
    return f"{pictures_coupon.axis(name, unit)[0] * value:.4g}"


def lines(record: CouponRecord) -> list[str]:
    """What a test came to, in a few lines."""
    found, moved = [], (record.prescribed_unit, record.prescribed)
    for name, (unit, values) in {record.prescribed_name: moved, **record.measures}.items():
        found.append(f"{name:<34}{_as_text(name, unit, values[-1])} {pictures_coupon.axis(name, unit)[1]}".rstrip())
    found.append(
        f"{record.elements} elements, {int(record.iterations.sum())} iterations, residual {record.residual.max():.1e} "
        f"at most, {record.wall_time:.1f} s"
    )
    return found


def page(case: Any, record: Any, section: report_page.Section, stamp: Any, lead: str, shown: Any) -> Any:
    """The report of one test.

    Parameters
    ----------
    case : scenes.build.Case
    record : CouponRecord or PullOutRecord
    section : its chapter
    stamp : of `results.provenance`
    lead : a sentence; shown : lines of the card
    """
    model = case.scene.fabric.cell_model
    tone = "unstable" if record.outcome == "unstable" else "stopped"
    cards = (
        chapters.fabric_card(case.fabric),
        chapters.law_card(case.laws[0], source=case.law_name if model == "compressible" else model),
        report_page.Card(WORDS[record.test], record.outcome, tuple(" ".join(line.split()) for line in shown), tone),
    )
    return report_page.Report(
        record.title,
        lead,
        (cards,),
        (
            section,
            chapters.cell(case.fabric, {case.law_name: case.laws}, model, **chapters.options(case.scene.fabric)),
            checks.section(record.checks),
            chapters.sources(case.fabric),
            chapters.making(stamp, {"test": record.wall_time}),
        ),
        f"weavecell {stamp['weavecell']}, {stamp['date']}",
    )
