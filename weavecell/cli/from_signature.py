"""Commands of the command line made from functions of the Python interface.

Of the function's parameters those of `ARGUMENTS` become arguments, the others options with their
default; the help is the text of the docstring, that of an option what the section Parameters says.
What is returned is printed; a doubtful result is exit code 3 where --strict is given. Two defaults
differ: a command uses all cores, and computes the range over what is assumed, if a law or the crimp
is. A command of a group, such as `fabrics list`, has no folder of its own by default.
"""

from __future__ import annotations

import builtins
import inspect
import logging
import os
import re
import sys
import warnings
from collections.abc import Callable
from pathlib import Path
from types import UnionType
from typing import Annotated, Any, Literal, Union, Unpack, get_args, get_origin

import typer

from fabrics.base.errors import DoubtfulError, DoubtfulResult, InputError, UnstableError
from fabrics.base.files import parse_toml
from weavecell.answers.result import Result
from weavecell.answers.tables import format_for_terminal
from weavecell.report import checks
from weavecell.results import glossary, progress

CORES = os.cpu_count() or 1
RESULTS = Path("results")
DEFAULTS: dict[str, Any] = {"jobs": CORES, "executor": "local", "resume": False}
ARGUMENTS = ("target", "other", "tests", "fabric", "fabrics", "name", "file", "record", "folder")
METAVARS = {
    "fabrics": "FABRIC...",
    "executor": "local|mpi|dask",
    "out": "FOLDER",
    "file": "PATH",
    "folder": "FOLDER",
}
# options with another name than their parameter
WORDS = {"values": "from"}
SHORT = {"out": "-o"}
# an input file has these; a fabric in Python needs them as arguments
OF_PYTHON = ("test", "velocity")
# the folder of a single run is named after the input file alone
OF_ONE_RUN = ("impact", "coupon")
LEAST = {"jobs": 1, "seed": 0}
_SECTION = re.compile(r"\n\n[A-Z]\w+\n-{3,}\n")
_ENTRY = re.compile(r"^(\w[\w, ]*) : (.*(?:\n +.*)*)", re.MULTILINE)


def command(
    function: Callable[..., Any],
    name: str,
    example: str,
    *keywords: str,
) -> tuple[Callable[..., None], str]:
    """Make the function that typer makes the command `name` of, and the line below its help.

    Parameters
    ----------
    function : returns a `weavecell.answers.result.Result`; one with a parameter `out` writes the result
        there
    example : arguments that its help ends with
    keywords : of `weavecell.setup` that are options beside the function's own; lists are written as
        in a file
    """
    text, meanings = read_docstring(function)
    parameters = []
    for parameter in read_signature(function).parameters.values():
        of_python = parameter.name in OF_PYTHON and parameter.kind is not parameter.KEYWORD_ONLY
        if not of_python and parameter.kind is not parameter.VAR_KEYWORD:
            parameters.append(parameter)
    parameters += unpack_keywords(function, meanings)
    has_checks = _computes(function)

    def call(strict: bool = False, verbose: bool = False, **values: Any) -> None:
        progress.told = verbose or not has_checks or bool(values.get("check"))
        if has_checks and "out" in values and values["out"] is None:
            values["out"] = _folder(name, parameters, values)
        chosen = {key: value for key, value in values.items() if value not in (None, [])}
        with warnings.catch_warnings():
            # the line of the checks says it already
            warnings.simplefilter("ignore", DoubtfulResult)
            try:
                for key in keywords:
                    if key in chosen:
                        chosen[key] = _read_list(chosen[key])
                result = function(**chosen)
            except UnstableError as problem:
                if problem.result is not None and "out" in values:
                    print(problem.result, flush=True)
                raise
            except InputError as problem:
                raise _name_option(problem, values) from None
        if isinstance(result, Result) and has_checks and not values.get("check"):
            print(result, flush=True)
            if "out" in values and type(result).answer is Result.answer:
                print(f"written to {values['out']}", flush=True)
            if getattr(result, "read_from", None) is not None:
                print("done before with the same input and code")
            if verbose:
                print(result.details(), flush=True)
                for line in result.assumed:
                    # which prints it once
                    logging.getLogger("weavecell").info(line)
                print(*glossary.lines(result.details(), result.checks), sep="\n", flush=True)
                checks.report(result.checks)
        elif result is not None:
            print(_as_printed(result), flush=True)
        if strict and result is not None and result.doubtful:
            # the folder of a run that was finished before
            doubts = "; ".join(getattr(result, "doubts", ()))
            raise DoubtfulError(": ".join(filter(None, ["the result is doubtful", doubts])))

    signature = [
        _parameter(parameter, meanings.get(parameter.name, "")) for parameter in parameters
    ]
    for key in keywords:
        signature.append(_parameter(_keyword(key, str), _escape(_meaning(key))))
    if has_checks:
        help_text = "Exit code 3 if a quality indicator is beyond its limit."
        strict = Annotated[bool, typer.Option("--strict", help=help_text)]
        only = inspect.Parameter.KEYWORD_ONLY
        signature.append(inspect.Parameter("strict", only, default=False, annotation=strict))
        help_text = "Print all that is known of the result."
        more = Annotated[bool, typer.Option("--verbose", "-v", help=help_text)]
        signature.append(inspect.Parameter("verbose", only, default=False, annotation=more))
    made: Any = call
    made.__signature__ = inspect.Signature(signature)
    made.__annotations__ = {parameter.name: parameter.annotation for parameter in signature}
    made.__doc__ = text
    return made, f"Example: [bold]weavecell {name} {example}[/bold]"


