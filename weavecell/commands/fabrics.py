"""The catalogue on the terminal: all fabrics in one table, or one with everything known about it."""

from __future__ import annotations

import csv
import shutil
from collections.abc import Iterable, Sequence
from pathlib import Path

from fabrics import assumed, catalogue
from fabrics.data_sheet import FAMILIES, FROM_THICKNESS, entries
from fabrics.errors import InputError
from fabrics.files import replace_whole, write_whole
from shellfabric.plies.gap import ply_gap
from weavecell.report.derived import derived

# heading, unit, and what stands in the column
_COLUMNS = (
    ("fabric", "", lambda f: f.name),
    ("count", "1/cm", lambda f: f"{f.weave.warp_count / 100:.1f}/{f.weave.weft_count / 100:.1f}"),
    ("crimp", "%", lambda f: "/".join(f"{100 * yarn.crimp:.2f}" for yarn in f.weave.yarns)),
    ("mass", "g/m²", lambda f: f"{1000 * f.weave.areal_density:.1f}"),
    ("thick", "mm", lambda f: f"{1000 * f.weave.thickness:.3f}"),
    ("strength", "N/yarn", lambda f: "/".join(f"{yarn.strength:.0f}" for yarn in f.weave.yarns)),
    ("a", "mm", lambda f: f"{1000 * f.laws[0].a:.4f}" if f.laws else "-"),
    ("b", "mm N^⅓", lambda f: f"{1000 * f.laws[0].b:.3f}" if f.laws else "-"),
)


def show_all(out: Path | None = None) -> None:
    """Print the catalogue, one line a fabric; with `out`, also write it as CSV."""
    rows = [[column(fabric) for _, _, column in _COLUMNS] for fabric in map(catalogue.load, catalogue.list_names())]
    if out is not None:
        with write_whole(out) as file:
            csv.writer(file).writerows([[f"{name} [{unit}]" if unit else name for name, unit, _ in _COLUMNS], *rows])
    heads = [f"{name}\n[dim]{unit}[/]" for name, unit, _ in _COLUMNS]
    print_table("Fabrics of the catalogue (warp / weft)", heads, rows)


def show(name: str, out: Path | None = None) -> None:
    """Print one fabric: what follows from its data, what is assumed, then each number with its source.

    Assumed are crimp, trellis law, solid laws, ply gap and section of the yarns where its file does not give them.
    """
    given = catalogue.load(name)
    fabric = _completed(given)
    if out is not None:
        _copy(name, Path(out))
    print_table(f"{fabric.name}: what follows", ["quantity", "value"], derived(fabric))
    for note in fabric.notes:
        print(note)
    rows = _assumptions(given, fabric)
    if rows:
        print_table(f"{fabric.name}: what is assumed", ["key", "value (range)", "source"], rows, numeric=False)
    rows = [(key, entry["value"], entry["status"], entry["source"]) for key, entry in given.sources.items()]
    print_table(
        f"{fabric.name}: where each number comes from", ["key", "value", "status", "source"], rows, numeric=False
    )


def _completed(fabric):
    """The fabric with the laws that are assumed for it, as far as its yarns belong to a family."""
    for complete in (assumed.with_shear, assumed.with_solid_laws):
        try:
            fabric = complete(fabric)
        except InputError as problem:
            print(f"note: {problem}")
    return fabric


def _assumptions(given, fabric):
    """(key, value with its range, source) of what the file does not give and a command takes in its place."""
    rows = []
    if "crimp" in fabric.assumed:
        share, factor = (entries()[name] for name in ("warp_share", "thickness"))
        ends = assumed.crimp_ends(fabric).values()
        for k, family in enumerate(FAMILIES):
            found = [each.weave.yarns[k].crimp for each in (fabric, *ends)]
            span = f"{100 * found[0]:.2f} % ({100 * min(found):.2f} .. {100 * max(found):.2f} %)"
            if given.sources[f"{family}.crimp"]["source"] == FROM_THICKNESS:
                rows.append((f"{family}.crimp", span, FROM_THICKNESS))
        rows.append(("thickness, factor", factor.written, factor.source))
        rows.append(("warp share of the heights", share.written, share.source))
    rows += [
        (key, entry["value"], entry["source"]) for key, entry in fabric.sources.items() if key not in given.sources
    ]
    gap = ply_gap(given)
    if gap.high > gap.low:
        rows.append((
            "interlayer_gap", f"{1e3 * gap.value:.3g} mm ({1e3 * gap.low:.3g} .. {1e3 * gap.high:.3g} mm)",
            f"{gap.source}; {entries()['ply_gap'].source}",
        ))  # fmt: skip
    if given.section is None:
        rows.append(("section", "sine, ellipse or conforming", "the first of these that fits (3D crossover)"))
    return rows


def _copy(name, folder):
    """Copy the data file of a fabric of the catalogue into `folder`; never over a file that is there."""
    target = folder / f"{name}.toml"
    if target.exists():
        raise InputError("exists already", file=target)
    source = Path(catalogue.__file__).parent / f"{name}.toml"
    if not source.exists():
        raise InputError(key="FABRIC", value=name, allowed=f"one of {', '.join(catalogue.list_names())} to be copied")
    with replace_whole(target) as beside:
        shutil.copyfile(source, beside)


def print_table(title: str, heads: Sequence[str], rows: Iterable[Sequence[str]], numeric: bool = True) -> None:
    """Print a table; of a numeric one the columns but the first are aligned to the right, and nothing is folded."""
    from rich import box
    from rich.console import Console
    from rich.table import Table

    table = Table(
        title=title, title_justify="left", title_style="bold", header_style="bold",
        box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0), pad_edge=False,
    )  # fmt: skip
    for position, head in enumerate(heads):
        table.add_column(head, justify="right" if numeric and position else "left", overflow="fold", no_wrap=numeric)
    for row in rows:
        table.add_row(*row)
    Console().print(table)
