"""python -m validation.published.biaxial_glass.specimen: the cross-shaped specimen against the crossover.

The specimen of thesis section 5.3 is pulled by its arms, its cross yarns drawn out of them or left in, and
the load per yarn at the grips is held against the crossover (see `curves`) at the strains of the specimen's middle.
What differs is what the test itself adds: load that the arms carry past the middle, strain that is not uniform. Figure
5-58 with the specimen's sizes is missing: the sizes here are assumed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from fabrics import catalogue
from fabrics.checks import FloatArray
from shellfabric.cell.model import CellModel
from shellfabric.coupon import quasistatic
from validation.program import program, write_csv

if TYPE_CHECKING:
    from fabrics.fabric import Fabric

CENTRE, ARM, MIDDLE = 12, 8, 6  # crossovers: side of the middle square, length of an arm, side of the gauge (assumed)
STRAINS = {"k = 1": (0.014, 0.014), "k = 2": (0.014, 0.007), "k = 0.5": (0.007, 0.014)}  # of the whole specimen
LOADED = 0.1  # of a yarn's strength: where loads are compared

COLUMNS = ["test", "cross yarns of the arms", "warp strain", "weft strain", "warp load N", "weft load N",
           "warp cell N", "weft cell N"]  # fmt: skip


@dataclass(frozen=True)
class Specimen:
    """One test on the specimen.

    Parameters
    ----------
    label : of STRAINS
    drawn : whether the arms have lost their cross yarns
    strain : (n, 2) [-] of the middle, along warp and weft
    load : (n, 2) [N] per yarn at the grips
    cell : (n, 2) [N] per yarn of the crossover at these strains
    tension : (n, 2) [N] of the same crossover with the thesis's equilibrium of forces, as in `curves`
    """

    label: str
    drawn: bool
    strain: np.ndarray
    load: np.ndarray
    cell: np.ndarray
    tension: np.ndarray

    def difference(self, reference: FloatArray, strength: Sequence[float]) -> float:
        """[-] largest |load / reference - 1| where the reference exceeds LOADED strengths."""
        loaded = reference > LOADED * np.asarray(strength)
        return float(np.max(np.abs(self.load[loaded] / reference[loaded] - 1)))


def pull_specimen(fabric: Fabric, label: str, drawn: bool = True, steps: int = 12) -> Specimen:
    """Pull the specimen until a yarn reaches its strength."""
    table = CellModel(fabric).table(201)
    run = quasistatic.biaxial(
        table, strain=STRAINS[label], centre=CENTRE, arm=ARM, cross_yarns_removed=drawn, steps=steps
    )
    strain = quasistatic.middle_strain(run, [MIDDLE * w for w in fabric.weave.w])
    load = np.stack([run.force(1, 0), run.force(3, 1)], axis=1) / CENTRE
    cell = table.model.solve(*(1 + strain).T)
    source = CellModel(fabric, form="equilibrium").solve(*(1 + strain).T)
    return Specimen(label, drawn, strain, load, np.stack([cell["N1"], cell["N2"]], axis=1),
                    np.stack([source["T1"], source["T2"]], axis=1))  # fmt: skip


def main(*, out: Path = Path("results/biaxial")) -> None:
    for name in ("glass-balanced", "glass-unbalanced"):
        fabric = catalogue.load(name)
        strength = [yarn.strength for yarn in fabric.weave.yarns]
        table = [COLUMNS]
        for label in STRAINS:
            for drawn in (True, False):
                arms = "drawn out" if drawn else "left in"
                done = pull_specimen(fabric, label, drawn)
                for row in np.hstack([done.strain, done.load, done.cell]):
                    table.append([label, arms, *(f"{value:.6g}" for value in row)])
                print(f"{name:17} {label:8} cross yarns {arms:10} load differs from the crossover's by at most "
                      f"{100 * done.difference(done.cell, strength):.2g} %, from the thesis's form of it by "
                      f"{100 * done.difference(done.tension, strength):.2g} %")  # fmt: skip
        write_csv(out / f"{name}-specimen.csv", table)


if __name__ == "__main__":
    program(main)
