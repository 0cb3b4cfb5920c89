"""What a calibration found: the laws fitted to the paths of a crossover, their intervals, and how far the
paths differ. Paths give pairs (F_c, d_c) of contact force and compression of one yarn, d_c = (h01 + h02 -
h1 - h2) / 2 (thesis eq. 4-13, errata E-05, E-40), sampled at equal shares of displacement. To all is fitted

    d_c = a - b / (F_c + F0)^(1/3),  F0 = (b/a)^3

(the printed form would depend on a force cut-off); also each yarn's own compression, and a law of the
tension ratio (`ratio_law`), the one to use where one law leaves more than `ONE_LAW`. d_c holds also what
closes between sections that do not conform; each yarn's own does not. Plates flatten slack yarns: their
curve is the contact law of plies of a pack (`contact`).
"""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from scipy.interpolate import PchipInterpolator

from fabrics import ply_laws
from fabrics.base.checks import FilePath, FloatArray
from fabrics.base.errors import InputError, UnstableError
from fabrics.base.files import write_whole
from fabrics.base.record import Record
from fabrics.compression import CompressionLaw
from fabrics.fabric import Fabric
from fabrics.ply_law import PlyLaw
from unitcell3d.cases import biaxial_and_platens
from unitcell3d.identify.platen_misfit import rising
from unitcell3d.identify.ratio_law import RatioLaw, imbalance

PLATES = "plates"
YARNS = ("warp", "weft")
SAMPLES = 25  # of each path in the fit, about as many as it has steps
PLY_SAMPLES = 24  # intervals of the contact law of plies
# m rms: where one law leaves more, that of the tension ratio is chosen
ONE_LAW = 1e-6