def _as_printed(result):
    """What is printed of a result without checks: a table is laid out, another one is its own text."""
    # a table is pandas' only where that is loaded
    pandas = sys.modules.get("pandas")
    if pandas is not None and isinstance(result, pandas.DataFrame):
        return format_for_terminal(result)
    return result


def _folder(name, parameters, values):
    """Folder of the results of a command, named after the command and what it is given."""
    stems = []
    for parameter in parameters:
        required = parameter.default is parameter.empty and parameter.name in ARGUMENTS
        named = required and parameter.name != "tests"
        if (named or parameter.name == "target") and values[parameter.name] is not None:
            given = values[parameter.name]
            stems += [Path(one).stem for one in (given if isinstance(given, list) else [given])]
    if name not in OF_ONE_RUN:
        stems = [*name.split(), *stems]
    return RESULTS / "-".join(stems)


class _Names(dict):
    """Names of a module and of Python; one that the module only checks types by is a class of that
    name."""

    def __missing__(self, name: str) -> type:
        if name.startswith("__"):
            raise KeyError(name)
        return type(name, (), {"__class_getitem__": classmethod(lambda cls, _: cls)})


def read_types(owner: Any) -> dict[str, Any]:
    """Return {name: type} of the annotations of a function or a TypedDict of ours."""
    inside = inspect.unwrap(owner)
    names = _Names(vars(builtins) | vars(inspect.getmodule(inside)))
    found = {}
    for name, annotation in owner.__annotations__.items():
        text = getattr(annotation, "__forward_arg__", annotation)
        found[name] = eval(text, {}, names) if isinstance(text, str) else text
    return found


def read_signature(function: Callable) -> inspect.Signature:
    """Return the signature of a function, with types for annotations."""
    types = read_types(function)
    signature = inspect.signature(function)
    parameters = [one.replace(annotation=types[one.name]) for one in signature.parameters.values()]
    return signature.replace(
        parameters=parameters, return_annotation=types.get("return", signature.empty)
    )


def _computes(function):
    """Whether a function computes a result with quality checks: as a plan that is run, or at once."""
    returned = read_types(function).get("return")
    return hasattr(function, "plan") or (
        isinstance(returned, type) and issubclass(returned, Result)
    )


def unpack_keywords(function: Callable, meanings: dict[str, str]) -> list[inspect.Parameter]:
    """Return the parameters of a TypedDict that stands for `**keywords`; their meanings are added.

    They are those that its own docstring explains. Those of `weavecell.setup` are keys of the input
    file, which a command reads.
    """
    *_, last = read_signature(function).parameters.values()
    if last.kind is not last.VAR_KEYWORD or get_origin(last.annotation) is not Unpack:
        return []
    (kind,) = get_args(last.annotation)
    types = read_types(kind)
    own = read_docstring(kind)[1]
    meanings |= own
    others = [key for key in own if key not in inspect.signature(function).parameters]
    return [_keyword(key, types[key]) for key in others]


