"""What holds for every command is tested by these, from the list of commands and their functions: a new command needs
no row in a test, its example stands in for it."""

import inspect
import shlex
from contextlib import suppress
from dataclasses import fields

from click.core import ParameterSource

from fabrics.base import run_cache
from fabrics.base.errors import InputError
from weavecell.answers.result import Result
from weavecell.answers.target import Target
from weavecell.cli import app, from_signature

# options by which a command writes what is named
WRITING = {"out", "html", "screenshot", "movie"}
FUNCTION = {words: app.find_function(name) for words, (name, *_) in app.COMMANDS.items()}
WORDS = {name: words for words, (name, *_) in app.COMMANDS.items()}


def answers(words):
    """Whether a command prints a result in eight lines; others print what is asked for."""
    returned = from_signature.read_types(FUNCTION[words]).get("return")
    return hasattr(FUNCTION[words], "plan") or (
        isinstance(returned, type) and issubclass(returned, Result)
    )


def writes(words):
    """Whether a command may write a file or a folder."""
    own = from_signature.read_signature(FUNCTION[words]).parameters
    return bool(WRITING & set(own)) or words.endswith("new")


def example_line(words):
    """The example that the help of a command ends with."""
    return f"{words} {app.COMMANDS[words][1]}".strip()


def example(words):
    """{parameter: value} of that example, as the function of the command takes it."""
    import typer

    command = typer.main.get_command(app.program())
    rest = shlex.split(example_line(words))
    while hasattr(command, "commands"):
        command = command.commands[rest.pop(0)]
    context = command.make_context(words, rest)
    return {
        name: value
        for name, value in context.params.items()
        if context.get_parameter_source(name) is ParameterSource.COMMANDLINE
    }


def without_effect(function, arguments, given, others):
    """Name the options that are taken and change nothing: with any of `others` the plan is the same,
    and none is refused.

    Parameters
    ----------
    function : a command
    given : the options beside which they are tried
    others : {option: values}
    """
    plan = function.plan
    silent = []
    for option, values in others.items():
        # a value that is refused has an effect
        with suppress(InputError):
            made = {digest(plan(*arguments, **{**given, option: value})) for value in values}
            if len(made) == 1:
                silent.append(option)
    return silent


def digest(made):
    """Return the digest of a plan: two of one digest do the same."""
    parts = {one.name: _without_scene(getattr(made, one.name)) for one in fields(made)}
    return run_cache.inputs_digest(parts)


def _without_scene(value):
    """A field of a plan as a digest takes it: of a Target its set-up, of a table its columns,
    of a function its name."""
    if isinstance(value, Target):
        return value.setup
    if inspect.isfunction(value):
        return value.__qualname__
    if hasattr(value, "to_dict"):
        return value.to_dict("list")
    if isinstance(value, (tuple, list)):
        return [_without_scene(one) for one in value]
    return value
