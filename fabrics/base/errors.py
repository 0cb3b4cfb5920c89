"""The errors a user can meet, each with the exit code that the command line returns for it.

InputError (2): a scene, fabric, mesh or restart file is wrong; nothing has been written.
UnstableError (3): a run has become unphysical and stopped itself; what it had computed is kept.
UndecidedError (3): a shot of a search of the critical velocity has neither stopped nor perforated;
see its class.
DoubtfulError (3): a run has ended with a quality indicator beyond its limit, and --strict was
given; results are kept.
"""

from __future__ import annotations

import re
import traceback
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from fabrics.base import amounts, written

_ROOT = Path(__file__).parents[2]
_OWN = [_ROOT / name for name in ("fabrics", "meshing", "unitcell3d", "shellfabric", "weavecell")]


class WeavecellError(Exception):
    """Base of all errors that are reported to the user as one line, without a traceback."""

    exit_code = 1

    def _render_traceback_(self) -> list[str]:
        """Return what IPython shows in place of a traceback: the line that called weavecell, and the
        error."""
        lines = [f"{type(self).__name__}: {self}"]
        for frame in reversed(traceback.extract_tb(self.__traceback__)):
            library = "-packages" in frame.filename
            own = any(Path(frame.filename).is_relative_to(folder) for folder in _OWN)
            if not own and not library:
                return [f"line {frame.lineno}: {frame.line}", *lines]
        return lines


# signals of this process that `raise_interrupt` made an interrupt of
_interrupts: list[int] = []


def raise_interrupt(number: int, _frame: object) -> None:
    """Raise KeyboardInterrupt, and remember it: a handler of signals.

    Raises
    ------
    KeyboardInterrupt
    """
    _interrupts.append(number)
    raise KeyboardInterrupt


@contextmanager
def interrupts() -> Iterator[None]:
    """Raise KeyboardInterrupt in this block also where it came inside of a library that makes
    another error of it: numba a SystemError as it calls a kernel, VTK an ImportError as it loads."""
    before = len(_interrupts)
    try:
        yield
    except (WeavecellError, OSError):
        raise
    except Exception as problem:
        if len(_interrupts) > before or _is_of_interrupt(problem):
            raise KeyboardInterrupt from None
        raise


def _is_of_interrupt(problem):
    """Whether a SystemError goes back to an interrupt."""
    cause = problem
    while isinstance(problem, SystemError) and cause is not None:
        if isinstance(cause, KeyboardInterrupt):
            return True
        cause = cause.__cause__ or cause.__context__
    return False


# in place of a value: what the file has, and nothing where that is not known
AS_WRITTEN = written.AS_WRITTEN


class InputError(WeavecellError, ValueError):
    """Bad input, one line a problem: the file, its line, the key, its value and what is allowed.

    Of a file that was read the line shows what stands there, in the user's unit, and beside a limit of
    ours the same in that unit; so do other keys that the line names (`fabrics.base.written`).

    Parameters
    ----------
    message : a complete sentence, used where the problem is not one key of one file
    file, key, value : where the bad value stands, and what it is; AS_WRITTEN of one that the file has
    allowed : what would have been accepted
    line : of the file, if it is known; else it is looked up
    made : where a value comes from that no user typed, such as "fitted: curve.csv"

    Examples
    --------
    >>> try:
    ...     wc.setup("S-720", "92.5 kg")
    ... except wc.InputError as problem:
    ...     print(problem.key, problem.value)
    velocity 92.5 kg
    """

    exit_code = 2

    def __init__(
        self,
        message: str | None = None,
        *,
        file: object = None,
        key: str | None = None,
        value: object = None,
        allowed: str | None = None,
        line: int = 0,
        made: str = "",
    ) -> None:
        self.message = message
        self.file = file
        self.key = key
        self.value = value
        self.allowed = allowed
        self.line = line
        self.made = made
        self._given = value
        found = written.find(file, key, value)
        if found is not None:
            self.line = line or found.line
            self.made = made or found.made
            self.value = found.part(value)
        elif value is AS_WRITTEN:
            self.value = None
        # one line, whatever breaks a value has
        super().__init__(" ".join(self._sentence(found).split()))

    def _sentence(self, found):
        """The line that a user reads; `found` is what stands in the file."""
        parts = []
        if self.file is not None:
            parts.append(f"{self.file}:{self.line}:" if self.line else f"{self.file}:")
        if self.key is not None:
            name = self.key
            if found is not None and found.key != self.key:
                name = f"{found.key} = {_shown(found.value)} has {self.key}"
            if self.value is not None:
                name += f" = {_shown(self.value)}"
            if self.made:
                name += f" ({self.made})"
            parts.append(f"{name}:")
        words = []
        if self.message is not None:
            words.append(self.message)
        if self.allowed is not None:
            words.append(f"must be {self.allowed}")
        text = amounts.in_unit_of(self.value, "; ".join(words))
        for name, other in written.others_in(self.file, text, self.key).items():
            text = text.replace(name, f"{name} ({other})", 1)
        return " ".join([*parts, text])

    def changed(self, **attributes: Any) -> InputError:
        """Return the same error with another file, key or value."""
        own: dict[str, Any] = {
            "file": self.file,
            "key": self.key,
            "value": self._given,
            "allowed": self.allowed,
            "line": self.line,
            "made": self.made,
        }
        if attributes.get("file", self.file) != self.file:
            own["line"] = 0
        return InputError(self.message, **own | attributes)


