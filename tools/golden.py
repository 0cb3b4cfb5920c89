"""Results of the solvers that must not change, in tests/golden/: inputs of examples/, coupons, limits, a V50, a fit.

    python tools/golden.py                    write them, half a minute of one core
    python tools/golden.py --check [NAME...]  compute them again, and compare with those that are kept

A file holds the numbers of one result by their names in the solver: of a fact its value, of a history mean,
root mean square and every tenth row, of a field mean and root mean square. A number may differ by a tolerance
times the root mean square of its field, or times a floor of its unit: 1e-11 on the machine that wrote the file
(`machine`), elsewhere 1e-9 of one ply and 1e-4 where bodies touch or a search ends at a tolerance of its own.
What measures the way to a solution (residuals, iterations) is left out; a coupon is relaxed to 1e-10 in two
steps, of which none is unloaded.
"""

import argparse
import ctypes
import json
import os
import platform
import tempfile
from dataclasses import fields, is_dataclass, replace
from math import ceil
from pathlib import Path

import llvmlite.binding
import numba
import numpy as np
import scipy
import scipy.linalg

from fabrics import catalogue
from fabrics.base.executors import InProcess
from fabrics.base.schema import read_toml
from shellfabric.cell.model import CellModel
from shellfabric.coupon import quasistatic
from shellfabric.impact.run import run_impact
from unitcell3d.identify.calibrate import calibrate
from weavecell.runs import v50
from weavecell.scenes import build, impact
from weavecell.scenes.coupon import CouponScene
from weavecell.scenes.fabric_table import check_scene
from weavecell.studies import ballistic_limit, inputs, pull_out

FOLDER, EXAMPLES = (Path(__file__).parents[1] / name for name in ("tests/golden", "examples"))
LONG = ("body-armour",)  # minutes
DIGITS = 14
ROWS = 6
MOST = 6
COLUMNS = 8  # a last axis up to this long is one of components: x, y, z; warp, weft; quantities
ONE_PLY = 1e-9
PACK = 1e-4  # contact of several bodies makes a difference of the last digit grow
OWN_MACHINE = 1e-11
NUMBERS = read_toml(FOLDER / "numbers.toml", what="table of numbers")[1]


def setup(path):
    """Build the set-up of an input file of an impact."""
    _, table = read_toml(path, what="input")
    scene = impact.check(table, path, "shot")
    return build.setup(build.build(scene, path, path.stem), path)


def run_shot(case):
    """Run a set-up; places of peaks without their signs, since mirrored segments bear the same to
    the last digit, and that digit says which was first."""
    result = run_impact(case)
    return replace(result, peaks=np.abs(result.peaks))


def coupon_test(path):
    """Run the coupon test of an input file."""
    _, table = read_toml(path, what="input")
    scene = check_scene(CouponScene, table, path, "coupon")
    case = build.build(scene, path, path.stem)
    table = CellModel(case.fabric, case.laws).table(201)
    if scene.test == "pull_out":
        return pull_out.run(table, scene.pull_out)
    options = scene.test_table.model_dump(exclude_none=True) | {"steps": 2, "tolerance": 1e-10}
    result = getattr(quasistatic, scene.test)(table, **options)
    if result.unloaded.any():
        raise ValueError(f"{path.stem}: the shape of an unloaded coupon is not kept")
    states = [
        {"load": state.load, "x": state.x, "reaction": state.reaction, "energies": state.energies}
        for state in result.states
    ]
    return {"outcome": result.outcome, "prescribed": result.prescribed, "states": states}


def critical_velocity(path):
    """Search the critical velocity of an input file."""
    return ballistic_limit.critical_velocity(setup(path).target(), tolerance=2.0)


def v50_of_eight_shots(path):
    """Compute V50 of an input file from eight shots."""
    with tempfile.TemporaryDirectory() as folder:
        return v50.study(
            setup(path), inputs.read_scatter(), shots=8, batch=4, seed=1, folder=folder
        )


RUNS = {
    "impact": (
        lambda path: run_shot(setup(path)),
        [path.stem for path in sorted(EXAMPLES.glob("*.toml")) if path.stem not in LONG],
    ),
    # the first part of it, which a quick test can afford
    "start": (
        lambda path: run_shot(replace(setup(path), end_time=80e-6)),
        ["S-728-pack"],
    ),
    "coupon": (
        coupon_test,
        ["coupons/S-720-frame", "coupons/S-720-warp", "coupons/S-726-pull-out"],
    ),
    "limit": (critical_velocity, ["S-720-stops", "S-728-incompressible"]),
    "v50": (v50_of_eight_shots, ["S-720-stops"]),
    "calibration": (
        lambda path: calibrate(catalogue.load(path.stem), size="coarse", executor=InProcess()),
        ["S-720"],
    ),
}
CASES = {
    f"{kind}-{Path(name).name}": (run, name)
    for kind, (run, names) in RUNS.items()
    for name in names
}


PACKS = (
    "impact-S-728-pack",
    "start-S-728-pack",
    "impact-hybrid-pack",
    "calibration-S-720",  # its iterations end at a residual
)


def tolerance(case, kept):
    """Return the tolerance [-] of a case, from where it was kept."""
    if kept["machine"] == machine():
        return OWN_MACHINE
    if case in PACKS:
        return PACK
    return ONE_PLY


# what makes libraries take the code of another processor
SETTINGS = (
    "NUMBA_CPU_NAME",
    "NUMBA_CPU_FEATURES",
    "OPENBLAS_CORETYPE",
    "NPY_DISABLE_CPU_FEATURES",
    "GLIBC_TUNABLES",
)


