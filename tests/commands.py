"""What holds for every command is tested by these, from the list of commands and their functions: a new command needs
no row in a test, its example stands in for it."""

import shlex

from click.core import ParameterSource

from weavecell.answers.result import Result
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
