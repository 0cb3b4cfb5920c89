"""A study of many shots under way: its folder, its finished runs, its progress."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from fabrics.base import run_cache
from weavecell.results import out_folder, progress

if TYPE_CHECKING:
    from weavecell.api.execution import Execution
    from weavecell.api.target import Target

# folder of the finished runs
RUNS = out_folder.RUNS


@dataclass(frozen=True)
class RunningStudy:
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
        """Return a function that shows the progress of the runs of a part of the study, called as
        report(number done, number of all)."""
        return lambda done, total: self.advance((part + done / total) / parts, f"{done} of {total}")


@contextmanager
def begin_study(
    panel: Target,
    title: str,
    how: Execution,
    names: Iterable[str],
    *inputs: Any,
) -> Iterator[RunningStudy]:
    """Open a study of `inputs` with its folder, the folder of finished runs, emptied unless it is
    to `resume`, and a bar.

    `names` are those of the files that it writes, with wildcards.

    Raises
    ------
    InputError : as `out_folder.claim`; any other names the target's file
    """
    place = out_folder.hold(how.out, names, how.resume, inputs)
    with (
        place as folder,
        keep_runs(folder, how.resume) as runs,
        panel.name_problems(),
        progress.bar(title) as bar,
    ):
        yield RunningStudy(folder, {"folder": runs, **how.pool}, bar)


@contextmanager
def keep_runs(folder: Path | None, resume: bool, name: str = RUNS) -> Iterator[Path]:
    """Open the folder of the finished runs, emptied unless it is to `resume`; a temporary one if
    `folder` is None."""
    with TemporaryDirectory() as spare:
        if folder is None:
            runs = Path(spare)
        else:
            runs = folder / name
        if not resume:
            run_cache.RunCache(runs).clear()
        yield runs
