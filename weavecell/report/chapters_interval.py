"""The chapter of an answer over what nobody knows."""

from __future__ import annotations

from pandas import DataFrame

from weavecell.report import pictures, pictures_uncertainty
from weavecell.report.page import Section, Table
from weavecell.results import display, finding, keys, one_table
from weavecell.results.finding import Finding
from weavecell.studies.interval import Interval
from weavecell.studies.sweep import QUANTITIES


def describe(found: Interval) -> Section:
    """Show the value of each run, in a picture and a table, and what moves it."""
    caption = f"{_begin(found.words())}. A ring is a stop; the band covers all runs."
    label = pictures_uncertainty.label_quantity(QUANTITIES[found.quantity])
    draw = pictures_uncertainty.draw_interval
    picture = pictures.draw_figure("interval", caption, draw, found, label)
    table = Table.from_frame(label_columns(found))
    points = tuple(found.lines())
    return Section("interval", "Over what nobody knows", "", (picture,), (table,), points=points)


def label_columns(found: Interval) -> DataFrame:
    """Return the table of the runs, columns with what they are and their units."""
    table = found.to_dataframe()
    columns = {}
    for name in map(str, table):
        key = one_table.find_column(name, "interval") or keys.infer_key(name)
        columns[key.meaning] = (key.unit, table[name])
    return display.frame(columns)


def find(title: str, found: Interval, doubts: tuple[str, ...]) -> Finding:
    """Return what a shot came to over what nobody knows, with what is doubtful of it."""
    colour = found.outcome
    if colour not in ("stopped", "perforated", "unstable"):
        colour = finding.PLAIN
    return Finding(title, found.words(), doubts, colour)


def write_sentence(found: Interval, shown: str) -> str:
    """Write the answer, then what the run came to that is shown, in a sentence."""
    shown = f"{shown[0].lower()}{shown[1:]}"
    return f"{_begin(found.words())}. Shown, {found.runs[0].name}: {shown}"


def _begin(text):
    return f"{text[0].upper()}{text[1:]}"
