"""The 3D crossover on the paths of the crossover convergence study, by what that study can vary in a minute."""

from __future__ import annotations

from typing import Any

from fabrics.errors import UnstableError
from validation.verification.cost_accuracy.core import Method, Quantity, Scene
from validation.verification.crossover_convergence import cases, study
from validation.verification.crossover_convergence.axes import METHOD, axes

VARIED = ("mesh", "elements through", "penalty", "load step", "domain", "integration")
QUANTITIES = tuple(
    Quantity(f"{force}, {path}", "N", "tensions" if force != "F_c" else "contact force")
    for force in cases.QUANTITIES
    for path in study.MEASURED
)


def run(case: Any) -> tuple[dict[str, float], dict[str, float]]:
    """({quantity: value}, {part: CPU time [s]}) of a case of the study."""
    fabric, paths = study.scene()
    found = cases.solve(fabric, {name: paths[name] for name in study.MEASURED}, case)
    if found["failed"]:
        raise UnstableError("; ".join(f"{path}: {why}" for path, why in found["failed"].items()))
    return found["values"], {"march": found["cpu"]}


def scene(quick: bool = False) -> Scene:
    """The scene; `quick` takes the coarsest meshes alone."""
    chosen = {axis.name: axis for axis in axes("quick")}
    meshes = list(chosen["mesh"].cases.items())
    base = next(case for label, case in meshes if case == cases.Case())
    methods = [Method("default", "default: 8 x 6 x 2", base)]
    for name in ("mesh",) if quick else VARIED:
        methods += [
            Method(name, label if name in ("mesh", "elements through") else f"{name} {label}", case)
            for label, case in chosen[name].cases.items()
            if case != base and chosen[name].kind == METHOD
        ]
    fabric, _ = study.scene()
    text = (
        f"A quarter crossover of {fabric.name} is pulled along two paths, {' and '.join(study.MEASURED)}, as in "
        "[crossover.md](crossover.md), which varies more and goes finer. Quantities: the tensions and the contact "
        "force at their ends. Every element is an eight-node hexahedron: there is no other order."
    )
    limits = [(chosen["mesh"].x[label], case) for label, case in meshes]
    stiff = chosen["penalty"].cases["x 3"]
    return Scene(
        "crossover-path", f"3D crossover of {fabric.name}", text, QUANTITIES, tuple(methods), run,
        lambda case: cases.Case(size=(4, 3, 1)), tuple(limits), () if quick else ((base, stiff),),
    )  # fmt: skip
