"""Tables of the results of impacts, and of what they cost."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from weavecell.report.page import Table

if TYPE_CHECKING:
    from shellfabric.impact.simulation import ImpactSetup
    from weavecell.results.impact import ImpactRecord


def percent(share: float) -> str:
    """A share as text, to two digits below 100 %."""
    return f"{100 * share:.2g} %" if share < 0.995 else f"{100 * share:.0f} %"


def residual(record: ImpactRecord) -> str:
    """Velocity at the end, as text."""
    name = "velocity at the end" if record.outcome in ("in flight", "unstable") else "residual velocity"
    return f"{name} {record.residual_velocity:.1f} m/s".replace(" 0.0 m/s", " 0 m/s")


def results(records: Sequence[ImpactRecord]) -> Table:
    """Results, one column a run."""
    rows = [
        ("outcome", lambda record: record.outcome),
        ("strike velocity [m/s]", lambda record: f"{record.strike_velocity:g}"),
        ("velocity at the end [m/s]", lambda record: residual(record).split()[-2]),
        ("time of stop, perforation or end [µs]", lambda record: f"{1e6 * record.time[-1]:.0f}"),
        ("strike energy [J]", lambda record: f"{record.strike_energy:.2f}"),
        ("absorbed energy [J]", lambda record: f"{record.absorbed_energy:.2f}"),
        ("largest back-face deflection [mm]", lambda record: f"{1e3 * record.max_deflection:.2f}"),
        ("largest contact force [kN]", lambda record: f"{1e-3 * record.contact_force.max():.3g}"),
        *(row for family in ("warp", "weft") for row in _peak_rows(family)),
        ("failed yarn segments", lambda record: f"{int(record.failed_segments[-1])}"),
        *(row for row in _FAILURE if any(record.failure for record in records)),
        ("energy error, of the strike energy [%]", lambda record: f"{100 * record.energy_error_max:.3f}"),
        (
            "artificial viscosity, of the absorbed energy [%]",
            lambda record: f"{100 * record.viscous_energy_fraction:.2f}",
        ),
    ]
    columns = ("result", *(("value",) if len(records) == 1 else (record.title for record in records)))
    found = tuple((name, *(value(record) for record in records)) for name, value in rows)
    return Table(columns, found, "Results", numeric=columns[1:])


def _of_failure(key, factor, digits):
    """What the record of a failure holds, as text; a dash where there is none."""

    def text(record):
        value = record.failure.get(key)
        return "–" if value is None else f"{factor * value:.{digits}f}"

    return text


_FAILURE = (
    ("tension at failure over the strength of the yarn, mean", _of_failure("tension_at_failure_over_strength", 1, 3)),
)


def _peak_rows(family):
    """Rows on the highest tension of a family."""
    several = lambda record: f", ply {record.peaks[family].ply}" if record.count > 1 else ""  # noqa: E731
    return (
        (
            f"peak tension of the {family} [N] (share of the strength)",
            lambda record: f"{record.peaks[family].tension:.1f} ({percent(record.peaks[family].share)})",
        ),
        (
            "its time [µs], place along warp and weft from the impact point [mm]",
            lambda record: (
                f"{1e6 * record.peaks[family].time:.1f}, "
                + " and ".join(f"{abs(1e3 * x):.1f}" for x in record.peaks[family].place)
                + several(record)
            ),
        ),
    )


def ply_table(record: ImpactRecord) -> Table:
    """One row a ply of a pack."""
    columns = ("ply", "failed yarn segments", "peak tension / strength, warp", "weft", "energy at the end [J]")
    peaks = record.peak_tension / record.strength
    rows = tuple(
        (str(p + 1), f"{record.plies['failed_yarns'][-1, p]:g}", f"{peaks[p, 0]:.2f}", f"{peaks[p, 1]:.2f}",
         f"{record.plies['energy'][-1, p]:.2f}")
        for p in range(record.count)
    )  # fmt: skip
    deepest = 100 * record.max_penetration_ratio.max()
    caption = f"Plies, from the front. A ply was pressed into the next by at most {deepest:.0f} % of its thickness."
    held, missed = record.torn_contact
    if held or missed:
        caption += f" Torn fabric was kept from passing through other plies {held:g} times, {missed:g} times in vain."
    return Table(columns, rows, caption=caption, numeric=columns[1:])


def cost(records: Sequence[ImpactRecord], setup: ImpactSetup | None = None) -> tuple[Table, ...]:
    """Tables for those who develop the code: cost of the time integration, and settings of the model."""
    columns = (
        "run",
        "elements",
        "steps",
        "time integration [s]",
        "ns per element and step",
        "formulation residual [%]",
    )
    rows = tuple(
        (record.title, f"{record.elements}", f"{record.steps}", f"{record.wall_time:.2f}",
         f"{record.ns_per_element_step:.1f}", f"{100 * _unstored(record) / record.strike_energy:.2f}")
        for record in records
    )  # fmt: skip
    caption = "Cost. Formulation residual: work of the cell's forces that the yarns do not store, of the strike energy."
    found = [Table(columns, rows, caption, numeric=columns[1:])]
    if setup is not None:
        settings = (
            ("cell model", setup.cell_model),
            ("cell formulation", setup.form),
            ("stretches along each side of the cell table", f"{setup.table_size}"),
            ("time between energy audits [µs]", f"{1e6 * setup.audit_interval:g}"),
            *((name.replace("_", " "), f"{value}") for name, value in vars(setup.numerics).items()),
        )
        found.append(Table(("setting", "value"), settings, "Settings of the solver"))
    return tuple(found)


def _unstored(record):
    """[J] at the end."""
    return float(np.atleast_1d(record.energies.get("formulation_residual", 0.0))[-1])
