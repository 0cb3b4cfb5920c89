"""Threshold of the axial force at which a yarn slips through a crossover, against the contact force there.

    T_f = c0 + mu_eff F_c

c0 is what resists without contact force (the crimp has to travel along the yarn), mu_eff Coulomb's coefficient as the
crossover has it: the yarns press on each other obliquely too, which the vertical force F_c does not count. Both are
fitted to thresholds of the 3D crossover at several contact forces (`unitcell3d.cases.pull_out`). The law is kept in the
file of the compression law, law.json, as its group "pull_out".
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import isfinite
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from fabrics import law_file
from fabrics.checks import FilePath, FloatArray, not_negative
from fabrics.errors import InputError
from fabrics.units import si

GROUP = "pull_out"
FRICTION, FRICTION_RANGE = 0.2, (0.15, 0.25)  # of aramid yarns on each other
FRICTION_STATUS = "literature"
FRICTION_SOURCE = "range quoted for aramid yarns on aramid yarns; no single measurement"


@dataclass(frozen=True)
class PullOutLaw:
    """Slip threshold of a crossover.

    Parameters
    ----------
    c0 : [N] threshold without contact force; a fit may put it slightly below 0
    mu_eff : [-] slope
    F_c, T_f : (n,) [N] contact forces and thresholds that were fitted
    friction : [-] Coulomb's coefficient of the 3D contact
    friction_range : (lowest, highest) [-] of the coefficient in the literature
    status : of the coefficient and its range
    source : where they come from
    residual_rms : [N] of the fit
    provenance : how the thresholds were computed

    Raises
    ------
    InputError : a number that is not finite, a negative slope, coefficient or contact force, a range that does not
        rise, or samples of unequal number
    """

    c0: float
    mu_eff: float
    F_c: tuple[float, ...] = ()
    T_f: tuple[float, ...] = ()
    friction: float = FRICTION
    friction_range: tuple[float, float] = FRICTION_RANGE
    status: str = FRICTION_STATUS
    source: str = FRICTION_SOURCE
    residual_rms: float | None = None
    provenance: str = ""

    def __post_init__(self):
        not_negative(self, "mu_eff", "friction")
        if not (isinstance(self.c0, (int, float)) and isfinite(self.c0)):
            raise InputError(key="c0", value=self.c0, allowed="a finite force")
        if len(self.F_c) != len(self.T_f):
            raise InputError(
                key="T_f",
                value=len(self.T_f),
                allowed=f"as many as contact forces, {len(self.F_c)}",
            )
        if not all(isfinite(value) and value >= 0 for value in self.F_c):
            raise InputError(key="F_c", value=self.F_c, allowed="zero or positive forces")
        low, high = self.friction_range
        if not 0 <= low < high:
            raise InputError(
                key="friction_range",
                value=self.friction_range,
                allowed="two rising numbers from 0 on",
            )

    def threshold(self, F_c: ArrayLike) -> FloatArray:
        """Threshold [N] at the contact force `F_c` [N]; never negative."""
        return np.maximum(self.c0 + self.mu_eff * np.maximum(np.asarray(F_c, float), 0.0), 0.0)

    @classmethod
    def fit(cls, F_c: ArrayLike, T_f: ArrayLike, **others: Any) -> PullOutLaw:
        """Least squares over samples (n,) [N] of contact forces and thresholds.

        others : further fields

        Raises
        ------
        InputError : fewer than two different contact forces
        """
        forces, thresholds = np.asarray(F_c, float), np.asarray(T_f, float)
        if forces.size < 2 or not np.ptp(forces) > 0:
            raise InputError(
                key="F_c",
                value=forces.tolist(),
                allowed="at least two different contact forces for a fit",
            )
        slope, start = (float(part) for part in np.polyfit(forces, thresholds, 1))
        off = thresholds - start - slope * forces
        samples, rms = (
            (tuple(forces.tolist()), tuple(thresholds.tolist())),
            float(np.sqrt(np.mean(off**2))),
        )
        return cls(start, max(slope, 0.0), *samples, residual_rms=rms, **others)

    def group(self) -> dict[str, Any]:
        """The content of the group "pull_out", as plain types."""
        return {
            "c0": f"{self.c0!r} N",
            "mu_eff": self.mu_eff,
            "friction": self.friction,
            "friction_range": list(self.friction_range),
            "status": self.status,
            "source": self.source,
            "F_c_N": list(self.F_c),
            "T_f_N": list(self.T_f),
            "residual_rms_N": self.residual_rms,
            "provenance": self.provenance,
        }

    def add_to(self, path: FilePath) -> None:
        """Write the group into the file of a compression law, in the place of one that is there.

        Raises
        ------
        InputError : no such file, or not a compression law
        """
        law_file.write(path, law_file.read(path) | {GROUP: self.group()})

    @classmethod
    def from_json(cls, path: FilePath) -> PullOutLaw | None:
        """The law in the file of a compression law; None where it has none.

        Raises
        ------
        InputError : no such file, not a compression law, or a bad value
        """
        group = law_file.read(path).get(GROUP)
        return None if group is None else cls.of_group(group, path)

    @classmethod
    def of_group(cls, group: Mapping[str, Any], path: FilePath) -> PullOutLaw:
        """The law of a group; `path` is named in errors.

        Raises
        ------
        InputError : a missing or a bad value
        """
        if not isinstance(group, Mapping):
            raise InputError(file=path, key=GROUP, value=group, allowed="a group of keys")
        try:
            low, high = (float(value) for value in group["friction_range"])
            F_c, T_f = (tuple(float(value) for value in group[key]) for key in ("F_c_N", "T_f_N"))
            rms = group.get("residual_rms_N")
            return cls(
                si(group["c0"], "N", file=path, key=f"{GROUP}.c0"),
                float(group["mu_eff"]),
                F_c,
                T_f,
                float(group["friction"]),
                (low, high),
                str(group["status"]),
                str(group["source"]),
                None if rms is None else float(rms),
                str(group.get("provenance", "")),
            )
        except KeyError as missing:
            raise InputError("is missing", file=path, key=f"{GROUP}.{missing.args[0]}") from None
        except InputError as problem:
            if problem.file is None:
                key = f"{GROUP}.{problem.key}"
                raise InputError(
                    file=path, key=key, value=problem.value, allowed=problem.allowed
                ) from None
            raise
        except (TypeError, ValueError):
            raise InputError("holds what is no number", file=path, key=GROUP) from None
