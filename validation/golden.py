"""Golden rows: the cheap rows of a study by which `validation.stale` sees whether its CSV is still true.

A change of the code seldom changes a number, and a digest of the code cannot tell which: the rows are computed again.
What the table [golden] of a study's file says of them: `Golden`.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Any

from pydantic import BeforeValidator, Field, model_validator

from fabrics.base.errors import InputError
from fabrics.base.schema import Table, as_tuple, described, number, string, validated
from validation import csv_file, study
from validation.study import Row, Study

TOLERANCE = 1e-9


class Golden(Table):
    """The golden rows of a study, or why it has none.

    [golden]
    rows = [{ method = "default" }]
    cpu_s = 0.9
    """

    rows: Annotated[
        tuple[dict[str, Any], ...],
        BeforeValidator(as_tuple),
        described(
            "one case for each kind of model of the study, by keys of `each` or its name",
            "a list of tables {key: value}",
        ),
    ] = ()
    cpu_s: number("[s] of all rows, measured: the cheapest study is first", 1.4, ge=0.0) = 0.0
    tolerance: number("[-] largest change of a number over the kept one", 1e-4, gt=0.0, le=0.1) = (
        TOLERANCE
    )
    absolute: Annotated[
        dict[str, float],
        described(
            "beside the tolerance, by heading and in its unit: of what is nothing but rounding",
            "a table {heading: number}",
        ),
    ] = Field(default_factory=dict)
    why: string("reason of a wider tolerance, or of `absolute`", "a sentence") = ""
    bracket: string(
        "the two ends of the bracket of a search, of `kept`, {heading: number or list} in the CSV. "
        "In place of the search one shot is fired a tenth of its width below, and one above",
        "an expression",
    ) = ""
    without: Annotated[
        tuple[str, ...],
        BeforeValidator(as_tuple),
        described("keywords that are left out, as the search of a mean", "a list of keywords"),
    ] = ()
    columns: Annotated[
        tuple[str, ...],
        BeforeValidator(as_tuple),
        described("headings that are compared, if not all", "a list of headings"),
    ] = ()
    clock: Annotated[
        tuple[str, ...],
        BeforeValidator(as_tuple),
        described("headings that are times of a computer", "a list of headings"),
    ] = ()
    none: string("why there is no row", "a sentence") = ""

    @model_validator(mode="after")
    def _are_given(self):
        if bool(self.rows) == bool(self.none):
            raise InputError(key="rows", allowed="given, or `none` says why not")
        if (self.tolerance > TOLERANCE or self.absolute) and not self.why:
            raise InputError(key="why", allowed="given beside a wider tolerance")
        return self


def table(chosen: Study) -> Golden:
    """Read [golden] of a study.

    Raises
    ------
    InputError : there is none, or it is no `Golden`
    """
    file = study.FOLDER / f"{chosen.name}.toml"
    if "golden" not in chosen.content:
        raise InputError("has no table [golden]: name rows, or say why there are none", file=file)
    return validated(Golden, chosen.content["golden"], file)


def rows(chosen: Study) -> list[Row]:
    """Return the golden rows of a study.

    Raises
    ------
    InputError : a selector that is of no case, or of several
    """
    found = []
    every = chosen.rows()
    for selector in table(chosen).rows:
        of_it = [row for row in every if selector.items() <= row.labels.items()]
        if len(of_it) != 1:
            raise InputError(
                key="golden.rows",
                value=selector,
                file=study.FOLDER / f"{chosen.name}.toml",
                allowed=f"keys and values of one case, and not of {len(of_it)}",
            )
        found += of_it
    return found


def kept_row(chosen: Study, row: Row, records: Sequence[dict[str, str]]) -> dict[str, str]:
    """Find the record of a case in the rows of its CSV.

    Raises
    ------
    InputError : there is none, or more than one
    """
    labels = {heading(chosen, key): csv_file.text(value) for key, value in row.labels.items()}
    found = [one for one in records if labels.items() <= one.items()]
    if len(found) != 1:
        raise InputError(
            f"has {len(found)} rows of the golden row {name(row)}: compute the study again",
            file=f"docs/reports/data/{chosen.name}.csv",
        )
    return found[0]


def heading(chosen: Study, key: str) -> str:
    """Return the heading of a column in the CSV."""
    return chosen.content.get("columns", {}).get(key, key)


def name(row: Row) -> str:
    """Name a case by its labels."""
    return ", ".join(f"{key} = {csv_file.text(value)}" for key, value in row.labels.items())


def places(chosen: Study, records: Sequence[dict[str, str]]) -> list[int]:
    """Return the numbers of the golden rows in the rows of the CSV, from 1."""
    return [records.index(kept_row(chosen, row, records)) + 1 for row in rows(chosen)]
