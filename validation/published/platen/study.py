"""S-720 between platens with the constants of thesis Table 3-2: what each modelling choice changes, one at a time.

The platen law of the fabric (eqs. 2-5 to 2-9, erratum E-03) is the target. Its offset is free: the thesis states that
the beginning of its test records is lost (chapter 7), so that the closure is known up to a constant. Each factor is
varied alone from the published state. Two closures say where a variant differs from the law: from the first pressure to
`PACKING` (loose yarn) and from there to the peak pressure (packed yarn).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import Executor
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from fabrics import catalogue
from fabrics.checks import FloatArray
from fabrics.executors import open_executor
from fabrics.fabric import Fabric
from fabrics.plate_curve import PlateCurve
from meshing import crossover as mesher
from unitcell3d.cases.biaxial_and_platens import plate_compression
from unitcell3d.identify.platen_misfit import closures, platen_misfit
from unitcell3d.model.crossover import Numerics
from unitcell3d.solver.history import History
from unitcell3d.solver.load_stepping import Steps

FABRIC = "S-720"
SIZE = (6, 4, 2)
STEPS = Steps(first=0.004, largest=0.02)  # of the path: 7 µm at the platens, so that rows resolve the lowest pressures
MIN_PLATE_GAP = 0.2  # of the platens' first distance: the softest variant reaches the peak pressure before
PACKING = 1e6  # Pa: the law closes four fifths below it
POINTS = 24
RANGES = (0.0, 1e5, 3e5, 1e6, 3e6)  # Pa: lower ends of the range of pressures that is compared
Change = Callable[[Fabric], Fabric]


@dataclass(frozen=True)
class Variant:
    """One factor: its group and text, the change of the fabric, options of the mesher, numerics."""

    group: str
    name: str
    change: Change | None = None
    mesh: dict[str, Any] = field(default_factory=dict)
    numerics: Numerics | None = None


@dataclass(frozen=True, eq=False)
class Outcome:
    """A variant between platens.

    Parameters
    ----------
    variant : Variant
    pressure, closure : (n,) [Pa], [m] computed, at equal ratios of pressure, moved to the law's mean
    closure_rms : [m] misfit of the closure, offset free
    pressure_rms : [-] relative misfit of the platen pressure, offset free
    loose, packed : [m] closures below and above `PACKING`
    Vf0 : (warp, weft) [-] of the mesh
    failed : reason for which the path ended early, or ""
    """

    variant: Variant
    pressure: FloatArray
    closure: FloatArray
    closure_rms: float
    pressure_rms: float
    loose: float
    packed: float
    Vf0: tuple[float, float]
    failed: str


def solids(**changes: Any) -> Change:
    """The change of a fabric that gives both yarns other solid constants; `Vf0` is a pair (warp, weft)."""
    fractions = changes.pop("Vf0", None)

    def change(fabric: Fabric) -> Fabric:
        assert fabric.solid_laws is not None
        laws = tuple(
            replace(law, **changes, **({} if fractions is None else {"Vf0": fractions[yarn]}))
            for yarn, law in enumerate(fabric.solid_laws)
        )
        return replace(fabric, solid_laws=laws)  # type: ignore[arg-type]

    return change


PUBLISHED = Variant("published", "Table 3-2, sine section, crimp by hand")
VARIANTS = (
    PUBLISHED,
    Variant("section", "ellipse", mesh={"section": "ellipse"}),
    Variant("section", "conforming", mesh={"section": "conforming"}),
    Variant("section", "width 1.23 mm (Table A-1)", mesh={"width": (1.23e-3, 1.23e-3)}),
    Variant("section", "width 1.0 mm", mesh={"width": (1.0e-3, 1.0e-3)}),
    Variant("crimp", "crimp of micrographs (Table A-2)", mesh={"crimp": "micrograph"}),
    Variant("Vf0", "Vf0 of micrographs (E-27)", solids(Vf0=(0.361, 0.396))),
    Variant("Vf0", "Vf0 and crimp of micrographs", solids(Vf0=(0.361, 0.396)), {"crimp": "micrograph"}),
    Variant("contact", "penalty / 10", numerics=Numerics(penalty=1e14)),
    Variant("contact", "toe 5 µm (0.5 µm)", numerics=Numerics(toe=5e-6)),
    Variant("contact", "friction 0.3, yarns and platens", numerics=Numerics(friction=0.3)),
    Variant("mesh", "8 x 6 x 2", mesh={"size": (8, 6, 2)}),
    Variant("constants", "shear modulus x 10 (K_G 0.01)", solids(K_G=0.01)),
    Variant("constants", "K_r / 4", solids(K_r=0.005)),
    Variant("constants", "K_r / 16", solids(K_r=0.00125)),
    Variant("constants", "E_c / 2", solids(E_c=1e9)),
    Variant("constants", "E_c x 2", solids(E_c=4e9)),
    Variant("constants", "V_c 0.90", solids(V_c=0.90)),
    Variant("constants", "V_c 1.20", solids(V_c=1.20)),
)


def curve(fabric: Fabric) -> PlateCurve:
    """The platen law of one ply at the measured areal density."""
    assert fabric.areal_density_measured is not None
    return PlateCurve.pressure_law(fabric.areal_density_measured)


def press(variant: Variant) -> tuple[History, tuple[float, float]]:
    """History between platens, and the fibre volume fractions of the mesh."""
    fabric = catalogue.load(FABRIC)
    if variant.change is not None:
        fabric = variant.change(fabric)
    mesh = mesher.build(fabric, **{"size": SIZE} | variant.mesh)
    history = plate_compression(
        mesh, fabric, min_plate_gap=MIN_PLATE_GAP, numerics=variant.numerics, steps=STEPS
    )  # fmt: skip
    return history, (float(mesh.Vf0[0]), float(mesh.Vf0[1]))


def outcome(variant: Variant) -> Outcome:
    """Press a variant and compare it with the law."""
    fabric = catalogue.load(FABRIC)
    target, area = curve(fabric), fabric.weave.cell_area
    history, Vf0 = press(variant)
    pressure = np.geomspace(target.pressure[0], target.pressure[-1], POINTS)
    closure = closures(history, area, pressure, target.at(pressure))
    misfit = platen_misfit(history, area, target, pressure)
    at = float(np.interp(np.log(PACKING), np.log(pressure), closure))
    return Outcome(
        variant, pressure, closure, misfit.closure, misfit.pressure, at - closure[0], closure[-1] - at, Vf0,
        history.failed,
    )  # fmt: skip


def outcomes(variants: tuple[Variant, ...] = VARIANTS, executor: str | Executor = "local", jobs: int = 1) -> Iterator:
    """The outcome of each variant, in order."""
    with open_executor(executor, jobs) as pool:
        yield from pool.map(outcome, variants)


def ranges() -> list[tuple[float, float, float]]:
    """(lower end [Pa], closure rms [m], relative pressure rms [-]) of the published constants over each range."""
    fabric = catalogue.load(FABRIC)
    target = curve(fabric)
    history, _ = press(PUBLISHED)
    found = []
    for lowest in RANGES:
        pressure = np.geomspace(max(lowest, target.pressure[0]), target.pressure[-1], POINTS)
        misfit = platen_misfit(history, fabric.weave.cell_area, target, pressure)
        found.append((float(pressure[0]), misfit.closure, misfit.pressure))
    return found
