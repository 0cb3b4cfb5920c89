"""What every result of the Python interface offers, and how it shows in a notebook."""

from __future__ import annotations

import functools
from base64 import b64encode
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from textwrap import shorten
from typing import TYPE_CHECKING, Any, ClassVar

from fabrics import assumed
from fabrics.base.checks import FilePath
from fabrics.base.counted import counted
from fabrics.base.door import in_terminal, option
from fabrics.base.errors import DoubtfulResult
from fabrics.base.extras import explain_missing, find_missing
from shellfabric.membrane.indicator import NOTED
from weavecell.answers.user_warnings import warn_user
from weavecell.results import display, finding, glossary, keys, one_table, out_folder
from weavecell.results.finding import Answer, Mover
from weavecell.results.keys import Key
from weavecell.results.left_out import LeftOut, lines_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from pandas import DataFrame

    from shellfabric.membrane.indicator import Indicator

_LONGEST = 200  # characters of a repr


class Result:
    """What every result offers. A derived class names its table of results/keys.toml, from which
    summary, table and CSV file are read off, and gives `_items`, whose columns these are; or it has
    `summary` and `_columns` itself. It writes its own `lines`, whose first is printed with what is
    doubtful, as every picture that it draws or writes is.

    Examples
    --------
    >>> shot = wc.impact("S-720", "150 m/s", opening="20 mm", end_time="10 us")
    >>> isinstance(shot, wc.Result), shot.doubtful, shot.checks_text
    (True, False, 'ok')
    """

    # table of results/keys.toml that says what it has
    kind: ClassVar[str] = ""
    # what computes it, for `cite`: "panel", "crossover" or "mesh"
    uses: ClassVar[tuple[str, ...]] = ("panel",)
    # lines that it prints at most, beside where it was written to
    _most_lines: ClassVar[int] = 7
    # that it was written to or read from; None of a result that stands in no folder
    folder: Path | None = None

    def __init_subclass__(cls, **options: Any) -> None:
        """Let the pictures of a result say its doubts."""
        super().__init_subclass__(**options)
        for name in ("plot", "plot_panel", "plot_mushroom"):
            if name in vars(cls):
                setattr(cls, name, _with_doubts(vars(cls)[name]))

    @property
    def checks(self) -> tuple[Indicator, ...]:
        """Quality checks (docs/reports/numerics.md), each with name, value, limit, unit, note,
        status ("ok", "noted" or "doubtful"), doubtful (bool) and text; empty if none is defined."""
        return ()

    @property
    def doubts(self) -> tuple[str, ...]:
        """What is doubtful of the result, in words: names of the quality checks that are beyond their
        limits, and what else its numbers rest on."""
        return finding.list_doubts(self.checks)

    @property
    def doubtful(self) -> bool:
        """Whether anything of the result is doubtful."""
        return bool(self.doubts)

    def mark(self, line: str) -> str:
        """Return a line about the result with what is doubtful of it."""
        return finding.mark(line, self.doubts)

    def lines(self) -> list[str]:
        """Write the lines that are printed, without what is doubtful."""
        raise NotImplementedError

    @property
    def answer(self) -> Answer:
        """What it came to, with what is doubtful of it, as it is printed and written."""
        return self._find_answer(getattr(self, "title", self._what()), self.lines()[0])

    def _find_answer(self, subject, value, moved=(), advice=(), **more):
        """Return the Answer with what the checks say and what is left out; `moved` are Movers with
        a number."""
        beyond = [check for check in self.checks if check.doubtful]
        beyond.sort(key=lambda check: -check.excess)
        numbers = {check.name: _say_check(check) for check in beyond}
        others = [doubt for doubt in self.doubts if doubt not in numbers]
        near = dict.fromkeys(_say_check(check) for check in self.checks if check.status == NOTED)
        remedies = [check.remedy.partition(";")[0] for check in beyond]
        return Answer(
            subject,
            value,
            (*others, *numbers.values()),
            movers=(*moved, *(Mover(part.brief, part.settle) for part in self.left_out)),
            advice=(*remedies, *advice),
            near=tuple(near),
            **more,
        )

    @property
    def checks_text(self) -> str:
        """ "ok", or "doubtful: ..." or "noted: ..." with the worst checks, their values and
        limits."""
        from weavecell.report import checks

        return checks.words(self.checks)

    def checks_table(self) -> DataFrame:
        """Return the quality checks as a table: name, value, limit, unit, status and meaning."""
        from weavecell.results.readable import ReadableTable

        columns = ("name", "value", "limit", "unit", "status", "meaning")
        rows = [[getattr(check, column) for column in columns] for check in self.checks]
        return ReadableTable(rows, columns=list(columns))

    def warn(self) -> None:
        """Warn with the category `DoubtfulResult` if the result is doubtful."""
        if self.doubtful:
            words = self.checks_text
            if not any(check.doubtful for check in self.checks):
                words = f"doubtful: {'; '.join(self.doubts)}"
            warn_user(f"{self._what()}: {words}", DoubtfulResult)

    @property
    def assumed(self) -> tuple[str, ...]:
        """Lines that name what is assumed of the fabric that the result is about."""
        return self._lines_of(assumed.lines)

    @property
    def left_out(self) -> tuple[LeftOut, ...]:
        """What the numbers of the result do not cover: mesh, sampling, assumed data, model."""
        return ()

    def _lines_of(self, lines):
        """What a function of the result's fabric says of it, if it has one."""
        fabric = getattr(self, "fabric", None)
        if fabric is None:
            return ()
        return tuple(lines(fabric))

    def _list_assumed_laws(self) -> list[str]:
        """The lines of `assumed` that a quasi-static result follows from."""
        return list(self._lines_of(assumed.laws))

    def _answered(self) -> dict[str, Any]:
        """Return the entries of a JSON file: the answer, and what is doubtful of it."""
        return {"answer": self.answer.entry()} | self._what_is_doubtful()

    def _what_is_assumed(self) -> dict[str, Any]:
        """Return the entries of a summary: what is doubtful, and what is assumed."""
        entries = self._what_is_doubtful()
        if self.assumed:
            entries |= {"assumed": "; ".join(self.assumed)}
        if self.left_out:
            entries["left_out"] = "; ".join(part.text for part in self.left_out)
        return entries

    def _what_is_doubtful(self) -> dict[str, Any]:
        """The entry of a summary and of a JSON file: what is doubtful; none where nothing is."""
        if not self.doubts:
            return {}
        return {"doubts": [*self.doubts]}

    def _what(self) -> str:
        """The result in a few words, for the warning."""
        return type(self).__name__

    def summary(self) -> dict[str, Any]:
        """Return {name with unit: value} of the result; the checks in words."""
        return one_table.facts(self, self.kind) | self._what_is_assumed()

    def _items(self) -> Any:
        """What the table has a row for each of: a sequence of objects, or one object with arrays."""
        raise NotImplementedError

    def _columns(self) -> Mapping[str, Any]:
        """{name with unit: (n,)} of the table."""
        return one_table.columns(self._items(), self.kind)

    def to_dataframe(self) -> DataFrame:
        """Return the result as a pandas.DataFrame; names of the columns end in their SI unit."""
        return one_table.frame(self._columns(), self.kind)

    def to_csv(self) -> str:
        """Return the table of `to_dataframe` as CSV, with all digits."""
        return one_table.csv(self.to_dataframe())

    def __str__(self) -> str:
        if type(self).answer is Result.answer:
            lines = self.details().splitlines()
            most = self._most_lines
            if len(lines) > most:
                rest = counted(len(lines) - most + 1, "more line")
                told = option("verbose") if in_terminal() else "details()"
                lines = [*lines[: most - 1], f"{rest}: {told}"]
            return "\n".join(lines)
        return "\n".join(self.answer.lines(self.folder))

    def details(self) -> str:
        """Write all that is known of it in lines, as --verbose prints it."""
        first, *others = self.lines()
        return "\n".join((self.mark(first), *others, *self._closing_lines()))

    def __repr__(self) -> str:
        parts = [self.mark(self.lines()[0]).rstrip(".")]
        if laws := self._list_assumed_laws():
            parts.append(f"assumed: {counted(len(laws), 'law')}")
        if self.checks_text != "ok":
            parts.append(f"checks {self.checks_text}")
        words = shorten("; ".join(parts), _LONGEST, placeholder=" ...")
        if self.doubts and "doubtful" not in words.lower():
            words = f"{words}; doubtful"
        return f"{type(self).__name__}({words})"

    def _closing_lines(self) -> list[str]:
        """What closes the printed result: what its numbers leave out and, in Python, checks that are not
        ok. The command line prints these itself, after the folder."""
        lines = lines_of(self.left_out)
        if self.checks_text != "ok" and not in_terminal():
            lines.append(f"checks: {self.checks_text}")
        return lines

    def _notebook_table(self) -> DataFrame:
        """The table that a notebook shows: what the summary has, with labels and units."""
        from pandas import DataFrame

        known = {key.name: key for key in self._keys_of_summary()}
        rows = []
        for name, value in self.summary().items():
            key = known.get(name) or keys.infer_key(name)
            # numbers get their unit; a truth value is a word
            if isinstance(value, (int, float)) and not isinstance(value, bool):
                rows.append((key.label, display.number(value, key.unit)))
            elif plain(value) and value not in (None, ""):
                rows.append((key.label, value))
        return DataFrame(rows, columns=["quantity", "value"])

    def _keys_of_summary(self) -> tuple[Key, ...]:
        """The keys that say what the numbers of `summary` are."""
        return keys.TABLES.get(self.kind, ())

    def _labelled_columns(self, *names: str) -> DataFrame:
        """The columns of `to_dataframe` with these names, or all, with labels and units."""
        table = self.to_dataframe()
        columns = [(keys.infer_key(str(name)), table[name]) for name in names or table]
        return display.frame({key.meaning: (key.unit, values) for key, values in columns})

    def _repr_html_(self) -> str:
        # a notebook shows the outcome in bold, then what the terminal prints
        (first, *others) = str(self).splitlines()
        table = self._notebook_table()
        explained: set[str] = set()
        marked = [glossary.mark(line, explained) for line in (first, *others)]
        bold = 1 if type(self).answer is Result.answer else 2
        lines = "\n".join((f"<b>{chr(10).join(marked[:bold])}</b>", *marked[bold:]))
        parts = [f"<pre style='white-space: pre-wrap'>{lines}</pre>"]
        if type(self).answer is not Result.answer:
            more = glossary.mark(self.details(), explained)
            parts.append(
                f"<details><summary>all that is known</summary><pre>{more}</pre></details>"
            )
        if hasattr(self, "plot") and find_missing("matplotlib") is None:
            picture = b64encode(self.plot()._repr_png_()).decode()
            parts.append(f"<img style='max-width: 100%' src='data:image/png;base64,{picture}'>")
        rows = table.to_html(
            index=False, border=0, max_rows=60, na_rep="–", float_format="{:.4g}".format
        )
        opened = ""
        # a long table is folded: the picture should stay in view
        if len(table) <= 24:
            opened = " open"
        return "".join(
            (
                *parts,
                f"<details{opened}><summary>all values, {counted(len(table), 'row')}</summary>{rows}</details>",
            )
        )


