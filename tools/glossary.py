"""The glossary of what kernels take: its entries held against the code, and the page of the site that shows them.

The table has one entry for each field of each named tuple that kernels are called with; `problems` says where it and
the code do not agree.
"""

import ast
import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[1]
TABLE = Path("shellfabric/jit/glossary.toml")
NOT_PASSED = ("output",)  # folders whose named tuples no kernel takes
HEAD = """# Glossary of the compiled code

From `shellfabric/jit/glossary.toml`. SI units throughout.

## Terms

"""


def tuples(root=ROOT):
    """{module.name: fields} of the named tuples that kernels take, in the order of the files."""
    found, folder = {}, root / "shellfabric"
    for path in sorted(folder.rglob("*.py")):
        parts = path.relative_to(folder).with_suffix("").parts
        for node in (
            ast.walk(ast.parse(path.read_text("utf-8"))) if parts[0] not in NOT_PASSED else ()
        ):
            if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "namedtuple":
                name, fields = map(ast.literal_eval, node.args)
                found[".".join((*parts, name))] = fields.split()
    return found


def table(root=ROOT):
    """The entries: {terms: {term: meaning}, module.name: {field: [shape, unit, meaning]}}."""
    return tomllib.loads((root / TABLE).read_text("utf-8"))


def problems(entries, fields):
    """What is missing, superfluous or incomplete in the table, as texts."""
    found = []
    for name in fields.keys() | entries.keys() - {"terms"}:
        here, there = entries.get(name, {}), fields.get(name, ())
        found += [f"{name}.{field} has no entry" for field in there if field not in here]
        found += [f"{name}.{field} is in the table alone" for field in here if field not in there]
        found += [
            f"{name}.{field} is to have shape, unit and meaning"
            for field, row in here.items()
            if not (
                isinstance(row, list)
                and len(row) == 3
                and all(isinstance(x, str) and x for x in row)
            )
        ]
    return sorted(found)


def page(entries, fields):
    """Text of the page."""
    text = HEAD + "".join(
        f"- **{term}**: {meaning}\n" for term, meaning in entries["terms"].items()
    )
    for name, names in fields.items():
        text += (
            f"\n## shellfabric.{name}\n\n| field | shape | unit | meaning |\n|---|---|---|---|\n"
        )
        for field in names:
            shape, unit, meaning = entries[name][field]
            text += f"| `{field}` | {shape} | {unit} | {meaning} |\n"
    return text


def write(folder):
    """Write the page kernel-arrays.md into a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "kernel-arrays.md").write_text(page(table(), tuples()), "utf-8")
