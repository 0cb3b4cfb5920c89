"""Commands, files and Python that the guide pages and README print, in their order; for tests of the site."""

import re
import shlex
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[1]
GUIDE = (
    "index",
    "installation",
    "first-shot",
    "own-fabric",
    "pack",
    "how-many-plies",
    "measure-first",
    "which-fabric",
    "crossover",
    "coupons",
    "biaxial-tests",
    "recipes",
    "accuracy",
    "studies",
    "limits",
    "theory-cell",
    "theory-panel",
    "validation",
    "questions",
    "from-other-codes",
    "reference",
)
PAGES = ("README.md", *(f"docs/{name}.md" for name in GUIDE))
_BLOCK = re.compile(r"^( *)(`{3,})(\{?\w*)[^\n]*\n(.*?)^\1\2", re.MULTILINE | re.DOTALL)
_FILE = re.compile(r"`([\w./-]+\.(?:toml|csv))`")
_OUTPUTS = {"out", "screenshot", "movie"}
_INPUT = re.compile(r"\.(toml|csv|json|h5|msh)$|^results/")


class Printed(NamedTuple):
    """A command, its output, a file or a piece of Python of a page: `kind`, its text, and of a file its name."""

    kind: str
    text: str
    name: str = ""


def of(page):
    """What a page prints: lines that call weavecell or Python and what these print, files that it names before their
    text, Python."""
    text = (ROOT / page).read_text("utf-8")
    found = []
    for block in _BLOCK.finditer(text):
        language = block[3]
        inside = block[4]
        before = text[: block.start()].rstrip().rsplit("\n\n", 1)[-1]
        named = _FILE.findall(before) if before.rstrip().endswith(":") else []
        if language == "python":
            found.append(Printed("python", inside))
        elif language in ("toml", "csv"):
            found.append(Printed("file", inside, named[-1] if named else f".{language}"))
        else:
            lines = re.sub(r"\\\n\s*", " ", inside).splitlines()
            commands = [line.strip() for line in lines if re.match(r" *(weavecell|python) ", line)]
            found += [Printed("command", line) for line in commands]
            if found and not (commands or language):
                found.append(Printed("output", inside))
    return found


def words(line):
    """Words of a command line, as a shell splits them, without the comment at its end."""
    return shlex.split(line, comments=True)


def parsed(argv):
    """(command, {parameter: value as text}) of a call of weavecell; a click error where an option does not exist."""
    import typer

    from weavecell.cli.app import program

    command = typer.main.get_command(program())
    name = "weavecell"
    rest = argv[1:]
    while rest and rest[0] in getattr(command, "commands", {}):
        command = command.commands[rest[0]]
        name = f"{name} {rest[0]}"
        rest = rest[1:]
    if getattr(command, "commands", None):
        return name, command.make_parser(command.context_class(command)).parse_args(list(rest[:1]))[
            0
        ]
    values, _, _ = command.make_parser(command.context_class(command)).parse_args(list(rest))
    for one in command.params:
        given = values.get(one.name)
        assert not one.required or (given and str(given) != "Sentinel.UNSET"), (
            f"{name}: {one.name} is missing"
        )
    return name, values


def files(name, values):
    """(files that a call reads, files and folders that it makes), as far as its words tell."""
    reads = []
    makes = []
    first = ""
    for key, value in values.items():
        for each in value if isinstance(value, (list, tuple)) else [value]:
            if not isinstance(each, (str, Path)):
                continue
            # of PLIES=FILE the file
            text = re.sub(r"^\d+=", "", str(each))
            new = key in _OUTPUTS or (name.endswith(" new") and text.endswith(".toml"))
            if new:
                makes.append(text)
            elif _INPUT.search(text):
                reads.append(text)
            first = first or text
    return reads, [*makes, f"results/{Path(first).stem}"] if first else makes
