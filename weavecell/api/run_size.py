"""What an impact or a study would take: elements, steps, memory and time, and what is assumed.
Nothing is run.

The CPU time of a step is that of `COSTS`, measured on one core: intact plies cost the lower value,
torn ones up to the higher. Plies of a pack cost something whatever their elements, and more under a
body of metal: 84 short shots at packs of 2 and 3 plies. A shot of a study ends after `DURATION`
times what a projectile of the first guess of the limit takes over half of the opening. These factors
and the shots that enclose a limit are estimates: 4.7 to 70 s for a `v50` of 18 s.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import ceil, log2
from typing import TYPE_CHECKING, Any

import numpy as np

from fabrics import assumed
from fabrics.base.counted import counted, plural
from fabrics.base.door import in_terminal, option
from fabrics.base.frozen import explain_frozen
from weavecell.answers.result import Result
from weavecell.answers.wording import NOTHING, Wording

if TYPE_CHECKING:
    from shellfabric.impact.setup import ImpactSetup
    from weavecell.answers.target import Target
    from weavecell.scenes.impact import Scene

# lowest and highest CPU time [s] of an element and step: one ply of S-720, 2 and 4 plies of S-726 and S-728, clay and
# gelatine, over 60 to 600 us
COSTS = {"one ply": (20e-9, 60e-9), "pack": (90e-9, 230e-9)}
# of a ply of a pack and step, beside its elements, and what a body of metal adds to it [s]
OF_A_PLY = 0.2e-3, 0.5e-3
OF_A_BODY = 0.1e-3, 0.25e-3
OF_A_BRICK = 850e-9, 1000e-9
OF_A_CROSSING = 200e-9, 400e-9  # of resolved yarns, with its nodes and segments
# estimates: of the time over half of the opening, and of the shots until a limit is enclosed
DURATION = 0.2, 1.0
ENCLOSES = 2.5
WIDTH = 1.0  # [m/s] of the bracket of a search, where it is not given
# shots beside the bracket of a limit that look for mixed outcomes, at most
LOOKS = 2
# lengths of itself that a bullet of metal goes at its strike velocity until it is through or stopped: of
# a pack of no plies, and more for each ply. Eleven shots at packs of 2 to 10 plies: 1.0 to 4.4 lengths
FLIGHT = 1.2, 0.15
# [%] by which half the element side moves what packs absorb of a fragment, the mean of three shots, and of a bullet:
# the larger of the studies cost-pack-fragment and cost-pack-bullet
MOVED_BY_HALF = 11.9
HALF_OF_THEM = (
    "elements half as long: four times as many, in steps of half the length at least, for 3 to 8 times "
    f"the CPU time; they moved the energy that two packs absorb by {MOVED_BY_HALF:g} % at most"
)
WITHIN = 2.0  # by which factor the time of a flight is known
# [s] a forecast of more says what it grows with, and of a study what spreads it
LONG = 600.0
GROWTH = (
    "it grows with plies, area and end time in proportion, and with the cube of a smaller side of the "
    "elements; threads share the plies of a pack"
)
SPREAD = "spread the shots over processes, or by dask and mpi over machines, to the same results"


def _in_megabytes(memory):
    """Memory [bytes] in words."""
    if memory < 1e6:
        return "below 1 MB"
    return f"{1e-6 * memory:,.0f} MB"


def _say_cost(cpu_time):
    """A range of CPU time [s] in words."""
    low, high = (f"{float(f'{seconds:.2g}'):,.12g}" for seconds in cpu_time)
    return f"{low} to {high} s of CPU time"


def shots_of_a_search(setup: ImpactSetup, tolerance: float = WIDTH) -> int:
    """Estimate the shots of a search for a limit: those that enclose it, and the halvings of the
    first step down to the tolerance [m/s]."""
    from weavecell.studies.ballistic_limit import first_guess
    from weavecell.studies.bracket import STEP

    first_step = (STEP - 1) * first_guess(setup.target())
    return ceil(ENCLOSES + max(log2(first_step / tolerance), 0.0))


class _Size(Result):
    """A forecast, whose table has one row."""

    _most_lines = 100  # what is asked for

    cpu_time: tuple[float, float]
    said: Wording

    @property
    def shot(self) -> str:
        """What is shot at, and by what; the report begins with it."""
        return self.said.summary()["shot"]

    @property
    def assumptions(self) -> tuple[str, ...]:
        """Lines on what the runs take for granted, as the report has them."""
        return tuple(": ".join(row) for row in self.said.assumptions)

    @property
    def settings(self) -> str:
        """Settings that are chosen, as the report has them, and of what the cells are made."""
        return self.said.settings

    def _columns(self):
        return {name: [value] for name, value in self.summary().items()}

    def _summarise_cpu_time(self):
        """Entries of the summary."""
        low, high = self.cpu_time
        return {"cpu_time_low_s": low, "cpu_time_high_s": high}

    @property
    def cost(self) -> str:
        """[s] of CPU time, in words."""
        return _say_cost(self.cpu_time)


@explain_frozen
@dataclass(frozen=True, repr=False)
class RunSize(_Size):
    """What an impact would take.

    Parameters
    ----------
    title : of the impact
    elements, bricks : of all plies, and of the block behind them
    steps, time_step : number at most, and length [s]
    memory : [bytes]
    cpu_time : (lowest, highest) [s] if the run goes on to its end time
    notes : lines on resolved yarns: what is assumed of them, and why they are resolved
    of_fabrics : lines that name what is assumed of the fabrics
    foreseen : lines on the checks that will not be ok if yarns fail (`quality.foresee`)
    model : line on the cheapest model that was enough in a scene like this one (`model_choice`)
    said : what is shot at, taken for granted and chosen, as the report has it
    of_bullet : lines on a pack that a bullet of metal strikes: CPU time of its flight, and its mesh
    beside : size of the drawn shots beside it; None without any

    Examples
    --------
    >>> size = wc.impact("S-720", "150 m/s", opening="20 mm", end_time="10 us", check=True)
    >>> size.elements, size.steps
    (98, 80)
    """

    title: str
    elements: int
    bricks: int
    steps: int
    time_step: float
    memory: float
    cpu_time: tuple[float, float]
    notes: tuple[str, ...] = ()
    of_fabrics: tuple[str, ...] = ()
    foreseen: tuple[str, ...] = ()
    model: str = ""
    said: Wording = NOTHING
    of_bullet: tuple[str, ...] = ()
    beside: StudySize | None = None

    @property
    def assumed(self) -> tuple[str, ...]:
        """All lines that name what is assumed."""
        return (*self.notes, *self.of_fabrics)

    @classmethod
    def estimate(
        cls,
        setup: ImpactSetup,
        title: str,
        notes: tuple[str, ...] = (),
        written: bool = True,
        scene: Scene | None = None,
        *,
        velocity: bool = True,
        drawn: bool = False,
    ) -> RunSize:
        """Estimate the size of a run of a set-up, which is checked as its run does.

        Parameters
        ----------
        notes : lines on resolved yarns
        written : whether pictures and files are made of the results
        scene, velocity, drawn : of `Wording.of_setup`

        Raises
        ------
        InputError : values that do not go together
        """
        from shellfabric.block.coupling import bricks_of
        from shellfabric.impact.run import check_impact
        from shellfabric.loop import pack_memory as memory
        from weavecell.studies import model_choice

        pack = check_impact(setup, written=written)
        bricks = bricks_of(pack.plies[0])
        steps = ceil(setup.end_time / pack.time_step)
        low, high = _forecast_cpu_time(setup, pack)
        needed = memory.needed(pack.plies, setup.snapshots, written=written)
        if setup.crossovers is not None:
            notes = (*setup.crossovers.assumed_lines, *notes)
        return cls(
            title,
            pack.elements,
            bricks,
            steps,
            pack.time_step,
            needed,
            (low, high),
            notes,
            tuple(line for fabric in setup.fabrics for line in assumed.lines(fabric)),
            _foresee(setup, pack),
            model_choice.advise(setup, pack),
            Wording.of_setup(setup, scene, velocity=velocity, drawn=drawn),
            _tell_bullet(setup, pack, (low, high)),
        )

    def summary(self) -> dict[str, Any]:
        """Return all of it, names with units."""
        return {
            "elements": self.elements,
            "bricks": self.bricks,
            "steps": self.steps,
            "time_step_s": self.time_step,
            "memory_bytes": self.memory,
            **self._summarise_cpu_time(),
            "assumed": "; ".join(self.assumed),
            **self.said.summary(),
        }

    def lines(self) -> list[str]:
        """Write the lines that are printed."""
        block = ""
        if self.bricks:
            block = f" and {counted(self.bricks, 'brick')}"
        lines = [
            f"{self.title}: nothing is run",
            f"{counted(self.elements, 'element')}{block}, at most {counted(self.steps, 'step')} of "
            f"{1e9 * self.time_step:.3g} ns",
            f"memory {_in_megabytes(self.memory)}; {self.cost} if it goes on to its end time",
            *self.of_bullet,
            *_say_beside(self.beside),
        ]
        if self.cpu_time[1] > LONG:
            lines.append(GROWTH)
        lines += (self.model, *self.notes, *self.foreseen)
        # a command has printed the others as it read its file
        if not in_terminal():
            lines += self.of_fabrics
        return [*lines, *self.said.lines]


def _say_beside(size):
    """Return the line on the drawn shots beside a shot, if there are any."""
    if size is None:
        return []
    return [f"beside it {counted(size.shots, 'drawn shot')}; {size.cost}"]


def forecast_flight(setup: ImpactSetup) -> float:
    """Forecast the time [s] after which a bullet of metal is through a pack, or stopped by it."""
    bullet = setup.projectile.turned
    assert bullet is not None
    none, of_each = FLIGHT
    return (none + of_each * setup.plies) * bullet.length / setup.strike_velocity


def _tell_bullet(setup, pack, cpu_time):
    """Lines on a pack that a bullet of metal strikes: what its flight costs, unless clay goes on behind it,
    and how fine the mesh is beside the one that is found for it."""
    if not setup.stops_a_bullet:
        return ()
    lines = []
    if setup.backing is None:
        flight = forecast_flight(setup)
        middle = min(flight / setup.end_time, 1.0) * (cpu_time[0] * cpu_time[1]) ** 0.5
        low, high = (float(f"{seconds:.2g}") for seconds in (middle / WITHIN, middle * WITHIN))
        lines.append(
            f"{low:,.12g} to {high:,.12g} s of it until the bullet is through or stopped, after about "
            f"{1e6 * flight:.0f} us"
        )
    found = replace(setup, grading=None, elements_per_crossover=None)
    if found.mesh == setup.mesh:
        lines.append(f"mesh found for the bullet: {setup.mesh_in_words}")
        return (*lines, HALF_OF_THEM)
    finer = found.target()
    factor = finer.elements / pack.elements * pack.time_step / finer.time_step
    lines.append(f"mesh given: {setup.mesh_in_words}")
    lines.append(
        f"without it one is found for the bullet, at {factor:.2g} times the CPU time: "
        f"{found.mesh_in_words}"
    )
    return tuple(lines)


def _forecast_cpu_time(setup, pack):
    """(lowest, highest) CPU time [s] of a run at a pack to its end time."""
    from shellfabric.block.coupling import bricks_of
    from shellfabric.yarns.model import crossings_of

    kind = "one ply"
    plies = bodies = 0
    if setup.plies > 1:
        kind = "pack"
        plies = setup.plies
    if setup.stops_a_bullet:
        bodies = plies
    crossings = sum(map(crossings_of, pack.plies))
    numbers = np.array([pack.elements, plies, bodies, bricks_of(pack.plies[0]), crossings])
    costs = np.array([COSTS[kind], OF_A_PLY, OF_A_BODY, OF_A_BRICK, OF_A_CROSSING])
    return ceil(setup.end_time / pack.time_step) * numbers @ costs


def _foresee(setup, pack):
    """Lines on the checks of a run that are foreseen to be doubtful."""
    from shellfabric.membrane import quality

    found = quality.foresee(pack, setup.strike_velocity, setup.crossovers is None)
    return tuple(f"foreseen if yarns fail: doubtful: {one.text}" for one in found if one.doubtful)


@explain_frozen
@dataclass(frozen=True, repr=False)
class StudySize(_Size):
    """What a study of many shots would take.

    Parameters
    ----------
    title : of the study
    shots : number, about, with those of its searches
    searches : of a limit, of `shots_of_a_search` each
    cpu_time : (lowest, highest) [s]
    foreseen, said : of RunSize, of its shots

    Examples
    --------
    >>> size = wc.critical_velocity("S-720", residual_shots=0, scan=False, opening="50 mm", check=True)
    >>> size.shots, size.searches
    (8, 1)
    """

    title: str
    shots: int
    searches: int
    cpu_time: tuple[float, float]
    foreseen: tuple[str, ...] = ()
    said: Wording = NOTHING

    @classmethod
    def estimate(
        cls,
        setup: ImpactSetup,
        title: str,
        shots: int,
        searches: int = 0,
        tolerance: float = WIDTH,
        *,
        scene: Scene | None = None,
        velocity: bool = False,
        drawn: bool = False,
    ) -> StudySize:
        """Estimate the size of shots and searches at a set-up.

        Parameters
        ----------
        tolerance : [m/s] of the searches
        scene, velocity, drawn : of `Wording.of_setup`

        Raises
        ------
        InputError : values that do not go together
        """
        from weavecell.studies.ballistic_limit import first_guess

        of_a_search = shots_of_a_search(setup, tolerance)
        shots += of_a_search * searches
        crossing = 0.5 * float(np.max(setup.opening)) / first_guess(setup.target())
        words: dict[str, Any] = {"scene": scene, "velocity": velocity, "drawn": drawn}
        of_a_run = RunSize.estimate(setup, title, **words)
        of_a_shot = crossing / setup.end_time
        low, high = shots * of_a_shot * np.multiply(of_a_run.cpu_time, DURATION)
        told: dict[str, Any] = {"foreseen": of_a_run.foreseen, "said": of_a_run.said}
        return cls(title, shots, searches, (low, high), **told)

    @classmethod
    def add_up(cls, title: str, names: Sequence[str], sizes: Sequence[StudySize]) -> StudySize:
        """Add up several sizes, each of the set-up of a name."""
        low, high = (sum(size.cpu_time[end] for size in sizes) for end in (0, 1))
        shots = sum(size.shots for size in sizes)
        searches = sum(size.searches for size in sizes)
        foreseen = dict.fromkeys(line for size in sizes for line in size.foreseen)
        told: dict[str, Any] = {
            "foreseen": tuple(foreseen),
            "said": Wording.merge(names, [size.said for size in sizes]),
        }
        return cls(title, shots, searches, (low, high), **told)

    def summary(self) -> dict[str, Any]:
        """Return all of it, names with units."""
        return {
            "shots": self.shots,
            "searches": self.searches,
            **self._summarise_cpu_time(),
            **self.said.summary(),
        }

    def lines(self) -> list[str]:
        """Write the lines that are printed."""
        searches = ""
        if self.searches:
            searches = f", of which {counted(self.searches, 'search')} of a limit"
        lines = [
            f"{self.title}: nothing is run",
            f"about {counted(self.shots, 'shot')}{searches}; {self.cost}",
        ]
        lines += self.foreseen
        if self.cpu_time[1] > LONG:
            lines += [GROWTH, f"{option('jobs', '')} and {option('executor', '')} {SPREAD}"]
        return [*lines, *self.said.lines]


def forecast_row(panel: Target, quantity: str, shots: int, width: float | None) -> StudySize:
    """Forecast the size of a row of `studies.sweep`; `shots` of a V50, `width` [m/s] of the bracket
    of a limit or None."""
    setup = panel.setup
    words: dict[str, Any] = {"scene": panel.scene}
    if quantity == "shot":
        return StudySize.estimate(setup, setup.title, 1, velocity=True, **words)
    # a shot asks for its own forecast, and needs no statistics for it
    from weavecell.runs import table
    from weavecell.studies import pack_limit
    from weavecell.studies.limit import usual_tolerance

    if quantity == "v50":
        return StudySize.estimate(table.as_fired(setup), setup.title, shots, drawn=True, **words)
    beside = pack_limit.SHOTS if setup.plies > 1 else LOOKS
    width = width or usual_tolerance(setup.target())
    return StudySize.estimate(setup, setup.title, beside, 1, tolerance=width, **words)


@explain_frozen
@dataclass(frozen=True, repr=False)
class WorkSize(Result):
    """What a command would compute that fires no shots: how much of what.

    Parameters
    ----------
    title : of what is computed
    amounts : {what is counted, in the singular: number}
    assumed : lines that name what is assumed
    said : what is tested, taken for granted and chosen, as the report has it

    Examples
    --------
    >>> print(wc.biaxial("S-720", ratio=["1:1", "2:1"], check=True))
    S-720, biaxial: nothing is run
    2 paths, 482 states
    """

    _most_lines = 100  # what is asked for

    title: str
    amounts: dict[str, int]
    assumed: tuple[str, ...] = ()
    said: Wording = NOTHING

    def summary(self) -> dict[str, Any]:
        """Return the amounts, and what is said."""
        amounts = {plural(noun): number for noun, number in self.amounts.items()}
        return amounts | self.said.summary()

    def _columns(self):
        return {name: [number] for name, number in self.summary().items()}

    def lines(self) -> list[str]:
        """Write the lines that are printed."""
        amounts = ", ".join(counted(number, noun) for noun, number in self.amounts.items())
        head = f"{self.title}: nothing is run"
        return [head, amounts, *self.assumed, *self.said.lines]
