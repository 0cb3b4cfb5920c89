"""The section of a report that states what assumed laws leave open."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from weavecell.report.page import Section, Table

if TYPE_CHECKING:
    from weavecell.studies.assumed_range import AssumedRange


def summary(found: AssumedRange | None) -> dict[str, Any]:
    """Entries of summary.json."""
    return {} if found is None else {"assumed_range": found.summary()}


def section(found: AssumedRange) -> Section:
    """The range of a velocity over assumed laws, and the runs that it consists of."""
    lead = (
        f"{found.words().capitalize()}. The file of the fabric does not give it; laws are those of its fibre family, "
        "with the range that the sources of the fabric state. The run was repeated with the soft and the stiff end of "
        "each law, and with each end of a crimp computed from the thickness. The range is that of these runs and no "
        "bound."
    )
    columns = ("laws", "outcome", f"{found.quantity} [m/s]")
    rows = tuple(
        (row.laws, row.outcome or "-", "-" if row.velocity is None else f"{row.velocity:.1f}") for row in found.rows
    )
    return Section(
        "assumed", "What the assumed laws leave open", lead, (), (Table(columns, rows, numeric=columns[2:]),)
    )
