"""Maps of where each method fails, found by running it, and the margins of the defaults.

    python -m validation stability time-step

All maps if none is named.

The folder
    stability-NAME.png      the map
    NAME.csv, NAME-edges.csv   one row a point; one row an edge of a default
    stability.json          edges and margins, provenance
    points/NAME/            a file for each point as soon as it is done: `--resume` begins with them
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

from validation.commands import studies
from weavecell.cli.from_signature import CORES


def main(
    maps: Sequence[str] = (), *, quick: bool = False, jobs: int = CORES, executor: str = "local", resume: bool = False,
    out: Path | None = None, page: Path | None = None,
) -> None:  # fmt: skip
    """Run maps, write their tables and pictures to the folder `out`, and print the margins of the defaults."""
    studies.run(KIND, maps, out, page=page, quick=quick, jobs=jobs, executor=executor, resume=resume)


def _tell(found):
    counts = ", ".join(f"{found.count(kind)} {kind}" for kind in ("stable", "wrong", "failed"))
    print(f"{found.map.title}: {counts}")
    for edge in found.edges:
        where = f"{found.map.x.name} {found.map.default[0] / found.map.x.unit:g}"
        where += "" if edge.y == found.map.default[1] else f", {found.map.y.label(edge.y)}"
        reach = f"edge at {edge.value / found.map.x.unit:.3g}" if edge.met else "no edge met"
        missed = "" if edge.enough else "  BELOW THE TARGET"
        print(f"  {where}: {reach} {edge.side}, margin {edge.margin:.2f}{missed}")


def _plain(found):
    edges = [
        {key: value for key, value in asdict(edge).items() if key != "beyond"} | {"enough": edge.enough}
        for edge in found.edges
    ]
    counts = {kind: found.count(kind) for kind in ("stable", "wrong", "failed")}
    return {"map": found.key, "default": found.map.default, "edges": edges, "points": counts}


def _modules():
    from validation.verification.stability import page, pictures, study, tables

    return study, tables, pictures, page


KIND = studies.Kind(
    _modules, "stability", "maps", "Stability", "points", "stability", "stability", "maps", _tell, _plain
)
