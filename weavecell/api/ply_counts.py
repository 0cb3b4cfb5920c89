"""How many plies of which fabric stop a threat, with a given probability."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any, Unpack

from fabrics.base.checks import FilePath
from fabrics.base.counted import counted
from fabrics.base.door import option
from fabrics.base.errors import InputError, InputErrors, UnstableError, together
from fabrics.fabric import Fabric
from shellfabric.plies.pack_keys import MOST_PLIES, PackKeys
from weavecell.answers.ply_counts import NAMES, PliesResult
from weavecell.api import quantities
from weavecell.api.command import Plan, Running, command
from weavecell.api.execution import ResumableKeywords, StudyKeywords
from weavecell.api.keywords import Keywords, explain_keywords
from weavecell.api.run_size import StudySize
from weavecell.api.target import is_input_file, is_setup, resolve_target

if TYPE_CHECKING:
    from shellfabric.impact.setup import ImpactSetup
    from weavecell.answers.target import Target
    from weavecell.runs.plies import PliesOfFabric, V50Test
TEST = "PLIES plies: V50, such as '5 plies: 290 m/s', or 'S-728, 5 plies: 290 m/s' of one of several fabrics"
_TEST = re.compile(r"(?:(?P<fabric>.+),)?\s*(?P<plies>\d+)\s*pl(?:y|ies)\s*:\s*(?P<velocity>.+)")
# said by other options, or what is asked for
_SAID = {"projectile": "stop", "plies": "", "ply": "", "areal_density": ""}


@dataclass(frozen=True)
class PliesPlan(Plan[PliesResult]):
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
    3
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
