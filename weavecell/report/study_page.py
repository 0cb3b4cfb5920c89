"""Files of a study of many runs: its table, record, picture and page."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fabrics import files
from weavecell.report import pictures
from weavecell.results import json_file, provenance

if TYPE_CHECKING:
    from pandas import DataFrame

    from shellfabric.impact.simulation import ImpactSetup


def write(
    out: Path, name: str, title: str, table: DataFrame, remarks: Sequence[str], content: Mapping[str, Any],
    draw: Callable[..., Any], setup: ImpactSetup, wall_time: float,
) -> None:  # fmt: skip
    """Write NAME.csv, .json, .png and .html to a folder.

    Parameters
    ----------
    table : its columns are headings with their units
    remarks : sentences above the table
    content : of the record, to which provenance and wall time [s] are added
    draw : called with pyplot, returns the figure
    setup : that was varied
    """
    import jinja2

    stamp = provenance.stamp("", setup=setup)
    files.write(out / f"{name}.csv", table.to_csv(index=False, float_format="%.6g"))
    json_file.write(out / f"{name}.json", {**content, "wall_time": wall_time, "provenance": stamp})
    files.write(out / f"{name}.png", pictures.render(draw, kind="png"))
    made = f"Version {stamp['weavecell']}, commit {stamp['commit']}, {stamp['date']}, {stamp['processor']}."
    text = (resources.files("weavecell.report") / "templates" / "scatter.html.j2").read_text("utf-8")
    template = jinja2.Environment(autoescape=True, undefined=jinja2.StrictUndefined).from_string(text)
    shown = table.to_html(index=False, border=0, float_format="%.4g", na_rep="-")
    files.write(
        out / f"{name}.html",
        template.render(name=name, title=title, table=shown, remarks=remarks, footer=f"{made} {stamp['packages']}."),
    )
