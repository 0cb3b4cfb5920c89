"""What a loading path leaves behind: one row per converged step, kept also where the path ends early."""

from __future__ import annotations

from dataclasses import dataclass, field, fields

import h5py
import numpy as np

from fabrics.errors import InputError
from fabrics.files import replace_whole

_FORMAT = "weavecell crossover history 1"


@dataclass(frozen=True)
class History:
    """A path of n converged steps, the first of them at rest. Index 0 is warp, 1 is weft.

    Parameters
    ----------
    path : (n,) [-] share of the path
    d1, d2 : (n,) [m] end displacements per end
    plates : (n,) [m] half the distance of the plates (infinite: none)
    T1, T2 : (n,) [N] tensions of the whole yarns, from the reactions
    F_c : (n,) [N] contact force of the crossover
    F_plate : (n, 2) [N] force on the upper and the lower plate
    h1, h2 : (n,) [m] heights of the centrelines
    d_c : (n,) [m] compression of one yarn, half of the loss of h1 + h2
    d_yarns : (n, 2) [m] of each yarn by itself: what its axis has approached its contact face at the crossing
    fibre_strain_max, fibre_strain_mean : (n, 2) [-] worst bar and mean of the bars of warp and weft
    iterations : (n,) Newton iterations
    seconds : (n,) [s] wall time of each step
    u : (points, 3) [m] displacement of the last step
    gaps : per yarn (nodes of the contact face,) [m] of the last step, infinite without a partner
    fabric, case : names
    failed : reason why the path ended before its end, "" where it did not
    """

    path: np.ndarray
    d1: np.ndarray
    d2: np.ndarray
    plates: np.ndarray
    T1: np.ndarray
    T2: np.ndarray
    F_c: np.ndarray
    F_plate: np.ndarray
    h1: np.ndarray
    h2: np.ndarray
    d_c: np.ndarray
    d_yarns: np.ndarray
    fibre_strain_max: np.ndarray
    fibre_strain_mean: np.ndarray
    iterations: np.ndarray
    seconds: np.ndarray
    u: np.ndarray = field(repr=False)
    gaps: tuple = field(repr=False)
    fabric: str = ""
    case: str = ""
    failed: str = ""

    def at(self, column, quantity, value):
        """`column` interpolated where `quantity` first reaches `value`; None where it never does.

        Parameters
        ----------
        column, quantity : (n,) arrays of this history
        """
        reached = np.flatnonzero(np.asarray(quantity) >= value)
        if reached.size == 0:
            return None
        i = reached[0]
        if i == 0:
            return float(column[0])
        share = (value - quantity[i - 1]) / (quantity[i] - quantity[i - 1])
        return float(column[i - 1] + share * (column[i] - column[i - 1]))

    def write(self, path, **notes):
        """Write as HDF5 (.h5), with notes (numbers and texts) that `notes` gives back."""
        with replace_whole(path) as beside, h5py.File(beside, "w") as file:
            file.attrs.update({f"note {name}": value for name, value in notes.items()}, format=_FORMAT)
            for item in fields(self):
                value = getattr(self, item.name)
                if isinstance(value, str):
                    file.attrs[item.name] = value
                elif item.name == "gaps":
                    for yarn, gaps in enumerate(value):
                        file[f"gaps/{yarn}"] = gaps
                else:
                    file[item.name] = value

    @staticmethod
    def notes(path):
        """The notes of a file; {} where it is none of these."""
        try:
            with h5py.File(path, "r") as file:
                return {name[5:]: value for name, value in file.attrs.items() if name.startswith("note ")}
        except OSError:
            return {}

    @classmethod
    def read(cls, path) -> History:
        """Read what `write` wrote.

        Raises
        ------
        InputError : no such file, or another format
        """
        try:
            with h5py.File(path, "r") as file:
                if file.attrs.get("format") != _FORMAT:
                    raise InputError(file=path, key="format", value=file.attrs.get("format"), allowed=repr(_FORMAT))
                content = {}
                for item in fields(cls):
                    if item.name == "gaps":
                        content["gaps"] = tuple(file[f"gaps/{yarn}"][:] for yarn in (0, 1))
                    elif item.name in file:
                        content[item.name] = file[item.name][:]
                    else:
                        content[item.name] = str(file.attrs[item.name])
        except OSError as problem:
            raise InputError("cannot be read", file=path, allowed=f"a crossover history ({problem})") from problem
        return cls(**content)
