"""The functions and results of the Python interface as plain Markdown, from signatures and docstrings."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable
from operator import attrgetter
from typing import Any

import weavecell
from weavecell.cli.from_signature import _SECTION, unpack_keywords

_ENTRY = re.compile(r"^(\*{0,2}\w[\w, ]*) : (.*(?:\n +.*)*)", re.MULTILINE)

SECTIONS = {
    "Fabrics, projectiles, metals, backings": (
        "fabrics",
        "fabric",
        "new_fabric",
        "new_shot",
        "show",
        "projectiles",
        "metals",
        "backings",
    ),
    "Shots": (
        "impact",
        "setup",
        "sweep",
        "draw",
        "run",
        "critical_velocity",
        "v50",
        "compare",
        "plies",
        "measure_first",
        "reduce_tests",
        "reduce_shot",
    ),
    "Tests of materials": ("coupon", "biaxial", "reduce_compression", "reduce_pull_out"),
    "The 3D crossover": (
        "mesh",
        "calibrate",
        "crossover.yarn",
        "crossover.platens",
        "crossover.biaxial",
        "crossover.path",
        "crossover.shear",
        "crossover.pull_out",
        "surface",
    ),
    "Files and pictures": ("export", "view", "load", "overlay", "cite"),
}


def page() -> str:
    """Write the text of the page.

    A function that stands in no section has its place in one of its own.
    """
    named = sum(SECTIONS.values(), ())
    others = tuple(name for name in functions() if name not in named)
    sections = SECTIONS | ({"Others": others} if others else {})
    parts = [
        "# Python",
        "Made from signatures and docstrings. [Reference](../../reference.md#python) has what holds for all.",
    ]
    parts += [
        f"## {title}\n\n" + "\n\n".join(map(_function, names)) for title, names in sections.items()
    ]
    left = [
        name
        for name in weavecell.__all__
        if inspect.isclass(getattr(weavecell, name)) and name not in sum(SECTIONS.values(), ())
    ]
    kinds = {name: getattr(weavecell, name) for name in left}
    results = [
        _class(name, kind) for name, kind in kinds.items() if not issubclass(kind, Exception)
    ]
    errors = [
        f"- `{name}`: {_first(kind)}" for name, kind in kinds.items() if issubclass(kind, Exception)
    ]
    parts += ["## Results\n\n" + "\n\n".join(results)]
    parts += [
        "## Errors\n\nEach has an `exit_code`, which the command line returns.\n\n"
        + "\n".join(errors)
    ]
    return "\n\n".join(parts) + "\n"


def functions() -> dict[str, Callable[..., Any]]:
    """Return the public functions by name."""
    public = {name: getattr(weavecell, name) for name in weavecell.__all__}
    return {name: thing for name, thing in public.items() if inspect.isfunction(thing)}


def documented(function: Callable[..., Any]) -> list[str]:
    """List the parameters that the docstring of a function explains, those of the section "Other
    Parameters" left out."""
    section = inspect.getdoc(function).partition("\nParameters\n-")[2]
    entries = _ENTRY.findall(_SECTION.split(section)[0])
    return [name for names, _ in entries for name in names.split(", ")]


def passing_on() -> list[str]:
    """List the functions whose docstring has a section of keywords that they pass on."""
    return [
        name
        for name, function in functions().items()
        if "\nOther Parameters\n" in inspect.getdoc(function)
    ]


def _function(name):
    """Heading with the signature, what it does, and an entry for each argument."""
    function = attrgetter(name)(weavecell)
    signature, last = [], inspect.Parameter.POSITIONAL_OR_KEYWORD
    for one in inspect.signature(function).parameters.values():
        if one.kind is one.KEYWORD_ONLY and last is one.POSITIONAL_OR_KEYWORD:
            signature.append("*")
        last = one.kind
        signature.append(str(one.replace(annotation=one.empty)))
    _, *sections = _SECTION.split(inspect.getdoc(function))
    entries = [
        f"- `{names}`: {_line(meaning)}"
        for names, meaning in _ENTRY.findall(sections[0] if sections else "")
    ]
    shared: dict[str, str] = {}
    unpack_keywords(function, shared)
    for key, meaning in shared.items():
        entries.append(f"- `{key}`: {meaning}".replace("\\", ""))
    call = f"`{name}({', '.join(signature)})`"
    return "\n\n".join(filter(None, (f"### {name}", call, _first(function), "\n".join(entries))))


def _class(name, kind):
    """Heading, what it is, and a line for each property and method of its own."""
    own = [
        (key, member)
        for key, member in vars(kind).items()
        if not key.startswith("_") and inspect.getdoc(member)
    ]
    rows = [
        f"- `{key}{'()' if callable(member) else ''}`: {_first(member)}"
        for key, member in own
        if callable(member) or isinstance(member, property)
    ]
    return f"### {name}\n\n{_first(kind)}" + ("\n\n" + "\n".join(rows) if rows else "")


def _first(thing):
    """The first paragraph of a docstring."""
    return _line(inspect.getdoc(thing).split("\n\n")[0])


def _line(text):
    return " ".join(text.split()).replace("``", "`")