def machine():
    """Return what sets the last digits of numbers of this process: {what: name}."""
    has = llvmlite.binding.get_host_cpu_features()
    vectors = [name for name in ("sse4.2", "avx", "fma", "avx2", "avx512f") if has.get(name)]
    return {
        "processor": " ".join([llvmlite.binding.get_host_cpu_name(), *vectors]),
        "blas": blas(),
        "libc": " ".join(platform.libc_ver()),
        **{library.__name__: library.__version__ for library in (numba, np, scipy)},
        **{name: os.environ[name] for name in SETTINGS if name in os.environ},
    }


def blas():
    """Return the version of OpenBLAS and the processor for which it runs; "another" of another BLAS."""
    try:
        config = ctypes.CDLL(scipy.linalg._fblas.__file__).openblas_get_config
    except AttributeError:
        return "another"
    config.restype = ctypes.c_char_p
    return config().decode()


def numbers(result, name=""):
    """Collect every number, text or list in a result: {name: value}."""
    if is_dataclass(result):
        result = {field.name: getattr(result, field.name) for field in fields(result)}
    if isinstance(result, tuple | list) and any(
        is_dataclass(part) or isinstance(part, dict) for part in result
    ):
        result = dict(enumerate(result))
    if isinstance(result, dict):
        parts = (
            numbers(part, f"{name}.{key}".lstrip("."))
            for key, part in result.items()
            if key not in NUMBERS["skipped"]
        )
        return {key: value for part in parts for key, value in part.items()}
    # doubts of a shot are several texts
    if isinstance(result, tuple) and any(isinstance(part, str) for part in result):
        result = ", ".join(result)
    if isinstance(result, str):
        return {name: result}
    if not isinstance(result, int | float | np.ndarray | tuple):
        return {}
    values = np.asarray(result, float)
    if values.ndim > 1 and 1 < values.shape[-1] <= COLUMNS:
        return {f"{name}.{n}": thinned(values[..., n]) for n in range(values.shape[-1])}
    return {name: thinned(values)}


def thinned(values):
    """Thin numbers: one as it is; of a history [mean, root mean square, every tenth row]; of a field
    [mean, root mean square]."""
    if values.ndim == 0:
        return float(f"{float(values):.{DIGITS}g}")
    if not values.any():
        return 0.0
    rows = values[:: max(10, ceil(len(values) / ROWS))] if len(values) > ROWS else values
    rows = rows.ravel() if rows.size <= MOST else ()
    found = (values.mean(), np.sqrt((values**2).mean()), *rows)
    return [float(f"{number:.{DIGITS}g}") for number in found]


def floor(name):
    """Return the floor of a number by its unit; KeyError of a name that tests/golden/numbers.toml lacks."""
    words = name.split(".")
    for start in range(len(words)):
        tail = ".".join(words[start:])
        for number in (tail, tail.rpartition(".")[0]):
            for unit, names in NUMBERS["names"].items():
                if number in names:
                    return NUMBERS["floor"][unit]
    raise KeyError(f"{name}: its unit is missing in {FOLDER / 'numbers.toml'}")


def same(name, kept, computed, allowed):
    """Tell whether a kept and a computed value agree: numbers to `allowed` [-] of the root mean square
    of their field, or of the floor of its unit."""
    if isinstance(kept, str) or isinstance(computed, str):
        return kept == computed
    kept = np.atleast_1d(kept)
    computed = np.atleast_1d(computed)
    if kept.shape != computed.shape:
        return False
    scale = max(abs(kept[0]), *kept[1:2], floor(name))
    return np.allclose(computed, kept, rtol=0.0, atol=allowed * scale, equal_nan=True)


def find_changes(case):
    """Compute a case again, and return the names of what differs from what is kept, and how many are."""
    run, source = CASES[case]
    kept = json.loads((FOLDER / f"{case}.json").read_text())
    computed = numbers(run(EXAMPLES / f"{source}.toml"))
    allowed = tolerance(case, kept)
    off = [
        name
        for name in kept["numbers"] | computed
        if name not in kept["numbers"]
        or name not in computed
        or not same(name, kept["numbers"][name], computed[name], allowed)
    ]
    return off, len(kept["numbers"]), allowed


def write(case):
    """Compute a case, and keep it."""
    run, source = CASES[case]
    computed = numbers(run(EXAMPLES / f"{source}.toml"))
    for name, value in computed.items():
        if not isinstance(value, str):
            floor(name)  # each has a unit
    lines = ",\n".join(f"{json.dumps(key)}: {json.dumps(value)}" for key, value in computed.items())
    head = json.dumps(machine(), indent=1)
    (FOLDER / f"{case}.json").write_text(f'{{"machine": {head},\n"numbers": {{\n{lines}\n}}}}\n')


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--check", action="store_true", help="compare, and write nothing")
    parser.add_argument("names", nargs="*", default=CASES, metavar="NAME")
    arguments = parser.parse_args()
    if unknown := [name for name in arguments.names if name not in CASES]:
        parser.error(f"unknown: {', '.join(unknown)}; NAME is one of {', '.join(CASES)}")
    changed = 0
    for case in arguments.names:
        if not arguments.check:
            write(case)
            continue
        off, many, allowed = find_changes(case)
        told = "the same"
        if off:
            told = f"CHANGED: {', '.join(off)}"
            changed += 1
        print(f"{case}: {many} entries to {allowed:g}; {told}", flush=True)
    raise SystemExit(changed > 0)
