"""Why the law of the fitted solid has a smaller b than the published one: one solid constant at a time.

    python -m validation.published.platen.law_by_constant CHAIN [--fabric S-720] [--page PAGE]

CHAIN is the folder of `weavecell calibrate --all --fit-solid`. The biaxial paths of the crossover are computed with the
solid of the fabric's file, with each constant in turn at its fitted value, with all but one, and with all; (a, b) are
fitted to each. The closures at given contact forces say where the law changes.
"""

from __future__ import annotations

import json
from itertools import combinations
from pathlib import Path

import numpy as np

from fabrics import catalogue
from fabrics.compression import CompressionLaw
from fabrics.errors import InputError
from fabrics.executors import open_executor
from fabrics.variants import with_solids
from meshing import crossover as mesher
from unitcell3d.cases import biaxial_and_platens
from unitcell3d.identify.solid_record import NAMES
from validation.program import program, publish
from weavecell.report.marked_page import markdown

RATIOS = ((1.0, 0.0), (0.0, 1.0), (1.0, 1.0))  # of the displacements of warp and weft: the calibration paths
SHARES = 25  # points of each path, at equal shares of its displacement
FORCES = (1.0, 10.0, 50.0)  # [N] at which closures are compared
MARKS = "<!-- law by constant -->", "<!-- end of the laws by constant -->"


def choices() -> list[tuple[str, ...]]:
    """The constants that have their fitted value: none, one, two, all."""
    return [chosen for n in range(len(NAMES) + 1) for chosen in combinations(NAMES, n)]


def fitted(chain: Path, fabric: str) -> dict[str, float]:
    """{"E_c", "V_c", "K_r": value} of the fit of a fabric.

    Raises
    ------
    InputError : the folder has no fit of this fabric
    """
    try:
        values = json.loads((chain / fabric / "solid.json").read_text("utf-8"))["values"]
        return {name: float(values[name]) for name in NAMES}
    except (OSError, ValueError, KeyError):
        raise InputError(f"has no fit of the solid of {fabric}", file=chain) from None


def law(fabric: str, constants: dict[str, float]) -> tuple[float, float, list[float]]:
    """(a [m], b [m N^(1/3)], closures [m] at FORCES) of the crossover with these solid constants."""
    given = catalogue.load(fabric)
    given = with_solids(given, **constants) if constants else given
    mesh, F, d = mesher.build(given, size="coarse"), [], []
    for ratio in RATIOS:
        path = biaxial_and_platens.biaxial(mesh, given, ratio)
        shares = np.linspace(0, path.path[-1], SHARES + 1)[1:]
        force, closure = (np.interp(shares, path.path, values) for values in (path.F_c, path.d_c))
        F.append(force[force > 0])
        d.append(closure[force > 0])
    force, closure = np.concatenate(F), np.concatenate(d)
    found, order = CompressionLaw.fit(force, closure), np.argsort(force)
    return found.a, found.b, [float(np.interp(at, force[order], closure[order])) for at in FORCES]


def table(fabric: str, found: dict) -> list[list[str]]:
    """A header, the published law, and a row for each choice; `found` {choice: what `law` gives}."""
    laws = catalogue.load(fabric).laws
    assert laws is not None
    published = laws[0]
    rows = [
        [
            "fabric",
            "at the fitted value",
            "a / published",
            "b / published",
            *(f"closed at {F:g} N [µm]" for F in FORCES),
        ]
    ]
    rows.append([fabric, "published law", "1", "1", *(f"{1e6 * float(published.d(F)):.1f}" for F in FORCES)])
    for choice, (a, b, closures) in found.items():
        name = ", ".join(choice) or "none: the file's solid"
        ratios = f"{a / published.a:.2f}", f"{b / published.b:.2f}"
        rows.append([fabric, name, *ratios, *(f"{1e6 * closure:.1f}" for closure in closures)])
    return rows


def main(chain: Path, *, fabric: str = "S-720", jobs: int = 1, page: Path | None = None) -> None:
    values = fitted(chain, fabric)
    constants = [{name: values[name] for name in choice} for choice in choices()]
    with open_executor("local", jobs) as pool:
        found = list(pool.map(law, [fabric] * len(constants), constants))
    made = markdown(table(fabric, dict(zip(choices(), found, strict=True))))
    publish(made, page, MARKS)


if __name__ == "__main__":
    program(main)
