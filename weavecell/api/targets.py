"""What the studies of many shots fire at: a fabric with keywords, an input file, or a set-up."""

from __future__ import annotations

import inspect
import os
import time
import warnings
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from fabrics import assumed, catalogue
from fabrics.base import run_cache
from fabrics.base.checks import FilePath
from fabrics.base.errors import InputError
from fabrics.fabric import Fabric
from fabrics.variants import with_linear_density
from weavecell.api import keywords
from weavecell.results import out_folder, progress
from weavecell.scenes import target as targets
from weavecell.scenes.honoured import NO_HISTORY
from weavecell.scenes.target import Target

if TYPE_CHECKING:
    from shellfabric.impact.setup import ImpactSetup
    from weavecell.api.execution import Execution
    from weavecell.scenes.honoured import Keys

# [m/s] for the deck of a fabric, and for studies that choose their velocities
STRIKE = 92.5
# folder of the finished runs
RUNS = "runs"


def of(
    target: Fabric | FilePath | ImpactSetup | None,
    options: Mapping[str, Any],
    refused: Keys,
    velocity: float | str | None = None,
    *,
    function: str = "setup",
    one_shot: bool = False,
) -> Target:
    """The target of a study.

    Parameters
    ----------
    target : a set-up, the path of an input file, or a fabric
    **options : keywords of `weavecell.setup` beside a fabric; none beside the others
    refused : keys of an input file that the study does not honour
    velocity : [m/s] at which a fabric is struck; of a study that chooses it None
    function : that was called, for messages
    one_shot : whether what is computed is a shot, to which strike velocity and [history] mean
        something

    Raises
    ------
    InputError : as `weavecell.setup`; keywords or a velocity beside a set-up or an input file; a
        shot without velocity
    """
    from shellfabric.impact.setup import ImpactSetup

    chosen = {key: value for key, value in options.items() if value is not None}
    beside = chosen
    if velocity is not None:
        beside = chosen | {"velocity": velocity}
    if isinstance(target, ImpactSetup):
        _refuse(beside, "a set-up")
        return Target(None, target, "", target.title, from_file=False)
    file = ""
    if isinstance(target, (str, os.PathLike)):
        file = str(target)
    if targets.is_input_file(file):
        _refuse(beside, "an input file")
        return targets.read(file, Path.cwd(), refused)
    if (
        isinstance(target, str)
        and not target.endswith(".toml")
        and target not in catalogue.list_names()
    ):
        raise targets.unknown(target)
    if "history" in chosen and not one_shot:
        raise InputError(key="history", allowed=NO_HISTORY)
    if velocity is None and one_shot:
        if file.endswith(".toml"):
            given = "an input file, or the fabric file with a velocity"
            raise InputError(
                "is a fabric file", file=target, allowed=f'{given}, such as "92.5 m/s"'
            )
        raise InputError(
            "is missing", key="velocity", allowed='given for a fabric, such as "92.5 m/s"'
        )
    panel = made(target, STRIKE if velocity is None else velocity, chosen, function)
    for line in (f"projectile: {panel.projectile}", *assumed.lines(panel.setup.fabric)):
        targets.build.LOG.info(line)
    return panel


def made(
    fabric: Fabric | FilePath | None,
    velocity: float | str,
    options: Mapping[str, Any],
    function: str = "setup",
) -> Target:
    """What `weavecell.setup` describes, with the input file that says the same if one can. Its
    notes are warnings.

    Parameters
    ----------
    fabric, velocity, options : arguments of `weavecell.setup`
    function : that was called with them, for messages

    Raises
    ------
    InputError : as `setup`
    """
    from weavecell.scenes import build

    own = None
    if fabric is not None:
        own = as_fabric(fabric)
    scene, written = keywords.scene(None if own is None else own.name, velocity, options, function)
    try:
        case = build.build(scene, None, "", own)
        ply = build.setup(case, None)
    except InputError as problem:
        raise keywords.named(problem) from None
    if options.get("snapshot_interval") is None:
        ply = replace(ply, snapshot_interval=None)
    folder = str(Path(__file__).parent)
    # a warning should point at the script, not at a file of ours
    line_of_the_user = next(
        n for n, frame in enumerate(inspect.stack(0)) if not frame.filename.startswith(folder)
    )
    for note in ply.notes:
        warnings.warn(note, stacklevel=line_of_the_user + 1)
    return Target(case, ply, keywords.text(written, fabric), ply.title, from_file=False)


def assumed_of(setup: ImpactSetup) -> tuple[str, ...]:
    """Lines that name what is assumed of the fabrics of a set-up."""
    return tuple(line for fabric in setup.fabrics for line in assumed.lines(fabric))


def as_fabric(fabric: Fabric | FilePath) -> Fabric:
    """A Fabric as it is; that of a name or file with the linear densities of the runs of the
    thesis."""
    if isinstance(fabric, Fabric):
        return fabric
    return with_linear_density(catalogue.load(fabric), "effective")


def _refuse(options, beside):
    for key in options:
        raise InputError(key=key, allowed=f"left out beside {beside}, which has it")


@dataclass(frozen=True)
class Study:
    """A study under way.

    Parameters
    ----------
    folder : of the results; None if nothing is written
    runs : folder, executor and jobs of `run_cache.results`
    advance : called as advance(share done, text)
    """

    folder: Path | None
    runs: dict[str, Any]
    advance: Callable[..., Any]
    began: float = field(default_factory=time.perf_counter)

    @property
    def wall_time(self) -> float:
        """[s] since it began."""
        return time.perf_counter() - self.began

    def report(self, part: int = 0, parts: int = 1) -> Callable[[int, int], None]:
        """Progress of the runs of a part of the study, called as report(number done, number of
        all)."""
        return lambda done, total: self.advance((part + done / total) / parts, f"{done} of {total}")


@contextmanager
def study(
    panel: Target,
    title: str,
    how: Execution,
    *inputs: Any,
) -> Iterator[Study]:
    """A study of `inputs` with its folder, the folder of finished runs, emptied but to `resume`,
    and a bar.

    Raises
    ------
    InputError : as `out_folder.claim`; any other names the target's file
    """
    place = out_folder.held(how.out, how.resume, inputs)
    with (
        place as folder,
        kept_runs(folder, how.resume) as runs,
        panel.named(),
        progress.bar(title) as bar,
    ):
        yield Study(folder, {"folder": runs, **how.pool}, bar)


@contextmanager
def kept_runs(folder: Path | None, resume: bool, name: str = RUNS) -> Iterator[Path]:
    """The folder of the finished runs, emptied but to `resume`; a temporary one where `folder` is
    None."""
    with TemporaryDirectory() as spare:
        if folder is None:
            runs = Path(spare)
        else:
            runs = folder / name
        if not resume:
            run_cache.RunCache(runs).clear()
        yield runs
