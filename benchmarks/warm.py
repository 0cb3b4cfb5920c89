"""Time of `weavecell impact` on the standard scene once its kernels are compiled, and of imports.

Run with nothing else on the machine:

    python benchmarks/warm.py [--repeats 5] [--out FILE.json]
    python benchmarks/warm.py --phases [--repeats 5] [--out FILE.json]

Each is a process of its own; medians of its wall and CPU time [s]. Before, one run that is not counted. Byte code is
kept as Python does by default, whatever PYTHONDONTWRITEBYTECODE says here: with it every process compiles all modules.

With --phases, where the CPU time of the two impacts goes: the functions of PHASES are wrapped, and each has the time
that no other of them takes inside it; means over the repeats [s]. A sampler's signals are lost in compiled code.
"""

from __future__ import annotations

import argparse
import functools
import importlib
import json
import os
import resource
import runpy
import statistics
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

ROOT = Path(__file__).parents[1]
SCENE = ROOT / "examples" / "S-720-stops.toml"
# phase: module and name of the function that makes it; what they load on the way is theirs
PHASES = {
    "table of the cell": ("shellfabric.impact.setup", "ImpactSetup.table"),
    "set-up of the solver": ("shellfabric.impact.run", "_make_solver"),
    "steps": ("shellfabric.loop.pack_solver", "PackSolver.advance"),
    "samples": ("shellfabric.loop.driver", "ExplicitSolver._sample"),
    "guards": ("shellfabric.loop.driver", "ExplicitSolver._guard"),
    "checkpoints": ("shellfabric.loop.checkpoint", "write"),
    "picture of the panel": ("weavecell.report.shot.view", "still"),
    "other pictures": ("weavecell.report.pictures", "render"),
    "ParaView series": ("weavecell.results.vtk", "write_panel"),
    "histories.h5, summary.json": ("weavecell.answers.shot", "ShotResult.save_numbers"),
    "rest of the report": ("weavecell.answers.shot", "ShotResult._write"),
}


def run(*words):
    """(wall, cpu) [s] of a process."""
    environment = {
        name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"
    }
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    subprocess.run(
        [sys.executable, *words],
        check=True,
        capture_output=True,
        env=environment | {"PYTHONPATH": str(ROOT)},
    )
    wall, after = time.perf_counter() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
    return wall, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


class Watch:
    """CPU time [s] of phases that are inside each other."""

    def __init__(self):
        self.found = Counter()
        self.open = ["all else"]
        self.read = 0.0

    def turn(self):
        """Give the time since the last turn to the innermost phase."""
        now = time.process_time()
        self.found[self.open[-1]] += now - self.read
        self.read = now

    def wrap(self, phase, module, name):
        """Have the calls of a function be of a phase."""
        *owner, name = name.split(".")
        holder = importlib.import_module(module)
        for part in owner:
            holder = getattr(holder, part)
        function = getattr(holder, name)

        @functools.wraps(function)
        def watched(*arguments, **keywords):
            self.turn()
            self.open.append(phase)
            try:
                return function(*arguments, **keywords)
            finally:
                self.turn()
                self.open.pop()

        setattr(holder, name, watched)


def measured(scene, out):
    """{phase: CPU time [s]} of an impact in this process."""
    watch = Watch()
    for phase, (module, name) in PHASES.items():
        watch.wrap(phase, module, name)
    watch.turn()
    watch.found = Counter({"imports": watch.found.total()})
    sys.argv = ["weavecell", "impact", scene, "--out", out]
    try:
        runpy.run_module("weavecell", run_name="__main__")
    except SystemExit as ended:
        if ended.code:
            raise
    watch.turn()
    return watch.found | {"all": watch.found.total()}


def phases(cases, repeats, folder):
    """{impact: {phase: mean CPU time [s]}}."""
    report = {}
    for name, words in cases.items():
        total = Counter()
        for _ in range(repeats):
            run(__file__, "--child", *words[3::2], "--out", f"{folder}/phases.json")
            total.update(json.loads(Path(f"{folder}/phases.json").read_text("utf-8")))
        report[name] = {
            key: round(total[key] / repeats, 3) for key in ("imports", *PHASES, "all else", "all")
        }
    return report


def medians(cases, repeats):
    """{case: [wall, CPU time]} [s], of runs that take turns."""
    times = {name: [] for name in cases}
    for _ in range(repeats):
        for name, words in cases.items():
            times[name].append(run(*words))
    return {
        name: [round(statistics.median(column), 3) for column in zip(*rows)]
        for name, rows in times.items()
    }


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--repeats", type=int, default=5)
    arguments.add_argument("--phases", action="store_true")
    arguments.add_argument("--child", nargs=2, help=argparse.SUPPRESS)
    arguments.add_argument("--out", type=Path)
    chosen = arguments.parse_args()
    if chosen.child:
        chosen.out.write_text(json.dumps(measured(*chosen.child)), encoding="utf-8")
        return
    with tempfile.TemporaryDirectory() as folder:
        plain = Path(folder) / "plain.toml"
        lines = SCENE.read_text("utf-8").splitlines()
        plain.write_text(
            "\n".join("outputs = []" if line.startswith("outputs") else line for line in lines)
        )

        def impact(scene):
            return "-m", "weavecell", "impact", str(scene), "--out", f"{folder}/{scene.stem}"

        cases = {
            "impact, all outputs": impact(SCENE),
            "impact, outputs = []": impact(plain),
            "weavecell --help": ("-m", "weavecell", "--help"),
            "import shellfabric": ("-c", "import shellfabric"),
            "import shellfabric.impact.run": ("-c", "import shellfabric.impact.run"),
            "import numba": ("-c", "import numba"),
            "import weavecell": ("-c", "import weavecell"),
        }
        run(*cases["impact, all outputs"])
        if chosen.phases:
            found = phases(
                {name: words for name, words in cases.items() if "impact" in words},
                chosen.repeats,
                folder,
            )
        else:
            found = {"columns": ["wall_s", "cpu_s"]} | medians(cases, chosen.repeats)
    report = {"load_average": os.getloadavg()[0]} | found
    text = json.dumps(report, indent=1)
    print(text)
    if chosen.out:
        chosen.out.write_text(text + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
