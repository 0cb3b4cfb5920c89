"""The chapter of a report on the mesh of an impact."""

from __future__ import annotations

from typing import TYPE_CHECKING

from weavecell.report.page import Section, Table

if TYPE_CHECKING:
    from shellfabric.impact.simulation import ImpactSetup
    from weavecell.results.impact import ImpactRecord


def section(record: ImpactRecord, setup: ImpactSetup) -> Section:
    """The mesh.

    Parameters
    ----------
    setup : with the mesh that was used
    """
    weave = setup.fabric.weave
    side = 1 / setup.resolved_elements_per_crossover if setup.grading is None else setup.grading[0][1]  # [crossovers]
    sides = " x ".join(f"{2e3 * w * side:.2f}" for w in weave.w)
    rows = [
        (
            "elements per crossover, along each side",
            f"{1 / side:.3g}" + ("" if setup.grading is None else " about the impact point, fewer outside"),
        ),
        ("smallest element [mm]", sides),
        ("projectile radius / longest side of it", f"{setup.projectile.radius / (2 * max(weave.w) * side):.2g}"),
        ("elements of the modelled part", f"{record.elements}"),
        ("modelled part of the panel", setup.symmetry),
        ("time steps", f"{record.steps} of {1e9 * record.time[-1] / max(1, record.steps):.3g} ns"),
    ]
    lead = (
        "The option --uncertainty of weavecell impact computes what the results change on a second mesh; a table "
        "[accuracy] in the input file finds the mesh that they need. Near the critical velocity the outcome itself "
        "depends on the mesh."
    )
    return Section("panel-mesh", "Mesh", lead, tables=(Table(("mesh", "value"), tuple(rows), numeric=("value",)),))
