"""JSON Schemas of scene files, with which editors complete and check."""

from __future__ import annotations

from typing import Any

from weavecell.scenes import supported
from weavecell.scenes.schema import Table


def json_schema(model: type[Table]) -> dict[str, Any]:
    """The JSON Schema of a scene file as it is written: quantities are texts with a unit.

    Parameters
    ----------
    model : Scene or CouponScene
    """
    schema, meanings = model.model_json_schema(), {entry.title for entry in supported.entries(model).values()}
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
