"""
From yarn data to impact
========================

One ply of S-720, 203 mm square and clamped, struck by a flat-nosed cylinder of 3 g and 5.5 mm, with the compression law
that is fitted to the fabric's own 3D crossover and with the published one. The projectile is rigid; one that is an
elastic-plastic bar is stopped at 155 m/s (examples/S-720-bar.toml). Each shot is that of ``weavecell impact
examples/S-720-stops.toml`` at its velocity and with its law. V50 of S-728 in 50 mm is over all that nobody gave, by
sixteen drawn shots of a sphere. It takes about a minute of two cores. Run with
``python examples/demo.py [FOLDER [MESH]]``; the mesh of the 3D crossover is coarse unless another is named.
"""

import logging
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import weavecell as wc
from fabrics.compression import CompressionLaw
from weavecell.report import chapters, page, pictures
from weavecell.report.shot import chapters_shot, moving, view
from weavecell.results import provenance
from weavecell.results.finding import Answer

TARGETS = {
    "92.5 m/s": ("stopped", "thesis Figure 5-4"),
    "155 m/s": ("perforated", "thesis Figure 5-5"),
}
MOST = {
    "error of the energy balance, of the strike energy": 0.01,
    "viscous energy, of the energy absorbed": 0.05,
}
# of examples/S-720-stops.toml
OPTIONS = {"end_time": "600 us", "snapshot_interval": "10 us"}
# [m], [m N^(1/3)] a and b that are fitted on the medium mesh (weavecell calibrate S-720 --mesh medium)
MEDIUM = {"a": 44.30e-6, "b": 56.16e-6}


def distance(law: CompressionLaw) -> str:
    """Return in words by how much a law differs from the one of the medium mesh."""
    shares = [f"{key} {getattr(law, key) / value - 1.0:+.1%}" for key, value in MEDIUM.items()]
    return f"{' and '.join(shares)} beside the medium mesh"


@contextmanager
def part(name: str) -> Iterator[None]:
    """Say every four seconds that a part goes on, and how long it took."""
    began, done = time.perf_counter(), threading.Event()

    def tell():
        while not done.wait(4.0):
            print(f"demo: {name}, {time.perf_counter() - began:.0f} s", flush=True)

    teller = threading.Thread(target=tell, daemon=True)
    teller.start()
    try:
        yield
    finally:
        done.set()
        teller.join()
    print(f"demo: {name}: {time.perf_counter() - began:.1f} s", flush=True)


def main(folder: str = "results/demo", size: str = "coarse") -> None:
    logging.getLogger(
        "weavecell"
    ).propagate = False  # plain lines: ffcx sets up logging for every library
    out, began = Path(folder), time.perf_counter()
    with part(f"calibration, {size} mesh"):
        solved = wc.calibrate("S-720", mesh=size, jobs=2, out=out / "calibration")
    laws = {"fitted law": solved.law, "published law": solved.mesh.fabric.laws[0]}
    used, cases = wc.fabric("S-720"), [(velocity, law) for velocity in TARGETS for law in laws]
    setups = [wc.setup(used, velocity, law=laws[law], **OPTIONS) for velocity, law in cases]
    with part("four impacts"):
        shots = [wc.impact(setup) for setup in setups]
    with part("V50 of drawn shots"):
        drawn = wc.v50("S-728", opening="50 mm", projectile="sphere 5.5 mm", jobs=2)
    with part("files of the impacts"):
        for (velocity, law), shot in zip(cases, shots):
            folder = shot.to_vtk(out / f"{velocity.split()[0]}-{law.split()[0]}").parent
            shot.write(folder / "histories.h5")

    records = [replace(shot, title=", ".join(case)) for case, shot in zip(cases, shots)]
    rows = []
    for (velocity, _), record in zip(cases, records):
        outcome, source = TARGETS[velocity]
        met = "yes" if record.outcome == outcome else "no"
        rows.append((f"{record.title} ({source})", outcome, record.outcome, met))
    worst = [
        max(getattr(record, key) for record in records)
        for key in ("energy_error_max", "viscous_energy_fraction")
    ]
    for (what, most), share in zip(MOST.items(), worst):
        rows.append(
            (
                what,
                f"at most {100 * most:g} %",
                f"{100 * share:.2g} %",
                "yes" if share <= most else "no",
            )
        )
    with part("report"):
        stamp = provenance.stamp(Path(__file__).read_text("utf-8"), used)
        times = {
            "calibration": solved.calibration.seconds["all"],
            "all of it": time.perf_counter() - began,
        }
        fit, cell = solved.sections()
        first = records[0]
        sections = (
            moving.section(first, moving.collect_instants(first, first.instants)),
            chapters_shot.chapter(first, view.still(first)),
            chapters.comparison(rows),
            page.Section(
                "v50",
                drawn.title,
                f"{drawn.answer}.",
                (pictures.draw_figure("v50", "", drawn.draw),),
                (page.Table.from_frame(drawn.table()),),
            ),
            chapters.mesh(
                solved.mesh.words(), (out / "calibration" / "crossover.png").read_bytes()
            ),
            fit,
            cell,
            chapters_shot.mesh(first, setups[0]),
            chapters_shot.assumptions(setups[0], shots[0].assumed, body=first.rigid_check),
        )
        mesh = f"{size} mesh, {distance(solved.law)}"
        said = __doc__.split("\n\n")[1].partition(" It takes")[0].replace("``", "")
        lead = said + f" The 3D crossover: {mesh}."
        outcome = " ".join(f"{record.title}: {record.outcome}." for record in records)
        doubts = dict.fromkeys(doubt for result in (solved, *shots) for doubt in result.doubts)
        found = Answer(
            "S-720: 3D crossover, calibration, impact", outcome, tuple(doubts), first.outcome
        )
        settings = chapters_shot.settings(setups[0])
        report = chapters.report(lead, (used,), sections, stamp, times, found, (settings,))
        page.write(report, out / "report.html")
        page.write_pictures(sections, out / "pictures")
    print(f"S-720, compression law of its 3D crossover ({mesh}): {solved.answer.value}")
    print("One ply, 203 mm, struck by a flat cylinder of 3 g:")
    for (velocity, _), record, shot in zip(cases, records, shots):
        outcome, source = TARGETS[velocity]
        left = f"{shot.outcome}, residual velocity {shot.residual_velocity:.4g} m/s"
        print(f"  {record.title}: {left} ({source}: {outcome})")
    print(drawn.answer)
    print(f"report: {out / 'report.html'}")


if __name__ == "__main__":
    main(*sys.argv[1:])
