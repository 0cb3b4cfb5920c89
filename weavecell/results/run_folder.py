"""What a folder holds of a run that has not ended: its checkpoints, from which it goes on."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from fabrics.base import run_cache
from fabrics.base.checks import FilePath
from fabrics.base.errors import InputError, WeavecellError
from fabrics.base.files import looking, write_hdf5
from fabrics.base.read_formats import read_hdf5
from weavecell.results import file_list
from weavecell.results.hdf5_file import put

if TYPE_CHECKING:
    from shellfabric.coupon.dynamic_relaxation import State

# state of a run that has not ended, which the run takes away itself
CHECKPOINTS = "checkpoint*.h5"
OF_COUPON = "weavecell coupon checkpoint 4"
_STATE = {"load": "1", "x": "m", "reaction": "N", "history": "N", "residual": "1", "energies": "J"}


class Interrupted(WeavecellError):
    """The user stopped a run that can be gone on with."""

    exit_code = 130


def list_checkpoints(out: Path) -> list[Path]:
    """List the checkpoints in a folder: one, or one for each model that has been tried."""
    return sorted(out.glob(CHECKPOINTS))


def is_checkpoint(name: str, path: Path) -> bool:
    """Tell whether a file with a name in a folder is a checkpoint, which carries its own digests."""
    if not file_list.matches(name, [CHECKPOINTS]):
        return False
    from shellfabric.loop import checkpoint

    formats = (checkpoint.FORMAT, OF_COUPON)
    with looking(), suppress(InputError), read_hdf5(path, *formats, sealed=True):
        return True
    return False


def write_states(path: FilePath, stamp: Mapping[str, str], states: Sequence[State]) -> None:
    """Keep the states of a run under way; `stamp` (`fabrics.base.run_cache`) is that of its scene
    and of the code."""
    with write_hdf5(path, OF_COUPON, sealed=True, **stamp) as file:
        for number, state in enumerate(states):
            for name, unit in _STATE.items():
                put(file, f"{number:05d}/{name}", getattr(state, name), unit)


def read_states(path: FilePath, stamp: Mapping[str, str]) -> list[State]:
    """Read the states that `write_states` wrote.

    Raises
    ------
    InputError : there are none, or those of another scene or other code
    """
    from shellfabric.coupon.dynamic_relaxation import State

    with read_hdf5(path, OF_COUPON, what="checkpoint", sealed=True) as file:
        run_cache.check_stamp(file.attrs, stamp, path, of="input file")
        groups = [{name: group[name][()] for name in _STATE} for _, group in sorted(file.items())]
    states = []
    for values in groups:
        values["load"] = float(values["load"])
        values["residual"] = float(values["residual"])
        values["energies"] = tuple(values["energies"])
        states.append(State(settled=True, **values))
    return states
