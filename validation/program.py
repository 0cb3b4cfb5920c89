"""The command line that the programs share.

The options of `python -m validation ...` are the parameters of the program's main function, by their annotations:

    def main(parts: Sequence[str] = (), *, page: Path | None = None, jobs: int = 1, quick: bool = False):
        ...

Positional parameters are arguments, the others options. A bool is a flag, and a Sequence takes any number of values.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Mapping, Sequence
from inspect import Parameter, signature
from typing import Any, get_args, get_origin

from fabrics.base.errors import WeavecellError, marked

NOTES = {
    "executor": "local, mpi or dask",
    "jobs": "cases beside each other",
    "out": "folder of what is written, and of kept results",
}


def program(main: Callable[..., Any], words: Sequence[str], **notes: str) -> None:
    """Run the main function of a module with the options of the command line; an error of ours is one line.

    Parameters
    ----------
    main : of the module that is run; a number that it returns is the exit code
    words : name of a program of `python -m validation`, and its arguments
    notes : what --help says of a parameter, if not what NOTES says
    """
    name, *arguments = words
    try:
        code = main(**options(main, NOTES | notes, arguments, name))
    except WeavecellError as problem:
        print(marked(problem), file=sys.stderr)
        code = problem.exit_code
    sys.exit(code or 0)


def options(
    main: Callable[..., Any], notes: Mapping[str, str], arguments: Sequence[str], name: str = ""
) -> Any:
    """Read {parameter: value} from the arguments of the command line."""
    sections = main.__globals__["__doc__"].split("\n\n")
    text = next(section for section in sections if "python -m" not in section)
    parser = argparse.ArgumentParser(prog=f"python -m validation {name}", description=text)
    for parameter in signature(main, eval_str=True).parameters.values():
        given = _reader(parameter.annotation)
        given["help"] = notes.get(parameter.name, "").replace("%", "%%")
        if parameter.default is not Parameter.empty:
            given["default"] = parameter.default
        flag = parameter.name
        if parameter.kind is Parameter.KEYWORD_ONLY:
            flag = f"--{flag.replace('_', '-')}"
        parser.add_argument(flag, **given)
    return vars(parser.parse_args(arguments))


def _reader(kind):
    """How a parser reads the values of a parameter with this annotation."""
    if kind is bool:
        return {"action": "store_true"}
    parts = get_args(kind) or (kind,)
    # the first part of "Path | None" says how a given value is read
    reader = {"type": parts[0]}
    if get_origin(kind) is Sequence:
        reader["nargs"] = "*"
    return reader
