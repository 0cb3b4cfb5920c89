"""Progress on stderr, by tqdm: a bar for each stage of work in a terminal and in a notebook.

In a batch job only the command line (`shown`) tells its progress, in lines; Python functions do
not.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, nullcontext
from typing import Any

from fabrics.base import kernel_cache
from fabrics.base.errors import UnstableError

# [s] a stage that takes less shows no bar
DELAY = 1.0
# a batch log is read once an hour: a line each 30 s is enough
# [s] between the lines of a batch job: more lines only fill its log
_EVERY = 30.0
shown = False
# whether the command line prints what is assumed and what comes next
told = True


class _Log:
    """stderr of a batch job, to which each state of a bar is a line."""

    def write(self, text: str) -> None:
        if line := text.strip():
            print(line, file=sys.stderr)

    def flush(self) -> None:
        sys.stderr.flush()


class _Cell:
    """The output of a notebook's cell that a bar is written over, so that none stays in a saved
    notebook."""

    def __init__(self) -> None:
        self.output: Any = None

    def write(self, text: str) -> None:
        from IPython.display import display

        content = {"text/plain": text.strip()}
        if self.output is None:
            self.output = display(content, raw=True, display_id=True)
        else:
            self.output.update(content, raw=True)

    def flush(self) -> None:
        pass


@contextmanager
def bar(title: str, estimate: bool = True) -> Iterator[Callable[..., None]]:
    """Show a bar for a stage, perhaps with an `estimate` of the time left; yields `advance(fraction
    done, text="")`.

    The estimate counts no time in which kernels were compiled.
    """
    shell = getattr(sys.modules.get("IPython"), "get_ipython", lambda: None)()
    notebook = hasattr(shell, "kernel")
    # a bar redraws its line, which a file of a batch job would keep as thousands of lines
    live = sys.stderr.isatty() or notebook
    if not (live or shown):
        yield lambda *_: None
        return
    from tqdm import tqdm

    drawn = ","
    if live:
        drawn = "|{bar}|"
    left = ""
    if estimate:
        left = "<{remaining}"
    form = f"{{desc}}: {{percentage:.0f}} %{drawn} {{elapsed}}{left}{{postfix}}"
    look: dict[str, Any] = {"leave": shown, "delay": DELAY, "miniters": 0, "bar_format": form}
    # the rate is the mean of the stage: of one that is still new, the last steps tell less
    look["smoothing"] = 0
    if notebook:
        look |= {"file": _Cell(), "position": 0}
    elif not live:
        look |= {"file": _Log(), "mininterval": _EVERY}
    with tqdm(desc=title, total=1.0, **look) as meter:
        counted = kernel_cache.seconds_compiled()

        def advance(fraction, text=""):
            nonlocal counted
            compiled = kernel_cache.seconds_compiled()
            meter.start_t += compiled - counted
            counted = compiled
            meter.set_postfix_str(text or "", refresh=False)
            meter.update(min(max(fraction, 0.0), 1.0) - meter.n)

        yield advance
        advance(1.0)


def write(line: str, file: Any) -> None:
    """Print a line above the bars."""
    # without a bar tqdm has not been imported, and need not be
    tqdm = sys.modules.get("tqdm.std")
    with nullcontext() if tqdm is None else tqdm.tqdm.external_write_mode(file):
        print(line, file=file, flush=True)


def run_with_bar(
    run: Callable[[tuple], Any], title: str, hooks: Sequence = ()
) -> tuple[Any, UnstableError | None]:
    """Run an impact as run(hooks) under a progress bar: (its result, the UnstableError that ended
    it or None)."""
    with bar(title) as advance:

        def show(solver):
            if solver.ended:
                share = 1.0
            else:
                share = solver.time / solver.end_time
            # that of its centre of mass: the tip of a bullet of metal swings
            advance(share, f"{solver.sample('v')[-1]:.1f} m/s")

        try:
            return run((show, *hooks)), None
        except UnstableError as problem:
            return problem.result, problem


def count_paths(advance: Callable[..., object], count: int) -> Callable[..., None]:
    """Return a function that shows the progress of `count` paths, as
    `unitcell3d.identify.calibrate` reports it, on one bar."""
    shares = {}

    def report_path(fabric, path, share):
        shares[fabric, path] = share
        text = ", ".join(
            f"{name} {100 * done:.0f} %" for (_, name), done in shares.items() if done < 1
        )
        advance(sum(shares.values()) / count, text)

    return report_path
