"""Commands of the command line made from functions of the Python interface.

Of the function's parameters those of `ARGUMENTS` become arguments, the others options with their default; the help is
the text of the docstring, that of an option what the section Parameters says. What is returned is printed; a doubtful
result is exit code 3 where --strict is given. Two defaults differ: a command uses all cores, and computes the range
over what is assumed, where a law or the crimp is. A command of a group, such as `fabrics list`, has no folder of its
own by default.
"""

from __future__ import annotations

import inspect
import os
import re
import tomllib
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

import typer

import weavecell
from fabrics.base.errors import DoubtfulError, DoubtfulResult, InputError, UnstableError
from weavecell.api.result import Result
from weavecell.report import checks

CORES = os.cpu_count() or 1
RESULTS = Path("results")
DEFAULTS: dict[str, Any] = {"jobs": CORES}
LEFT_OUT = {
    "assumed_range": "laws"
}  # what a function gets where neither the option nor --no-... is given
ARGUMENTS = ("target", "tests", "fabric", "name", "file")
METAVARS = {"executor": "local|mpi|dask", "out": "FOLDER", "file": "PATH"}
WORDS = {"values": "from"}  # options with another name than their parameter
SHORT = {"out": "-o"}
OF_PYTHON = ("test", "velocity")  # positional parameters of a fabric, which an input file says
OF_ONE_RUN = ("impact", "coupon")  # whose folder is named after the input file alone
LEAST = {"jobs": 1, "seed": 0}
_SECTION = re.compile(r"\n\n[A-Z]\w+\n-{3,}\n")
_ENTRY = re.compile(r"^(\w[\w, ]*) : (.*(?:\n +.*)*)", re.MULTILINE)


def command(
    function: Callable[..., Any], name: str, example: str, *keywords: str
) -> tuple[Callable[..., None], str]:
    """The function that typer makes the command `name` of, and the line below its help.

    Parameters
    ----------
    function : returns a `weavecell.api.result.Result`; one with a parameter `out` writes the result there
    example : arguments that its help ends with
    keywords : of `weavecell.setup` that are options beside the function's own; lists are written as in a file
    """
    text, meanings = documented(function)
    given = inspect.signature(function).parameters.values()
    own = [p for p in given if p.name not in OF_PYTHON or p.kind is p.KEYWORD_ONLY]
    parameters = [p for p in own if p.kind is not p.VAR_KEYWORD]
    required = [
        p.name
        for p in parameters
        if p.name == "target" or (p.default is p.empty and p.name not in ("out", "tests"))
    ]
    has_checks = inspect.signature(function).return_annotation not in ("None", "Listing")

    def call(strict: bool = False, **values: Any) -> None:
        if values.get("out", "") is None and " " not in name:
            stems = [Path(values[key]).stem for key in required if values[key] is not None]
            values["out"] = RESULTS / "-".join(stems if name in OF_ONE_RUN else [name, *stems])
        values |= {key: LEFT_OUT.get(key) for key, value in values.items() if value is None}
        chosen = {key: value for key, value in values.items() if value not in (None, [])}
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", DoubtfulResult)  # said once, in the line of the checks
            try:
                chosen |= {key: _listed(chosen[key]) for key in keywords if key in chosen}
                result = function(**chosen)
            except UnstableError as problem:
                if problem.result is not None and "out" in values:
                    print(problem.result, f"written to {values['out']}", sep="\n", flush=True)
                raise
            except InputError as problem:
                raise _of_option(problem, values) from None
        if result is not None:
            print(result)
        if isinstance(result, Result) and has_checks:
            if "out" in values and not values.get("check"):
                print(f"written to {values['out']}", flush=True)
            checks.report(result.checks, strict)
        elif strict and result is not None and result.doubtful:  # done before
            raise DoubtfulError("the result is doubtful")

    strict = Annotated[
        bool,
        typer.Option("--strict", help="Exit code 3 if a quality indicator is beyond its limit."),
    ]
    signature = [_parameter(p, meanings.get(p.name, "")) for p in parameters]
    signature += [_parameter(_keyword(key), _escaped(_meaning(key))) for key in keywords]
    if has_checks:
        signature.append(
            inspect.Parameter(
                "strict", inspect.Parameter.KEYWORD_ONLY, default=False, annotation=strict
            )
        )
    made: Any = call
    made.__signature__ = inspect.Signature(signature)
    made.__annotations__ = {p.name: p.annotation for p in signature}
    made.__doc__ = text
    return made, f"Example: [bold]weavecell {name} {example}[/bold]"


