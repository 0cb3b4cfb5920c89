"""Tables that a notebook shows as a reader wants them."""

from __future__ import annotations

from typing import Any

from pandas import DataFrame, option_context


class ReadableTable(DataFrame):
    """A pandas.DataFrame that shows four digits and whole texts; the numbers in it are exact.

    Examples
    --------
    >>> table = ReadableTable({"value": [10.2362204, 0.00051]})
    >>> [row.split() for row in repr(table).splitlines()[1:]], table["value"][0]
    ([['0', '10.24'], ['1', '0.00051']], 10.2362204)
    """

    @property
    def _constructor(self) -> Any:
        # parts of it are shown alike
        return ReadableTable

    def __repr__(self) -> str:
        with option_context("display.float_format", "{:.4g}".format):
            return str(super().__repr__())

    def _repr_html_(self) -> Any:
        whole = ("display.max_colwidth", None, "display.float_format", "{:.4g}".format)
        with option_context(*whole):
            return super()._repr_html_()
