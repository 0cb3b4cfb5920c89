"""The maps as a page of the documentation, every number and judgement in it from what was run."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from validation.marked_page import markdown
from validation.verification.stability import study
from validation.verification.stability.core import FAILED, MARGIN_TARGET, STABLE, WRONG, Found
from validation.verification.stability.pictures import number, pictured
from validation.verification.study import write_page


def write(maps: Sequence[tuple[Found, str]], path: Path, command: str) -> None:
    """Write the page; its pictures are in figures/ beside it.

    Parameters
    ----------
    maps : pairs (core.Found, when, where and by which version it was run)
    command : that makes it
    """
    overview = ["## Margins of the defaults", margins([found for found, _ in maps])]
    there = {found.map.key for found, _ in maps}
    missing = [f'"{study.load(name).title}"' for name in study.NAMES if name not in there]
    if missing:
        overview.append(f"Maps that have not been computed with the present code: {', '.join(missing)}.")
    sections = [(_section(found), made) for found, made in maps]
    write_page(path, study.PAGE, command, "map by map", overview, sections)


def margins(maps: Sequence[Found]) -> str:
    """One row an edge of a default."""
    rows = []
    for found in maps:
        chart = found.map
        for edge in found.edges:
            named = chart.x.name if edge.y == chart.default[1] else f"{chart.x.name}; {chart.y.label(edge.y)}"
            rows.append([
                f"{chart.title}: {named}", f"{chart.default[0] / chart.x.unit:g}", edge.side, _edge(edge, chart.x.unit),
                f"{'' if edge.met else 'at least '}{edge.margin:.3g}", "yes" if edge.enough else "**no**",
                "" if edge.beyond is None else _beyond(edge.beyond),
            ])  # fmt: skip
    head = ["number", "default", "side", "edge", "margin", f"at least {MARGIN_TARGET:g}", "beyond it"]
    return markdown([head, *rows], numbers=True)


def _edge(edge, unit):
    return f"{edge.value / unit:.3g}" if edge.met else "none met"


def _beyond(outcome):
    if outcome.kind == FAILED:
        return f"stopped: {outcome.message.split(', at node')[0].split(':')[0]}"
    return "wrong" + (f": {outcome.message}" if outcome.message else "")


def _section(found):
    chart = found.map
    lines = []
    if chart.wrong:
        lines.append(f"- Wrong: {chart.wrong}; {found.count(WRONG)} of {len(found.outcomes)} points.")
    if chart.guard:
        lines.append(f"- Guard: {chart.guard}. Failed: {found.count(FAILED)} of {len(found.outcomes)} points.")
    messages = list(dict.fromkeys(_short(o.message) for o in found.outcomes.values() if o.kind == FAILED and o.message))
    if messages:
        lines.append("- Messages, for instance: " + "; ".join(f'"{text}"' for text in messages[:2]) + ".")
    return [f"## {chart.title}", chart.text, _content(found), "\n".join(lines)]


def _content(found):
    """The picture with its caption, the table of a map of one or two rows, or a sentence where all is well."""
    chart = found.map
    if pictured(found):
        caption = f"*{chart.title}: {chart.y.name} against {chart.x.name}.*"
        return f"![{chart.title}](figures/stability-{chart.key}.png)\n\n{caption}"
    if found.count(STABLE) == len(found.outcomes):
        return f"All {len(found.outcomes)} points are stable."
    head = [f"{chart.y.name} / {chart.x.name}", *(chart.x.label(x) for x in chart.x.values)]
    rows = [[chart.y.label(y), *(_cell(found, x, y) for x in chart.x.values)] for y in chart.y.values]
    return f"{markdown([head, *rows], numbers=True)}\nNumbers: {chart.number}."


def _cell(found, x, y):
    outcome = found.outcomes[x, y]
    value = "" if outcome.value is None else number(outcome.value)
    word = "" if outcome.kind == STABLE else outcome.kind
    return f"**{', '.join(each for each in (value, word) if each)}**" if word else value


def _short(text):
    return text if len(text) < 200 else text[:197] + "..."
