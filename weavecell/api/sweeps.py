"""Sweeps: several shots, or an input file over values of its keys."""

from __future__ import annotations

import itertools
import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Unpack

from fabrics import plausible
from fabrics.base import run_cache
from fabrics.base.checks import FilePath
from fabrics.base.counted import counted
from fabrics.base.door import in_terminal
from fabrics.base.errors import InputError, nearest, together
from fabrics.base.executors import as_done, open_executor
from fabrics.base.files import parse_toml
from fabrics.base.schema import unread, with_tables
from fabrics.fabric import Fabric
from weavecell.answers.shot import shot_of
from weavecell.answers.sweep import NAMES, SweepResult, SweepTable, say_changes, with_unit
from weavecell.answers.target import Target
from weavecell.answers.wording import Wording
from weavecell.api import keywords, quantities
from weavecell.api.command import Plan, Running, command
from weavecell.api.execution import Execution, ResumableKeywords
from weavecell.api.keywords import explain_keywords
from weavecell.api.limits import NO_LIMIT
from weavecell.api.run_size import StudySize, forecast_row
from weavecell.api.target import (
    STRIKE,
    build_target,
    is_input_file,
    is_setup,
    read_target,
    resolve_target,
)
from weavecell.results import progress
from weavecell.scenes import build
from weavecell.scenes.varied_setup import vary_setup

if TYPE_CHECKING:
    from shellfabric.impact.setup import ImpactSetup
    from weavecell.scenes.fabric_table import Reader


@dataclass(frozen=True)
class SweepPlan(Plan[SweepTable]):
    """An input file that is about to be computed over values of its keys.

    Parameters
    ----------
    panels : the Target of each row
    combinations : {key: value} of each row
    keys : all of them
    quantity : "shot", "critical-velocity" or "v50"
    tolerance : [m/s] of the bracket of a limit, None for the usual one
    shots, seed : of a V50
    """

    files = NAMES

    panels: tuple[Target, ...]
    combinations: tuple[dict[str, Any], ...]
    keys: tuple[str, ...]
    quantity: str
    tolerance: float | None
    shots: int
    seed: int

    @property
    def target(self) -> Target:
        """The first, whose file is named in problems."""
        return self.panels[0]

    @property
    def title(self) -> str:
        """What is computed."""
        return f"{len(self.panels)} x {self.quantity}"

    @property
    def inputs(self) -> Sequence[tuple]:
        """Set-up, quantity and tolerance of each row."""
        from weavecell.studies import inputs

        return [
            (inputs.use_one_thread(panel.setup), self.quantity, self.tolerance)
            for panel in self.panels
        ]

    def forecast(self) -> StudySize:
        """Forecast shots and CPU time of all rows together."""
        sizes = [
            forecast_row(panel, self.quantity, self.shots, self.tolerance) for panel in self.panels
        ]
        names = list(map(say_changes, self.combinations))
        return StudySize.add_up(self.title, names, sizes)

    def run(self, running: Running) -> SweepTable:
        """Compute the rows."""
        rows = self._compute_rows(running)
        table = []
        for changes, panel, row in zip(self.combinations, self.panels, rows):
            areal_density = {"areal_density_kg_m2": panel.setup.areal_density}
            table.append(dict.fromkeys(self.keys) | changes | areal_density | row)
        result = SweepTable(self.quantity, self.keys, tuple(table), self.panels)
        return running.save(result)

    def _compute_rows(self, running):
        from weavecell.runs import sweep as studies

        with running.count(self.title) as part:
            if self.quantity != "v50":
                return run_cache.results(studies.row, self.inputs, report=part(), **running.cache)
            # the shots of a V50 run in parallel already, so the V50s follow one another
            rows = []
            for number, panel in enumerate(self.panels):
                drawn = {"shots": self.shots, "seed": self.seed, **running.cache}
                report = part(number, len(self.panels))
                rows.append(studies.row(panel.setup, self.quantity, report=report, **drawn))
            return rows


