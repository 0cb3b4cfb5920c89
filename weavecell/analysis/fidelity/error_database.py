"""What the models of single plies are known to get wrong: errors.json, which the survey makes
(`validation.verification.fidelity`). No survey foretells the errors of packs: their answers are held against a coarser
mesh.

For each regime (`quantities.regime`) and quantity
    scenes     how many it is known from
    usual      how far two scouts are apart in the median
and there for each model
    factor     of `quantities.scale`, what its error against the full model stays below in 97 scenes of a hundred
    apart      likewise, of its distance from its partner, in all scenes
    weight     of the partner's peak tensions in its own
    expected   the error that four scenes of five stay below, whatever the scale
and for each model
    cost       process time of its run over that of the full model, the median
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from importlib import resources
from math import inf
from typing import TYPE_CHECKING, Any

from weavecell.analysis.fidelity import quantities
from weavecell.analysis.fidelity.ladder import PACK_DEFAULT, PACK_FULL

if TYPE_CHECKING:
    from weavecell.analysis.fidelity.ladder import Model

FILE = "errors.json"
_PACK_COST = 0.48  # of the default mesh of packs over the finer one, the median of 56 drawn packs


@dataclass(frozen=True)
class Book:
    """errors.json as it is.

    Parameters
    ----------
    models : {model: {"cost": [-]}}
    regimes : {regime: {quantity: {"scenes", "usual", "models": {model: {"factor", "apart", "expected", "weight"}}}}}
    finest : {regime: {quantity: [-] what the full model itself is expected to be off by}}
    others : {method: {"cost": [-], "expected": {quantity: [-]}}} of methods that are there to compare with
    made : how it was made
    """

    models: dict
    regimes: dict
    finest: dict
    others: dict
    made: dict

    def cost(self, model: Model) -> float:
        """[-] of the full model's."""
        return self.models.get(model.name, {}).get("cost", inf)

    def expected(self, model: Model, name: str) -> float:
        """[-] error in the worse of the regimes, before anything is known of a scene; infinite where none is known."""
        found = [known[name]["models"] for known in self.regimes.values() if name in known]
        return max((each[model.name]["expected"] for each in found if model.name in each), default=inf)

    def of_mesh(self, name: str, regime: str) -> dict[str, tuple[int, float, float]]:
        """{quantity: (scenes, error, error of the full model)} of a model by its name, of the quantities that a regime
        has: the error that four scenes of five of the regime stay below. Empty of a model that was not surveyed."""
        found = {}
        for quantity, known in self.regimes.get(regime, {}).items():
            own = self.own(quantity, regime)  # 0 of the residual velocity of a panel that holds
            if name in known["models"] and own > 0:
                found[quantity] = (known["scenes"], known["models"][name]["expected"], own)
        return found

    def bound(self, model: Model, name: str, seen: Sequence[dict[str, Any]]) -> float:
        """[-] what the error of a model is below, of a scene of which two scouts have `seen` (finer, coarser).

        A hasty shot (`quantities.hasty`) is none for elements of a crossover and more.
        """
        if quantities.is_defined(name, quantities.regime(seen[0])) and quantities.hasty(seen[0]) and model.coarse:
            return inf
        return self._times("factor", model, name, seen)

    def apart(self, model: Model, name: str, seen: Sequence[dict[str, Any]]) -> float:
        """[-] how far its answer may be from what it is held against, before the scene is unlike the survey's."""
        return self._times("apart", model, name, seen)

    def weight(self, model: Model, regime: str) -> float:
        """[-] of the partner's peak tensions in the model's."""
        known = self.regimes.get(regime, {}).get("peak_tension", {"models": {}})
        return known["models"].get(model.name, {}).get("weight", 0.0)

    def own(self, name: str, regime: str | None = None) -> float:
        """[-] what the full model is itself expected to be off by, in the worse regime where none is given; 0 where
        nothing is known."""
        regimes = self.finest if regime is None else (regime,)
        return max((self.finest.get(each, {}).get(name, 0.0) for each in regimes), default=0.0)

    def _times(self, key, model, name, seen):
        regime = quantities.regime(seen[0])
        if not quantities.is_defined(name, regime):
            return 0.0  # what is not there is not wrong
        known = self.regimes.get(regime, {}).get(name)
        if known is None or model.name not in known["models"]:
            return inf
        bound = known["models"][model.name][key] * quantities.scale(name, *seen, known["usual"])
        return bound if bound == bound else inf


def load(*, packs: bool = False) -> Book:
    """The Book of the package, of single plies; of packs one that knows costs alone."""
    if packs:
        return Book({PACK_DEFAULT: {"cost": _PACK_COST}, PACK_FULL: {"cost": 1.0}}, {}, {}, {}, {})
    file = resources.files("weavecell.analysis.fidelity") / FILE
    return Book(**json.loads(file.read_text("utf-8")))
