"""Curves of tests in CSV files, and the constants of a fabric file that are fitted to them.

    picture frame    "shear angle [deg], shear stress [MPa]", or "shear angle [deg], force [N]" with
                     the side of the frame
    bias strip       "displacement [mm], force [N]", with width and length
    yarn in tension  "strain [%], force [N]"

The shear stress of the trellis law is the work for a change of the shear angle over the volume of
the fabric, its area at rest times t, its thickness as a shell. The three zones are fitted
(`unitcell3d.identify.shear_fit`).
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from fabrics.base.checks import FilePath
from fabrics.base.errors import InputError
from fabrics.base.tables import read_columns

if TYPE_CHECKING:
    from unitcell3d.identify.shear_fit import ShearFit

# shares of the greatest force between which a curve counts as straight
LINEAR = (0.2, 0.9)
# a straight line needs so many points
FEWEST = 5


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

    With phi = (pi/2 - gamma) / 2 the crosshead moves by L sin(phi) dgamma, so that its force F
    gives

        stress = F sin(phi) / (L t),

    the shear force along a side, F / (2 cos phi), times cos(gamma) / (L t).

    Parameters
    ----------
    path : of the CSV file
    thickness : [m] of the fabric as a shell
    side : [m] of the frame; needed if the file gives the force of the crosshead

    Raises
    ------
    InputError : one line naming the file, the row, the value and what is allowed
    """
    column = read_columns(
        path,
        {"shear angle": "rad", "shear stress": "Pa", "force": "N"},
        what="a picture-frame curve",
        example="shear angle [deg]",
        either=("shear stress", "force"),
    )
    gamma = column["shear angle"]
    _check_rising(path, "shear angle", gamma)
    if "force" not in column:
        return _fit_shear(path, gamma, column["shear stress"])
    if side is None or not side > 0:
        raise InputError(
            "gives the force of the crosshead: the side of the frame is needed", file=path
        )
    phi = 0.5 * (0.5 * np.pi - gamma)
    return _fit_shear(path, gamma, column["force"] * np.sin(phi) / (side * thickness))


def bias_extension(path: FilePath, thickness: float, strip: tuple[float, float] | None) -> ShearFit:
    """Fit the trellis law to the curve of a bias strip.

    Yarns do not stretch; of a strip of width W and length H >= 2 W the middle shears by gamma, the
    zones beside it by gamma / 2 (Cao et al. 2008):

        sin gamma = (1 + displacement / (H - W))^2 - 1,   p = W / (2 (H - W))
        (1 - p) stress(gamma) + p stress(gamma / 2) = F (cos(gamma / 2) - sin(gamma / 2)) / (2 W t)

    Parameters
    ----------
    path : of the CSV file
    thickness : [m] of the fabric as a shell
    strip : (width, length between the clamps) [m]

    Raises
    ------
    InputError : one line naming the file, the row, the value and what is allowed
    """
    column = read_columns(
        path,
        {"displacement": "m", "force": "N"},
        what="a curve of a bias strip",
        example="displacement [mm]",
    )
    if strip is None:
        raise InputError("needs the width and the length of its strip: give strip", file=path)
    width, length = strip
    if not 0 < 2 * width <= length:
        allowed = "width, length: the length at least twice the width"
        raise InputError(key="strip", value=f"{width:g} m, {length:g} m", allowed=allowed)
    moved = column["displacement"]
    _check_rising(path, "displacement", moved)
    sine = (1 + moved / (length - width)) ** 2 - 1
    if sine.max(initial=0.0) >= 1:
        most = (2**0.5 - 1) * (length - width)
        allowed = f"below {1e3 * most:.4g} mm, where the yarns are aligned"
        raise InputError(
            file=path, key="displacement", value=f"{1e3 * moved.max():.4g} mm", allowed=allowed
        )
    gamma = np.arcsin(sine)
    stress = column["force"] * (np.cos(0.5 * gamma) - np.sin(0.5 * gamma)) / (2 * width * thickness)
    return _fit_shear(path, gamma, stress, half=width / (2 * (length - width)))


def _check_rising(path, key, values):
    if not np.all(np.diff(values) > 0) or values.min(initial=0.0) < 0:
        raise InputError(file=path, key=key, value="not rising", allowed="at least 0 and rising")


def _fit_shear(path, gamma, stress, half=0.0):
    """The ShearFit of a measured curve, errors with the name of its file."""
    from unitcell3d.identify.shear_fit import fit

    try:
        return fit(gamma, stress, half=half, any_curve=True)
    except InputError as problem:
        raise problem.changed(file=path) from None


def yarn_tension(path: FilePath) -> YarnFit:
    """Fit axial stiffness and failure strain to the tensile curve of a yarn.

    The straight line through the points between LINEAR shares of the greatest force gives E A_s and
    the slack at its foot; the failure strain is the greatest force over E A_s.

    Parameters
    ----------
    path : of the CSV file

    Raises
    ------
    InputError : one line naming the file, the row, the value and what is allowed
    """
    column = _tensile_curve(path)
    strain = column["strain"]
    force = column["force"]
    top = float(force.max(initial=0.0))
    before_peak = np.cumsum(force == top) == 0
    straight = before_peak & (force >= LINEAR[0] * top) & (force <= LINEAR[1] * top)
    if straight.sum() < FEWEST:
        allowed = f"at least {FEWEST} points between {LINEAR[0]:g} and {LINEAR[1]:g} of the greatest force"
        raise InputError(file=path, key="rows", value=int(straight.sum()), allowed=allowed)
    e = strain[straight]
    f = force[straight]
    EA, start = np.polyfit(e, f, 1)
    if not EA > 0:
        raise InputError("the force does not rise with the strain", file=path)
    rms = float(np.sqrt(np.mean((EA * e + start - f) ** 2)))
    return YarnFit(float(EA), top / float(EA), -float(start) / float(EA), rms)


def yarn_with_foot(path: FilePath) -> YarnFit:
    """Fit axial stiffness, failure strain and the foot at low strain to the tensile curve of a yarn.

    All points up to the greatest force are fitted by E A_s (e - s (1 - exp(-e / s))), s the slack
    (`shellfabric.cell.yarn_kernels`).

    Parameters
    ----------
    path : of the CSV file

    Raises
    ------
    InputError : one line naming the file, the row, the value and what is allowed
    """
    from scipy.optimize import curve_fit

    line = yarn_tension(path)
    column = _tensile_curve(path)
    last = int(np.argmax(column["force"])) + 1
    strain = column["strain"][:last]
    force = column["force"][:last]
    reach = float(strain.max())

    def law(e, EA, s):
        return EA * (e + s * np.expm1(-e / s))

    bounds = ((0.0, 1e-6 * reach), (np.inf, reach))
    start = (line.EA, float(np.clip(line.slack, 2e-6 * reach, 0.9 * reach)))
    (EA, slack), _ = curve_fit(law, strain, force, p0=start, bounds=bounds, x_scale=start)
    rms = float(np.sqrt(np.mean((law(strain, EA, slack) - force) ** 2)))
    return YarnFit(float(EA), float(force[-1] / EA), float(slack), rms)


def _tensile_curve(path):
    """Strain [-] and force [N] of a tensile curve of a yarn."""
    return read_columns(
        path,
        {"strain": "", "force": "N"},
        what="a tensile curve of a yarn",
        example="strain [%]",
    )


def name_of(path: FilePath) -> str:
    """Return the file as a source: its name without folders."""
    return Path(path).name
