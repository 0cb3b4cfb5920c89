"""Tables of cells kept from run to run, by the content of the cell and the code that fills them.

In a process the last few are in memory: shots that differ in velocity, panel or mesh share them.
Between processes what the cell's equations give at the grid is kept, under the cell and the number of stretches, and
the coefficients are made anew, so that a kept table is the filled one to the last bit. The files
lie in the user's cache folder (`WEAVECELL_CACHE_DIR`, or `$XDG_CACHE_HOME/weavecell`, or
`~/.cache/weavecell`); the least recently used are removed. With WEAVECELL_CACHE_DIR empty nothing
is kept.
"""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path

import numpy as np

from fabrics.base.run_cache import RunCache, inputs_digest, key
from shellfabric.cell.model import COLUMNS, CellModel, CellTable

MOST_BYTES = 200e6  # of all kept tables; one of 201 x 201 has 2.6 MB
# tables in memory, of 12 MB each with what the kernels read: the fabrics of a pack and of a comparison
MOST_IN_MEMORY = 4
_IN_MEMORY: dict[str, CellTable] = {}


def folder() -> Path | None:
    """Return the folder of the kept tables, or None if none are kept."""
    given = os.environ.get("WEAVECELL_CACHE_DIR")
    if given is not None:
        if given:
            return Path(given, "tables")
        return None
    root = os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache")
    # a user without a home keeps none
    if not os.path.isabs(root):
        return None
    return Path(root, "weavecell", "tables")


def share(model: CellModel, n: int = 201, *, on_disk: bool = False) -> CellTable:
    """Return the table of a cell with n x n stretches: that in memory, or one that is made.

    Parameters
    ----------
    on_disk : whether it is made by `table`

    Raises
    ------
    InputError, UnstableError : as CellTable.fill
    """
    name = inputs_digest((model, int(n)))
    found = _IN_MEMORY.pop(name, None)
    if found is None and on_disk:
        found = table(model, n)
    elif found is None:
        found = model.table(n)
    # the one used last is at the end
    _IN_MEMORY[name] = found
    if len(_IN_MEMORY) > MOST_IN_MEMORY:
        del _IN_MEMORY[next(iter(_IN_MEMORY))]
    return found


def table(model: CellModel, n: int = 201) -> CellTable:
    """Return the table of a cell with n x n stretches: a kept one, or one that is filled and kept.

    Raises
    ------
    InputError, UnstableError : as CellTable.fill
    """
    place = folder()
    if place is None:
        return model.table(n)
    kept = RunCache(place)
    name = key((model, int(n)), "shellfabric.cell.table_cache")
    with suppress(OSError, KeyError, ValueError):
        x, y, out = _split(kept[name])
        os.utime(kept.file(name))
        return CellTable.of_values(model, x, y, dict(zip(COLUMNS, out)))
    filled = model.table(n)
    with suppress(OSError):
        kept[name] = _join(filled)
        trim(place, MOST_BYTES)
    return filled


def trim(place: Path, most: float) -> None:
    """Remove the files of a folder that were used longest ago, until the others have at most `most`
    bytes."""
    files = sorted(
        (file.stat().st_mtime, file.stat().st_size, file) for file in RunCache(place).files()
    )
    excess = sum(size for _, size, _ in files) - most
    for _, size, file in files:
        if excess <= 0:
            break
        file.unlink(missing_ok=True)
        excess -= size


def _join(filled):
    """One array (8 n + 2, n): the two stretches, then the columns."""
    columns = np.stack([filled.values[name] for name in COLUMNS])
    return np.vstack([filled.stretch1, filled.stretch2, columns.reshape(-1, filled.stretch2.size)])


def _split(array):
    """((n,), (n,), (8, n, n)) of what `_join` made; ValueError where it is no such array."""
    n = array.shape[-1]
    if array.shape != (len(COLUMNS) * n + 2, n) or array.dtype != float:
        raise ValueError("is not a table")
    return array[0].copy(), array[1].copy(), array[2:].reshape(len(COLUMNS), n, n)
