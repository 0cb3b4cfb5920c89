"""The judge of all charts: what a method costs, how far it is from the limit of the finest, and which none beats.

A scene's reference is not a run but the limit that its meshes extrapolate to (`validation.verification.richardson`).
Its uncertainty is given with it: the scatter of the extrapolation, a quarter of its step beyond the finest mesh,
and by how much finer choices of everything else (time step, table, tolerance) move the value.

Cost is CPU time of the process from the scene's data to its answer, filling of tables included: on a machine that is
shared, wall time says more about the others. Kernels are compiled before the clock starts.
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from math import isnan, nan
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from fabrics.errors import UnstableError
from validation.verification.richardson import Extrapolation, extrapolate

MARGIN = 0.1  # a more expensive method is listed if it reduces the error by a tenth: times are no better known
AIMED = 0.05  # [-] error whose cheapest method is named
ALIKE = 1e-4  # [-] of a value: errors below are all alike
ENOUGH = 0.6  # [s] of CPU time after which a run is not repeated
MOST = 5  # repeats


@dataclass(frozen=True)
class Quantity:
    """A computed quantity of a scene; errors of one group share a panel of its chart."""

    name: str
    unit: str
    group: str


@dataclass(frozen=True)
class Method:
    """One way to solve a scene: `choice` is what it varies, `name` what a reader calls it, `case` what is run."""

    choice: str
    name: str
    case: object


@dataclass(frozen=True)
class Scene:
    """A standard scene.

    Parameters
    ----------
    key, title, text : of the command line, of the chart, and of the page
    quantities : of Quantity
    methods : of Method; the first is the one that the code takes by default
    meshes : pairs (element size, case) of falling size, whose limit is the reference; none where `exact` is given
    finer : pairs (case, the same case with something else finer), which tell what else the reference is unsure of
    run : run(case) -> ({quantity: value}, {part: CPU time [s]}); raises UnstableError where a method fails
    warm : warm(case) -> a short case that compiles what the given one needs
    exact : {quantity: value} where there is a closed form
    """

    key: str
    title: str
    text: str
    quantities: tuple
    methods: tuple
    run: Callable
    warm: Callable
    meshes: tuple = ()
    finer: tuple = ()
    exact: dict | None = None

    @property
    def groups(self) -> dict[str, list[Quantity]]:
        """{group: [its quantities]} in their order."""
        found: dict[str, list[Quantity]] = {}
        for quantity in self.quantities:
            found.setdefault(quantity.group, []).append(quantity)
        return found

    @property
    def cases(self) -> list[Any]:
        """All cases once, cheapest kinds first."""
        found = (
            [m.case for m in self.methods] + [case for _, case in self.meshes] + [c for two in self.finer for c in two]
        )
        return list(dict.fromkeys(found))


@dataclass(frozen=True)
class Sample:
    """What one case came to: values or why it failed, and its cost.

    Parameters
    ----------
    values : {quantity: value}, empty where it failed
    cpu, wall : [s] medians
    parts : {part: CPU time [s]} of the last run
    repeats : runs that the medians are of
    failed : why, or empty
    """

    values: dict
    cpu: float
    wall: float
    parts: dict
    repeats: int
    failed: str = ""


@dataclass(frozen=True)
class Entry:
    """A method with its sample and its errors {quantity: [-]} in what it found."""

    method: Method
    sample: Sample
    errors: dict

    def worst(self, quantities: Iterable[Quantity]) -> float:
        """[-] largest error in some quantities; nan where one of them was not found."""
        found = [self.errors.get(q.name, nan) for q in quantities]
        return nan if any(map(isnan, found)) else max(found)


@dataclass(frozen=True)
class Reference:
    """The limit of a quantity: value, half width, and the extrapolation it comes from (None of a closed form)."""

    value: float
    half_width: float
    basis: Extrapolation | None

    @property
    def share(self) -> float:
        """[-] half width over value."""
        return self.half_width / abs(self.value)


@dataclass(frozen=True)
class Chart:
    """A judged scene.

    Parameters
    ----------
    scene : Scene
    references : {quantity: Reference}
    entries : of Entry, one a method
    fronts : {group: [entries that none other beats, cheapest first]}
    """

    scene: Scene
    references: dict
    entries: list
    fronts: dict

    @property
    def key(self) -> str:
        """Name of the scene on the command line."""
        return self.scene.key

    def unsure(self, group: str) -> float:
        """[-] largest half width of the references of a group."""
        return max(self.references[q.name].share for q in self.scene.groups[group])


_warm: set[Any] = set()


def timed(run: Callable[..., Any], warm: Callable[..., Any], case: Any, most: int = MOST) -> Sample:
    """Solve a case, over again while it is short; warm(case) before it, once for each case that it gives."""
    short = warm(case)
    if short not in _warm:
        run(short)
        _warm.add(short)
    cpu: list[float] = []
    wall: list[float] = []
    values, parts, failed = {}, {}, ""
    while len(cpu) < most and sum(cpu) < ENOUGH:
        clocks = time.process_time(), time.perf_counter()
        try:
            values, parts = run(case)
        except UnstableError as problem:
            failed = str(problem)
        cpu.append(time.process_time() - clocks[0])
        wall.append(time.perf_counter() - clocks[1])
        if failed:
            break
    return Sample(values, statistics.median(cpu), statistics.median(wall), parts, len(cpu), failed)


def judge(scene: Scene, samples: dict) -> Chart:
    """Hold solved cases {case: Sample} against the scene's reference."""
    references = {q.name: _reference(scene, samples, q.name) for q in scene.quantities}
    entries = []
    for method in scene.methods:
        values = samples[method.case].values
        errors = {name: abs(values[name] / found.value - 1) for name, found in references.items() if name in values}
        entries.append(Entry(method, samples[method.case], errors))
    return Chart(scene, references, entries, fronts(scene, references, entries))


