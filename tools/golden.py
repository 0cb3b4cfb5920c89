"""Results of the solvers that must not change, in tests/golden/: inputs of examples/, coupons, limits, a V50, a fit.

    python tools/golden.py                    write them, half a minute of one core
    python tools/golden.py --check [NAME...]  compute them again, and compare with those that are kept

Each file holds the numbers of one result by their names in the solver: facts, of histories mean and every tenth row,
of fields mean and mean square. Twelve digits agree on one kind of processor.
"""

import argparse
import json
import tempfile
from dataclasses import fields, is_dataclass
from math import ceil, isclose
from pathlib import Path

import numpy as np

from fabrics import catalogue
from fabrics.base.executors import InProcess
from fabrics.base.schema import read_toml
from shellfabric.cell.model import CellModel
from shellfabric.coupon import quasistatic
from shellfabric.impact.run import run_impact
from unitcell3d.identify.calibrate import calibrate
from weavecell.scenes import build, honoured, impact
from weavecell.scenes.coupon import CouponScene
from weavecell.scenes.fabric_table import check_scene
from weavecell.studies import ballistic_limit, inputs, pull_out, v50

FOLDER, EXAMPLES = (Path(__file__).parents[1] / name for name in ("tests/golden", "examples"))
LONG = ("body-armour",)  # minutes
DIGITS, TOLERANCE, ROWS, MOST = 12, 1e-11, 6, 6
SKIPPED = (  # inputs, words, clocks, fields at every instant, and small differences of energies
    *(
        "setup",
        "target",
        "coupon",
        "snapshots",
        "scatter",
        "wall_time",
        "alone_from",
        "ns_per_element_step",
        "seconds",
    ),
    *(
        "meaning",
        "meanings",
        "unit",
        "limit",
        "note",
        "provenance",
        "quads",
        "area",
        "checks",
        "path_laws",
        "sizes",
    ),
    *("error", "balance", "yarn_snap"),
    # what pictures show of resolved yarns, which none of these has
    *("yarn_surface", "yarn_tension", "yarn_family", "resolved"),
)


def setup(path):
    """Build the set-up of an input file of an impact."""
    _, table = read_toml(path, what="input")
    scene = impact.check(table, path, honoured.IMPACT)
    return build.setup(build.build(scene, path, path.stem), path)


def coupon_test(path):
    """Run the coupon test of an input file."""
    _, table = read_toml(path, what="input")
    scene = check_scene(CouponScene, table, path, honoured.COUPON)
    case = build.build(scene, path, path.stem)
    table = CellModel(case.fabric, case.laws).table(201)
    if scene.test == "pull_out":
        return pull_out.run(table, scene.pull_out)
    options = scene.test_table.model_dump(exclude_none=True) | scene.run.model_dump(
        exclude={"outputs"}
    )
    return getattr(quasistatic, scene.test)(table, **options)


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
        lambda path: run_impact(setup(path)),
        [path.stem for path in sorted(EXAMPLES.glob("*.toml")) if path.stem not in LONG],
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
            if key not in SKIPPED
        )
        return {key: value for part in parts for key, value in part.items()}
    return (
        {name: thinned(result)}
        if isinstance(result, int | float | str | np.ndarray | tuple)
        else {}
    )


def thinned(value):
    """Thin a value: a number or text as it is; of a history mean and every tenth row; of a field
    mean and mean square."""
    if isinstance(value, str) or np.ndim(value) == 0:
        return value if isinstance(value, str) else float(f"{float(value):.{DIGITS}g}")
    values = np.asarray(value)
    if not values.any():
        return 0.0
    rows = values[:: max(10, ceil(len(values) / ROWS))] if len(values) > ROWS else values
    rows = rows.ravel() if rows.size <= MOST else [(values.astype(float) ** 2).mean()]
    return [thinned(number) for number in (values.mean(), *rows)]


def same(kept, computed):
    """Compare a kept and a computed value; numbers may differ by TOLERANCE."""
    if isinstance(kept, list) and isinstance(computed, list):
        return len(kept) == len(computed) and all(map(same, kept, computed))
    return kept == computed or (
        type(kept) is type(computed) is float and isclose(kept, computed, rel_tol=TOLERANCE)
    )


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--check", action="store_true", help="compare, and write nothing")
    parser.add_argument("names", nargs="*", default=CASES, metavar="NAME")
    arguments, changed = parser.parse_args(), 0
    for case in arguments.names:
        run, source = CASES[case]
        computed, file = numbers(run(EXAMPLES / f"{source}.toml")), FOLDER / f"{case}.json"
        if arguments.check:
            kept = json.loads(file.read_text())
            off = [key for key in kept | computed if not same(kept.get(key), computed.get(key))]
            print(
                f"{case}: {len(kept)} entries; {'CHANGED: ' * bool(off)}{', '.join(off) or 'the same'}",
                flush=True,
            )
            changed += bool(off)
        else:
            lines = ",\n".join(
                f"{json.dumps(key)}: {json.dumps(value)}" for key, value in computed.items()
            )
            file.write_text(f"{{\n{lines}\n}}\n")
    raise SystemExit(changed > 0)
