"""Which model a scene needs: the one that was enough in the nearest of some scenes that were run in all models.

models_of_scenes.csv is a copy of the table of `python -m validation study models-of-scenes`, which `python
tools/pages.py` makes. Scenes are alike by the kind of the projectile, the width of its nose in spacings of the yarns,
its velocity over that with which a search for the limit begins, the number of plies, and the friction between yarns.
"""

from __future__ import annotations

import csv
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib import resources
from math import hypot, log
from typing import TYPE_CHECKING

from fabrics.assumed import friction_between_yarns

if TYPE_CHECKING:
    from shellfabric.impact.setup import ImpactSetup
    from shellfabric.membrane.model import Panel
    from shellfabric.plies.model import Pack

FILE = "models_of_scenes.csv"
BULLET = "bullet"
NOSE = "nose"
# steps that count alike: factors on nose, velocity and plies; of the friction a difference
FACTORS = {"nose": 2.0, "velocity": 1.5, "plies": 3.0}
FRICTION = 0.15
FAR = 1.5  # steps from which on a scene is not like another


@dataclass(frozen=True)
class SceneNumbers:
    """What decides which model a scene needs.

    Parameters
    ----------
    kind : BULLET of a body that deforms, or NOSE of a rigid one
    nose : [-] diameter of the projectile over the smaller spacing of the yarns of the struck ply
    velocity : [-] over that with which a search for the limit begins
    plies : number
    friction : [-] between yarns where they slip
    """

    kind: str
    nose: float
    velocity: float
    plies: float
    friction: float

    def distance(self, other: SceneNumbers) -> float:
        """Compute how many steps of FACTORS and FRICTION another scene is away [-]; infinite of
        another kind."""
        if self.kind != other.kind:
            return float("inf")
        steps = [(self.friction - other.friction) / FRICTION]
        for name, factor in FACTORS.items():
            steps.append(log(getattr(self, name) / getattr(other, name)) / log(factor))
        return hypot(*steps)


@dataclass(frozen=True)
class KnownScene:
    """A scene that was run in several models.

    Parameters
    ----------
    name : in words
    numbers : SceneNumbers
    cheapest : the cheapest model within 5 % of the richest
    richest : the model that the others are held against
    off : [%] of the cheapest
    cost : [-] CPU time of the cheapest over that of the richest
    """

    name: str
    numbers: SceneNumbers
    cheapest: str
    richest: str
    off: float
    cost: float

    def __str__(self) -> str:
        if self.cheapest == self.richest:
            return f"{self.cheapest}: no cheaper model is within 5 % in the like shot {self.name}"
        return (
            f"{self.cheapest}, {self.off:.1f} % off {self.richest} at {self.cost:.2g} of the CPU time in the like "
            f"shot {self.name}"
        )


def describe(setup: ImpactSetup, target: Panel | Pack) -> SceneNumbers:
    """Return the numbers of a scene whose panel or pack is `target`."""
    from weavecell.studies.ballistic_limit import first_guess

    kind = NOSE
    if setup.projectile.body == "metal":
        kind = BULLET
    zone = setup.crossovers or setup.instead
    friction = friction_between_yarns(setup.fabric).value
    if zone is not None:
        friction = zone.friction
    return SceneNumbers(
        kind,
        setup.projectile.radius / min(setup.fabric.weave.w),
        setup.strike_velocity / first_guess(target),
        float(setup.plies),
        friction,
    )


@cache
def known_scenes() -> tuple[KnownScene, ...]:
    """Read the scenes that were run."""
    text = (resources.files("weavecell.studies") / FILE).read_text("utf-8")
    lines = text.splitlines()[1:]
    return tuple(_scene_of(row) for row in csv.DictReader(lines))


def _scene_of(row: Mapping[str, str]) -> KnownScene:
    numbers = SceneNumbers(
        row["kind"],
        nose=float(row["nose"]),
        velocity=float(row["velocity"]),
        plies=float(row["plies"]),
        friction=float(row["friction"]),
    )
    return KnownScene(
        row["scene"],
        numbers,
        row["cheapest within 5 %"],
        row["richest"],
        float(row["off [%]"]),
        float(row["CPU over that of the richest"]),
    )


def find_nearest(numbers: SceneNumbers) -> KnownScene | None:
    """Find the nearest of the scenes that were run; None if none is like the one of these numbers."""
    nearest = min(known_scenes(), key=lambda scene: numbers.distance(scene.numbers))
    if numbers.distance(nearest.numbers) > FAR:
        return None
    return nearest


def advise(setup: ImpactSetup, target: Panel | Pack) -> str:
    """Say which model the scene needs, in one line; arguments as of `describe`."""
    like = find_nearest(describe(setup, target))
    if like is None:
        count = len(known_scenes())
        return f"model: none of the {count} scenes that were run in all models is like this one"
    return f"model: {like}"