@contextmanager
def placed(file: object, prefix: str = "") -> Iterator[None]:
    """Give an InputError that is raised in this block, and names no file, this one and the prefix
    before its key."""
    try:
        yield
    except InputError as problem:
        # what was read from a file inside this block knows better where it stands
        if problem.file is not None:
            raise
        key = problem.key
        if key is not None:
            key = prefix + key
        raise problem.changed(file=file, key=key) from None


# of the letters of a name, of which its like has more
_ALIKE = 2 / 3 + 1e-9


def nearest(name: str, known: Iterable[str]) -> str | None:
    """Find the one of the `known` names that a mistyped `name` may be meant for: one with more than two
    thirds of its letters in their places, else the only one that begins with it, or has a word of it."""
    names = list(known)
    best = max(names, key=lambda other: _likeness(name.lower(), other.lower()), default="")
    if best and _likeness(name.lower(), best.lower()) > _ALIKE:
        return best
    begun = [other for other in names if other.lower().startswith(name.lower())]
    for found in (begun if len(name) > 2 else [], share_word(name, names)):
        if len(found) == 1:
            return found[0]
    return None


def share_word(name: str, known: Iterable[str]) -> list[str]:
    """List the `known` names that have a word of a name."""
    words = set(_words_of(name))
    return [other for other in known if words & set(_words_of(other))]


def _words_of(name):
    """Return the words of at least four letters, one and several alike."""
    return [word.removesuffix("s") for word in re.findall(r"[a-z]{4,}", name.lower())]


def _likeness(name, other):
    """Return the share of the letters that need no change, exchanges of neighbours counting as one
    change [-]."""
    # rows of the table of distances of all beginnings
    before: list[int] = []
    row = list(range(len(other) + 1))
    for i, letter in enumerate(name):
        before, last, row = row, before, [i + 1]
        for j, its in enumerate(other):
            least = min(before[j + 1] + 1, row[j] + 1, before[j] + (letter != its))
            if i and j and letter == other[j - 1] and name[i - 1] == its:
                least = min(least, last[j - 1] + 1)
            row.append(least)
    return 1 - row[-1] / max(len(name), len(other), 1)


def nearest_name(name: str, known: Iterable[str]) -> str | None:
    """Find the `known` name that a mistyped one may be meant for, as `nearest`, but none with other
    numbers in it: a fragment of 2.79 g is near to one of 17 grain by its letters alone."""
    numbers = _numbers_in(name)
    if numbers:
        known = [other for other in known if _numbers_in(other) == numbers]
    return nearest(name, known)


def _numbers_in(name):
    return [float(number) for number in re.findall(r"[0-9]*\.?[0-9]+", name)]


def unknown_name(
    kind: str,
    name: str,
    known: Sequence[str],
    *,
    file: object = None,
    key: str | None = None,
    near: str | None = None,
) -> InputError:
    """Return the InputError of a `name` that no `kind` has, with the nearest of the `known` names
    and all of them."""
    near = near or nearest_name(name, known)
    hint = ";"
    if near:
        hint = f', did you mean "{near}"?'
    return InputError(
        f"unknown {kind}{hint} allowed: {', '.join(known)}", file=file, key=key, value=name
    )


