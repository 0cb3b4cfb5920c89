"""What programs share: their command line.

The options of `python -m validation...` are the parameters of its main function, by their annotations:

    def main(fabrics: Sequence[str] = ("S-720",), *, page: Path | None = None, jobs: int = 1, resume: bool = False):
        ...

    if __name__ == "__main__":
        program(main, resume="take shots that are done from the folder")

Positional parameters are arguments, the others options: a bool is a flag, a Sequence takes any number of values, a
tuple as many as it has, a Literal one of its values.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Mapping, Sequence
from inspect import Parameter, signature
from types import NoneType
from typing import Any, Literal, get_args, get_origin

from fabrics.errors import WeavecellError, marked

NOTES = {
    "executor": "local, mpi or dask",
    "jobs": "cases beside each other",
    "out": "folder of what is written, and of kept results",
}


def program(main: Callable[..., object], words: Sequence[str] = (), **notes: str) -> None:
    """Run the main function of a module with the options of the command line; an error of ours is one line.

    Parameters
    ----------
    main : of the module that is run; a number that it returns is the exit code
    words : name of a program of `python -m validation`, and its arguments; those of the process by default
    notes : what --help says of a parameter, where NOTES does not
    """
    name, *arguments = words or ("",)

    try:
        code: Any = main(**options(main, NOTES | notes, arguments if words else None, name))
    except WeavecellError as problem:
        print(marked(problem), file=sys.stderr)
        code = problem.exit_code
    sys.exit(code or 0)


def options(
    main: Callable[..., object],
    notes: Mapping[str, str],
    arguments: Sequence[str] | None = None,
    program: str = "",
) -> Any:
    """{parameter: value} from the arguments of the command line; those of the process by default."""
    module = main.__globals__  # type: ignore[attr-defined]
    name = f"validation {program}" if program else module["__spec__"].name.removesuffix(".__main__")
    text = next(part for part in module["__doc__"].split("\n\n") if "python -m" not in part)
    parser = argparse.ArgumentParser(prog=f"python -m {name}", description=text)
    for parameter in signature(main, eval_str=True).parameters.values():
        given = {"help": notes.get(parameter.name, "").replace("%", "%%"), **_values(parameter)}
        if parameter.kind is Parameter.KEYWORD_ONLY:
            parser.add_argument(
                f"--{parameter.name.replace('_', '-')}", default=parameter.default, **given
            )
        elif parameter.default is Parameter.empty:
            parser.add_argument(parameter.name, **given)
        else:
            parser.add_argument(
                parameter.name, default=parameter.default, **{"nargs": "?", **given}
            )
    return vars(parser.parse_args(arguments))


def _values(parameter):
    """How a parser reads the values of a parameter."""
    kind = parameter.annotation
    if NoneType in get_args(kind):
        [kind] = (one for one in get_args(kind) if one is not NoneType)
    origin = get_origin(kind)
    parts = get_args(kind)
    if origin is Literal:
        return {"choices": parts}
    if origin is tuple:
        return {"nargs": len(parts), "type": parts[0]}
    if origin is Sequence:
        return {"nargs": "*", "type": parts[0]}
    if kind is bool:
        return {"action": "store_true"}
    return {"type": kind}
