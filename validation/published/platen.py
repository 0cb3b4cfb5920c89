"""python -m validation.published.platen [--out results/platen] [--page docs/reports/platens.md] [--jobs N]

S-720 between platens with the published solid constants: what each modelling choice changes, one at a time (thesis
section 3.4.3.2). Writes platen.csv and platen.png. With --page the tables go into that page, the picture beside it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from fabrics import catalogue
from fabrics.checks import FloatArray
from fabrics.executors import open_executor
from fabrics.fabric import Fabric
from fabrics.plate_curve import PlateCurve
from meshing import crossover as mesher
from meshing.pictures_style import BLUE, FAINT, GREEN, INK, ORANGE, RED
from unitcell3d.cases.biaxial_and_platens import plate_compression
from unitcell3d.identify.platen_misfit import closures, platen_misfit
from unitcell3d.model.crossover import Numerics
from unitcell3d.solver.history import History
from unitcell3d.solver.load_stepping import Steps
from validation.marked_page import markdown
from validation.program import program, publish, save, write_csv

MARKS = "<!-- tables of validation.published.platen -->", "<!-- end of the tables -->"
HEAD = (
    "factor", "variant", "Vf0 of the mesh", "misfit of closure, µm", "misfit of pressure, %",
    "closure below 1 MPa, µm", "closure above 1 MPa, µm",
)  # fmt: skip


def law_closures(pressure: FloatArray, law: FloatArray) -> tuple[float, float]:
    """[m] closures of the law below and above `PACKING`."""
    loose = float(np.interp(np.log(PACKING), np.log(pressure), law))
    return loose, float(law[-1]) - loose


def factor_rows(outcomes: Sequence[Outcome], law: FloatArray) -> list[Any]:
    """A header, the law, and a row a variant."""
    loose, packed = law_closures(outcomes[0].pressure, law)
    rows = [HEAD, ("", "**platen law**", "", "", "", f"{1e6 * loose:.1f}", f"{1e6 * packed:.1f}")]
    for each in outcomes:
        failed = f" (ended early: {each.failed})" if each.failed else ""
        rows.append((
            each.variant.group, each.variant.name + failed, " / ".join(f"{value:.3f}" for value in each.Vf0),
            f"{1e6 * each.closure_rms:.1f}", f"{100 * each.pressure_rms:.0f}", f"{1e6 * each.loose:.1f}",
            f"{1e6 * each.packed:.1f}",
        ))  # fmt: skip
    return rows


FABRIC = "S-720"
SIZE = (6, 4, 2)
STEPS = Steps(first=0.004, largest=0.02)  # of the path: 7 µm at the platens, so that rows resolve the lowest pressures
MIN_PLATE_GAP = 0.2  # of the platens' first distance: the softest variant reaches the peak pressure before
PACKING = 1e6  # Pa: the law closes four fifths below it
POINTS = 24
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


COLOURS = {"section": BLUE, "crimp": BLUE, "Vf0": BLUE, "contact": GREEN, "mesh": GREEN, "constants": RED}
LABELS = {BLUE: "geometry", GREEN: "contact and mesh", RED: "solid constants"}


def draw(plt: Any, outcomes: Sequence[Outcome], loose: float, packed: float) -> Any:
    """Misfit of the pressure, and closures below and above 1 MPa, a row for each variant.

    Parameters
    ----------
    outcomes : the published constants first; `closure_rms`, `pressure_rms`, `loose` and `packed` are drawn
    loose, packed : [m] closures of the platen law below and above 1 MPa
    """
    figure, (left, right) = plt.subplots(1, 2, figsize=(11.4, 7.2), sharey=True)
    for row, each in enumerate(outcomes):
        colour = COLOURS.get(each.variant.group, INK)
        left.plot(100 * each.pressure_rms, row, "o", ms=8, color=colour)
        for value, filled in ((each.loose, True), (each.packed, False)):
            right.plot(1e6 * value, row, "o", ms=8, color=colour, mfc=colour if filled else "white", mew=1.8)
    left.axvline(100 * outcomes[0].pressure_rms, color=FAINT, lw=1.2, ls="--")
    left.axvline(15, color=ORANGE, lw=2)
    right.axvline(1e6 * loose, color=ORANGE, lw=2)
    right.axvline(1e6 * packed, color=ORANGE, lw=2, ls="--")
    names = [each.variant.name for each in outcomes]
    left.set_yticks(range(len(names)), ["published constants (Table 3-2)", *names[1:]])
    left.invert_yaxis()
    left.set(title="misfit of the pressure", xlabel="rms of the relative misfit [%]", xlim=(0, 80))
    right.set(title="closure", xlabel="closure [µm]", xlim=(0, None))
    line = plt.Line2D
    marks = [line([], [], marker="o", ls="", color=colour, label=text) for colour, text in LABELS.items()]
    marks += [
        line([], [], color=ORANGE, label="left: target 15 %; right: platen law, below 1 MPa"),
        line([], [], color=ORANGE, ls="--", label="platen law, above 1 MPa"),
        line([], [], marker="o", ls="", color=INK, label="right, filled: closure below 1 MPa"),
        line([], [], marker="o", ls="", color=INK, mfc="white", mew=1.8, label="open: above 1 MPa"),
    ]
    figure.legend(handles=marks, loc="outside lower center", ncols=3, fontsize=10)
    return figure


def main(*, out: Path = Path("results/platen"), page: Path | None = None, jobs: int = 1) -> None:
    with open_executor("local", jobs) as pool:
        found = list(pool.map(outcome, VARIANTS))
    law = curve(catalogue.load(FABRIC)).at(found[0].pressure)
    rows = factor_rows(found, law)
    write_csv(out / "platen.csv", rows)
    picture = page.parent / "figures" / "platen-factors.png" if page else out / "platen.png"
    save(draw, found, *law_closures(found[0].pressure, law), to=picture, dpi=90)
    publish(markdown(rows), page, MARKS)


if __name__ == "__main__":
    program(main)
