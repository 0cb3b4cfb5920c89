"""The chapter of a report on the mesh of an impact, and on the error that is to be expected of it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from weavecell.analysis.fidelity import error_database, ladder, quantities
from weavecell.report.page import Section, Table

if TYPE_CHECKING:
    from shellfabric.impact.simulation import ImpactSetup
    from weavecell.results.impact import ImpactRecord


def section(record: ImpactRecord, setup: ImpactSetup) -> Section:
    """Mesh, and what meshes like it were found to be off by.

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
    lead, errors = expected(record, setup)
    tables = [Table(("mesh", "value"), tuple(rows), numeric=("value",))]
    if errors:
        columns = ("result", "expected error of this mesh", "of the finest mesh itself")
        tables.append(Table(columns, errors, "Expected error", numeric=columns[1:]))
    return Section("panel-mesh", "Mesh and its expected error", lead, tables=tuple(tables))


def expected(record: ImpactRecord, setup: ImpactSetup) -> tuple[str, tuple[tuple[str, str, str], ...]]:
    """(text, rows of result, expected error, error of the finest mesh), from the survey of docs/reports/fidelity.md."""
    further = (
        "The option --uncertainty of weavecell impact computes the uncertainty of this very shot from a second mesh."
    )
    if record.count > 1:
        return f"No survey of mesh errors holds for packs with the present contact of plies. {further}", ()
    known, finest = error_database.load(packs=False), ladder.FULL
    n = setup.resolved_elements_per_crossover
    name = f"{n} element{'s' if n > 1 else ''}"
    name = finest if finest.startswith(f"{name},") else name
    regime = quantities.regime({"outcome": record.outcome})
    errors = known.of_mesh(name, regime) if _surveyed(setup) and record.outcome != "unstable" else {}
    if not errors:
        return f"The survey of mesh errors (docs/reports/fidelity.md) has no mesh or cell like this one. {further}", ()
    kind = "perforated" if regime == quantities.THROUGH else "stopped"
    lead = (
        f"From a survey of {min(scenes for scenes, *_ in errors.values())} {kind} shots on "
        f"one ply of other fabrics, projectiles and velocities ({known.made['date']}, "
        "docs/reports/fidelity.md): four of five differed by less than this from the finest mesh, "
        f"{finest.split(',')[0]} per crossover along each side. "
        "Near the critical velocity the outcome itself depends on the mesh. "
    )
    haste = quantities.haste(record.strike_velocity, setup.fabric.weave.yarns)
    if quantities.hasty({"haste": haste}) and setup.resolved_elements_per_crossover == 1:
        lead += (
            "This strike velocity breaks yarns almost at once: with one element per crossover the absorbed energy of "
            "such shots was off by 10 to 90 %. "
        )
    rows = tuple(
        (quantities.WORDS[quantity], f"{100 * error:.2g} %", f"{100 * own:.2g} %")
        for quantity, (_, error, own) in errors.items()
    )
    return lead + further, rows


def _surveyed(setup):
    """Whether the cell is that of the survey, and the mesh uniform."""
    plain = setup.grading is None and setup.surface is None and setup.crossovers is None
    return plain and setup.cell_model == "compressible" and setup.form == "variational"
