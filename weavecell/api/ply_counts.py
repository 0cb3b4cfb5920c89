"""How many plies of which fabric stop a threat, with a given probability.

The folder has, beside runs/ with a file for each run, report.html, plies.json, plies.csv (a row a fabric),
shots.csv, shares.csv (the picture), plies.svg and scene.toml.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import cache, cached_property
from math import nan
from typing import TYPE_CHECKING, Any, Unpack

from fabrics.base.checks import FilePath
from fabrics.base.counted import counted
from fabrics.base.door import option
from fabrics.base.errors import InputError, InputErrors, UnstableError, together
from fabrics.base.frozen import explain_frozen
from fabrics.fabric import Fabric
from shellfabric.plies.pack_keys import MOST_PLIES, PackKeys
from weavecell.answers.study_result import DrawnStudy
from weavecell.api import quantities
from weavecell.api.command import Plan, Running, command
from weavecell.api.execution import ResumableKeywords, StudyKeywords
from weavecell.api.keywords import Keywords, explain_keywords
from weavecell.api.run_size import StudySize
from weavecell.api.target import is_input_file, is_setup, resolve_target
from weavecell.results import out_folder
from weavecell.results.finding import Answer, Mover

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from pandas import DataFrame

    from shellfabric.impact.setup import ImpactSetup
    from weavecell.answers.target import Target
    from weavecell.report.page import Section
    from weavecell.runs.measurement import Count, Measurement
    from weavecell.runs.plies import PliesOfFabric, V50Test

NAMES = (
    "plies.json",
    "plies.csv",
    "shots.csv",
    "shares.csv",
    "plies.svg",
    *out_folder.INPUT,
    "report.html",
)
TEST = "PLIES plies: V50, such as '5 plies: 290 m/s', or 'S-728, 5 plies: 290 m/s' of one of several fabrics"
_TEST = re.compile(r"(?:(?P<fabric>.+),)?\s*(?P<plies>\d+)\s*pl(?:y|ies)\s*:\s*(?P<velocity>.+)")
# said by other options, or what is asked for
_SAID = {"projectile": "stop", "plies": "", "ply": "", "areal_density": ""}


@dataclass(frozen=True)
class PliesPlan(Plan["PliesResult"]):
    """Shots at packs of fabrics that are about to be fired.

    Parameters
    ----------
    fabrics : names, files, or Fabrics
    options : keywords of `setup`, with the projectile
    velocity, sure : [m/s] that is to be stopped, and with which probability
    shots, seed : number of shots at each fabric, and of all random numbers
    tests : of each fabric
    """

    files = NAMES

    fabrics: tuple[Any, ...]
    options: Mapping[str, Any]
    stop: str
    velocity: float
    sure: float
    shots: int
    seed: int
    tests: tuple[tuple[V50Test, ...], ...]

    def target_of(self, fabric: Any, plies: int) -> Target:
        """Resolve the Target of so many plies."""
        options = {**self.options, "plies": plies}
        if plies == 1:
            options = {key: value for key, value in options.items() if not hasattr(PackKeys, key)}
        try:
            panel = resolve_target(fabric, options, "v50", self.velocity, function="plies")
        except InputError as problem:
            raise _name_options(problem) from None
        return panel.resolved()

    def setups_of(self, fabric: Any) -> Callable[[int], ImpactSetup]:
        """Return the set-up as it is fired at, of a count of plies."""
        from weavecell.runs import table

        return cache(lambda plies: table.as_fired(self.target_of(fabric, plies).setup))

    @property
    def inputs(self) -> Sequence[object]:
        """What is fired at, and seed: velocities, counts and shots follow, and are found by themselves."""
        from weavecell.studies import inputs

        setups = [self.setups_of(fabric)(2) for fabric in self.fabrics]
        alike = [inputs.use_one_thread(setup, strike_velocity=1.0) for setup in setups]
        return [("plies", *alike, inputs.read_scatter(), self.seed)]

    def forecast(self) -> StudySize:
        """Forecast shots and CPU time, at the counts that are guessed."""
        from weavecell.runs import plies

        names, parts = [], []
        for fabric in self.fabrics:
            setup_of = self.setups_of(fabric)
            target = self.target_of(fabric, plies.guess_count(setup_of, self.velocity))
            setup = setup_of(target.setup.plies)
            words: dict[str, Any] = {"scene": target.scene, "drawn": True}
            parts.append(StudySize.estimate(setup, target.title, self.shots, 0, **words))
            names.append(target.title)
        return StudySize.add_up(f"plies that stop {self.stop}", names, parts)

    def run(self, running: Running) -> PliesResult:
        """Fire at each."""
        from weavecell.report.chapters_discretisation import read_scored
        from weavecell.runs import plies, v50
        from weavecell.studies import inputs

        scatter, error = inputs.read_scatter(), plies.find_error(read_scored())
        found: list[PliesOfFabric] = []
        targets: list[Target] = []
        with running.count(f"plies that stop {self.stop}") as part:
            for number, (fabric, tests) in enumerate(zip(self.fabrics, self.tests)):
                one = plies.study(
                    self.setups_of(fabric),
                    scatter,
                    error,
                    velocity=self.velocity,
                    sure=self.sure,
                    shots=self.shots,
                    batch=v50.BATCH,
                    seed=self.seed,
                    tests=tests,
                    report=part(number, len(self.fabrics)),
                    **running.cache,
                )
                found.append(one)
                count = one.by_tests.plies if one.posterior is not None else one.reference
                targets.append(self.target_of(fabric, min(count, MOST_PLIES)))
        result = PliesResult(tuple(found), tuple(targets), self.stop, self.seed, running.wall_time)
        running.save(result)
        failures = [failure for one in found for failure in one.failures]
        if failures:
            lost = f"{counted(len(failures), 'shot')} left out of all estimates"
            running.failure = UnstableError(f"{lost}: {failures[0]}", result=result)
        return result


@command(PliesPlan)
@explain_keywords(ResumableKeywords, Keywords)
def plies(
    fabrics: list[Fabric | FilePath] | tuple[Fabric | FilePath, ...] | Fabric | FilePath,
    *,
    stop: str | Mapping[str, Any],
    at: float | str,
    sure: float = 0.9,
    test: list[str] | str | None = None,
    shots: int | None = None,
    check: bool = False,
    seed: int = 1,
    **options: Unpack[StudyKeywords],
) -> PliesPlan:
    """Find the fewest plies of each fabric that stop a threat with a probability, over all that nobody gave.

    Drawn shots, as those of `v50`, hit packs of several counts of plies. The count has two columns: by the model
    alone, and with what tests say of the model, by the rows that were scored. An own V50 narrows the second.
    Fabrics are ranked by areal density; those whose order is not decided say so.

    The folder `out` then has report.html, plies.json, plies.csv, plies.svg, shots.csv, shares.csv, scene.toml of the
    first fabric, and runs/ with a file for each shot.

    Parameters
    ----------
    fabrics : names of fabrics or their files; in Python also Fabrics, in a list or one alone
    stop : the threat, name of a projectile, such as "FSP 1.10 g"; in Python also a dict of its keys
    at : its strike velocity [m/s], such as "300 m/s"
    sure : probability that it is stopped
    test : a V50 that was tested, PLIES plies: V50, such as "5 plies: 290 m/s", with the fabric before it of several
    shots : number of shots at each fabric, at least 4; if not given 16
    check : run nothing and write nothing: forecast shots and CPU time
    seed : seed of all random numbers
    **options : jobs, executor, out and resume; keywords of `setup` but projectile, plies,
        areal_density, ply and history

    Returns
    -------
    PliesResult

    Raises
    ------
    InputError : as `v50`, an input file in place of a fabric, or a probability that is none
    UnstableError : shots without an outcome; its attribute `result` is the PliesResult of the others

    Examples
    --------
    >>> found = wc.plies("S-728", stop="FSP 1.10 g", at="120 m/s", shots=4, opening="50 mm")
    >>> found.counts["S-728"].plies
    4
    """
    from weavecell.runs import v50

    listed = list(fabrics) if isinstance(fabrics, (list, tuple)) else [fabrics]
    for one in listed:
        if is_setup(one) or (isinstance(one, str) and is_input_file(one)):
            allowed = "a fabric, its file or its name: an input file has its plies"
            raise InputError(key="fabrics", value=str(one), allowed=allowed)
    names = [str(getattr(one, "name", one)) for one in listed]
    if not listed or len(set(names)) < len(names):
        raise InputError(key="fabrics", value=names, allowed="one fabric or more, each once")
    if not stop:
        raise InputError(key="stop", value=stop, allowed="a projectile, such as 'FSP 1.10 g'")
    for key, other in _SAID.items():
        if options.get(key) is not None:
            allowed = f"given as {option(other)}" if other else "left out: it is what is asked for"
            raise InputError(key=key, value=options[key], allowed=allowed)  # type: ignore[literal-required]
    chance = quantities.number(sure, "", "sure")
    if not 0 < chance < 1:
        raise InputError(key="sure", value=sure, allowed="a probability between 0 and 1")
    sizes = {
        "shots": quantities.read_whole(v50.USUAL if shots is None else shots, "shots", v50.LEAST),
        "seed": quantities.read_whole(seed, "seed", 0),
    }
    velocity = quantities.read_positive(at, "m/s", "at")
    tests = _read_tests([test] if isinstance(test, str) else test or [], names)
    threat = stop if isinstance(stop, str) else "the projectile"
    setups = {**options, "projectile": stop}
    made = PliesPlan(tuple(listed), setups, threat, velocity, chance, **sizes, tests=tests)
    for one in listed:
        # refused before the first shot
        made.target_of(one, 2)
    return made


def _name_options(problem):
    """Return the problem of a set-up with the arguments of `plies` that it is of."""
    if isinstance(problem, InputErrors):
        return together([_name_options(part) for part in problem.problems])
    given = {"target": "fabrics", "velocity": "at"}
    key = (problem.key or "").replace("projectile", "stop", 1)
    return problem.changed(key=given.get(key, key) or None)


def _read_tests(texts, names):
    """Return the V50Tests of each fabric.

    Raises
    ------
    InputError : a text of another form, or of no fabric or of none of these
    """
    from weavecell.runs.plies import V50Test

    found: dict[str, list[V50Test]] = {name: [] for name in names}
    for text in texts:
        parts = _TEST.fullmatch(text.strip())
        if parts is None or not 1 <= int(parts["plies"]) <= MOST_PLIES:
            raise InputError(key="test", value=text, allowed=TEST)
        name = (parts["fabric"] or names[0]).strip()
        if name not in found or (parts["fabric"] is None and len(names) > 1):
            raise InputError(
                key="test", value=text, allowed=f"of one of {', '.join(names)}; {TEST}"
            )
        velocity = quantities.read_positive(parts["velocity"], "m/s", "test")
        found[name].append(V50Test(int(parts["plies"]), velocity))
    return tuple(map(tuple, found.values()))


@dataclass(frozen=True)
class FabricRow:
    """A row of the table: a fabric, its plies and what they weigh.

    Parameters
    ----------
    fabric : its name
    plies, plies_low, plies_high : with what tests say of the model; None where all outcomes are alike
    model, model_low, model_high : by the model alone
    areal_density, thickness : [kg/m2], [m] of these plies
    v50, low, high : [m/s] of that pack, as tests say
    margin : [-] of this V50 over the velocity that is stopped, less 1
    group : number among groups by areal density, the lightest 1; fabrics of one are not decided
    """

    fabric: str
    plies: int | None
    plies_low: int | None
    plies_high: int | None
    model: int | None
    model_low: int | None
    model_high: int | None
    areal_density: float
    thickness: float
    v50: float
    low: float
    high: float
    margin: float
    group: int


@explain_frozen
@dataclass(frozen=True, repr=False)
class PliesResult(DrawnStudy):
    """The fewest plies of each fabric that stop a threat; the table has a row a fabric.

    Parameters
    ----------
    found : tuple of `weavecell.runs.plies.PliesOfFabric`, of each fabric
    targets : tuple of Target, each with the plies that were found
    stop : the threat in words
    seed : of the shots
    wall_time : [s]

    Examples
    --------
    >>> found = wc.plies("S-728", stop="FSP 1.10 g", at="120 m/s", shots=4, opening="50 mm")
    >>> found.by_model["S-728"].plies <= found.counts["S-728"].plies
    True
    """

    kind = "ply_counts"

    found: tuple[PliesOfFabric, ...]
    targets: tuple[Target, ...]
    stop: str
    seed: int
    wall_time: float

    @property
    def target(self) -> Target:  # type: ignore[override]
        """The first."""
        return self.targets[0]

    @property
    def names(self) -> list[str]:
        """Names of the fabrics."""
        return [target.setup.fabric.name for target in self.targets]

    @property
    def title(self) -> str:
        return f"plies that stop {self.stop} at {self.velocity:g} m/s in {100 * self.sure:g} % of shots"

    @property
    def velocity(self) -> float:
        """[m/s] that is stopped."""
        return self.found[0].velocity

    @property
    def sure(self) -> float:
        """Probability of a stop that was asked for."""
        return self.found[0].sure

    @property
    def counts(self) -> dict[str, Count]:
        """{fabric: (plies, low, high)} with what tests say of the model; without those that are not determined."""
        return {name: one.by_tests for name, one in self._known.items()}

    @property
    def by_model(self) -> dict[str, Count]:
        """{fabric: (plies, low, high)} by the model alone."""
        return {name: one.by_model for name, one in self._known.items()}

    @property
    def _known(self):
        of_each = dict(zip(self.names, self.found))
        return {name: one for name, one in of_each.items() if one.posterior is not None}

    @property
    def groups(self) -> list[list[str]]:
        """Fabrics by areal density, the lightest first; the order within a group is not decided. An error of the
        model that two fabrics share cancels."""
        from weavecell.runs.plies import group, real_counts

        masses = {}
        for name, one in self._known.items():
            real = real_counts(one.posterior, one.reference, one.velocity, one.sure)
            masses[name] = real * self._weave(name).areal_density
        return group(masses)

    def _weave(self, name):
        return self.targets[self.names.index(name)].setup.fabric.weave

    @property
    def doubts(self) -> tuple[str, ...]:
        """How many shots have which checks beyond their limits; and an order that pinned yarns do not decide."""
        from weavecell.runs.passing import count_doubts
        from weavecell.studies import choice

        counts = [
            f"{name}: {doubt}"
            for name, one in zip(self.names, self.found)
            for doubt in count_doubts(one.shots, one.failures)
        ]
        order = choice.doubt_order([target.setup for target in self.targets])
        return (*counts, *(order if len(self.found) > 1 else ()))

    @property
    def answer(self) -> Answer:
        """The plies of each fabric, and what to measure first."""
        from weavecell.runs import v50
        from weavecell.studies import unknown

        ranked = [name for group in self.groups for name in group]
        lost = [name for name in self.names if name not in ranked]
        shots = [shot for one in self.found for shot in one.shots]
        passed = sum(shot.perforated for shot in shots)
        parts = [f"{counted(len(shots), 'drawn shot')}, {passed} pass"]
        alike = [f"{name} not determined: all outcomes are alike" for name in lost]
        if not ranked:
            return self._find_answer(self.title, "; ".join(alike), over=parts[0])
        shown = ranked[:2]
        others = [f"{len(ranked) - 2} more"] if len(ranked) > 2 else []
        value = ", ".join([f"{name} {self.counts[name].words()}" for name in shown] + others)
        model = ", ".join(self.by_model[name].words() for name in shown)
        rows = {row.fabric: row for row in self._items()}
        weights = " and ".join(f"{rows[name].areal_density:.3g}" for name in shown)
        parts.append(f"{weights} kg/m²")
        if len(ranked) > 1:
            first = self.groups[0]
            decided = f"{first[0]} is lightest" if len(first) == 1 else "lightest not decided"
            parts[-1] += f", {decided}"
        least = self._known[ranked[0]]
        # the least plies are those of the first; a test of its V50 has no mover beside which it stands
        advice = tuple(one.advice for one in least.measure(ranked[0])[:2] if one.is_worth)
        movers = [
            Mover(name, unknown.ADVICE.get(name, ""), width, len(least.shots) >= v50.MANY)
            for name, width in least.moved.items()
        ]
        said = "; ".join([f"plies: {value}; by the model alone {model}", *alike])
        return self._find_answer(self.title, said, movers, advice, over="; ".join(parts))

    @cached_property
    def measurements(self) -> tuple[Measurement, ...]:
        """As in `DrawnStudy`, of the plies of each fabric."""
        from weavecell.runs.measurement import rank

        return rank(part for name, one in self._known.items() for part in one.measure(name))

    def summary(self) -> dict[str, Any]:
        """Return what was asked for, and the plies of each fabric."""
        content: dict[str, Any] = {
            "velocity_m_s": self.velocity,
            "sure": self.sure,
            "shots": sum(len(one.shots) for one in self.found),
            "plies": {name: list(count) for name, count in self.counts.items()},
            "plies_by_model": {name: list(count) for name, count in self.by_model.items()},
        }
        return content | self._what_is_assumed()

    def _items(self):
        numbers = {name: k for k, group in enumerate(self.groups, 1) for name in group}
        return [
            self._row(name, one, numbers.get(name, 0)) for name, one in zip(self.names, self.found)
        ]

    def _row(self, name, one, number):
        if one.posterior is None:
            return FabricRow(name, *(None,) * 6, *(nan,) * 6, number)
        plies, weave = one.by_tests.plies, self._weave(name)
        v50 = one.v50(plies)
        masses = plies * weave.areal_density, plies * weave.thickness
        margin = v50.value / one.velocity - 1
        return FabricRow(name, *one.by_tests, *one.by_model, *masses, *v50, margin, number)

    def lines(self) -> list[str]:
        """Write the lines that are printed."""
        lines = [f"{self.answer.value}."]
        for row, one in zip(self._items(), self.found):
            if one.posterior is None:
                lines.append(
                    f"{row.fabric}: not determined, {counted(len(one.shots), 'shot')} end alike."
                )
                continue
            tests = "".join(
                f"; tested {counted(t.plies, 'ply')}: {t.velocity:g} m/s" for t in one.tests
            )
            lines.append(
                f"{row.fabric}: plies {one.by_tests.words()}, {row.areal_density:.3g} kg/m², "
                f"{1e3 * row.thickness:.2g} mm; V50 {row.v50:.3g} m/s ({row.low:.3g} to {row.high:.3g}), "
                f"{100 * row.margin:+.0f} %; by the model alone {one.by_model.words()}{tests}."
            )
        error = self.found[0].error
        for name, rows in (("V50", error.factor), ("exponent of plies", error.growth)):
            lines.append(
                f"Computed less measured, {name}: {rows.mean:+.2g} ± {rows.deviation:.2g}, {rows.size} scored rows."
            )
        tied = [" and ".join(group) for group in self.groups if len(group) > 1]
        lines += [f"Not decided by areal density: {words}." for words in tied]
        lines += [
            f"Without an outcome: {failure}." for one in self.found for failure in one.failures
        ]
        return lines + self.notes

    def _own_chapters(self) -> list[Section]:
        """What to measure first, by fabric."""
        from weavecell.report.page import Section, Table

        columns = "plies of", "measured", "to", "plies then", "by", "read by"
        rows = []
        for one in self.measurements:
            row = one.answer.removeprefix("plies of "), one.quantity, one.known_words
            rows.append((*row, one.words(one.then), one.test, one.reader))
        return [Section("first", "What to measure first", tables=(Table(columns, tuple(rows)),))]

    def files(self) -> dict[str, Any]:
        """Return {file: what it holds}, as `StudyResult` does."""
        content = {**self.summary(), "stop": self.stop, "wall_time": self.wall_time}
        content |= self._what_to_measure() | {"groups": self.groups}
        content["model_error"] = asdict(self.found[0].error)
        return {
            "plies.json": content,
            "plies.csv": self.to_csv(),
            "shots.csv": self.shots.to_csv(index=False),
            "shares.csv": self.shares.to_csv(index=False),
            "plies.svg": None,
        }

    @cached_property
    def shares(self) -> DataFrame:
        """The table of the picture: the share that stops by fabric and plies."""
        from pandas import DataFrame, concat

        tables = [DataFrame({"fabric": name, **one.shares()}) for name, one in self._known.items()]
        return concat(tables, ignore_index=True) if tables else DataFrame({"fabric": []})

    @property
    def shots(self) -> Any:
        """The table of the shots, a row each, with fabric and plies."""
        from pandas import concat

        from weavecell.results import one_table
        from weavecell.runs.table import list_drawn

        tables = []
        for name, one in zip(self.names, self.found):
            columns = dict(one_table.columns(one.shots, "v50")) | list_drawn(one.shots)
            table = one_table.frame(columns, "v50")
            table.insert(0, "plies", one.counts)
            table.insert(0, "fabric", name)
            tables.append(table)
        return concat(tables, ignore_index=True)

    def draw(self, pyplot: Any) -> Figure:
        """Draw the share that stops against the number of plies, a panel a fabric."""
        from weavecell.report import pictures_uncertainty

        return pictures_uncertainty.plies(pyplot, self.shares, self.to_dataframe(), self.sure)