# of a value that a line shows
_LONGEST = 200


def _shown(value):
    """A value in an error: six digits of a number, as a converted unit has noise in the last."""
    if type(value) is float:
        return repr(float(f"{value:.6g}"))
    try:
        return _shorten(repr(value))
    # an object of the user's
    except Exception:
        return f"a {type(value).__name__}"


def _shorten(text):
    """A text with its middle left out where it is too long for a line."""
    if len(text) <= _LONGEST:
        return text
    return f"{text[: _LONGEST // 2]} ... {text[-_LONGEST // 4 :]}"


class InputErrors(InputError):
    """Several things that are wrong with one input, a line each; its attributes are those of the
    first.

    Parameters
    ----------
    problems : of one input, at least one
    """

    def __init__(self, problems: Sequence[InputError]) -> None:
        first = problems[0]
        self.problems = tuple(problems)
        WeavecellError.__init__(self, "\n".join(map(str, problems)))
        for name in ("message", "file", "key", "value", "allowed", "line", "made"):
            setattr(self, name, getattr(first, name))

    # exceptions come back from worker processes pickled, and pickle calls the class with `Exception.args`
    def __reduce__(self) -> tuple[Any, ...]:
        return InputErrors, (self.problems,)


def together(problems: Sequence[InputError]) -> InputError:
    """Join all `problems` in one error: the one itself, or an InputErrors."""
    if len(problems) == 1:
        return problems[0]
    return InputErrors(problems)


def without_file(problem: InputError, file: object) -> InputError:
    """Return an InputError without a file that the user has not given."""
    if isinstance(problem, InputErrors):
        return together([without_file(part, file) for part in problem.problems])
    if problem.file != file:
        return problem
    return problem.changed(file=None)


def marked(problem: object) -> str:
    """Format an error as a program prints it, each line marked as one."""
    return "\n".join(f"error: {line}" for line in str(problem).splitlines())


class UnstableError(WeavecellError):
    """A run that has become unphysical, with where and when.

    Parameters
    ----------
    message : what was found (energy drift, NaN, inverted element, failed Newton)
    where : the element, node or load case, in words
    when : the time, step or load, in words
    result : what the run had computed by then, if it leaves something

    Attributes
    ----------
    shots : of a search, those that had ended before

    Examples
    --------
    >>> print(wc.UnstableError("the energy error is 12 %", where="element 7", when="after 3 us"))
    the energy error is 12 %, at element 7, after 3 us
    """

    exit_code = 3
    shots: tuple = ()

    def __init__(
        self, message: str, *, where: str | None = None, when: str | None = None, result: Any = None
    ) -> None:
        self.where = where
        self.when = when
        self.result = result
        text = message
        if where is not None:
            text += f", at {where}"
        if when is not None:
            text += f", {when}"
        super().__init__(text)


class UndecidedError(WeavecellError):
    """A shot of a search that has neither stopped nor perforated: its panel has no critical
    velocity at this speed.

    Attributes
    ----------
    shots : those that had ended before it

    Examples
    --------
    >>> wc.UndecidedError("neither stopped nor perforated after 2 ms").shots
    ()
    """

    exit_code = 3
    shots: tuple = ()


class DoubtfulError(WeavecellError):
    """A run with a quality indicator beyond its limit, if the user wants that to be an error
    (--strict)."""

    exit_code = 3


class DoubtfulResult(UserWarning):
    """Warning of the Python interface: a result with a quality check beyond its limit.
    `warnings.simplefilter("error", weavecell.DoubtfulResult)` makes it an error.

    Examples
    --------
    >>> import warnings
    >>> with warnings.catch_warnings():
    ...     warnings.simplefilter("error", wc.DoubtfulResult)
    ...     try:
    ...         wc.impact("S-720", "150 m/s", opening="20 mm", end_time="10 us", elements_per_crossover=1,
    ...                   numerics={"contact_points": 2})
    ...     except wc.DoubtfulResult as problem:
    ...         print(str(problem)[:58])
    S-720, 150 m/s: in flight: doubtful: contact point spacing
    """
