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
from contextlib import contextmanager, suppress
from importlib import resources
from pathlib import Path

from fabrics import lazy
from fabrics.errors import WeavecellError
from weavecell.commands.options import CORES, RESULTS, ExecutorOption, JobsOption, MeshOption, OutOption, Size, example

with lazy.imports():
    from fabrics import assumed, catalogue, executors, units, variants
    from weavecell.commands import calibrate, impact, mesh
    from weavecell.report import chapters
    from weavecell.report import page as report_page
    from weavecell.report.shot import chapters_mesh, chapters_shot, tables_shot
    from weavecell.results import json_file, out_folder, progress, provenance
    from weavecell.scenes import build, of_commands
    from weavecell.scenes import impact as scenes_impact


@example("weavecell demo --out results/demo")
def demo(
    out: OutOption = None,
    mesh_size: MeshOption = Size.medium,
    jobs: JobsOption = CORES,
    executor: ExecutorOption = "local",
) -> None:
    """S-720 of the catalogue: mesh, calibration, and four impacts, with a summary and one HTML page."""
    out, size = out or RESULTS / "demo", mesh_size.value
    began = time.perf_counter()
    file = resources.files("weavecell") / "scenes" / "demo.toml"
    text, plan = scenes_impact.read_toml(file, what="demonstration")  # type: ignore[arg-type]
    fabric = catalogue.load(plan["calibration"]["fabric"])
    out_folder.claim(out)
    clock = Clock()
    compiler = executors.CONTEXT.Process(target=_compile, args=(plan,), daemon=True)
    if jobs > 1:
        compiler.start()
    with clock.stage("mesh"):
        meshed = mesh.build(fabric, size=size, domain="whole")
        mesh.write(meshed, out / "mesh")
    with clock.stage("calibration"):
        calibration = calibrate.solved(fabric, out / "calibration", size=size, jobs=jobs, executor=executor)
    with clock.stage("impacts"):
        if jobs > 1:
            compiler.join()
        shots = [_shoot(plan, case, law, out) for case in plan["impact"] for law in LAWS]
    records = [record for _, record, _ in shots]
    with clock.stage("pictures"), progress.bar("Pictures and report") as advance:
        sections = _sections(fabric, meshed, calibration, records, out, advance)
    clock.times["all of it"] = time.perf_counter() - began
    rows = _targets(plan, [(case, record) for case, record, _ in shots])
    stamp = provenance.stamp(text)
    sections = [sections[-1], chapters.comparison(rows), *sections[:-1]]
    page = _page(fabric, plan, calibration, records, sections, stamp, clock, shots[0][2])
    report_page.write(page, out / "report.html")
    report_page.write_pictures(sections, out / "pictures")
    columns = ("quantity", "target", "value", "met")
    summary = {"rows": [dict(zip(columns, row)) for row in rows], "wall_times_s": clock.times, "provenance": stamp}
    json_file.write_summary(out / "summary.json", summary)
    _tell(plan, fabric, calibration, records, out)


# name of the law in folders, in words, and how a scene of the demonstration gives it
LAWS = {"fitted": ("fitted law", "../calibration/law.json"), "table": ("published law", "published")}


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


def _compile(plan):
    """Compile the kernels of the impacts, in a process beside the calibration: by one of them, of which nothing is
    kept. What goes wrong the impact itself reports, and the kernels are not announced: the bars of the
    calibration are on the terminal."""
    import logging

    logging.getLogger("weavecell").setLevel(logging.ERROR)
    with suppress(WeavecellError, KeyboardInterrupt):
        from shellfabric.impact import simulation

        *_, setup = _set_up(plan, plan["impact"][0], "table", Path())
        simulation.run(setup, table=setup.table(kept=True))


def _set_up(plan, case, law, out):
    """(folder, title, text of the scene, Case, ImpactSetup) of one impact."""
    import tomlkit

    words, value = LAWS[law]
    folder = out / f"{case['name']}-{law}"
    title = f"{case['strike_velocity']}, {words}"
    table = {"title": title} | {name: dict(inner) for name, inner in plan["scene"].items()}
    table["fabric"]["law"] = value
    table["projectile"]["strike_velocity"] = case["strike_velocity"]
    table["run"]["outputs"] = ["paraview"]
    file = folder / "scene.toml"
    this = build.build(scenes_impact.check(table, file, of_commands.IMPACT), file, folder.name)
    return folder, title, tomlkit.dumps(table), this, build.setup(this, file)


