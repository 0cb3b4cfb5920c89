"""Time of `weavecell impact` on the standard scene once its kernels are compiled, and of imports.

Run with nothing else on the machine:

    python benchmarks/warm.py [--repeats 5] [--out FILE.json]

Each is a process of its own; medians of its wall and CPU time [s]. Before, one run that is not counted. Byte code is
kept as Python does by default, whatever PYTHONDONTWRITEBYTECODE says here: with it every process compiles all modules.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).parents[1]
SCENE = ROOT / "examples" / "S-720-stops.toml"


def run(*words):
    """(wall, cpu) [s] of a process."""
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    subprocess.run(
        [sys.executable, *words], check=True, capture_output=True, env=environment | {"PYTHONPATH": str(ROOT)}
    )
    wall, after = time.perf_counter() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
    return wall, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--repeats", type=int, default=5)
    arguments.add_argument("--out", type=Path)
    chosen = arguments.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        plain = Path(folder) / "plain.toml"
        lines = SCENE.read_text("utf-8").splitlines()
        plain.write_text("\n".join("outputs = []" if line.startswith("outputs") else line for line in lines))
        impact = lambda scene: ("-m", "weavecell", "impact", str(scene), "--out", f"{folder}/{scene.stem}")  # noqa: E731
        cases = {
            "impact, all outputs": impact(SCENE),
            "impact, outputs = []": impact(plain),
            "weavecell --help": ("-m", "weavecell", "--help"),
            "import shellfabric": ("-c", "import shellfabric"),
            "import shellfabric.impact.single_ply": ("-c", "import shellfabric.impact.single_ply"),
            "import numba": ("-c", "import numba"),
            "import weavecell": ("-c", "import weavecell"),
        }
        run(*cases["impact, all outputs"])
        times = {name: [] for name in cases}
        for _ in range(chosen.repeats):
            for name, words in cases.items():
                times[name].append(run(*words))
    report = {"columns": ["wall_s", "cpu_s"], "load_average": os.getloadavg()[0]}
    report |= {name: [round(statistics.median(column), 3) for column in zip(*rows)] for name, rows in times.items()}
    text = json.dumps(report, indent=1)
    print(text)
    if chosen.out:
        chosen.out.write_text(text + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
