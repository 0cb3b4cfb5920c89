"""Clay and gelatine behind a panel: the drop test of clay calibration, and dents behind packs.

python -m validation.published.backing [--out results/backing] [--page docs/reports/backing.md]

The drop test (NIJ 0101.04 and later, as quoted by the National Research Council, Testing of Body Armor Materials,
Phase III, 2012): a steel sphere of 63.5 mm and about 1 kg falls 2.0 m on a block of clay, here of 610 x 610 x 140 mm;
the dent of each drop must be 19 +- 3 mm deep. It strikes at (2 g h)^(1/2) = 6.26 m/s; its weight
during the dent, 1 % of its energy, is left out, and so is friction. The window is compared with and nothing is fitted
to it.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np

from fabrics import backings, run_cache
from fabrics.files import replace_whole
from shellfabric.backing.block import Backing
from shellfabric.projectile.projectile import Projectile
from validation.marked_page import markdown
from validation.models.bare_impact import Strike, strike
from validation.program import program, publish, write_csv
from weavecell.report import pictures, pictures_body

CLAY = "Roma Plastilina No. 1"
BALL = Projectile(mass=1.0, shape="sphere", radius=31.75e-3)
SPEED = float(np.sqrt(2 * 9.81 * 2.0))  # [m/s]
SIZES = (4.0, 2.0)  # [mm] of the smallest hexahedra behind packs: of all shots, and of the first once more
WINDOW = (17.0, 23.0)  # [mm] 20 +- 3; of 19 +- 3 it would be 16 to 22
MARKS = "<!-- drop test of validation.published.backing -->", "<!-- end of the drop test -->"
PACKS = "<!-- packs of validation.published.backing -->", "<!-- end of the packs -->"
HEADS = (
    "backing", "smallest hexahedron, mm", "hexahedra", "deepest, mm", "left, mm", "volume, cm³", "time to the turn, ms",
    "energy error, %", "hourglass, %",
)  # fmt: skip


def drop(name: str, min_size: float) -> Strike:
    """The ball falls on the block, until 2 ms after it has turned back.

    Parameters
    ----------
    name : of `fabrics.backings`
    min_size : [m] edge of the smallest hexahedra
    """
    block = Backing(
        material=backings.load(name), size=(0.61, 0.61, 0.14), min_size=min_size, refined_depth=0.045, growth=1.4
    )
    return strike(block, BALL, SPEED, 0.03, after=2e-3)


def row(name: str, min_size: float, found: Strike) -> tuple[str, ...]:
    """A row under HEADS."""
    start, turn = found.energies["projectile"][0], int(np.argmax(found.z))
    error = 100 * np.abs(found.energies["error"]).max() / start
    return (
        name, f"{1e3 * min_size:g}", f"{len(found.block.bricks)}", f"{1e3 * found.z[turn]:.1f}",
        f"{1e3 * found.block.back_face_signature:.1f}", f"{1e6 * found.block.volume:.1f}", f"{1e3 * found.t[turn]:.1f}",
        f"{error:.2f}", f"{100 * found.energies['hourglass'][turn] / start:.1f}",
    )  # fmt: skip


def in_the_limit(rows: Sequence[Sequence[str]]) -> str:
    """A sentence: the dents of clay against the window, and where a straight line through the meshes leads."""
    of_clay = [one for one in rows if one[0] == CLAY]
    size, deepest, left = (np.array([float(one[c]) for one in of_clay]) for c in (1, 3, 4))
    said = f"The window is {WINDOW[0]:g} to {WINDOW[1]:g} mm. "
    said += f"With hexahedra of {size[-1]:g} mm clay is left with {left[-1]:.1f} mm: "
    said += "within it." if WINDOW[0] <= left[-1] <= WINDOW[1] else "outside it."
    if len(size) > 1:
        ends = [float(np.polyval(np.polyfit(size, one, 1), 0.0)) for one in (deepest, left)]
        said += " A straight line through the meshes leads to {:.1f} mm deepest and {:.1f} mm left".format(*ends)
        said += " at size 0, which is an estimate and no run."
    return said


def pack(plies: int, velocity: float, size: float) -> dict[str, Any]:
    """The summary of a round-nosed projectile of 8 g and 9 mm on free plies of S-728 before clay, followed for 0.3 ms
    after the stop; size [mm] of the smallest hexahedra."""
    import weavecell as wc

    shot = {"mass": "8 g", "diameter": "9 mm", "shape": "hemisphere", "edge_radius": "0.3 mm"}
    block = {
        "material": CLAY, "size": ["120 mm", "120 mm", "60 mm"], "min_size": f"{size:g} mm",
        "refined_depth": "16 mm", "growth": 1.5, "after_stop": "0.3 ms",
    }  # fmt: skip
    found = wc.impact(
        "S-728", velocity, plies=plies, projectile=shot, backing=block, opening="80 mm", boundary="free",
        end_time="3 ms",
    )  # fmt: skip
    return found.summary()


def main(
    *, out: Path = Path("results/backing"), page: Path | None = None, meshes: Sequence[float] = (12.0, 8.0, 6.0),
    plies: Sequence[int] = (8, 16), velocities: Sequence[float] = (150.0, 200.0, 250.0),
) -> None:  # fmt: skip
    if meshes:
        rows = _drops(meshes, out, page)
        publish(f"{markdown(rows, numbers=True)}\n{in_the_limit(rows)}\n", page, MARKS)
    if plies:
        rows = _packs(plies, velocities, out)
        write_csv(out / "packs.csv", rows)
        publish(markdown(rows, numbers=True), page, PACKS)


def _drops(meshes, out, page):
    """Rows of the drop tests, of clay on all meshes and of the others on the first; a picture of the last ones."""
    cases = [(CLAY, size) for size in meshes] + [(name, meshes[0]) for name in backings.list_names() if name != CLAY]
    rows, last = [HEADS], {}
    for name, size in cases:
        found = drop(name, 1e-3 * size)
        rows.append(row(name, 1e-3 * size, found))
        print(*rows[-1], flush=True)
        last |= {f"{name}, {size:g} mm": found.block} if size in (meshes[0], meshes[-1]) else {}
    write_csv(out / "drop-test.csv", rows)
    folder = page.parent / "figures" if page else out
    with replace_whole(folder / "drop-test.png") as beside:
        beside.write_bytes(pictures.render(pictures_body.crater, last, kind="png"))
    return rows


def _packs(plies, velocities, folder):
    """Rows of the packs before clay; each shot is kept in the folder."""
    rows = [("plies", "smallest hexahedron, mm", "velocity, m/s", "outcome", "stop, µs", "end, µs", "signature, mm",
             "volume, cm³", "block moves with, %", "energy error, %")]  # fmt: skip
    finer = [(plies[0], velocities[0], SIZES[1])]
    for count, velocity, size in [(*case, SIZES[0]) for case in product(plies, velocities)] + finer:
        [found] = run_cache.results(pack, [(count, velocity, size)], folder=folder)
        moving = 100 * found["energies_at_end_J"]["backing_kinetic"] / found["strike_energy_J"]
        stop = f"{1e6 * found['stop_time_s']:.0f}" if found["stop_time_s"] else ""
        rows.append((f"{count}", f"{size:g}", f"{velocity:g}", found["outcome"], stop,
                     f"{1e6 * found['end_time_s']:.0f}", f"{found['back_face_signature_mm']:.1f}",
                     f"{1e6 * found['dent_volume_m3']:.2f}", f"{moving:.1f}",
                     f"{100 * found['energy_error_max']:.2f}"))  # fmt: skip
        print(*rows[-1], flush=True)
    return rows


if __name__ == "__main__":
    program(
        main,
        meshes="smallest hexahedra [mm]; without values, no drop test",
        plies="of the packs; without values, no packs",
        velocities="[m/s]",
    )
