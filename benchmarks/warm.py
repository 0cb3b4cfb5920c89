"""Time of `weavecell impact` on the standard scene once its kernels are compiled, and of imports.

Run with nothing else on the machine:

    python benchmarks/warm.py [--repeats 5] [--out FILE.json]
    python benchmarks/warm.py --phases [--repeats 5] [--out FILE.json]

Each is a process of its own; medians of its wall and CPU time [s]. Before, one run that is not counted. Byte code is
kept as Python does by default, whatever PYTHONDONTWRITEBYTECODE says here: with it every process compiles all modules.

With --phases, where the CPU time of the two impacts goes: the stack is looked at every 4 ms of CPU time, and belongs to
the first row of PHASES of which it has a frame; means over the repeats [s].
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import runpy
import signal
import statistics
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

ROOT = Path(__file__).parents[1]
SCENE = ROOT / "examples" / "S-720-stops.toml"
INTERVAL = 4e-3  # [s] of CPU time between two looks; Linux has no shorter one
# phase: (part of a file's name, name of a function or "" for any) of the frames that make it
PHASES = {
    "import of matplotlib": ("/matplotlib/", "<module>"),
    "other imports": ("", "<module>"),
    "checkpoints": ("output/checkpoint.py", ""),
    "first calls of kernels, which load them": ("numba/core/dispatcher.py", "_compile_for_args"),
    "3D pictures": ("report/pictures3d.py", ""),
    "other pictures": ("report/pictures.py", "render"),
    "ParaView series": ("results/vtk.py", ""),
    "histories.h5, summary.json": ("results/run_folder.py", ""),
    "rest of the report": ("report/", ""),
    "table of the cell": ("cell/table_cache.py", ""),
    "samples and guards": ("driver/solver.py", "_sample"),
    "steps": ("driver/solver.py", "run"),
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


def phase_of(frame):
    """The phase that a stack belongs to."""
    frames = []
    while frame is not None and not frame.f_code.co_filename.endswith("weavecell/__main__.py"):
        frames.append((frame.f_code.co_filename, frame.f_code.co_name))
        frame = frame.f_back
    for name, (file, function) in PHASES.items():
        if any(file in where and function in ("", what) for where, what in frames):
            return name
    return "all else"


def sampled(scene, out):
    """{phase: CPU time [s]} of an impact in this process."""
    found = Counter()
    signal.signal(signal.SIGPROF, lambda _, frame: found.update([phase_of(frame)]))
    signal.setitimer(signal.ITIMER_PROF, INTERVAL, INTERVAL)
    sys.argv = ["weavecell", "impact", scene, "--out", out]
    try:
        runpy.run_module("weavecell", run_name="__main__")
    except SystemExit as ended:
        if ended.code:
            raise
    signal.setitimer(signal.ITIMER_PROF, 0)
    share = time.process_time() / sum(found.values())
    return {name: share * count for name, count in found.items()} | {"all": time.process_time()}


def phases(cases, repeats, folder):
    """{impact: {phase: mean CPU time [s]}}."""
    report = {}
    for name, words in cases.items():
        total = Counter()
        for _ in range(repeats):
            run(__file__, "--child", *words[3::2], "--out", f"{folder}/phases.json")
            total.update(json.loads(Path(f"{folder}/phases.json").read_text("utf-8")))
        report[name] = {key: round(total[key] / repeats, 3) for key in (*PHASES, "all else", "all")}
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
        chosen.out.write_text(json.dumps(sampled(*chosen.child)), encoding="utf-8")
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
