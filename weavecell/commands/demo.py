"""The demonstration: one fabric of the catalogue, its 3D crossover, impacts with two laws, and one report.

The runs and their targets stand in scenes/demo.toml.

The folder of `weavecell demo`
    mesh/           as of `weavecell mesh`
    calibration/    as of `weavecell calibrate`; law.json is the fitted law
    <impact>-<law>/ as of `weavecell impact`, without pictures: repeat one with `weavecell impact <folder>/scene.toml`
    pictures/       of the report
    summary.json    targets and values
    report.html     all of it on one page
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import resources
from pathlib import Path

import weavecell
from fabrics import catalogue
from fabrics.units import si
from fabrics.variants import with_linear_density
from weavecell.commands import calibrate, impact, mesh
from weavecell.report import chapters
from weavecell.report import page as report_page
from weavecell.results import json_file, progress, provenance
from weavecell.scenes import build, toml_writer
from weavecell.scenes import impact as scenes_impact


def demonstrate(out: Path, *, size: str, jobs: int, executor: str) -> None:
    """Run the demonstration with a crossover of mesh `size`, write everything to `out`, print the summary."""
    began = time.perf_counter()
    file = resources.files("weavecell") / "scenes" / "demo.toml"
    text, plan = scenes_impact.read_toml(file, what="demonstration")  # type: ignore[arg-type]
    fabric = catalogue.load(plan["calibration"]["fabric"])
    clock = Clock()
    with clock.stage("mesh"):
        meshed = mesh.build(fabric, size=size, domain="whole")
        mesh.write(meshed, out / "mesh")
    with clock.stage("calibration"):
        calibration = calibrate.calibrate(fabric, out / "calibration", size=size, jobs=jobs, executor=executor)
    with clock.stage("impacts"):
        shots = [_shoot(plan, case, law, out) for case in plan["impact"] for law in LAWS]
    records = [record for _, record in shots]
    with clock.stage("pictures"), progress.bar("Pictures and report") as advance:
        sections = _sections(fabric, meshed, calibration, records, out, advance)
    clock.times["all of it"] = time.perf_counter() - began
    rows = _targets(plan, shots, clock.times["all of it"])
    stamp = provenance.stamp(text)
    page = _page(fabric, plan, calibration, records, [chapters.comparison(rows), *sections], stamp, clock)
    report_page.write(page, out / "report.html")
    report_page.write_pictures(sections, out / "pictures")
    columns = ("quantity", "target", "value", "met")
    summary = {"rows": [dict(zip(columns, row)) for row in rows], "wall_times_s": clock.times, "provenance": stamp}
    json_file.write_summary(out / "summary.json", summary)
    _tell(plan, rows, calibration, clock.times, out)


# name of the law in folders, in words, and how a scene of the demonstration gives it
LAWS = {"fitted": ("fitted law", "../calibration/law.json"), "table": ("Table 5-1's law", "published")}


class Clock:
    """Wall times of named stages [s]."""

    def __init__(self) -> None:
        self.times: dict[str, float] = {}

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Time a block."""
        began = time.perf_counter()
        yield
        self.times[name] = time.perf_counter() - began


def _shoot(plan, case, law, out):
    """Run one impact and write its folder; returns (case, record)."""
    words, value = LAWS[law]
    folder = out / f"{case['name']}-{law}"
    title = f"{case['strike_velocity']}, {words}"
    table = {"title": title} | {name: dict(inner) for name, inner in plan["scene"].items()}
    table["fabric"]["law"] = value
    table["projectile"]["strike_velocity"] = case["strike_velocity"]
    table["run"]["outputs"] = ["paraview"]
    text = toml_writer.dumps(table)
    file = folder / "scene.toml"
    this = build.build(scenes_impact.check(table, file, impact.SUPPORT), file, folder.name)
    record, snapshots, *_ = impact.fire(this, build.setup(this, file), title)
    impact.write(folder, this, record, snapshots, text, lambda *_: None)
    return case, record


def _sections(fabric, meshed, calibration, records, out, advance):
    laws = {"fitted": calibration.law, "Table 5-1": fabric.laws[0]}
    sections = [
        chapters.mesh(mesh.facts(meshed), (out / "mesh" / "crossover.png").read_bytes()),
        calibrate.fit_chapter(calibration, laws),
    ]
    advance(0.3)
    pairs = {label: (law, law) for label, law in laws.items()}
    sections.append(chapters.cell(fabric, pairs, paths=calibrate.paths(calibration, fabric)))
    advance(0.4)
    return [*sections, chapters.impact(records)]


def _targets(plan, shots, seconds):
    """Rows (quantity, target, value, met)."""
    rows = []
    for case, record in shots:
        met = record.outcome == case["outcome"]
        rows.append((f"{record.title} ({case['source']})", case["outcome"], record.outcome, "yes" if met else "no"))
    limits = plan["targets"]
    for what, key, measure in (
        ("largest error of the energy balance, of the strike energy", "balance", "energy_error_max"),
        ("viscous energy, of the energy absorbed", "numerical", "viscous_energy_fraction"),
    ):
        worst = max((getattr(record, measure) for _, record in shots))
        share = si(limits[key], "")
        rows.append((what, f"at most {limits[key]}", chapters.percent(worst), "yes" if worst <= share else "no"))
    allowed = si(limits["wall_time"], "s")
    rows.append(
        ("wall time, all of it", f"under {allowed:g} s", f"{seconds:.0f} s", "yes" if seconds < allowed else "no")
    )
    return rows


def _page(fabric, plan, calibration, records, sections, stamp, clock):
    used = with_linear_density(fabric, plan["scene"]["fabric"]["linear_density"])
    law_card = chapters.law_card(calibration.law, fabric.laws[0], "fitted to the 3D crossover")
    return report_page.Report(
        plan["title"],
        plan["subtitle"],
        ((chapters.fabric_card(used), law_card), tuple(chapters.impact_card(record) for record in records)),
        (*sections, chapters.sources(fabric), chapters.making(stamp, clock.times)),
        f"weavecell {weavecell.__version__}, {stamp['date']}",
    )


def _tell(plan, rows, calibration, times, out):
    from rich import box
    from rich.console import Console
    from rich.table import Table

    table = Table(title=plan["title"], title_justify="left", title_style="bold", box=box.SIMPLE_HEAD, pad_edge=False)
    for name in ("quantity", "target", "value", "met"):
        table.add_column(name, overflow="fold")
    for row in rows:
        table.add_row(*row, style="red" if row[-1] == "no" else "")
    console = Console()
    console.print(table)
    law = calibration.law
    console.print(f"fitted law: a = {1e3 * law.a:.4f} mm, b = {1e3 * law.b:.4f} mm N^(1/3)")
    console.print("wall times: " + ", ".join(f"{name} {seconds:.1f} s" for name, seconds in times.items()))
    console.print(f"report: {out / 'report.html'}", soft_wrap=True)