@dataclass(frozen=True)
class Calibration:
    """What a calibration found.

    Parameters
    ----------
    fabric : name
    law : CompressionLaw fitted to all biaxial paths
    path_laws : {path: CompressionLaw} fitted to each path alone; None where no law fits it
    histories : {path: Record}, and "plates"
    residuals : {path: rms distance [m] of its samples from the joint law}
    yarn_laws : (warp, weft) CompressionLaw fitted to each yarn's own compression on all paths; None
        where none fits
    ratio_law : RatioLaw fitted to all paths, or None
    ratio_residuals : {path: rms distance [m] of its samples from the ratio law}
    failures : {path: [biaxial_and_platens.Failure]}
    published : CompressionLaw of the fabric's file, or None
    seconds : {path: wall time [s]}, and "all" of the whole calibration
    sizes : (biaxial, plates) mesh sizes
    friction : [-] Coulomb's coefficient the paths were solved with
    contact : PlyLaw of plies on each other, from the platens; None where no platen was pressed
    """

    fabric: str
    law: CompressionLaw
    path_laws: dict
    histories: dict
    residuals: dict
    yarn_laws: tuple
    ratio_law: RatioLaw | None
    ratio_residuals: dict
    failures: dict
    published: CompressionLaw | None
    seconds: dict
    sizes: tuple
    friction: float = 0.0
    contact: PlyLaw | None = None

    @property
    def plates(self) -> Record:
        """Record between plates."""
        return self.histories[PLATES]

    @property
    def comparison(self) -> dict[str, float]:
        """Fitted over published a and b, and the rms distance [m] of the laws over the fitted
        forces; {} if none."""
        if self.published is None or self.published.a == 0 or self.law.F_range is None:
            return {}
        low, high = self.law.F_range
        F = np.linspace(low, high, 200)
        published = replace(self.published, form="regularised")
        return {
            "a_ratio": self.law.a / published.a,
            "b_ratio": self.law.b / published.b,
            "rms_m": float(np.sqrt(np.mean((self.law.d(F) - published.d(F)) ** 2))),
        }

    @property
    def spread(self) -> dict[str, tuple[float, float]]:
        """{"a", "b": (least, greatest)} [m], [m N^(1/3)] of the paths that determine their own law;
        {} where none does.

        A path that stays at low forces may tell neither a nor b: their intervals then hold the half
        or the double.
        """
        laws = [law for law in self.path_laws.values() if law is not None and _determined(law)]
        if not laws:
            return {}
        return {
            key: tuple(pick(getattr(law, key) for law in laws) for pick in (min, max))
            for key in ("a", "b")
        }

    @property
    def chosen(self) -> str:
        """ "one law", or "law of the tension ratio" where one leaves more than `ONE_LAW` and there
        is such a law."""
        one = _rms(self.law)
        sees_more = self.ratio_law is not None and _rms(self.ratio_law) < one
        return "law of the tension ratio" if one > ONE_LAW and sees_more else "one law"

    def summary(self) -> dict[str, Any]:
        """Return all numbers of the calibration, as plain types."""
        laws = {name: law and _numbers(law) for name, law in self.path_laws.items()}
        return {
            "format": "weavecell calibration 1",
            "fabric": self.fabric,
            "mesh": {"biaxial": self.sizes[0], "plates": self.sizes[1]},
            "friction": self.friction,
            "law": {
                "a_m": self.law.a,
                "b_m_N^(1/3)": self.law.b,
                "rms_m": self.law.residual_rms,
                "F_range_N": self.law.F_range,
                "a_interval_m": self.law.a_interval,
                "b_interval_m_N^(1/3)": self.law.b_interval,
                "doubts": self.law.doubts,
            },
            "chosen": self.chosen,
            "spread_of_the_paths": {
                "a_m": self.spread.get("a"),
                "b_m_N^(1/3)": self.spread.get("b"),
            },
            "published": self.published
            and {"a_m": self.published.a, "b_m_N^(1/3)": self.published.b},
            "comparison": self.comparison,
            "fit_of_each_path": laws,
            "rms_of_each_path_from_the_law_m": self.residuals,
            "fit_of_each_yarn": {
                name: law and _numbers(law) for name, law in zip(YARNS, self.yarn_laws)
            },
            "fit_by_tension_ratio": self.ratio_law
            and {
                "p": self.ratio_law.p,
                "F0_N": self.ratio_law.F0 if np.isfinite(self.ratio_law.F0) else None,
                "rms_m": self.ratio_law.residual_rms,
                "rms_of_each_path_m": self.ratio_residuals,
            },
            "failure": {
                name: [vars(item) for item in found] for name, found in self.failures.items()
            },
            "ended_early": {
                name: history.failed for name, history in self.histories.items() if history.failed
            },
            "seconds": self.seconds,
        }

    def write(self, directory: FilePath) -> None:
        """Write law.json and calibration.json into a directory."""
        directory = Path(directory)
        with write_whole(directory / "calibration.json") as file:
            json.dump(self.summary(), file, indent=2)
            file.write("\n")
        self.write_law(directory / "law.json")

    def write_law(self, path: FilePath) -> None:
        """Write the joint law, with the contact law of plies."""
        self.law.to_json(path, self.contact)


def contact_of_plies(history: Record, fabric: Fabric, size: str) -> PlyLaw:
    """Compute the contact law of plies from a compression between platens, "computed".

    Steps that press less than one before are left out: pressure rises with closure. P^(1/3), which
    is nearly straight, is interpolated by monotone cubics over the closure and sampled at
    `PLY_SAMPLES` equal intervals. Beyond the last pressure the law is that of solid fibre.

    Parameters
    ----------
    history : between platens; closure counts from their first touch
    fabric : whose crossover it is
    size : mesh size, as a text

    Raises
    ------
    UnstableError : no platen was ever pressed
    """
    pressure, closure = rising(history, fabric.weave.cell_area)
    pressure = pressure[closure > 0]
    closure = closure[closure > 0]
    curve = PchipInterpolator([0.0, *closure], np.cbrt([0.0, *pressure]))
    at = np.linspace(0.0, closure[-1], PLY_SAMPLES + 1)
    left_out = len(history["path"]) - 1 - len(pressure)
    source = f"3D crossover of {fabric.name} between platens, {size} mesh"
    if left_out:
        source += f", {left_out} steps of falling force left out"
    return PlyLaw(at, curve(at) ** 3, ply_laws.solid_fibre(fabric).stiffness, source, "computed")


