"""Reference pages that are made from code and data.

    python tools/reference_pages.py [docs/generated]

Kept in git, for those who read the repository: input.md has every key of input files; scene.schema.json and
coupon.schema.json are JSON Schemas of the input files, for editors.

Made with the site alone, in the folder `site`: results.md has every key of result files, files.md tables of output and
data files; cli.md has every command with its arguments, options and defaults, as
`weavecell COMMAND --help`; python.md the functions and results of the Python interface, as `help(wc.impact)`; errata.md
the errata of the thesis, architecture.md the layers and folders, kernel-arrays.md what kernels take; `thesis` has
copies of the pages in validation/reports.
"""

from __future__ import annotations

import json
import os
import re
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
FOLDER = ROOT / "docs" / "generated"
# pages on the thesis stand beside the code that judges it; the site has copies
THESIS = ROOT / "validation" / "reports"
COPIES = FOLDER / "site" / "thesis"
sys.path[:0] = [str(ROOT), str(ROOT / "tools")]

import architecture  # noqa: E402
import errata_page  # noqa: E402
import file_formats  # noqa: E402
import kernel_arrays  # noqa: E402
import keys_page  # noqa: E402
import python_page  # noqa: E402

from fabrics.base import files  # noqa: E402

HEAD = "# Command line\n\nMade from the definitions of the commands. Exit codes: 0 done, 1 failed, 2 bad input, 3 a run"
HEAD += " that became unstable or a doubtful result with `--strict`, 130 interrupted."


def commands(command, name):
    """Yield (name, command) of a click command and those under it, groups left out."""
    inner = getattr(command, "commands", None)
    if inner is None:
        yield name, command
        return
    for word, each in inner.items():
        yield from commands(each, f"{name} {word}")


def plain(text):
    """Return help without the marks of rich, on one line, safe in a table."""
    return " ".join(re.sub(r"\\(\[)|\[/?(?:bold|dim)?\]", r"\1", text or "").split()).replace(
        "|", r"\|"
    )


def section(name, command):
    """Write the Markdown of one command."""
    arguments = [one for one in command.params if one.param_type_name == "argument"]
    options = [
        one
        for one in command.params
        if one.param_type_name == "option" and "--help" not in one.opts
    ]
    usage = " ".join(
        [
            name,
            *(one.metavar or one.name.upper() for one in arguments),
            *(["[OPTIONS]"] if options else []),
        ]
    )
    paragraphs = [plain(each) for each in (command.help or "").split("\n\n")]
    lines = [f"## {name}", "", f"```\n{usage}\n```", "", "\n\n".join(paragraphs), ""]
    if command.params:
        lines += ["| argument or option | default | meaning |", "| --- | --- | --- |"]
    for one in arguments:
        lines.append(
            f"| `{one.metavar or one.name.upper()}` | | {plain(getattr(one, 'help', ''))} |"
        )
    for one in options:
        value = f" {one.metavar}" if one.metavar and not getattr(one, "is_flag", False) else ""
        words = ", ".join([*one.opts, *one.secondary_opts]) + value.replace("|", r"\|")
        default = one.default
        default = (
            "" if default is None or callable(default) else str(getattr(default, "value", default))
        )
        lines.append(
            f"| `{words}` | {default and f'`{default}`'} | {plain(getattr(one, 'help', ''))} |"
        )
    example = plain(getattr(command, "epilog", "")).removeprefix("Example: ")
    return "\n".join([*lines, "", *([f"Example: `{example}`", ""] if example else [])])


def cli():
    """Write cli.md."""
    import typer

    from weavecell.cli.app import program

    return "\n\n".join(
        [
            HEAD,
            *(section(*each) for each in commands(typer.main.get_command(program()), "weavecell")),
        ]
    )


def json_schema(model):
    """Return the JSON Schema of an input file as it is written: quantities are texts with a unit.

    Parameters
    ----------
    model : Scene or CouponScene
    """
    from fabrics.base.schema import entries

    schema, meanings = model.model_json_schema(), {entry.title for entry in entries(model).values()}
    for table in (schema, *schema["$defs"].values()):
        for entry in table["properties"].values():
            unit = entry.pop("unit", None)
            if unit is not None:
                entry.pop("default", None)  # a number
            if entry.get("title") in meanings:
                ends = f" [{unit}]" if unit else ""
                entry["description"] = f"{entry.pop('title')}{ends}; {entry['description']}"
    schema["$schema"] = "https://json-schema.org/draft/2020-12/schema"
    return schema


def schemas():
    """Return the JSON Schema of each input file: {name of the file: schema}."""
    from weavecell.scenes.coupon import CouponScene
    from weavecell.scenes.impact import Scene

    return {
        f"{name}.schema.json": json_schema(model)
        for name, model in (("scene", Scene), ("coupon", CouponScene))
    }


def kept_pages():
    """Write the pages and schemas that are kept in git: {name: text}."""
    texts = {"input.md": keys_page.page()}
    for name, found in schemas().items():
        texts[name] = json.dumps(found, indent=2) + "\n"
    return texts


def with_links(text, folder, place):
    """Return a page of a folder as it stands in another place: with links that lead from there, those to
    pages on the thesis to the site's copies."""

    def led(link):
        path, mark, anchor = link[1].partition("#")
        if not path or ":" in path:
            return link[0]
        file = Path(os.path.normpath(folder / path))
        if file.parent == THESIS and file.suffix == ".md":
            file = COPIES / file.name
        return f"]({os.path.relpath(file, place)}{mark}{anchor})"

    return re.sub(r"\]\(([^)\s]+)\)", led, text)


def thesis_pages():
    """Write the site's copies of the pages on the thesis: {name: text}."""
    return {
        f"site/thesis/{page.name}": with_links(page.read_text("utf-8"), THESIS, COPIES)
        for page in sorted(THESIS.glob("*.md"))
    }


def site_pages():
    """Write the pages that the site alone has: {name: text}."""
    return thesis_pages() | {
        "site/results.md": keys_page.results_page(),
        "site/files.md": file_formats.page().replace("](../", "](../../"),
        "site/cli.md": cli(),
        "site/python.md": python_page.page(),
        "site/errata.md": errata_page.page(),
        "site/architecture.md": architecture.text(),
        # meanings of keys link from the folder of input.md
        "site/kernel-arrays.md": kernel_arrays.page().replace("](../", "](../../"),
    }


def stale(folder, texts):
    """Return those of {name: text} that a folder has not, or not as they are."""
    found = {}
    for name, text in texts.items():
        path = Path(folder) / name
        if not path.exists() or path.read_text("utf-8") != text:
            found[name] = text
    return found


def write(folder):
    """Write all pages to a folder; Sphinx reads again what is newer."""
    for name, text in stale(folder, kept_pages() | site_pages()).items():
        files.write(Path(folder) / name, text)


if __name__ == "__main__":
    write(Path(sys.argv[1]) if len(sys.argv) > 1 else FOLDER)