def _shoot(plan, case, law, out):
    """Run one impact and write its folder; returns (case, record, setup)."""
    folder, title, text, this, setup = _set_up(plan, case, law, out)
    record, snapshots, *_ = impact.fire(this, setup, title)
    impact.write(folder, this, setup, record, snapshots, text, lambda *_: None)
    return case, record, setup


def _sections(fabric, meshed, calibration, records, out, advance):
    laws = {"fitted": calibration.law, "published": fabric.laws[0]}
    sections = [
        chapters.mesh(mesh.facts(meshed), (out / "mesh" / "crossover.png").read_bytes()),
        calibrate.fit_chapter(calibration, laws),
    ]
    advance(0.3)
    pairs = {label: (law, law) for label, law in laws.items()}
    sections.append(chapters.cell(fabric, pairs, paths=calibrate.paths(calibration, fabric)))
    advance(0.4)
    return [*sections, chapters_shot.chapter(records)]


def _targets(plan, shots):
    """Rows (quantity, target, value, met)."""
    rows = []
    for case, record in shots:
        met = record.outcome == case["outcome"]
        rows.append((f"{record.title} ({case['source']})", case["outcome"], record.outcome, "yes" if met else "no"))
    limits = plan["targets"]
    for what, key, measure in (
        ("largest error of the energy balance, of the strike energy", "balance", "energy_error_max"),
        ("artificial viscosity, of the absorbed energy", "numerical", "viscous_energy_fraction"),
    ):
        worst = max((getattr(record, measure) for _, record in shots))
        share = units.si(limits[key], "")
        met = "yes" if worst <= share else "no"
        rows.append((what, f"at most {limits[key]}", tables_shot.percent(worst), met))
    return rows


def _page(fabric, plan, calibration, records, sections, stamp, clock, setup):
    used = variants.with_linear_density(fabric, plan["scene"]["fabric"]["linear_density"])
    law_card = chapters.law_card(calibration.law, fabric.laws[0], "fitted to the 3D crossover")
    more = (
        chapters_mesh.section(records[0], setup),
        chapters_shot.assumptions(setup, tuple(assumed.lines(used)), body=records[0].rigid_check),
    )
    return report_page.Report(
        plan["title"],
        plan["subtitle"],
        ((chapters.fabric_card(used), law_card), tuple(chapters_shot.card(record) for record in records)),
        (
            *sections,
            *more,
            chapters.sources(used),
            chapters.making(stamp, clock.times, tables_shot.cost(records, setup)),
        ),
        f"weavecell {stamp['weavecell']}, {stamp['date']}",
        outcome=" ".join(_of_law(words, records) for words, _ in LAWS.values()),
    )


def _of_law(words, records):
    """What the impacts with a law came to, in one sentence."""
    found = (
        f"{record.outcome} at {record.strike_velocity:g} m/s"
        + (f" ({tables_shot.residual(record)})" if record.outcome == "perforated" else "")
        for record in records
        if record.title.endswith(words)
    )
    return f"{words.capitalize()}: {', '.join(found)}."


def _tell(plan, fabric, calibration, records, out):
    """Print the laws, what each impact came to, and where the report is."""
    from rich import box
    from rich.console import Console
    from rich.table import Table

    law, published = calibration.law, fabric.laws[0]
    print(plan["title"])
    print("compression law of a yarn, from the 3D crossover (published):")
    print(f"  a = {1e3 * law.a:.4f} mm ({1e3 * published.a:.4f} mm)")
    print(f"  b = {1e3 * law.b:.4f} mm N^(1/3) ({1e3 * published.b:.4f} mm N^(1/3))")
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    table.add_column("impact", no_wrap=True)
    table.add_column("outcome")
    for name in ("residual [m/s]", "deflection [mm]", "energy error [%]"):
        table.add_column(name, justify="right")
    for record in records:
        table.add_row(
            record.title, record.outcome, tables_shot.residual(record).split()[-2],
            f"{1e3 * record.max_deflection:.1f}", f"{100 * record.energy_error_max:.3f}",
        )  # fmt: skip
    Console().print(table)
    print(f"report: {out / 'report.html'}")
