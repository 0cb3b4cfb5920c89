"""What the studies of this folder share: their cases in a folder, and the page that tells of them.

A study runs many cases and keeps each as soon as it is done (`fabrics.run_cache`), so that an interrupted study
continues where it was. Charts (`cost_accuracy`) and maps (`stability`) are written to a page with one section each.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

from fabrics.errors import InputError
from fabrics.files import write_whole
from validation.commits import computed


def known(option: str, name: str, names: Sequence[str]) -> None:
    """Raise InputError unless a study has this name; `option` of the command line, such as "--map"."""
    if name not in names:
        raise InputError(key=option, value=name, allowed=f"one of {', '.join(names)}")


def write_page(
    path: Path,
    title: str,
    question: str,
    text: str,
    command: str,
    one_by_one: str,
    overview: Iterable[str],
    sections: Iterable[tuple[Sequence[str], str]],
) -> None:
    """Write a page of a study whole; its pictures are in figures/ beside it.

    Parameters
    ----------
    title, question, text : of the page, what it answers, and its introduction
    command, one_by_one : that makes the page, and how else, as "map by map"
    overview : (heading, table) of all of them
    sections : pairs (paragraphs of one, when, where and by which version it was run)
    """
    sections = list(sections)
    run = computed(command, *(made for _, made in sections))
    stated = f"{run[:-1]}, or {one_by_one}. Not to be edited by hand."
    parts = [f"# {title}", f"*{question}*", stated, text, *overview]
    for paragraphs, made in sections:
        parts += [*paragraphs, f"Run: {made}"]
    with write_whole(path) as file:
        file.write("\n\n".join(part.rstrip("\n") for part in parts) + "\n")
