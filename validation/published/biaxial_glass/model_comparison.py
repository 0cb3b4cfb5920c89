"""python -m validation.published.biaxial_glass.model_comparison [--out FOLDER] [FABRIC ...]: one weave in three models.

Tension per yarn at k = 1, and with the cross yarns free, of
- the crossover's cell, in the thesis's form and in the variational one;
- the shell coupon: the cross-shaped specimen, its load per yarn against the strain of its middle. Its arms
  are yarns that have lost their cross yarns, longer than the cloth they came from and softer, so that grips that move
  alike would not stretch the middle alike: they are moved by what its arms need at the middle's loads. With the cross
  yarns free, a strip whose sides are free;
- the 3D crossover; with the cross yarns free a yarn of it that crosses nothing. Its solid is assumed
  for glass. It knows nothing of the published a and b: the cell is also given the law that is fitted to the contact
  forces and compressions of the 3D crossover itself along this path.

Needs dolfinx. Writes a table (CSV) and a picture a weave, and prints the differences from the thesis's form.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from fabrics import catalogue
from fabrics.checks import FloatArray
from fabrics.compression import CompressionLaw
from meshing.pictures_style import BLUE, GREEN, INK, ORANGE
from shellfabric.cell.model import CellModel
from shellfabric.coupon import quasistatic
from validation.marked_page import markdown
from validation.program import program, save, write_csv
from validation.published.biaxial_glass.curves import at_ratio, free_edge

if TYPE_CHECKING:
    from fabrics.fabric import Fabric

MODELS = ("cell, thesis's form", "cell, variational", "shell coupon", "3D crossover", "cell, law of the 3D crossover")
YARNS = ("warp", "weft")
# crossovers: side of the middle square, length of an arm, side of the gauge; assumed, for Figure 5-58 is missing
CENTRE, ARM, MIDDLE = 12, 8, 6
REACH, STEPS = 0.98, 12  # of the cell's curve, load steps
STRIP = (16, 6)  # crossovers: length and width of the strip with free sides
TOLERANCE = 1e-4  # out-of-balance force over the reaction


def equal_strains(fabric: Fabric, crossover: Any) -> tuple[dict[str, Any], Any]:
    """({model: (strain (n, 2), tension (n, 2))} at k = 1, the law that is fitted to the 3D crossover)."""
    from unitcell3d.cases import biaxial_and_platens

    found = {}
    for name, form in zip(MODELS, ("equilibrium", "variational")):
        curve = at_ratio(CellModel(fabric, form=form), 1.0)
        found[name] = curve.strain, curve.tension
    found[MODELS[2]] = middle_alike(fabric)
    solid = biaxial_and_platens.biaxial(crossover, fabric, fabric.weave.w)
    found[MODELS[3]] = np.stack([solid.d1, solid.d2], axis=1) / fabric.weave.w, np.stack([solid.T1, solid.T2], axis=1)
    touching = solid.F_c > 0
    law = CompressionLaw.fit(solid.F_c[touching], solid.d_c[touching], provenance="3D crossover, k = 1")
    curve = at_ratio(CellModel(fabric, (law, law), form="equilibrium"), 1.0)
    found[MODELS[4]] = curve.strain, curve.tension
    return found, law


def middle_alike(fabric: Fabric) -> tuple[FloatArray, FloatArray]:
    """(strain of the middle (n, 2), load per yarn (n, 2)) of the cross-shaped specimen, its middle stretched alike."""
    table, weave = CellModel(fabric).table(201), fabric.weave
    end = REACH * at_ratio(table.model, 1.0).strain[-1, 0]

    def grips(load):
        cell = table.model.solve(1 + load * end, 1 + load * end)
        arms = [(1 + yarn.crimp) * (1 + float(cell[N]) / yarn.EA) - 1 for N, yarn in zip(("N1", "N2"), weave.yarns)]
        return (CENTRE * load * end + 2 * ARM * np.array(arms) * (load > 0)) / (CENTRE + 2 * ARM)

    run = quasistatic.biaxial(table, strain=grips, centre=CENTRE, arm=ARM, steps=STEPS, tolerance=TOLERANCE)
    strain = quasistatic.middle_strain(run, [MIDDLE * w for w in weave.w])
    return strain, np.stack([run.force(1, 0), run.force(3, 1)], axis=1) / CENTRE


def cross_yarns_free(fabric: Fabric, crossover: Any, family: int) -> dict[str, Any]:
    """{model: (strain (n,), tension (n,))} of one yarn family, 0 warp or 1 weft, the other free."""
    from unitcell3d.cases import single_yarn as cases_single_yarn

    yarn, found = YARNS[family], {}
    curve = free_edge(CellModel(fabric, form="equilibrium"), yarn)
    found[MODELS[0]] = curve.strain[:, family], curve.tension[:, family]
    pitch = [2 * w for w in (fabric.weave.w if family == 0 else fabric.weave.w[::-1])]
    end = curve.strain[-1, family]
    strip = quasistatic.uniaxial(
        CellModel(fabric).table(201), direction=yarn, length=STRIP[0] * pitch[0], width=STRIP[1] * pitch[1],
        strain=end, steps=STEPS, tolerance=TOLERANCE,
    )  # fmt: skip
    found[MODELS[2]] = strip.prescribed, strip.force(1, 0) / STRIP[1]
    alone = cases_single_yarn.pull(crossover, fabric, family)
    found[MODELS[3]] = alone["strain"], alone["T"]
    return found


def compare(fabric: Fabric, size: str = "coarse") -> tuple[dict[str, Any], Any]:
    """({title: (yarn, {model: (strain, tension)})}, law): warp and weft at k = 1, then each with the other free."""
    from meshing import crossover

    built = crossover.build(fabric, size=size)
    equal, law = equal_strains(fabric, built)
    tests = {
        f"{yarn}, k = 1": (yarn, {name: (e[:, family], T[:, family]) for name, (e, T) in equal.items()})
        for family, yarn in enumerate(YARNS)
    }
    for family, yarn in enumerate(YARNS):
        tests[f"{yarn}, cross yarns free"] = yarn, cross_yarns_free(fabric, built, family)
    return tests, law


def differences(models: dict[str, Any], strength: float) -> dict[str, Any]:
    """{model: (rms [N], rms over strength, largest [N])} from the first model, at the samples of each."""
    names = list(models)
    e0, T0 = models[names[0]]
    found = {}
    for name in names[1:]:
        e, T = models[name]
        common = (e >= 0) & (e <= e0[-1])
        off = T[common] - np.interp(e[common], e0, T0)
        rms = float(np.sqrt(np.mean(off**2)))
        found[name] = rms, rms / strength, float(off[np.argmax(np.abs(off))])
    return found


def chart(pyplot: Any, fabric: Fabric, tests: Any) -> Any:
    """Draw tests, {title: (yarn, {model: (strain, tension)})}: the cells as lines, coupon and crossover as marks."""
    styles = {
        "cell, thesis's form": {"color": INK, "lw": 1.7}, "cell, variational": {"color": BLUE, "ls": "--"},
        "shell coupon": {"color": ORANGE, "marker": "o", "ls": "", "mfc": "none", "ms": 7},
        "3D crossover": {"color": GREEN, "marker": "^", "ls": "", "ms": 5},
        "cell, law of the 3D crossover": {"color": GREEN, "ls": ":", "lw": 1.7},
    }  # fmt: skip
    figure, axes = pyplot.subplots(2, 2, figsize=(10.4, 7.6))
    for axis, (title, (yarn, models)) in zip(axes.flat, tests.items()):
        for name, (strain, tension) in models.items():
            axis.plot(100 * strain, tension, label=name, **styles[name])  # type: ignore[arg-type]
        axis.set(xlabel=f"{yarn} strain [%]", xlim=(0, None), ylim=(0, None), title=f"{fabric.name}, {title}")
    for axis in axes[:, 0]:
        axis.set_ylabel("tension per yarn [N]")
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return figure


def main(
    fabrics: Sequence[str] = ("glass-balanced", "glass-unbalanced"),
    *,
    size: Literal["coarse", "medium", "fine"] = "coarse",
    out: Path = Path("results/biaxial"),
) -> None:
    for name in fabrics:
        fabric = catalogue.load(name)
        tests, law = compare(fabric, size)
        rows = [["test", "model", "strain", "tension N"]]
        for title, (_, models) in tests.items():
            for model, (strain, tension) in models.items():
                rows += [[title, model, f"{e:.6g}", f"{T:.6g}"] for e, T in zip(strain, tension)]
        write_csv(out / f"{name}-sides.csv", rows)
        save(chart, fabric, tests, to=out / f"{name}-sides.png")
        print(f"\n{name}; law of the 3D crossover: a = {1e3 * law.a:.4f} mm, b = {1e5 * law.b:.2f} mm uN^(1/3)\n")
        compared, within = [["test", *MODELS[1:]]], []
        for title, (yarn, models) in tests.items():
            found = differences(models, fabric.weave.yarns[YARNS.index(yarn)].strength)
            entries = [found.get(model) for model in MODELS[1:]]
            cells = [f"{one[0]:.1f} ({100 * one[1]:.1f} %), {one[2]:+.1f}" if one else "" for one in entries]
            compared.append([title, *cells])
            if MODELS[4] in models:
                own = differences({name: models[name] for name in (MODELS[4], MODELS[3])}, 1.0)[MODELS[3]]
                within.append(f"{title}: {own[0]:.1f} N rms, {own[2]:+.1f} N at most")
        print(markdown(compared))
        print("3D crossover from the cell with its own law: " + "; ".join(within))


if __name__ == "__main__":
    program(main, size="of the 3D mesh")