@dataclass(frozen=True)
class SetupsPlan(Plan[SweepResult]):
    """Set-ups that are about to be fired at, each as `impact` does.

    Parameters
    ----------
    setups : tuple of ImpactSetup
    """

    runs = ""

    setups: tuple[ImpactSetup, ...]

    def forecast(self) -> StudySize:
        """Forecast CPU time of all shots together."""
        from weavecell.api.run_size import RunSize

        title = counted(len(self.setups), "shot")
        sizes = [RunSize.estimate(setup, setup.title) for setup in self.setups]
        low, high = (sum(size.cpu_time[end] for size in sizes) for end in (0, 1))
        names = [f"shot {number}" for number in range(1, len(sizes) + 1)]
        said = Wording.merge(names, [size.said for size in sizes])
        return StudySize(title, len(sizes), 0, (low, high), said=said)

    def run(self, running: Running) -> SweepResult:
        """Fire."""
        arguments = [(setup,) for setup in self.setups]
        title = counted(len(arguments), "shot")
        with open_executor(**running.how.pool) as pool, progress.bar(title) as advance:
            shots = {}
            for number, shot in as_done(pool, _fire, arguments):
                shots[number] = shot
                advance(len(shots) / len(arguments))
        return SweepResult(tuple(shot for _, shot in sorted(shots.items())))


