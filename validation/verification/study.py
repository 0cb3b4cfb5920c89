"""What the studies of this folder share: their cases in a folder, and the page that tells of them.

A study runs many cases and keeps each as soon as it is done (`fabrics.run_cache`), so that an interrupted study
continues where it was. Charts (`cost_accuracy`) and maps (`stability`) are written to a page with one section each.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
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
    texts: Mapping[str, str],
    command: str,
    one_by_one: str,
    overview: Iterable[str],
    sections: Iterable[tuple[Sequence[str], str]],
) -> None:
    """Write a page of a study whole; its pictures are in figures/ beside it.

    Parameters
    ----------
    texts : title of the page, question that it answers, and text that introduces it
    command, one_by_one : that makes the page, and how else, as "map by map"
    overview : (heading, table) of all of them
    sections : pairs (paragraphs of one, when, where and by which version it was run)
    """
    sections = list(sections)
    run = computed(command, *(made for _, made in sections))
    stated = f"{run[:-1]}, or {one_by_one}. Not to be edited by hand."
    parts = [f"# {texts['title']}", f"*{texts['question']}*", stated, texts["text"], *overview]
    for paragraphs, made in sections:
        parts += [*paragraphs, f"Run: {made}"]
    with write_whole(path) as file:
        file.write("\n\n".join(part.rstrip("\n") for part in parts) + "\n")
