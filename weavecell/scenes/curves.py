"""Curves of tests in CSV files, and the constants of a fabric file that are fitted to them.

Picture frame: columns "shear angle [deg], shear stress [MPa]", or "shear angle [deg], force [N]" with the side of the
frame. The force F of the crosshead on a frame of side L, sheared by gamma, is a shear force F_s along each side:

    F = 2 F_s cos(phi),  phi = (pi/2 - gamma) / 2,  stress = F_s / (L t)

with t the thickness of the fabric as a shell (thesis section 6.6). The three zones of the trellis law are fitted
(`unitcell3d.identify.shear_fit`).

Yarn in tension: columns "strain [%], force [N]". The straight line through the points between LINEAR shares of the
greatest force gives E A_s and the slack at its foot; the failure strain is the greatest force over E A_s.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from fabrics.checks import FilePath
from fabrics.errors import InputError
from fabrics.files import read_columns

if TYPE_CHECKING:
    from unitcell3d.identify.shear_fit import ShearFit

LINEAR = (0.2, 0.9)  # of the greatest force
FEWEST = 5  # points on the straight line


@dataclass(frozen=True)
class YarnFit:
    """Constants of a yarn in tension.

    Parameters
    ----------
    EA : [N] axial stiffness
    failure_strain : [-] greatest force over E A_s
    slack : [-] strain at the foot of the straight line
    rms : [N] of the points on it
    """

    EA: float
    failure_strain: float
    slack: float
    rms: float


def picture_frame(path: FilePath, thickness: float, side: float | None = None) -> ShearFit:
    """Fit the trellis law to the curve of a picture-frame test.

    Parameters
    ----------
    path : of the CSV file
    thickness : [m] of the fabric as a shell, on which the stress acts
    side : [m] of the frame; needed where the file gives the force of the crosshead

    Raises
    ------
    InputError : one line naming the file, the row, the value and what is allowed
    """
    from unitcell3d.identify.shear_fit import fit

    column = read_columns(
        path,
        {"shear angle": "rad", "shear stress": "Pa", "force": "N"},
        what="a picture-frame curve",
        content="a picture-frame curve: shear angle, and shear stress or force",
        heading="shear angle, shear stress or force with its unit, such as shear angle [deg]",
        accepts=lambda names: (
            sorted(names) in (["shear angle", "shear stress"], ["force", "shear angle"])
        ),
        columns="shear angle, and shear stress or force",
    )
    gamma = column["shear angle"]
    if not np.all(np.diff(gamma) > 0) or gamma.min(initial=0.0) < 0:
        raise InputError(
            file=path, key="shear angle", value="not rising", allowed="at least 0 and rising"
        )
    if "force" in column:
        if side is None or not side > 0:
            raise InputError(
                "gives the force of the crosshead: the side of the frame is needed", file=path
            )
        stress = column["force"] / (2 * np.cos(0.5 * (0.5 * np.pi - gamma))) / (side * thickness)
    else:
        stress = column["shear stress"]
    try:
        return fit(gamma, stress)
    except InputError as problem:
        raise InputError(str(problem), file=path) from None


def yarn_tension(path: FilePath) -> YarnFit:
    """Fit axial stiffness and failure strain to the tensile curve of a yarn.

    Parameters
    ----------
    path : of the CSV file

    Raises
    ------
    InputError : one line naming the file, the row, the value and what is allowed
    """
    column = read_columns(
        path,
        {"strain": "", "force": "N"},
        what="a tensile curve of a yarn",
        content="a tensile curve of a yarn: strain and force",
        heading="strain or force with its unit, such as strain [%] or force [N]",
        accepts=lambda names: sorted(names) == ["force", "strain"],
        columns="strain and force",
    )
    strain, force = column["strain"], column["force"]
    peak = int(np.argmax(force)) if len(force) else 0
    top = float(force[peak]) if len(force) else 0.0
    straight = (force[: peak + 1] >= LINEAR[0] * top) & (force[: peak + 1] <= LINEAR[1] * top)
    if straight.sum() < FEWEST:
        allowed = f"at least {FEWEST} points between {LINEAR[0]:g} and {LINEAR[1]:g} of the greatest force"
        raise InputError(file=path, key="rows", value=int(straight.sum()), allowed=allowed)
    e, f = strain[: peak + 1][straight], force[: peak + 1][straight]
    EA, start = np.polyfit(e, f, 1)
    if not EA > 0:
        raise InputError("the force does not rise with the strain", file=path)
    rms = float(np.sqrt(np.mean((EA * e + start - f) ** 2)))
    return YarnFit(float(EA), top / float(EA), -float(start) / float(EA), rms)


def name_of(path: FilePath) -> str:
    """The file as a source: its name without folders."""
    return Path(path).name
