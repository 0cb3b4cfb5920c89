"""The inverse of `curves`: the compression law from one biaxial test, as the thesis takes it from k = 1.

    python -m validation.published.biaxial_glass.fit TEST.csv --fabric NAME [--predict OTHER.csv ...] [--out FOLDER]

The constants a and b come with their confidence intervals, and with what they predict at other ratios (thesis section
5.3, Figures 5-59 to 5-64). The format of a test is described in validation/published/biaxial_glass/measured.py.

a = exp(p) and F0 = exp(q) stay positive, and b = a F0^(1/3); residuals are tensions over the yarn's strength. Intervals
are those of the linearised problem at 95 %; bands of a prediction hold 95 % of the curves of parameters drawn from it.
With --origin the origin of the strains is a parameter too: the thesis names its shift as a cause of its misfit. It
names the cosine of its yarns and their linear tension too: --profile and --toe give the cell others.
"""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
from scipy.optimize import least_squares
from scipy.stats import t as student

from fabrics import catalogue
from fabrics.checks import FilePath
from fabrics.compression import CompressionLaw
from fabrics.errors import InputError
from fabrics.fabric import Fabric
from fabrics.files import replace_whole, write_whole
from shellfabric.cell.model import CellModel
from validation.program import program
from validation.published.biaxial_glass.curves import TOE, toe_of
from validation.published.biaxial_glass.measured import Test

DRAWS = 200
CONFIDENCE = 0.95