def samples(history: Record, *columns: FloatArray) -> tuple[FloatArray, ...]:
    """Sample F_c [N] and columns (d_c [m] if none are given) at equal shares of a path's
    displacement, from contact on."""
    shares = np.linspace(0, history["path"][-1], SAMPLES + 1)[1:]
    columns = columns or (history["d_c"],)
    F, *rest = (np.interp(shares, history["path"], column) for column in (history["F_c"], *columns))
    return F[F > 0], *(column[F > 0] for column in rest)


def evaluate(
    fabric: Fabric,
    histories: dict[str, Record],
    sizes: tuple[str, str],
    seconds: dict[str, float],
    friction: float = 0.0,
) -> Calibration:
    """Evaluate solved paths: the Calibration.

    Parameters
    ----------
    histories : {path: Record} and "plates"
    sizes : (biaxial, plates) mesh sizes, as texts
    seconds : {path: [s]}
    friction : [-] they were solved with

    Raises
    ------
    UnstableError : no path got far enough for a fit
    """
    pairs = {name: samples(history) for name, history in histories.items() if name != PLATES}
    F, d = (np.concatenate([pair[i] for pair in pairs.values()]) for i in (0, 1))
    if F.size < 3:
        reasons = "; ".join(history.failed for history in histories.values() if history.failed)
        raise UnstableError(
            f"no path of {fabric.name} reached contact: {reasons or 'the yarns never touch'}"
        )
    provenance = f"3D crossover of {fabric.name}, {sizes[0]} mesh, paths {', '.join(pairs)}"
    if friction:
        provenance += f", friction {friction:g}"
    law = CompressionLaw.fit(F, d, provenance=provenance, fabric=fabric.name)
    yarn_laws, ratio_law, ratio_residuals = _finer(histories, fabric.name)
    return Calibration(
        fabric=fabric.name,
        law=law,
        path_laws={name: _own_law(name, pair, fabric.name) for name, pair in pairs.items()},
        histories=histories,
        residuals={
            name: float(np.sqrt(np.mean((law.d(pair[0]) - pair[1]) ** 2)))
            for name, pair in pairs.items()
        },
        yarn_laws=yarn_laws,
        ratio_law=ratio_law,
        ratio_residuals=ratio_residuals,
        failures={name: biaxial_and_platens.failure(histories[name], fabric) for name in pairs},
        published=fabric.laws[0] if fabric.laws else None,
        seconds=seconds,
        sizes=sizes,
        friction=friction,
        contact=_contact(histories, fabric, sizes[1]),
    )


def _contact(histories, fabric, size):
    try:
        return contact_of_plies(histories[PLATES], fabric, size)
    except UnstableError:
        return None


def _finer(histories, fabric):
    """Laws of each yarn's own compression, and the law that sees the tension ratio with its
    residual by path."""
    found = {name: h for name, h in histories.items() if name != PLATES}
    rows = {
        name: samples(h, h["d_c"], imbalance(h["T1"], h["T2"]), *h["d_yarns"].T)
        for name, h in found.items()
    }
    F, d, m, *yarns = (np.concatenate(columns) for columns in zip(*rows.values()))
    made = "own compression at the crossing, paths " + ", ".join(found)
    yarn_laws = tuple(
        _own_law(f"{name}: {made}", (F, own), fabric) for name, own in zip(YARNS, yarns)
    )
    try:
        law = RatioLaw.fit(F, m, d)
    except InputError:
        return yarn_laws, None, {}
    return (
        yarn_laws,
        law,
        {
            name: float(np.sqrt(np.mean((law.d(r[0], r[2]) - r[1]) ** 2)))
            for name, r in rows.items()
        },
    )


def _rms(law):
    return 0.0 if law.residual_rms is None else law.residual_rms


def _determined(law):
    pairs = ((law.a, law.a_interval), (law.b, law.b_interval))
    return all(value / 2 < low and high < 2 * value for value, (low, high) in pairs)


def _numbers(law):
    return {"a_m": law.a, "b_m_N^(1/3)": law.b, "rms_m": law.residual_rms}


def _own_law(name, pair, fabric):
    try:
        return CompressionLaw.fit(*pair, provenance=name, fabric=fabric)
    except InputError:
        return None
