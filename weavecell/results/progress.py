"""Progress on stderr: one bar per stage of work on a terminal; elsewhere, as in a batch job, plain lines.

Only the command line shows it (`shown`), not the functions of the Python interface.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

from fabrics.errors import UnstableError

_EVERY = 30.0  # [s] between plain lines
shown = False


@contextmanager
def bar(title: str) -> Iterator[Callable[..., None]]:
    """Show a bar for a stage; yields `advance(fraction, text="")`, to be called with the fraction done, 0 to 1."""
    if not shown:
        yield lambda *_: None
        return
    if not sys.stderr.isatty():
        started = last = time.perf_counter()

        def line(fraction, text=""):
            nonlocal last
            if time.perf_counter() - last >= _EVERY:
                last = time.perf_counter()
                print(f"{title}: {100 * fraction:.0f} %{text and ', '}{text}", file=sys.stderr, flush=True)

        yield line
        print(f"{title}: {time.perf_counter() - started:.1f} s", file=sys.stderr, flush=True)
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, SpinnerColumn, TaskProgressColumn, TextColumn, TimeElapsedColumn

    columns = (
        SpinnerColumn(finished_text="[green]\u2713[/]"),
        TextColumn("{task.description}", justify="left"),
        BarColumn(bar_width=28),
        TaskProgressColumn(),
        TimeElapsedColumn(),
        TextColumn("[dim]{task.fields[note]}[/]"),
    )
    with Progress(*columns, console=Console(file=sys.stderr)) as progress:
        task = progress.add_task(f"{title:<34}", total=1.0, note="")

        def advance(fraction, text=""):
            progress.update(task, completed=min(max(fraction, 0.0), 1.0), note=text)

        yield advance
        progress.update(task, completed=1.0, note="")


def watched(run: Callable[[tuple], Any], title: str, hooks: Sequence = ()) -> tuple[Any, UnstableError | None]:
    """run(hooks) of an impact under a progress bar: (its result, the UnstableError that ended it or None)."""
    from shellfabric.output.hooks import Progress

    with bar(title) as advance:
        watching = Progress(lambda share, speed: advance(share, f"{speed:.1f} m/s"))
        try:
            return run((watching, *hooks)), None
        except UnstableError as problem:
            return problem.result, problem


def by_path(advance: Callable[..., object], count: int) -> Callable[..., None]:
    """Progress of `count` paths, as `unitcell3d.identify.calibrate` reports it, shown on one bar."""
    shares = {}

    def report_path(fabric, path, share):
        shares[fabric, path] = share
        text = ", ".join(f"{name} {100 * done:.0f} %" for (_, name), done in shares.items() if done < 1)
        advance(sum(shares.values()) / count, text)

    return report_path