@command(SweepPlan, SetupsPlan)
@explain_keywords(ResumableKeywords)
def sweep(  # type: ignore[misc]  # `out` is one of its options too
    target: Fabric | FilePath | ImpactSetup | Iterable[ImpactSetup],
    *,
    over: list[str] | Mapping[str, Sequence[Any]] | None = None,
    quantity: str = "shot",
    tolerance: float | str | None = None,
    shots: int | None = None,
    seed: int | None = None,
    check: bool = False,
    out: FilePath | None = None,
    **options: Unpack[ResumableKeywords],
) -> Plan[SweepTable | SweepResult]:
    """Repeat an input file over values of its keys, and compute a shot, the ballistic limit or V50
    of each.

    All combinations are checked before the first is computed. Ignored keys of the input file:
    title, run.snapshot_interval, run.checkpoint_interval, run.outputs, and for a limit or V50
    projectile.strike_velocity, run.end_time and backing.after_stop; [history] is rejected.

    The folder then holds report.html, sweep.csv, sweep.json, sweep.png (against areal density, of
    numbers of plies), scene.toml, and runs/, a file for each finished run.

    Parameters
    ----------
    target : input file of a ply or pack, or name of a fabric or its file; in Python also a Fabric,
        a set-up of `setup`, or several set-ups without `over`, of which each is fired as `impact`
        does
    over : KEY=VALUE,VALUE,... of the input file, may be given again, for all combinations; in
        Python also a dict, whose numbers are in SI units. A key is also one of modulus,
        failure_strain, crimp_warp, crimp_weft, areal_density, compression_a, compression_b,
        trellis_stiffness, trellis_angles and failure_length, whose values are factors on that
        number of all fabrics
    quantity : what is computed of each: shot, critical-velocity or v50
    tolerance : of a critical velocity, highest stop and lowest perforation differ by this at most
        [m/s]; if not given by 1 m/s of one ply, about 5 % of a pack, whose result is V50 with its
        interval
    shots : of a V50, number of shots; if not given 16
    seed : of a V50, of all that is drawn; if not given 1
    check : run nothing and write nothing: forecast shots and CPU time
    out : folder of the results; in Python None writes nothing. Of set-ups nothing is written
    **options : jobs, executor and resume

    Returns
    -------
    SweepTable, a row for each combination; of set-ups SweepResult, in their order, in which an
    unstable shot has the outcome "unstable". Doubtful shots of set-ups warn, all in one
    `DoubtfulResult`

    Raises
    ------
    InputError : a wrong key or value, a set-up that cannot be run, jobs below 1, or no such
        executor

    Examples
    --------
    >>> setups = [wc.setup("S-720", velocity, opening="20 mm", end_time="10 us") for velocity in (100, 150)]
    >>> [round(shot.residual_velocity) for shot in wc.sweep(setups)]
    [99, 148]
    >>> table = wc.sweep("S-720", over={"panel.opening": ["20 mm"], "run.end_time": ["5 us", "10 us"],
    ...                                  "projectile.strike_velocity": ["150 m/s"]})
    >>> [row["outcome"] for row in table.rows]
    ['in flight', 'in flight']
    """
    for name, value in options.items():
        if name in keywords.tables():
            raise InputError(_hint_at_key(name, value), key=name, value=value)
    Execution.refuse_others("sweep", options)
    given = target
    target = _one_setup(target)
    if not (is_setup(target) or isinstance(target, (str, Path))):
        unused = {"over": over, "tolerance": tolerance, "shots": shots, "seed": seed}
        quantities.refuse_unused(unused, "beside set-ups")
        if out is not None:
            allowed = "left out of set-ups: an input file, or a fabric, has a report"
            raise InputError(key="out", allowed=allowed)
        setups = _list_setups(target)
        digests = list(map(run_cache.inputs_digest, setups))
        for number, digest in enumerate(digests):
            if (first := digests.index(digest)) < number:
                message = f"set-up {number + 1} is the same as set-up {first + 1}"
                raise InputError(message, key="target", allowed="set-ups that differ")
        panels = [resolve_target(setup, {}, "shot", function="sweep") for setup in setups]
        return SetupsPlan(tuple(panel.nominal().setup for panel in panels))
    from weavecell.runs import sweep as studies
    from weavecell.scenes.impact import Scene
    from weavecell.studies import inputs, strengths

    if quantity not in list(studies.QUANTITIES):
        raise InputError(
            key="quantity", value=quantity, allowed=f"one of {', '.join(studies.QUANTITIES)}"
        )
    if quantity != "v50":
        quantities.refuse_unused({"shots": shots, "seed": seed}, f"with {quantity}")
    if quantity != "critical-velocity":
        quantities.refuse_unused({"tolerance": tolerance}, f"with {quantity}")
    width, count, first = quantities.read_search(tolerance, shots, seed, usual=(None, 16))
    keys: dict[str, list[Any]] = {}
    in_si = isinstance(over, Mapping)
    for key, values in over.items() if isinstance(over, Mapping) else map(parse, over or ()):
        listed = []
        if isinstance(values, Iterable) and not isinstance(values, (str, bytes)):
            listed = [keywords.plain(value) for value in values]
        if not listed:
            raise InputError(
                key=f"over, {key}", value=values, allowed="a list of one value or more"
            )
        for value in listed:
            # a key that is given again has more values
            if value in keys.setdefault(key, []):
                raise InputError("is given twice", key=f"over, {key}", value=value)
            keys[key].append(value)
    if not keys:
        raise InputError("is missing", key="over", allowed=OVER)
    factors = inputs.table("range")
    for key in keys:
        if key.partition(".")[0] not in Scene.model_fields and key not in factors:
            hint = _hint_at_key(key, keys[key])
            raise InputError(hint, key=f"over, {key}")
    struck = "projectile.strike_velocity"
    of_fabric = isinstance(given, (str, Path, Fabric)) and not is_input_file(str(given))
    if quantity == "shot" and struck not in keys and of_fabric:
        example = _over(struck, ["90 m/s", "150 m/s"])
        allowed = f"given for a fabric, such as {example}, or an input file"
        raise InputError("is missing", key=struck, allowed=allowed)
    readers: dict[str, Reader] = {"shot": "sweep", "critical-velocity": "limit", "v50": "v50"}
    reader = readers[quantity]
    passed = unread(Scene, reader)
    for key, values in keys.items():
        if any(passed.get(name) == "" for name in with_tables(key)):
            allowed = f"left out: {quantity} does not read it, and all rows would be alike"
            raise InputError(key=f"over, {key}", value=values, allowed=allowed)
    combinations = [dict(zip(keys, values)) for values in itertools.product(*keys.values())]
    panels = [_panel(target, Path(out or "."), reader, each, in_si) for each in combinations]
    for panel in panels:
        if quantity == "v50":
            strengths.check(panel.setup, inputs.read_scatter())
        elif quantity == "critical-velocity":
            strengths.require_failure(panel.setup, NO_LIMIT)
    panels = [panel.nominal() for panel in panels]
    plan = SweepPlan(
        tuple(panels),
        tuple(combinations),
        tuple(keys),
        quantity,
        width,
        count,
        first,
    )
    _refuse_alike(plan)
    return plan


def _refuse_alike(plan):
    """Refuse values that make the same set-up twice, by the digest that finds runs again.

    Raises
    ------
    InputError : it names a key that makes no difference
    """
    seen: dict[str, dict[str, Any]] = {}
    for changes, of_row in zip(plan.combinations, plan.inputs):
        digest = run_cache.inputs_digest(of_row)
        before = seen.setdefault(digest, changes)
        if before is changes:
            continue
        key = next(key for key in changes if changes[key] != before.get(key))
        message = f"makes the same set-up as {say_changes(before)}"
        raise InputError(message, key=f"over, {key}", value=changes[key])