class WrittenResult(Result):
    """A result with files. A derived class names them, `_written`, and writes them, `_write`."""

    _written: Sequence[str] = ()

    def save(self, out: FilePath) -> None:
        """Write the files that stand at the top of its module to a folder, but what a run keeps for
        `resume`."""
        folder = Path(out)
        with out_folder.hold(folder, self._written), finding.showing(self.doubts):
            self._write(folder)
        remember_folder(self, folder)

    def _write(self, folder: Path) -> None:
        raise NotImplementedError


def _say_check(check):
    """Return a check with its value and limit."""
    unit = f" {check.unit}".rstrip()
    return f"{check.name} {check.value:.3g}{unit} (limit {check.limit:g}{unit})"


def _with_doubts(show):
    """A method that draws pictures of its result, which say what is doubtful of it."""

    @functools.wraps(show)
    def called(result, *arguments, **options):
        with finding.showing(result.doubts):
            return show(result, *arguments, **options)

    return called


def remember_folder(result: Result, folder: FilePath) -> None:
    """Note at a result, which is frozen, the folder that holds it."""
    vars(result)["folder"] = Path(folder)


def plain(value: object) -> bool:
    """Tell whether a value is shown: a text, a number or None."""
    return isinstance(value, (str, int, float)) or value is None


def save_to(result: Any, out: FilePath | None) -> Any:
    """Return the result, and write it to `out` if there is such a path."""
    if out is not None:
        result.save(out)
    return result


@explain_missing()
def figure(draw: Callable, *arguments: Any) -> Figure:
    """Return what draw(pyplot, *arguments) returns, in the style of the reports."""
    from weavecell.report.pictures_figure import drawn

    return drawn(draw, *arguments)
