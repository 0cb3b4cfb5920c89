"""Speed against accuracy: the standard scenes, each with every method that the project has for it.

Folder of `weavecell chart --scene crossover`
    crossover.csv, orders.csv   one row a case; one row a limit
    crossover.md, figures/      the page of the documentation (docs/crossover.md) with its pictures
    chart.json                  which methods none beats, the reference, provenance
    cases/                      a file for each case as soon as it is done: `--resume` begins with them
"""

from __future__ import annotations

from fabrics.errors import InputError
from weavecell import json_file, progress, provenance


def chart_command(scene, out, **choices):
    """Run the study of a scene, write its tables, pictures and page to the folder `out`, and print what it found."""
    if scene not in SCENES:
        raise InputError(key="--scene", value=scene, allowed=f"one of {', '.join(SCENES)}")
    SCENES[scene](out, **choices)


def crossover(out, *, level, only, processes, resume):
    """The 3D crossover path."""
    from validation.crossover_study import page, pictures, study, tables

    with progress.bar("Study of the 3D crossover") as advance:
        found = study.run(out, level=level, only=only or None, resume=resume, processes=processes, progress=advance)
    stamp = provenance.stamp()
    tables.write_csv(found, out / "crossover.csv")
    tables.write_orders(found, out / "orders.csv")
    drawn = pictures.draw_all(found, out / "figures")
    words = [f"--only '{','.join(only)}'"] if only else []
    command = " ".join(["weavecell chart --scene crossover", f"--level {level}", *words])
    made = f"Version {stamp['weavecell']}, commit {stamp['commit']}, {stamp['date']}, {stamp['processor']}."
    page.write(found, out / "crossover.md", made, command, drawn)
    best = [{"method": study.name(found, e), "cpu_s": e.result["cpu"], "error": e.error} for e in found.best]
    content = {"scene": "crossover", "level": level, "fabric": found.fabric, "best": best, "provenance": stamp}
    content["reference"] = {
        name: {"value": value, "half_width": half} for name, (value, half) in found.reference.items()
    }
    json_file.write(out / "chart.json", content)
    print(f"{len(found.entries)} cases; none beats, in time and error:")
    for entry in best:
        print(f"  {entry['method']:<28}{entry['cpu_s']:8.1f} s {100 * entry['error']:8.2f} %")
    print(f"written to {out}")


SCENES = {"crossover": crossover}
