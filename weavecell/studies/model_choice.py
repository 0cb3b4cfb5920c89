"""Which model a scene needs: the cheapest that was enough in each like one of some scenes that were run in all models.
One that was enough in the nearest alone is not taken: like scenes differ by more than what it had to spare there.

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
from itertools import takewhile
from math import hypot, log
from typing import TYPE_CHECKING

from fabrics.assumed import friction_between_yarns
from fabrics.base.counted import counted

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
NEAR = 5.0  # [%] from the richest model within which another is enough
RICHEST = {NOSE: "resolved yarns", BULLET: "body of metal"}  # of the models that an impact has
# {model: what a heading of the table calls it}
HEADINGS = {
    "membrane, 1 element": "1 element",
    "membrane, 3 elements": "3 elements",
    **{name: name for name in ("resolved yarns", "rigid nose", "bar", "body of metal")},
}


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
    richest : the model that the others are held against
    off : {model: [%]} from the richest, with what is not known of it; of those that an impact has
    cpu : {model: CPU time [s]} of these and of the richest
    """

    name: str
    numbers: SceneNumbers
    richest: str
    off: Mapping[str, float]
    cpu: Mapping[str, float]

    @property
    def enough(self) -> list[str]:
        """The models that were enough, the cheapest first."""
        return sorted(
            (name for name, off in self.off.items() if off <= NEAR), key=self.cpu.__getitem__
        )


@dataclass(frozen=True)
class Advice:
    """The model that a scene needs, by the scenes that are like it.

    Parameters
    ----------
    model : name
    like : the nearest scene
    against : a like scene in which the cheapest model that was enough in the nearest is furthest from
        enough; None if it is enough in all
    others : number of like scenes beside the nearest
    """

    model: str
    like: KnownScene
    against: KnownScene | None
    others: int

    def __str__(self) -> str:
        like = self.like
        cheapest = next(iter(like.enough), self.model)
        if self.against is not None:
            off = f"is {self.against.off[cheapest]:.1f} % off in another, {self.against.name}"
            return f"{self.model}: {cheapest}, enough in the like shot {like.name}, {off}"
        if self.model == RICHEST[like.numbers.kind]:
            return f"{self.model}: no cheaper model is within 5 % in the like shot {like.name}"
        cost = like.cpu[self.model] / like.cpu[like.richest]
        words = (
            f"{self.model}, {like.off[self.model]:.1f} % off {like.richest} at {cost:.2g} of the CPU time in the like "
            f"shot {like.name}"
        )
        if not self.others:
            return words
        return f"{words}, and within 5 % in {counted(self.others, 'other')}"


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
    known = float(row["known to [%]"])
    off = {}
    cpu = {row["richest"]: float(row[f"CPU, {HEADINGS.get(row['richest'], row['richest'])} [s]"])}
    for model, heading in HEADINGS.items():
        if model == row["richest"]:
            off[model] = 0.0
        elif row.get(f"off, {heading} [%]"):
            off[model] = float(row[f"off, {heading} [%]"]) + known
            cpu[model] = float(row[f"CPU, {heading} [s]"])
    return KnownScene(row["scene"], numbers, row["richest"], off, cpu)


def find_advice(numbers: SceneNumbers) -> Advice | None:
    """Find the model that a scene needs; None if none of the scenes that were run is like it."""
    by_distance = sorted(known_scenes(), key=lambda scene: numbers.distance(scene.numbers))
    like = [scene for scene in by_distance if numbers.distance(scene.numbers) <= FAR]
    if not like:
        return None
    nearest = like[0]

    def find_worst(model):
        """The like scene in which a model is furthest off."""
        return max((one for one in like if model in one.off), key=lambda one: one.off[model])

    richest = RICHEST[numbers.kind]
    cheaper = list(takewhile(lambda model: model != richest, nearest.enough))
    good = [model for model in cheaper if find_worst(model).off[model] <= NEAR]
    against = None
    if cheaper and cheaper[0] not in good:
        against = find_worst(cheaper[0])
    return Advice(next(iter(good), richest), nearest, against, len(like) - 1)


def advise(setup: ImpactSetup, target: Panel | Pack) -> str:
    """Say which model the scene needs, in one line; arguments as of `describe`."""
    found = find_advice(describe(setup, target))
    if found is None:
        count = len(known_scenes())
        return f"model: none of the {count} scenes that were run in all models is like this one"
    return f"model: {found}"
