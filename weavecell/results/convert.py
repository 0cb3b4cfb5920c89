"""Results of a finished run in a standard format.

The folder of `weavecell convert`
    panel.vtkhdf         `--to vtkhdf`: all snapshots of panel.pvd in one file (`results.vtkhdf`)
    histories.parquet    `--to parquet`: the histories, a row a sample, units in the schema (`results.parquet`)
"""

from __future__ import annotations

from pathlib import Path

from fabrics.errors import InputError
from weavecell.results import parquet, vtkhdf

NAMES = {"vtkhdf": "panel.vtkhdf", "parquet": "histories.parquet"}  # what is written to the folder by default


def convert(folder: Path, to: str, out: Path | None = None) -> Path:
    """Write the snapshots of a run as VTKHDF, or its histories as Parquet.

    Parameters
    ----------
    folder : of a finished run: of an impact with panel.pvd for "vtkhdf", of an impact or a coupon for "parquet"
    to : of NAMES
    out : file to write; None takes that of NAMES in `folder`

    Returns
    -------
    path : of the file written

    Raises
    ------
    InputError : an unknown format, nothing to convert, or no pyarrow; nothing has been written
    """
    if to not in NAMES:
        raise InputError(key="--to", value=to, allowed=" or ".join(NAMES))
    path = out or folder / NAMES[to]
    if path.suffix != f".{to}":
        raise InputError(key="--out", value=str(path), allowed=f"a file named *.{to}")
    if to == "vtkhdf":
        vtkhdf.write(path, folder / "panel.pvd")
    else:
        try:
            parquet.write_histories(path, folder / "histories.h5")
        except ImportError as problem:
            allowed = f"vtkhdf, or parquet with the Python package pyarrow ({problem})"
            raise InputError(key="--to", value=to, allowed=allowed) from None
    return path
