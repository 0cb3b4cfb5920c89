"""One crimped yarn pulled straight, and what one-point integration of its solid leaves free.

The thesis shows that a yarn of under-integrated solids is stable with bars and throws its nodes about without (thesis
Figures 3-3, 3-4). Here: tension against strain for some numbers of fibre lines with bars beside the closed form
(eq. 4-7), and the eigenvalues of the tangent at rest, with one and with 2 x 2 x 2 integration points.

    python -m validation.published.single_yarn [FABRIC] [SIZE] [FOLDER]

writes single-yarn.svg and single-yarn.json.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
from scipy import sparse

from fabrics import catalogue
from fabrics.checks import FloatArray
from fabrics.fabric import Fabric
from fabrics.files import replace_whole, write_whole
from meshing import crossover
from unitcell3d.cases import single_yarn as cases_single_yarn
from unitcell3d.cases.single_yarn import YarnModel
from unitcell3d.material import solid_law
from unitcell3d.model.crossover import Load
from validation.program import program

ZERO = 1e-9  # of the largest eigenvalue
POINTS = {"one point": solid_law.ONE_POINT, "2 x 2 x 2 points": solid_law.FULL}


def spectrum(mesh: Any, fabric: Fabric, family: int, bars: int | None, integration: int) -> FloatArray:
    """(size,) sizes of the eigenvalues of the resting tangent over the largest, rising."""
    model = YarnModel(mesh, fabric, family, bars=bars, integration=integration)
    q = np.zeros(model.size)
    model.forces(q, Load())
    model.system(q, Load())
    pattern = model.pattern
    matrix = sparse.csr_matrix((pattern.entries, pattern.columns, pattern.starts)).toarray()
    values = np.sort(np.abs(np.linalg.eigvals(matrix)))
    return values / values[-1]


def measure(name: str = "S-720", size: str = "coarse") -> dict[str, Any]:
    """{"pulls": {family: {bars: Record}}, "spectra": {(points, bars): (n,)}} of one fabric."""
    fabric = catalogue.load(name)
    mesh = crossover.build(fabric, size=size)
    middle = mesh.grids[0].shape[1]
    pulls = {
        family: {bars: cases_single_yarn.pull(mesh, fabric, family, bars=bars) for bars in (0, middle, None)}
        for family in (0, 1)
    }
    spectra = {
        (label, bars): spectrum(mesh, fabric, 0, bars, points) for label, points in POINTS.items() for bars in (0, None)
    }
    return {"fabric": fabric, "pulls": pulls, "spectra": spectra}


def picture(found: Any, path: Path) -> None:
    """Both panels as one figure."""
    from meshing.pictures_style import FAINT, WARP, WEFT, plots

    with plots() as pyplot:
        figure, (left, right) = pyplot.subplots(1, 2, figsize=(11.5, 4.6))
        for family, (label, colour) in enumerate(zip(("warp", "weft"), (WARP, WEFT))):
            pulls = found["pulls"][family]
            full = pulls[None]
            left.plot(100 * full["strain"], full["T_taut"], color=FAINT, lw=1.4, ls="--",
                      label="eq. 4-7" if family else None)  # fmt: skip
            left.plot(100 * full["strain"], full["T"], color=colour, lw=2.2, label=f"{label}, bars on all lines")
            for bars, marker in zip((b for b in pulls if b is not None), "xo"):
                record = pulls[bars]
                left.plot(100 * record["strain"], record["T"], marker, color=colour, ms=5, mfc="white",
                          label=f"{label}, on {bars}" if bars else f"{label}, no bars")  # fmt: skip
        left.set(xlabel="strain of the end distance [%]", ylabel="tension [N]")
        left.set_title(f"{found['fabric'].name}, one yarn", loc="left", fontweight="bold")
        left.legend(fontsize=10)
        for (label, bars), values in found["spectra"].items():
            style = "-" if label != "one point" else "--"
            colour = WEFT if bars == 0 else WARP
            zero = int(np.sum(values < ZERO))
            right.semilogy(np.arange(1, len(values) + 1), np.maximum(values, 1e-18), style, color=colour, lw=2,
                           label=f"{label}, {'without' if bars == 0 else 'slack'} bars: {zero} zero")  # fmt: skip
        right.set(xlabel="number of the eigenvalue", ylabel="size over the largest")
        right.set_title("tangent of the resting warp", loc="left", fontweight="bold")
        right.legend(fontsize=10, loc="lower right")
        with replace_whole(path) as beside:
            figure.savefig(beside)
        pyplot.close(figure)


def main(name: str = "S-720", size: str = "coarse", folder: Path = Path("results/single-yarn")) -> None:
    """Measure, write and print."""
    found = measure(name, size)
    picture(found, folder / "single-yarn.svg")
    numbers = {}
    for (label, bars), values in found["spectra"].items():
        numbers[f"{label}, {'without' if bars == 0 else 'slack'} bars"] = {
            "unknowns": len(values), "zero-energy modes": int(np.sum(values < ZERO))
        }  # fmt: skip
    for family, label in enumerate(("warp", "weft")):
        record = found["pulls"][family][None]
        taut = record["T"] > 0.2 * record["T"].max()
        slope, start = np.polyfit(record["strain"][taut], record["T"][taut], 1)
        yarn = found["fabric"].weave.yarns[family]
        numbers[label] = {
            "taut stiffness over E A_s": slope * (1 + yarn.crimp) / yarn.EA,
            "straight at the strain": -start / slope,
            "crimp": yarn.crimp,
        }
    with write_whole(folder / "single-yarn.json") as file:
        json.dump(numbers, file, indent=2)
        file.write("\n")
    print(json.dumps(numbers, indent=2))


if __name__ == "__main__":
    program(main, name="fabric", size="of the mesh")