def _keyword(key, annotation):
    """A keyword that may be left out."""
    only = inspect.Parameter.KEYWORD_ONLY
    return inspect.Parameter(key, only, default=None, annotation=annotation | None)


def _meaning(key):
    """What a keyword of `weavecell.setup` means: the title of its field in the schema."""
    from fabrics.base.schema import entries
    from weavecell.api import keywords
    from weavecell.scenes.impact import Scene

    return entries(Scene)[f"{keywords.tables()[key]}.{key}"].title


def _read_list(text):
    """A list as it stands in a file; any other text as it is."""
    if not text.lstrip().startswith("["):
        return text
    try:
        return parse_toml(f"value = {text}")["value"]
    except ValueError:
        return text


def read_docstring(function: Callable) -> tuple[str, dict[str, str]]:
    """Split a numpydoc docstring: (text before the sections, {parameter: its meaning}), brackets
    written for rich."""
    text, *sections = _SECTION.split(inspect.getdoc(function) or "")
    parameters = "".join(sections[:1])
    meanings: dict[str, str] = {}
    for names, meaning in _ENTRY.findall(parameters):
        words = _escape(" ".join(meaning.split()).split("; in Python")[0])
        meanings |= dict.fromkeys(names.split(", "), words)
    paragraphs = [" ".join(part.split()) for part in text.split("\n\n")]
    return _escape("\n\n".join(paragraphs)), meanings


def _escape(text):
    return text.replace("[", "\\[")


def _parameter(parameter, meaning):
    """A parameter as typer takes it; one that is left out has the function's own default."""
    name = parameter.name
    default = DEFAULTS.get(name, parameter.default)
    kinds = _split_union(parameter.annotation)
    kind = _kind(kinds)
    choices = [word for one in kinds if get_origin(one) is Literal for word in get_args(one)]
    metavar = METAVARS.get(name)
    if metavar is None and kind is str and choices:
        metavar = "|".join(choices)
    only = inspect.Parameter.KEYWORD_ONLY
    settings: dict[str, Any] = {"help": meaning, "min": LEAST.get(name)}
    if name in ARGUMENTS:
        settings["metavar"] = metavar or name.upper()
        left_out = parameter.empty
        if name in ("target", "other"):
            if "folder" in meaning:
                settings["metavar"] = "FILE|FOLDER|FABRIC"
            elif "fabric" in meaning:
                settings["metavar"] = "FILE|FABRIC"
            else:
                settings["metavar"] = "FILE"
            if default is None:
                left_out = None
        annotation: Any = Annotated[kind, typer.Argument(**settings)]
        return inspect.Parameter(name, only, default=left_out, annotation=annotation)
    required = default is parameter.empty and name != "out"
    if default is parameter.empty and not required:
        default = None
    words = [_option(name)]
    if default is True or set(kinds) == {bool, type(None)}:
        words = [f"{words[0]}/--no-{words[0][2:]}"]
    if name in SHORT:
        words.append(SHORT[name])
    if default is None:
        kind = kind | None
    annotation = Annotated[kind, typer.Option(*words, metavar=metavar, **settings)]
    return inspect.Parameter(name, only, default=default, annotation=annotation)


def _split_union(annotation):
    """The kinds that a union has; another annotation is the only one."""
    if isinstance(annotation, UnionType) or get_origin(annotation) is Union:
        return get_args(annotation)
    return (annotation,)


def _kind(kinds):
    """The type that typer reads a text as."""
    if get_origin(kinds[0]) is list:
        return list[str]
    if str not in kinds:
        for kind in (bool, int, float):
            if kind in kinds:
                return kind
    return str


def _option(name):
    return "--" + WORDS.get(name, name).replace("_", "-")


def _name_option(problem, names):
    """An InputError of a parameter, with the option that has its value."""
    if problem.key not in names or problem.file is not None:
        return problem
    key = _option(problem.key)
    if problem.key in ARGUMENTS:
        key = METAVARS.get(problem.key, problem.key.upper())
    return problem.changed(key=key)