def _keyword(key):
    return inspect.Parameter(
        key, inspect.Parameter.KEYWORD_ONLY, default=None, annotation="str | None"
    )


def _meaning(key):
    """What a keyword of `weavecell.setup` means: the title of its field in the schema."""
    from fabrics.base.schema import entries
    from weavecell.api import keywords
    from weavecell.scenes.impact import Scene

    return entries(Scene)[f"{keywords.tables()[key]}.{key}"].title


def _listed(text):
    """A list as it stands in a file; any other text as it is."""
    if not text.lstrip().startswith("["):
        return text
    try:
        return tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        return text


def documented(function: Callable) -> tuple[str, dict[str, str]]:
    """(text before the sections, {parameter: its meaning}) of a numpydoc docstring, brackets written for rich.

    "as of `other`" is what the docstring of that function of the Python interface says.
    """
    text, *sections = _SECTION.split(inspect.getdoc(function) or "")
    meanings: dict[str, str] = {}
    for names, meaning in _ENTRY.findall(sections[0] if sections else ""):
        other = re.fullmatch(r"as of `(\w+)`", meaning)
        known = {}
        if other:
            known = documented(getattr(weavecell, other[1]))[1]
        words = _escaped(" ".join(meaning.split()).split("; in Python")[0])
        meanings |= {name: known.get(name, words) for name in names.split(", ")}
    return "\n\n".join(_escaped(" ".join(part.split())) for part in text.split("\n\n")), meanings


def _escaped(text):
    return text.replace("[", "\\[")


def _parameter(parameter, meaning):
    """A parameter as typer takes it; one that is left out has the function's own default."""
    name = parameter.name
    default = parameter.default
    if name in LEFT_OUT and default is False:
        default = None
    else:
        default = DEFAULTS.get(name, default)
    kinds = parameter.annotation.split(" | ")
    kind = next(
        (kind for text, kind in (("bool", bool), ("int", int), ("float", float)) if text in kinds),
        str,
    )
    if "str" in kinds or "FilePath" in kinds:
        kind = str
    if kinds[0].startswith("list["):
        kind = list[str]
    choices = kind is str and re.search(r"Literal\[(.*?)\]", parameter.annotation)
    metavar = METAVARS.get(
        name, re.sub("[\"' ]", "", choices[1]).replace(",", "|") if choices else None
    )
    settings: dict[str, Any] = {"help": meaning, "metavar": metavar, "min": LEAST.get(name)}
    if name in ARGUMENTS:
        settings["metavar"] = metavar or name.upper()
        if name == "target":
            if "fabric" in meaning:
                settings["metavar"] = "FILE|FABRIC"
            else:
                settings["metavar"] = "FILE"
        annotation: Any = Annotated[kind, typer.Argument(**settings)]
        if name == "target" and default is None:
            left_out = None
        else:
            left_out = parameter.empty
        return inspect.Parameter(
            name, inspect.Parameter.KEYWORD_ONLY, default=left_out, annotation=annotation
        )
    if default is parameter.empty:
        default = ...
        if name == "out":
            default = None
    word = _option(name)
    with_no = default is True or name in LEFT_OUT
    words = [
        f"{word}/--no-{word[2:]}" if with_no else word,
        *(SHORT[key] for key in SHORT if key == name),
    ]
    annotation = Annotated[
        kind if default is not None else kind | None, typer.Option(*words, **settings)
    ]
    if default is ...:
        default = parameter.empty
    return inspect.Parameter(
        name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=annotation
    )


def _option(name):
    return "--" + WORDS.get(name, name).replace("_", "-")


def _of_option(problem, names):
    """An InputError of a parameter, with the option that has its value."""
    if problem.key not in names or problem.file is not None:
        return problem
    if problem.key in ARGUMENTS:
        key = METAVARS.get(problem.key, problem.key.upper())
    else:
        key = _option(problem.key)
    message = (
        str(problem)
        .removeprefix(f"{problem.key} = {problem.value!r}: ")
        .removeprefix(f"{problem.key}: ")
    )
    renamed = InputError(
        f"{key} = {problem.value!r}: {message}"
        if problem.value is not None
        else f"{key}: {message}"
    )
    renamed.key = key
    renamed.value = problem.value
    renamed.allowed = problem.allowed
    return renamed
