"""Options of the cell on the command lines of this package."""

from __future__ import annotations

import argparse
from typing import Any

from fabrics.errors import InputError
from fabrics.units import si
from shellfabric.cell.model import PROFILES


def toe(text: str) -> Any:
    """A strain from "0.1 %", or those of warp and weft from "0.1 %, 0.2 %"."""
    try:
        values = tuple(si(part.strip(), "", key="--toe") for part in text.split(","))
    except InputError as problem:
        raise argparse.ArgumentTypeError(str(problem)) from None
    return values[0] if len(values) == 1 else values


def add_options(parser: argparse.ArgumentParser) -> None:
    """--profile and --toe, of CellModel."""
    parser.add_argument("--profile", choices=list(PROFILES), default="cosine", help="of the yarns")
    parser.add_argument("--toe", type=toe, default=0.0, help="strain that the fibres' straightening takes: 0.1 %%, or "
                        "one of the warp and one of the weft, 0.1 %%,0.2 %%")  # fmt: skip
