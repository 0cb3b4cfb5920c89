"""Ranges that follow from assumed laws, beside the results with the published laws of the same fabrics.

    python -m validation.published.assumed_laws [FABRIC ...] [--out FOLDER] [--page docs/reports/assumed-laws.md]

Three Kevlar fabrics of the catalogue are treated as a fabric of which only the data sheet is known: their compression,
trellis and solid laws are taken away, the fibre family's are assumed (`fabrics.families`), and the coarse 3D crossover
yields the compression law and its range. The critical velocity and a residual velocity with every combination of the
ends of the assumed laws are compared with those of the published compression and trellis laws.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import weavecell as wc
from fabrics.compression import CompressionLaw
from fabrics.fabric import Fabric
from validation.marked_page import markdown
from validation.program import program, publish_all, write_csv
from weavecell.results import provenance
from weavecell.studies.assumed_range import AssumedRange

OUT = Path("results/assumed-laws")
FABRICS = ("S-720", "S-728", "S-731")
MESH = "coarse"
MULTIPLE = 1.3  # strike velocity of the residual velocity, over the critical velocity with the published laws
TOLERANCE = 0.5  # [m/s] between a stop and a perforation
Rows = list[list[str]]


@dataclass(frozen=True)
class Comparison:
    """Results of one fabric with published and with assumed laws.

    Parameters
    ----------
    fabric : Fabric with its published laws
    law : CompressionLaw that was computed with the assumed solid law, with its range
    critical : [m/s] critical velocity with the published laws
    critical_range : AssumedRange of the critical velocity with the assumed laws
    strike : [m/s] of the residual velocities
    residual : [m/s] residual velocity with the published laws
    residual_range : AssumedRange of the residual velocity with the assumed laws
    """

    fabric: Fabric
    law: CompressionLaw
    critical: float
    critical_range: AssumedRange
    strike: float
    residual: float
    residual_range: AssumedRange


def without_laws(fabric: Fabric) -> Fabric:
    """The fabric as its data sheet has it: no compression, trellis or solid law."""
    return replace(fabric, laws=None, shear=None, solid_laws=None)


def compare(name: str, mesh: str = MESH) -> Comparison:
    """Both sets of laws of one fabric of the catalogue.

    Parameters
    ----------
    name : of the catalogue
    mesh : of the 3D crossover, "coarse", "medium" or "fine"

    Raises
    ------
    InputError, UnstableError, UndecidedError : as `weavecell.calibrate` and `weavecell.critical_velocity`
    """
    fabric = wc.fabric(name)
    search: dict[str, Any] = {"tolerance": TOLERANCE, "residual_shots": 0, "scan": False}
    critical = wc.critical_velocity(fabric, **search).velocity
    found = wc.calibrate(without_laws(fabric), mesh=mesh)
    bare = replace(found.fabric, laws=None)
    around = wc.critical_velocity(bare, law=found.law, assumed_range=True, **search).range
    strike = MULTIPLE * critical
    shot = wc.impact(bare, strike, law=found.law, assumed_range=True)
    residual = wc.impact(fabric, strike).residual_velocity
    return Comparison(fabric, found.law, critical, around, strike, residual, shot.range)


def laws(found: list[Comparison]) -> Rows:
    """Published, nominal assumed and both ends of the compression law."""
    rows = [["fabric", "a published, mm", "a assumed (soft, stiff), mm", "b published, mm N^(1/3)",
             "b assumed (soft, stiff), mm N^(1/3)"]]  # fmt: skip
    for each in found:
        published, ends = each.fabric.laws[0], each.law.assumed_range
        cells = [each.fabric.name]
        for key in ("a", "b"):
            index = "ab".index(key)
            around = ", ".join(f"{1e3 * end[index]:.4f}" for end in ends) if ends else "no range"
            cells += [f"{1e3 * getattr(published, key):.4f}", f"{1e3 * getattr(each.law, key):.4f} ({around})"]
        rows.append(cells)
    return rows


def velocities(found: list[Comparison]) -> Rows:
    """Critical and residual velocities: published, nominal assumed, range."""
    rows = [["fabric", "quantity", "published laws, m/s", "assumed laws, m/s", "range over the assumed laws, m/s",
             "half range over the nominal value, %", "published within the range"]]  # fmt: skip
    for each in found:
        for label, published, around in (
            ("critical velocity", each.critical, each.critical_range),
            (f"residual velocity at {each.strike:.1f} m/s", each.residual, each.residual_range),
        ):
            nominal = around.rows[0].velocity
            share = f"{50 * (around.high - around.low) / nominal:.1f}" if nominal else "-"
            rows.append([
                each.fabric.name, label, f"{published:.1f}", f"{nominal:.1f}", f"{around.low:.1f} to {around.high:.1f}",
                share, "yes" if around.low <= published <= around.high else "**no**",
            ])  # fmt: skip
    return rows


def combinations(found: list[Comparison]) -> Rows:
    """The critical and the residual velocity of every combination of ends."""
    names = list(dict.fromkeys(row.laws for each in found for row in each.critical_range.rows))
    rows = [["laws", *(f"{each.fabric.name}, {what}, m/s" for each in found for what in ("critical", "residual"))]]
    for name in names:
        cells = [name]
        for each in found:
            for around in (each.critical_range, each.residual_range):
                row = {row.laws: row for row in around.rows}.get(name)
                none = row is None or row.velocity is None
                cells.append(row.outcome if row and row.velocity is None else "-" if none else f"{row.velocity:.1f}")
        rows.append(cells)
    return rows


def main(fabrics: Sequence[str] = FABRICS, *, out: Path = OUT, page: Path | None = None) -> None:
    stamp = provenance.stamp()  # before a page of the checkout is written to
    found = [compare(name) for name in fabrics]
    tables = {table.__name__: table(found) for table in (laws, velocities, combinations)}
    for name, rows in tables.items():
        write_csv(out / f"{name}.csv", rows)
    texts = {name: markdown(rows) for name, rows in tables.items()}
    publish_all(texts, page, "validation.published.assumed_laws", stamp)


if __name__ == "__main__":
    program(main)