def _one_setup(target):
    """The set-up of a Fabric, struck as in the standard shot; any other target as it is."""
    if isinstance(target, Fabric):
        return build_target(target, STRIKE, {}, "sweep").setup
    return target


def _list_setups(target):
    """The set-ups that are given together.

    Raises
    ------
    InputError : anything else, or none
    """
    listed: tuple[Any, ...] = ()
    if isinstance(target, Iterable):
        listed = tuple(target)
    if not listed or not all(map(is_setup, listed)):
        allowed = "an input file, a fabric, a set-up of `setup`, or a list of set-ups"
        raise InputError(key="target", value=target, allowed=allowed)
    return listed


def _panel(target, folder, reader, changes, in_si):
    """The Target with the values of some keys, and factors on numbers of its fabrics, in place of
    its own; numbers of quantities are in SI units, or need a unit as in a file."""
    from weavecell.studies import inputs

    factors = {key: value for key, value in changes.items() if key in inputs.table("range")}
    for key, factor in factors.items():
        if isinstance(factor, bool) or not isinstance(factor, (int, float)) or not factor > 0:
            raise InputError(key=key, value=factor, allowed="a factor above 0, such as 1.2")
    compared = [plausible.Number(key, "factor", factor) for key, factor in factors.items()]
    for note in plausible.judge(compared):
        build.LOG.info(f"note: {note}")
    keys = {key: value for key, value in changes.items() if key not in factors}
    if is_setup(target):
        varied = vary_setup(target, keys)
        panel = Target(None, varied, "", varied.title, from_file=False)
    else:
        written = {key: with_unit(key, value) for key, value in keys.items()} if in_si else keys
        try:
            panel = read_target(str(target), folder, reader, changes=written)
        except InputError as problem:
            # no line of the file has these values
            parts = getattr(problem, "problems", (problem,))
            raise together(
                [
                    part.changed(file=None, key=f"over, {part.key}") if part.key in keys else part
                    for part in parts
                ]
            ) from None
    if not factors:
        return panel
    if panel.setup.surface is not None:
        raise InputError("a response surface holds for one fabric", key=next(iter(factors)))
    return replace(panel, setup=inputs.scale_setup(panel.setup, **factors))


def _over(key, values):
    """How a user would vary a key."""
    if in_terminal():
        return f'--over "{key}={",".join(map(str, values))}"'
    return f'over={{"{key}": {json.dumps(values, default=str)}}}'


def _hint_at_key(name, values):
    """What to write for a name that is not a key of an input file with its table."""
    listed = list(values) if isinstance(values, (list, tuple)) else [values]
    known = {"velocity": "projectile.strike_velocity"}
    for key, table in keywords.tables().items():
        known[key] = f"{table}.{key}" if table else key
    if near := nearest(name, known):
        return f"is not a key of an input file, did you mean {_over(known[near], listed)}?"
    example = _over("panel.opening", ["150 mm", "200 mm"])
    return f"is not a key of an input file; a key has its table before it, such as {example}"


OVER = 'KEY=VALUE,VALUE,... such as "panel.plies=2,4,8"'


def parse(text: str) -> tuple[str, list[Any]]:
    """Parse a text such as "panel.plies=2,4,8" or "projectile.strike_velocity=100 m/s,150 m/s":
    (key, values).

    Raises
    ------
    InputError : a text of another form
    """
    if not isinstance(text, str):
        raise InputError(key="over", value=text, allowed=f"a dict, or a list of texts {OVER}")
    key, mark, values = text.partition("=")
    if not mark or not key.strip() or not all(value.strip() for value in values.split(",")):
        raise InputError(key="over", value=text, allowed=OVER)
    return key.strip(), [_value(value.strip()) for value in values.split(",")]


def _value(text):
    """A number or a truth value as in TOML; any other text as it is."""
    try:
        value = parse_toml(f"value = {text}")["value"]
    except ValueError:
        return text
    if isinstance(value, (bool, int, float, str)):
        return value
    return text


def _fire(setup):
    """The ShotResult of a set-up, in a process of a sweep."""
    from shellfabric.impact.run import run_impact_or_partial

    result, problem = run_impact_or_partial(setup)
    return shot_of(resolve_target(setup, {}, "shot"), result, problem)