@dataclass(frozen=True, eq=False)
class Fit:
    """Constants fitted to a test.

    Parameters
    ----------
    fabric : Fabric
    law : CompressionLaw with its intervals; residual_rms is left out, for the residuals are tensions
    shift : [-] of the strains' origin, with its interval; (0, None) where it was not fitted
    parameters, covariance : of p, q and the shift
    residual : [-] rms over the yarn's strength
    options : of the cell: form, profile, toe
    """

    fabric: Fabric
    law: CompressionLaw
    shift: tuple
    parameters: np.ndarray
    covariance: np.ndarray
    residual: float
    options: dict

    def tension(self, strain: np.ndarray) -> np.ndarray:
        """(n, 2) [N] per yarn at strains (n, 2), with the fitted constants."""
        return _tension(self.fabric, self.parameters, strain, self.options)

    def band(self, strain: np.ndarray, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
        """((n, 2), (n, 2)) [N] between which 95 % of the curves of drawn parameters lie, at strains (n, 2)."""
        draws = np.random.default_rng(seed).multivariate_normal(self.parameters, self.covariance, DRAWS)
        curves = np.array([_tension(self.fabric, draw, strain, self.options) for draw in draws])
        return tuple(np.quantile(curves, [0.5 - CONFIDENCE / 2, 0.5 + CONFIDENCE / 2], axis=0))


def fit(fabric: Fabric, test: Test, *, origin: bool = False, form: str = "equilibrium", **options: Any) -> Fit:
    """Fit a and b to a test, and the origin of its strains if wanted; `options` are those of CellModel.

    Raises
    ------
    InputError : a test at which the yarns do not touch, or to which no constants can be fitted
    """
    strength, options = np.array([yarn.strength for yarn in fabric.weave.yarns]), {"form": form, **options}
    measured = ~np.isnan(test.tension)
    start = np.array(
        [np.log(0.4 * sum(fabric.weave.h0) / 2), np.log(3e-3 * strength.mean()), *([0.0] if origin else [])]
    )

    def residuals(parameters):
        return ((_tension(fabric, parameters, test.strain, options) - test.tension) / strength)[measured]

    bounds = ([-30, -30, -0.02][: start.size], [np.log(fabric.weave.thickness), 20, 0.02][: start.size])
    scale = np.array([1.0, 3.0, 1e-3])[: start.size]
    found = least_squares(residuals, start, x_scale=scale, diff_step=1e-5, bounds=bounds)
    free = found.fun.size - start.size
    if not found.success or free < 1 or np.linalg.matrix_rank(found.jac, tol=1e-12) < start.size:
        raise InputError("tells nothing of the compression law: no a and b can be fitted", file=test.source or None)
    covariance = np.linalg.inv(found.jac.T @ found.jac) * np.sum(found.fun**2) / free
    return _packed(fabric, test, found.x, covariance, found.fun, student.ppf(0.5 + CONFIDENCE / 2, free), options)


def _packed(fabric, test, x, covariance, residuals, spread, options):
    a, F0 = float(np.exp(x[0])), float(np.exp(x[1]))
    b, C = a * F0 ** (1 / 3), covariance
    da, db = spread * C[0, 0] ** 0.5, spread * (C[0, 0] + 2 / 3 * C[0, 1] + C[1, 1] / 9) ** 0.5
    with np.errstate(over="ignore"):  # a constant that the test does not determine has no upper end
        intervals = [(value * np.exp(-half), value * np.exp(half)) for value, half in ((a, da), (b, db))]
    law = CompressionLaw(
        a, b, provenance=f"fitted to {Path(test.source).name or 'a biaxial test'}, k = {test.ratio:.3g}",
        a_interval=intervals[0], b_interval=intervals[1], fabric=fabric.name,
    )  # fmt: skip
    shift = (0.0, None)
    if x.size > 2:
        half = spread * C[2, 2] ** 0.5
        shift = (float(x[2]), (float(x[2] - half), float(x[2] + half)))
    return Fit(fabric, law, shift, x, covariance, float(np.sqrt(np.mean(residuals**2))), options)


def _tension(fabric, parameters, strain, options):
    """(n, 2) [N] of the cell with the constants of the parameters; a shift of the origin counts in both directions."""
    a, F0 = np.exp(parameters[0]), np.exp(parameters[1])
    law = CompressionLaw(float(a), float(a * F0 ** (1 / 3)))
    shift = parameters[2] if len(parameters) > 2 else 0.0
    found = CellModel(fabric, (law, law), **options).solve(*(1 + strain + shift).T)
    return np.stack([found["T1"], found["T2"]], axis=-1)


def write(found: Fit, tests: Mapping[str, Test], path: FilePath) -> None:
    """One row a sample of each test: strains, measured and computed tensions, and the band of the latter."""
    with write_whole(path) as file:
        rows = csv.writer(file)
        rows.writerow(
            [
                "test",
                "warp strain",
                "weft strain",
                *(
                    f"{family} tension {what} N"
                    for family in ("warp", "weft")
                    for what in ("measured", "computed", "low", "high")
                ),
            ]
        )
        for name, test in tests.items():
            computed, (low, high) = found.tension(test.strain), found.band(test.strain)
            for strain, *parts in zip(test.strain, test.tension, computed, low, high):
                values = [part[family] for family in (0, 1) for part in parts]
                rows.writerow([name, *(f"{value:.6g}" for value in (*strain, *values))])  # fmt: skip


def picture(found: Fit, tests: Mapping[str, Test], path: FilePath) -> None:
    """Measured and computed tensions of the fitted test and of those predicted."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    from meshing.pictures_style import BLUE, GREEN, PURPLE, RED

    figure, axes = plt.subplots(1, 2, figsize=(10, 4.4), layout="constrained", squeeze=False)
    for colour, (name, test) in zip((GREEN, BLUE, RED, PURPLE), tests.items()):
        computed, (low, high) = found.tension(test.strain), found.band(test.strain)
        for family, axis in enumerate(axes[0]):
            x = 100 * test.strain[:, family]
            axis.plot(x, test.tension[:, family], "o", ms=4, mfc="none", color=colour)
            axis.fill_between(x, low[:, family], high[:, family], color=colour, alpha=0.25, lw=0)
            axis.plot(x, computed[:, family], color=colour, lw=1.8, label=f"{name}, k = {test.ratio:.3g}")
    for name, axis in zip(("warp", "weft"), axes[0]):
        axis.set(title=name, xlabel=f"{name} strain, %", ylabel="tension per yarn, N", xlim=(0, None), ylim=(0, None))
        axis.grid(alpha=0.3)
        axis.spines[["top", "right"]].set_visible(False)
    axes[0, 0].legend(frameon=False)
    figure.suptitle(
        f"{found.fabric.name}: circles measured, lines and 95 % bands from the law fitted to the first test"
    )
    with replace_whole(path) as beside:
        figure.savefig(beside, dpi=140)
    plt.close(figure)


def main(
    test: Path, *, fabric: str = "glass-balanced", predict: Sequence[Path] = (), origin: bool = False,
    form: Literal["equilibrium", "variational"] = "equilibrium", profile: Literal["cosine", "straight"] = "cosine",
    toe: str = "0", out: Path = Path("results/biaxial"),
) -> None:  # fmt: skip
    weave = catalogue.read(fabric) if fabric.endswith(".toml") else catalogue.load(fabric)
    tests = {path.stem: Test.read(path) for path in (test, *predict)}
    found = fit(weave, tests[test.stem], origin=origin, form=form, profile=profile, toe=toe_of(toe))
    law, strength = found.law, np.array([yarn.strength for yarn in weave.weave.yarns])
    found.law.to_json(out / f"{test.stem}-law.json")
    write(found, tests, out / f"{test.stem}-fit.csv")
    picture(found, tests, out / f"{test.stem}-fit.png")
    assert law.a_interval is not None
    assert law.b_interval is not None
    print(f"a = {1e3 * law.a:.4f} mm ({1e3 * law.a_interval[0]:.4f} to {1e3 * law.a_interval[1]:.4f})")
    low, b, high = (1e5 * value for value in (law.b_interval[0], law.b, law.b_interval[1]))
    print(f"b = {b:.3f} mm uN^(1/3) ({low:.3f} to {high:.3f})")
    if origin:
        span = " to ".join(f"{100 * end:.4f}" for end in found.shift[1])
        print(f"origin of the strains shifted by {100 * found.shift[0]:.4f} % ({span})")
    for name, one in tests.items():
        off = (found.tension(one.strain) - one.tension) / strength
        print(f"{name:20} k = {one.ratio:.3g}: rms {100 * np.sqrt(np.nanmean(off**2)):.2f} % of the strength")


if __name__ == "__main__":
    program(main, test="TEST.csv", predict="OTHER.csv ...", origin="fit the origin of the strains too", toe=TOE)
