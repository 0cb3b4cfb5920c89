"""The choices that the study varies, each alone about the base, from scene.toml."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass, replace
from importlib import resources
from typing import Any

from unitcell3d.model.crossover import Numerics
from validation.verification.crossover_convergence.cases import Case

CONTENT: dict[str, Any] = tomllib.loads(
    resources.files("validation.verification.crossover_convergence").joinpath("scene.toml").read_text("utf-8")
)
BASE = Case()
METHOD, MODEL = "method", "model"


@dataclass(frozen=True)
class Axis:
    """One choice.

    Parameters
    ----------
    name : of the choice
    kind : METHOD or MODEL
    cases : {label: Case}
    x : {label: number} that goes to zero as the method gets exact; None where there is no such number
    unit : of x, for the reader
    counted : the reference is moved by its limit
    lead : what the page says of it first
    """

    name: str
    kind: str
    cases: dict
    x: dict | None = None
    unit: str = ""
    counted: bool = True
    lead: str = ""


def axes(level: str = "full") -> list[Axis]:
    """All axes, the mesh first; `level`: "quick", "full" or "fine"."""
    return [_axis(dict(entry), CONTENT["levels"][level] if n == 0 else None) for n, entry in enumerate(CONTENT["axis"])]


def _axis(entry, most):
    """The axis of an entry, with its first `most` cases."""
    if "field" in entry:
        field, power = entry.pop("field"), entry.pop("power")
        rows: list[Any] = [
            (_factor(f), {} if f == 1 else {"numerics": {field: f}}, f**power) for f in entry.pop("factors")
        ]
    else:
        rows = entry.pop("cases")[:most]
    x = {label: number for label, _, *places in rows for number in places}
    return Axis(cases={label: _case(changes) for label, changes, *_ in rows}, x=x or None, **entry)


def _factor(f):
    return "default" if f == 1 else f"x {f:g}" if f > 1 else f"/ {1 / f:g}"


def _case(changes):
    """The base with changes; those of Numerics but friction are factors on their defaults."""
    changes = dict(changes)
    if "numerics" in changes:
        [(name, value)] = changes["numerics"].items()
        changes["numerics"] = {name: value if name == "friction" else getattr(Numerics(), name) * value}
    pairs = {name: tuple(changes[name].items()) for name in ("numerics", "steps", "solids") if name in changes}
    size = {"size": tuple(changes["size"])} if "size" in changes else {}
    return replace(BASE, **changes | pairs | size)
