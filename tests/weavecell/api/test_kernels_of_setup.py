"""What `make setup` and `make kernels` compile: no shot of the demo and no first run of a user finds another kernel."""

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]

# fires the runs of the tool, then first runs, and prints what only these take from the cache of kernels
RUNS = """
import os, sys, tempfile, tomllib, warnings
from functools import partial
from pathlib import Path

warnings.simplefilter("ignore")
sys.path[:0] = ["tools", "."]
from compile_kernels import list_runs
from fabrics.base import kernel_cache
from tests.scene_text import toml
import weavecell as wc

taken = set()
kind = kernel_cache._files()
load = kind.load

def noted(self, key):
    taken.add((self._index_name.split("-")[0], str(key[0])))
    return load(self, key)

kind.load = noted
for number, (_, run) in enumerate(list_runs()):
    run()
    if number == 0:
        # what `make setup` compiles is enough for the shots of the demo
        before = set(taken)
        wc.impact("S-720", "155 m/s", opening="60 mm", end_time="60 us", snapshot_interval="10 us")
        for kernel, types in sorted(taken - before):
            print(f"demo: {kernel}", flush=True)
EXAMPLES = Path("examples").resolve()

def short(file):
    table = tomllib.loads(file.read_text())
    table.setdefault("run", {}).update(outputs=[], end_time="6 us")
    for name in ("snapshot_interval", "checkpoint_interval"):
        table["run"].pop(name, None)
    table["panel"]["opening"] = "50 mm"
    if table["panel"].get("plies", 1) > 3:
        table["panel"]["plies"] = 3
    if "stl" in table["projectile"]:
        table["projectile"]["stl"] = str(EXAMPLES / table["projectile"]["stl"])
    if "file" in table["fabric"]:
        table["fabric"]["file"] = str(EXAMPLES / table["fabric"]["file"])
    scene = Path(f"short-{file.name}")
    scene.write_text(toml(table))
    return scene

shot = partial(wc.impact, "S-728", "300 m/s", opening="30 mm", end_time="4 us")
pack = partial(shot, plies=2)
clay = {"material": "Roma Plastilina No. 1", "size": ["60 mm", "60 mm", "30 mm"], "min_size": "3 mm"}
first = {
    "bias extension": partial(
        wc.coupon, "S-720", "bias_extension", length="40 mm", width="15 mm", elongation="1 mm", steps=1
    ),
    "biaxial": partial(wc.coupon, "S-720", "biaxial", strain=["1 %", "0.5 %"], centre=4, arm=4, steps=1),
    "pull-out": partial(
        wc.coupon, "S-726", "pull_out", crossings=10, displacement="1 mm", crossover_cohesion="0.5 N"
    ),
    "clay": partial(pack, backing=clay),
    "clay, uniform": partial(pack, backing=clay, elements_per_crossover=1),
    "friction of plies": partial(pack, ply_friction=0.2),
    "turned plies": partial(shot, ply=[{}, {"name": "S-726", "angle": "30 deg"}]),
    "bullet on a uniform pack": partial(pack, projectile="9 mm FMJ 8.0 g", elements_per_crossover=1),
}
os.chdir(tempfile.mkdtemp())
for file in sorted(EXAMPLES.glob("*.toml")):
    first[file.name] = partial(wc.impact, short(file))
for name, run in first.items():
    before = set(taken)
    run()
    for kernel, types in sorted(taken - before):
        print(f"{name}: {kernel}", flush=True)
"""


@pytest.mark.slow(24)
def test_no_first_run_compiles_what_setup_has_not():
    pytest.importorskip("gmsh")
    done = subprocess.run(
        [sys.executable, "-c", RUNS], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout == ""
