"""Maps of where a method works: points that are run, each with what happened, and the default's margin.

A point is STABLE where the run ends and its answer is good, WRONG where it ends quietly with an answer that is off by
more than the map allows, FAILED where a guard stopped it with a message (fabrics.errors.UnstableError, exit code 3).
A number that the user sets directly has its edge looked for along its axis, from the default outwards, by bisection
between the last stable value and the first that is not. The margin is the ratio of edge and default, above 1.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from math import sqrt
from typing import Any

from fabrics.errors import UnstableError

STABLE, WRONG, FAILED = "stable", "wrong", "failed"
MARGIN_TARGET = 1.5  # margin
ABOVE, BELOW = "above", "below"
HALVINGS = 5  # of the ratio between a stable and an unstable value


@dataclass(frozen=True)
class Axis:
    """One direction of a map: its name, and the values that are run (numbers, or texts).

    unit : that the name tells, in the values' own: 1e-3 where values are [m] and the name says [mm]
    """

    name: str
    values: tuple
    unit: float = 1.0

    def label(self, value: float) -> str:
        """What a reader calls a value."""
        return value if isinstance(value, str) else f"{value / self.unit:g}"


@dataclass(frozen=True)
class Outcome:
    """What a point came to: kind, a number to print there (None: none), the message of a guard or a remark, and the
    quality indicators (`shellfabric.panel.quality`) of its run."""

    kind: str
    value: float | None = None
    message: str = ""
    checks: tuple = field(default=(), compare=False)  # of the run itself; not in the map's table


@dataclass(frozen=True)
class Map:
    """A question to a method.

    Parameters
    ----------
    key, title, text : of files, of the picture, and of the page
    x, y : Axis
    point : point(x, y) -> Outcome
    number : what the numbers in the cells are
    wrong : what counts as wrong
    guard : what catches a failure
    default : (x, y) that the code takes by default, or None where it takes none of the points
    sides : of ABOVE, BELOW: towards which of them the default's x could leave the stable region
    rows : values of y whose edges are looked for too
    failed : what a failure is called
    """

    key: str
    title: str
    text: str
    x: Axis
    y: Axis
    point: Callable
    number: str = ""
    wrong: str = ""
    guard: str = ""
    default: tuple | None = None
    sides: tuple = ()
    rows: tuple = ()
    failed: str = "stopped by a guard"

    @property
    def points(self) -> list[tuple[Any, Any]]:
        """(x, y) of the map; the default is one of them."""
        found = [(x, y) for y in self.y.values for x in self.x.values]
        return found if self.default is None or self.default in found else [*found, self.default]


@dataclass(frozen=True)
class Edge:
    """Where the stable region ends on one side of the default.

    Parameters
    ----------
    y : of the row
    side : ABOVE or BELOW
    value : the edge; the end of the axis where none was met
    met : whether there is an edge on the axis
    margin : [-] ratio of edge and default, above 1 where the default is inside
    beyond : Outcome of the nearest point beyond, or None
    """

    y: object
    side: str
    value: float
    met: bool
    margin: float
    beyond: Outcome | None

    @property
    def enough(self) -> bool:
        return self.margin >= MARGIN_TARGET


@dataclass(frozen=True)
class Found:
    """A map that has been run: {(x, y): Outcome} and its edges."""

    map: Map
    outcomes: dict
    edges: tuple

    @property
    def key(self) -> str:
        """Name of the map on the command line."""
        return self.map.key

    def count(self, kind: str) -> int:
        """Points of a kind."""
        return sum(outcome.kind == kind for outcome in self.outcomes.values())


def guarded(run: Callable[[], Any]) -> Outcome:
    """What run() -> Outcome came to, FAILED where a guard stopped it."""
    try:
        return run()
    except UnstableError as problem:
        return Outcome(FAILED, None, str(problem))


def explore(chart: Map, solve: Callable[..., Any], halvings: int = HALVINGS) -> Found:
    """Run a map.

    Parameters
    ----------
    chart : Map
    solve : solve([(x, y), ...]) -> [Outcome, ...]
    halvings : of the ratio between the last stable value and the first that is not
    """
    outcomes = dict(zip(chart.points, solve(chart.points)))
    rows = [chart.default[1], *(y for y in chart.rows if y != chart.default[1])] if chart.sides else []
    edges = tuple(_edge(chart, outcomes, y, side, solve, halvings) for y in rows for side in chart.sides)
    return Found(chart, outcomes, edges)


def _edge(chart, outcomes, y, side, solve, halvings):
    start = chart.default[0]
    beyond = sorted((x for x in chart.x.values if (x > start if side == ABOVE else x < start)), reverse=side == BELOW)
    inside, outside = start, None
    for x in beyond:
        if outcomes[x, y].kind != STABLE:
            outside = x
            break
        inside = x
    if outcomes[start, y].kind != STABLE:
        return Edge(y, side, start, True, 1.0, outcomes[start, y])
    if outside is None:
        return Edge(y, side, inside, False, _margin(start, inside, side), None)
    worst = outcomes[outside, y]
    for _ in range(halvings if outside > 0 else 0):
        middle = sqrt(inside * outside)
        [outcome] = solve([(middle, y)])
        if outcome.kind == STABLE:
            inside = middle
        else:
            outside, worst = middle, outcome
    return Edge(y, side, inside, True, _margin(start, inside, side), worst)


def _margin(start, edge, side):
    return edge / start if side == ABOVE else start / edge
