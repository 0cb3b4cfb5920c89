"""One small patch struck in three models, and whether crossovers may be pinned for the nose.

The folder of `weavecell patch`
    patch.json      the answer, velocities, first failure, energy error and cost of each model,
                    provenance
    patch.csv       velocity and way of the nose in each model, one row a time
    patch.svg       the same
    scene.toml      the input file as it was given
    inputs/         copies of the files that the input file names
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, Unpack

import numpy as np

from fabrics.base.checks import FilePath
from fabrics.base.counted import counted
from fabrics.base.errors import InputError
from fabrics.base.frozen import explain_frozen
from fabrics.fabric import Fabric
from weavecell.api import meshes, quantities
from weavecell.api.command import Plan, Running, command
from weavecell.api.keywords import Keywords, explain_keywords
from weavecell.api.run_size import SizeOfPatch
from weavecell.api.study_result import DrawnResult
from weavecell.api.target import list_assumptions, resolve_target
from weavecell.api.wording import Wording
from weavecell.results import out_folder, progress
from weavecell.results.finding import Answer

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from shellfabric.impact.setup import ImpactSetup
    from shellfabric.membrane.indicator import Indicator
    from weavecell.api.target import Target
    from weavecell.studies.small_patch import SmallPatch, Struck

NAMES = ("patch.json", "patch.csv", "patch.svg", *out_folder.INPUT)
WORDS = {"pinned": "pinned crossovers", "yarns": "resolved yarns", "solids": "solid yarns"}
ROWS = 51


@dataclass(frozen=True)
class PatchPlan(Plan["PatchResult"]):
    """A patch that is about to be struck.

    Parameters
    ----------
    target : Target
    patch : `weavecell.studies.small_patch.SmallPatch`
    """

    files = NAMES
    runs = ""

    target: Target
    patch: SmallPatch

    def forecast(self) -> SizeOfPatch:
        """Forecast hexahedra and CPU time."""
        pinned = Wording.of_setup(self.patch.pinned_setup(), None, velocity=True)
        yarns = Wording.of_setup(self.patch.yarns_setup(), None, velocity=True)
        both = Wording.merge(("pinned crossovers", "resolved yarns"), (pinned, yarns))
        said = replace(
            both,
            shots=(("", f"{_describe_patch(self.target, self.patch)}."),),
            assumptions=(*both.assumptions, ("solid yarns", self.patch.solids_in_words)),
        )
        return SizeOfPatch.estimate(self.patch, self.target.shot_title, said)

    def run(self, running: Running) -> PatchResult:
        """Strike it in each model."""
        from weavecell.studies import small_patch

        done = []
        for model, strike in zip(small_patch.MODELS, self.patch.strike()):
            with progress.bar(f"Patch of {WORDS[model]}"):
                done.append(strike())
        return running.save(PatchResult(self.target, self.patch, tuple(done)))


@command(PatchPlan)
@explain_keywords(Keywords)
def patch(
    target: Fabric | FilePath | ImpactSetup | None,
    velocity: float | str | None = None,
    *,
    struck: Literal["gap", "crossover"] = "gap",
    crossings: int | None = None,
    duration: float | str = "50 us",
    mesh: str | tuple[int, int, int] = "2,2,1",
    check: bool = False,
    out: FilePath | None = None,
    **options: Unpack[Keywords],
) -> PatchPlan:
    """Ask whether crossovers may be pinned for a nose: strike one small patch in three models.

    Pinned crossovers, resolved yarns, and woven solid yarns, which neither of the other two was
    built from (docs/theory-panel.md, "Woven solid yarns"). Of the input file count fabric, laws,
    projectile, strike velocity, the friction between yarns and whether these fail; the patch is one
    ply of its own, clamped all round, and its edges are felt after a few microseconds, in all
    models alike.

    Parameters
    ----------
    target : input file of a ply; in Python also a fabric, or a set-up of `setup`
    velocity : of a fabric, [m/s] of the strike
    struck : gap between four yarns, or crossover
    crossings : of each family, an even number; as few as the nose allows if not given, 12 at least
    duration : [s], such as "50 us"
    mesh : hexahedra of the solids along, across and through a quarter of a yarn in one crossing
    check : whether to forecast hexahedra and CPU time alone; nothing is run or written
    out : folder of the results; in Python None writes nothing
    **options : beside a fabric, keywords of `setup`

    Returns
    -------
    PatchResult

    Raises
    ------
    InputError : as `setup`; several plies, a block, a nose that is tilted, oblique, deforms or is
        too wide, or a fabric without solid laws
    UnstableError : the run of a model became unphysical

    Examples
    --------
    >>> wc.patch("S-720", "60 m/s", check=True).bricks
    6272
    """
    from weavecell.studies import small_patch

    panel = resolve_target(target, options, "patch", velocity, function="patch", one_shot=True)
    size = meshes.size(mesh)
    if not isinstance(size, tuple):
        raise InputError(key="mesh", value=mesh, allowed="three whole numbers, such as 2,2,1")
    seconds = quantities.read_positive(duration, "s", "duration")
    count = crossings
    if count is None:
        count = max(small_patch.fewest_crossings(panel.setup), 12)
    with panel.name_problems():
        chosen = small_patch.SmallPatch(panel.setup, count, struck, size, seconds)
    return PatchPlan(panel, chosen)


def _describe_patch(target, patch):
    """The shot, size of the patch, and where it is struck."""
    place = {"gap": "in a gap", "crossover": "on a crossover"}[patch.place]
    count = patch.crossings
    return f"{target.shot_title}: {count} x {counted(count, 'crossover')}, struck {place}"


@explain_frozen
@dataclass(frozen=True, repr=False)
class PatchResult(DrawnResult):
    """A patch that has been struck in three models; the table has a row a time.

    Parameters
    ----------
    target : Target
    patch : `weavecell.studies.small_patch.SmallPatch`
    struck : Struck of pinned crossovers, resolved and solid yarns

    Examples
    --------
    >>> alike = wc.patch("S-720", "60 m/s", duration="1 us")
    >>> alike.verdict.partition(":")[0], len(alike.to_dataframe())
    ('crossovers may be pinned for this nose', 51)
    """

    kind = "patch"

    target: Target
    patch: SmallPatch
    struck: tuple[Struck, ...]

    @property
    def fabric(self) -> Fabric:
        """The fabric."""
        return self.target.setup.fabric

    @property
    def assumed(self) -> tuple[str, ...]:
        """Lines that name what is assumed of the fabric and of resolved yarns."""
        return (*self.patch.zone.assumed_lines, *list_assumptions(self.target.setup))

    @property
    def checks(self) -> tuple[Indicator, ...]:
        """Quality checks: the energy balance of the model whose error is largest."""
        from shellfabric.membrane import quality

        error = max(one.energy_error for one in self.struck)
        return (quality.indicator("energy error", error),)

    @property
    def until(self) -> float:
        """[s] since the first touch to which the models are compared."""
        from weavecell.studies import small_patch

        return small_patch.compare_until(self.struck)

    @property
    def verdict(self) -> str:
        """Whether crossovers may be pinned, in a sentence."""
        from weavecell.studies import small_patch

        return small_patch.judge(self.struck, self.patch.shot.strike_velocity)

    @property
    def answer(self) -> Answer:
        """The verdict."""
        value, _, found = self.verdict.partition(": ")
        return self._find_answer(self._title, value, over=f"{len(self.struck)} models, {found}")

    def summary(self) -> dict[str, Any]:
        """Return the verdict, and of each model what it came to."""
        found = super().summary()
        for one in self.struck:
            found[f"{one.model}_velocity_m_s"] = one.velocity(self.until)
            if isfinite(one.first_failure):
                found[f"{one.model}_first_failure_s"] = one.first_failure
            found[f"{one.model}_energy_error"] = one.energy_error
            found[f"{one.model}_steps"] = one.steps
            found[f"{one.model}_cpu_time_s"] = one.cpu
        return found

    def _what(self):
        return self._title

    def _columns(self):
        at = np.linspace(0.0, min(one.t[-1] for one in self.struck), ROWS)
        columns = {"time_s": at}
        for one in self.struck:
            columns[f"{one.model}_velocity_m_s"] = np.interp(at, one.t, one.v)
            columns[f"{one.model}_way_m"] = np.interp(at, one.t, one.z)
        return columns

    def draw(self, pyplot: Any) -> Figure:
        """Draw the velocity [m/s] of the nose in time and over its way, in each model."""
        from weavecell.report import pictures_records

        curves = [(WORDS[one.model], one.t, one.z, one.v) for one in self.struck]
        return pictures_records.draw_noses(pyplot, curves, self.until, self._title)

    @property
    def _title(self):
        return _describe_patch(self.target, self.patch)

    def files(self) -> dict[str, Any]:
        """Return {file: what it holds} that stands at the top of the module."""
        return {
            "patch.json": {"format": "weavecell patch 1", **self.summary()},
            "patch.csv": self.to_csv(),
            "patch.svg": None,
        }

    def save(self, out: FilePath) -> None:
        """Write the files that stand at the top of the module to a folder."""
        from weavecell.results import provenance

        folder = Path(out)
        with out_folder.hold(out, NAMES):
            self.target.keep_input(folder)
            stamp = provenance.stamp(self.target.text, setup=self.target.setup)
            self._write_files(folder, stamp)

    def lines(self) -> list[str]:
        """Write the lines that are printed, without what is doubtful."""
        times = [t for t in (10e-6, 20e-6, 30e-6, 40e-6, 50e-6) if t < self.until]
        times.append(self.until)
        head = f"{'velocity [m/s] at':<19}" + "".join(f"{1e6 * t:>8.3g} us" for t in times)
        lines = [
            f"{self._title}, friction {self.patch.friction:g} between yarns",
            head + "   CPU s",
        ]
        for one in self.struck:
            speeds = "".join(f"{one.velocity(t):>11.1f}" for t in times)
            lines.append(f"{WORDS[one.model]:<19}{speeds}{one.cpu:>8.2g}")
        for one in self.struck:
            if isfinite(one.first_failure):
                at = 1e6 * one.first_failure
                lines.append(f"{WORDS[one.model]}: the first fibre fails at {at:.3g} us")
        (balance,) = self.checks
        lines.append(f"energy error at most {balance.value:.2%} of the strike energy")
        lines.append(self.verdict)
        laws = self._list_assumed_laws()
        return [*lines, *self.patch.zone.assumed_lines, *laws]
