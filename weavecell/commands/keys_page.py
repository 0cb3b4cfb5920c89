"""docs/reference/input.md: every key of scenes and result files, from the schema and the declared keys.

python -m weavecell.commands.keys_page [docs/reference/input.md]
"""

from __future__ import annotations

import sys
from dataclasses import fields
from pathlib import Path

from fabrics.files import write_whole
from weavecell.commands import coupon, critical_velocity, fidelity, impact, uncertainty
from weavecell.results import keys
from weavecell.scenes import build, supported
from weavecell.scenes.coupon import CouponScene
from weavecell.scenes.impact import Scene
from weavecell.scenes.reference import meanings

PAGE = Path("docs") / "reference" / "input.md"
HEAD = f"""# Keys of scenes and results

Made by `python -m weavecell.commands.keys_page {PAGE}`; not to be edited by hand.

## Scenes of impacts

Quantities are texts with a unit, in any unit of the dimension; the unit here is that of the default. Where the default
is "none", the code chooses `run.elements_per_crossover`, `numerics.contact_points` and `panel.ply_gap`; any other is
not used. An editor completes and checks these keys with the JSON Schemas that `make docs` writes to docs/generated.

Columns of commands: `weavecell impact`, without and with `[accuracy]`;
`weavecell critical-velocity` and `weavecell v50` ("limit"), and `weavecell sensitivity`, of plies and packs. "no":
rejected in one line; "ignored": without meaning there."""
SHOTS = {
    "impact": impact.SUPPORT,
    "accuracy": fidelity.SUPPORT,
    "limit": critical_velocity.SUPPORT,
    "sensitivity": uncertainty.OF_SOBOL,
}
CODE = "`{}`".format
RESULTS = {
    "summary.json of all runs": keys.SHARED,
    "summary.json of impacts": keys.IMPACT,
    "summary.json of coupons": keys.COUPON,
    "summary.json of the demonstration": keys.DEMO,
    "critical-velocity.json": keys.CRITICAL_VELOCITY,
    "Energies": keys.ENERGIES,
    "histories.h5 of impacts": keys.DATASETS,
    "histories.h5 of coupons": keys.COUPON_DATASETS,
    "Attributes in histories.h5": keys.ATTRIBUTES,
}
NOTES = {
    "critical-velocity.json": "Also format, fabric, law_name, wall_time_s, checks and provenance, as in summary.json.",
    "Energies": "Entries of the energy balance, each computed on its own; in `energies_at_end_J` and `/energies`.",
    "histories.h5 of impacts": "A file holds the groups that its run gives.",
    "Attributes in histories.h5": "The root also has the texts and scalars of summary.json.",
}


def page() -> str:
    """The text of docs/reference/input.md."""
    parts = [HEAD, _scene_table(Scene, SHOTS)]
    parts += ["## Scenes of coupons", _scene_table(CouponScene, {"coupon": coupon.SUPPORT})]
    for title, table in RESULTS.items():
        rows = [(CODE(key.name), key.unit, key.meaning) for key in table]
        parts += [f"## {title}", *([NOTES[title]] if title in NOTES else []), _table(("key", "unit", "meaning"), rows)]
    return "\n\n".join(parts) + "\n"


def _scene_table(model, supports):
    defaults = _solver_defaults()
    words = meanings(model)
    rows = [
        (CODE(key), words[key], _unit(entry), defaults.get(key) or _default(entry), entry.description,
         *(_support(support, key) for support in supports.values()))
        for key, entry in supported.entries(model).items()
    ]  # fmt: skip
    return _table(("key", "meaning", "unit", "default", "allowed", *supports), rows)


def _unit(entry):
    return (entry.json_schema_extra or {}).get("unit", "")


def _default(entry):
    if entry.is_required():
        return "required"
    value = entry.get_default(call_default_factory=True)
    return "none" if value is None else '""' if value == "" else _text(value)


def _text(value):
    if isinstance(value, tuple):
        return ", ".join(map(_text, value))
    if isinstance(value, bool):
        return str(value).lower()
    return f"{value:g}" if isinstance(value, float) else str(value)


def _solver_defaults():
    """{key: default} of keys that the scene leaves to the objects of the solver, or to the data of the block."""
    from fabrics.materials import Isotropic, load
    from shellfabric.backing.block import Backing
    from shellfabric.panel.model import Numerics

    known = {f"numerics.{entry.name}": entry.default for entry in fields(Numerics)}
    known |= {f"backing.{entry.name}": entry.default for entry in fields(Backing) if entry.name != "material"}
    material = load("backing")
    known |= {f"backing.{entry.name}": getattr(material, entry.name) for entry in fields(Isotropic)}
    names = {f"{key.partition('.')[0]}.{field}": key for key, field in build.FIELDS.items()}
    return {names.get(key, key): _text(value) for key, value in known.items() if value is not None}


def _support(support, key):
    if key in support.supported:
        return "yes"
    return "ignored" if key in support.ignored else "no"


def _table(columns, rows):
    lines = [columns, ["---"] * len(columns), *rows]
    return "\n".join("| " + " | ".join(cell.replace("|", "\\|") for cell in line) + " |" for line in lines)


def main() -> None:
    """Write the page."""
    path = Path(sys.argv[1]) if len(sys.argv) > 1 else PAGE
    with write_whole(path) as file:
        file.write(page())
    print(f"written to {path}")


if __name__ == "__main__":
    main()
