"""What the models are known to get wrong: errors.json, written by the survey (`python -m validation.fidelity survey`).

For each model and quantity
    expected   the error against the full model that four scenes out of five stay below
    typical    the median error
    factor     times the difference from the model's check, what its error stays below in 19 scenes out of 20
    cost       process time of its run over that of the full model, the median
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from importlib import resources
from math import inf

FILE = "errors.json"


@dataclass(frozen=True)
class Book:
    """errors.json as it is: {model: {quantity: {"expected", "typical", "factor"}, "cost"}}, and how it was made."""

    models: dict
    made: dict

    def expected(self, model, quantity):
        """[-] share; infinite where the survey knows none."""
        return self.models.get(model.name, {}).get(quantity, {}).get("expected", inf)

    def estimate(self, model, quantity, difference):
        """[-] what the error is below, from the difference between a model's answer and its check's."""
        known = self.models.get(model.name, {}).get(quantity)
        return inf if known is None else max(known["factor"] * difference, known["typical"])

    def cost(self, model):
        """[-] of the full model's."""
        return self.models.get(model.name, {}).get("cost", inf)


def load():
    """The Book of the package."""
    text = (resources.files("validation.fidelity") / FILE).read_text("utf-8")
    content = json.loads(text)
    return Book(content["models"], content["made"])
