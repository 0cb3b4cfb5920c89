"""Runs that several claims read are made once; the folder keeps each (`fabrics.run_cache`)."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, order=True)
class Run:
    """A computation by name, with its arguments as JSON."""

    name: str
    arguments: str

    @classmethod
    def of(cls, name: str, **arguments: Any) -> Run:
        """The run `name` of `runs.RUNS` with these arguments."""
        return cls(name, json.dumps(arguments, sort_keys=True))

    @property
    def keywords(self) -> dict[str, Any]:
        return json.loads(self.arguments)