def fronts(scene: Scene, references: dict[str, Reference], entries: Sequence[Entry]) -> dict[str, list[Entry]]:
    """{group: [entries that none other beats, cheapest first]}; within what is known of the reference all are alike."""
    cost, found = [entry.sample.cpu for entry in entries], {}
    for group, quantities in scene.groups.items():
        known = max(ALIKE, *(references[q.name].share for q in quantities))
        errors = [max(entry.worst(quantities), known) for entry in entries]
        found[group] = [entries[i] for i in non_dominated(cost, errors, MARGIN)]
    return found


def non_dominated(cost: ArrayLike, error: ArrayLike, margin: float = 0.0) -> list[int]:
    """Numbers of the methods of which none other is at most as dear and at most as wrong, and better in one of the two.

    Parameters
    ----------
    cost, error : (n,) of each method; one that is not a number dominates nothing and is left out
    margin : share of the error that a dearer method has to take off the next cheaper one's to be named

    Returns
    -------
    list of int, from the cheapest to that of the lowest error
    """
    cost, error = np.asarray(cost, float), np.asarray(error, float)
    good = [int(i) for i in np.flatnonzero(np.isfinite(cost) & np.isfinite(error))]
    kept, least = [], np.inf
    for i in sorted(good, key=lambda i: (cost[i], error[i])):
        if error[i] < least:
            kept.append(i)
            least = (1 - margin) * error[i]
    return kept


def _reference(scene, samples, name):
    if scene.exact is not None:
        return Reference(scene.exact[name], 0.0, None)
    sizes = [size for size, _ in scene.meshes]
    values = [samples[case].values[name] for _, case in scene.meshes]
    found = extrapolate(sizes, values)
    moved = sum(abs(samples[fine].values[name] - samples[case].values[name]) for case, fine in scene.finer)
    half = found.scatter + 0.25 * abs(found.limit - values[-1]) + moved
    return Reference(float(found.limit), float(half), found)
