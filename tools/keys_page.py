"""The pages input.md and results.md: every key of input files and of result files, from the schema and the declared
keys."""

from __future__ import annotations

import inspect
import sys
from dataclasses import fields
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

from fabrics.base.schema import Table, entries, tables, unit_of, unread, with_tables, without_place
from weavecell.results import keys, one_table
from weavecell.results.result_folder import KINDS
from weavecell.scenes.coupon import CouponScene
from weavecell.scenes.impact import Scene

HEAD = """---
tocdepth: 3
---

# Input file

Made from the code. [Reference](../reference.md) says how an input file is written.

An input file is a [TOML](https://toml.io) file. A quantity is a string with a unit, in any unit of its dimension:
`"92.5 m/s"`, `"300 ft/s"`: one number, with a decimal point, and one unit. Everything is checked before a run starts;
a wrong key or value is refused in one line. The same keys are keywords in Python. Editors complete and
check input files with the JSON Schemas `scene.schema.json` and `coupon.schema.json`, which lie beside this page.

Each entry has the allowed values, the SI unit of the default, and the default; a key without one may be left out, and
its text then says what holds. All commands that take the file use a key, unless it says by which it is **refused**, or
**ignored** since it means nothing to them: *impact* is `weavecell impact`, *limits* are `weavecell critical-velocity`
and `v50`, *export* and *coupon* are the commands of these names; `sweep` and `compare` use keys as the
command that they repeat."""
HEAD_OF_RESULTS = """# Result files

Made from the code. A `*` stands for a name or number that the run gives. The table of a result is its CSV file and its
`to_dataframe()`, with the same columns; `wc.load(folder)` has it again to the last digit. [Files](files.md) says which
command writes which."""
# command: what it reads a scene for
COMMANDS = {"impact": "shot", "limits": "limit", "export": "export", "coupon": "coupon"}
RESULTS = {
    "summary.json of all runs": keys.SHARED,
    "summary.json of impacts": keys.IMPACT,
    "summary.json of coupons": keys.TABLES["coupon"],
    **{
        f"{name} and its table": keys.TABLES[kind.table]
        for name, kind in KINDS.items()
        if kind.table != "coupon"
    },
    "Energies": keys.TABLES["energies"],
    "histories.h5 of impacts": keys.DATASETS,
    "histories.h5 of coupons": keys.COUPON_DATASETS,
    "Attributes in histories.h5": keys.ATTRIBUTES,
}
NOTES = {
    "critical-velocity.json and its table": "Also fabric, law_name and wall_time_s, as in summary.json.",
    "Energies": "Entries of the energy balance, each computed on its own; in `energies_at_end_J` and `/energies`.",
    "histories.h5 of impacts": "A file holds the groups that its run gives.",
    "Attributes in histories.h5": "The root also has the texts and scalars of summary.json.",
}


def page() -> str:
    """Write the text of the page."""
    parts = [HEAD, "## Input file of an impact", *_tables(Scene), "## Input file of a coupon"]
    parts += [
        "Title and `[fabric]` as above; one table of a test; `[run]`.",
        *_tables(CouponScene, "title", "fabric"),
    ]
    return "\n\n".join(parts) + "\n"


def results_page() -> str:
    """Write the text of the page of result files."""
    parts = [HEAD_OF_RESULTS]
    for title, table in RESULTS.items():
        rows = []
        for key in table:
            column = key.name.startswith(one_table.ROWS)
            name = f"`{key.name.removeprefix(one_table.ROWS)}`"
            if column:
                name += ", column"
            if column or not key.of:
                rows.append((name, key.si_unit, key.meaning))
        parts += [
            f"## {title}",
            *([NOTES[title]] if title in NOTES else []),
            _table(("key", "unit", "meaning"), rows),
        ]
    return "\n\n".join(parts) + "\n"


def _tables(model, *left_out):
    """A section for each table of an input file, an entry for each of its keys."""
    defaults, shown = _solver_defaults(), {}
    keys = entries(model)
    for name, table in tables(model).items():
        if (name.partition(".")[0] or "title") in left_out:
            continue
        heading = "### Before the tables"
        if name:
            heading = f"### Table [{name}]"
        yield heading
        if table in shown:
            yield f"Its keys are those of [{shown[table]}]."
            continue
        shown[table] = name
        yield "{}\n\n```toml\n{}\n```".format(*about(table))
        for key, entry in keys.items():
            if key.rpartition(".")[0] != name:
                continue
            parts = {"Allowed": entry.description}
            if unit_of(entry) not in (None, "1"):
                parts["Unit"] = unit_of(entry)
            default = defaults.get(key) or _default(entry)
            if default is not None:
                parts["Default"] = default
            parts |= _exceptions(key, model)
            yield f"#### {key}\n\n{entry.title[0].upper()}{entry.title[1:]}."
            yield " ".join(f"*{part}:* {text}." for part, text in parts.items())


def about(table: type[Table]) -> list[str]:
    """Return what a table is and lines of TOML with an example: its docstring, before and after the
    first empty line."""
    return inspect.cleandoc(table.__doc__ or "").split("\n\n", 1)


def _exceptions(key, model):
    """{"Ignored by", "Refused by", "Told as left out by": commands} of a key; those of [fabric] are also
    keys of coupons."""
    both = key.startswith("fabric.")
    kinds = ("Ignored by", "Refused by", "Told as left out by")
    found: dict[str, list[str]] = {kind: [] for kind in kinds}
    for name, reader in COMMANDS.items():
        if not both and (name == "coupon") != (model is CouponScene):
            continue
        told = without_place(model, reader)
        if any(part in told for part in with_tables(key)):
            found["Told as left out by"].append(name)
        words = unread(model, reader)
        stands = [words[part] for part in with_tables(key) if part in words]
        if any(stands):
            found["Refused by"].append(name)
        elif stands:
            found["Ignored by"].append(name)
    return {verb: ", ".join(names) for verb, names in found.items() if names}


def _default(entry):
    if entry.is_required():
        return "required"
    value = entry.get_default(call_default_factory=True)
    if value is False and entry.json_schema_extra:
        return "0"
    if value is None:
        return None
    if value == "":
        return '""'
    return _text(value)


def _text(value):
    if isinstance(value, tuple):
        return ", ".join(map(_text, value))
    if isinstance(value, bool):
        return str(value).lower()
    return f"{value:g}" if isinstance(value, float) else str(value)


def _solver_defaults():
    """{key: default} of keys that the input file leaves to the data of the block."""
    from fabrics.materials import Isotropic, load

    material = load("backing")
    known = {entry.name: getattr(material, entry.name) for entry in fields(Isotropic)}
    return {f"backing.{key}": _text(value) for key, value in known.items() if value is not None}


def _table(columns, rows):
    lines = [columns, ["---"] * len(columns), *rows]
    return "\n".join(
        "| " + " | ".join(cell.replace("|", "\\|") for cell in line) + " |" for line in lines
    )
