"""Results of coupons, and of the calibration of the 3D crossover."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fabrics.checks import FilePath
from fabrics.errors import InputError
from weavecell.api.result import Result, figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from fabrics.compression import CompressionLaw
    from fabrics.fabric import Fabric
    from shellfabric.panel.quality import Indicator
    from unitcell3d.identify.calibration import Calibration
    from weavecell.results.coupon import CouponRecord
    from weavecell.results.pull_out import PullOutRecord

__all__ = ["CalibrationResult", "CouponResult", "PullOutResult"]


@dataclass(frozen=True, repr=False)
class CouponResult(Result):
    """A quasi-static test on a piece of fabric.

    Parameters
    ----------
    record : `weavecell.results.coupon.CouponRecord`
    assumed : lines that name the laws that are assumed

    Examples
    --------
    >>> frame = wc.coupon("S-720", "picture_frame", shear_angle="5 deg", crossovers=2, steps=2)
    >>> [round(float(angle), 3) for angle in frame.record.prescribed]  # [rad]
    [0.044, 0.087]
    """

    record: CouponRecord
    assumed: tuple[str, ...] = ()

    @property
    def outcome(self) -> str:
        """ "complete" or "yarn at its strength"."""
        return self.record.outcome

    @property
    def checks(self) -> tuple[Indicator, ...]:
        """Quality checks of the test."""
        return self.record.checks

    def _what(self):
        return self.record.title

    def summary(self) -> dict[str, Any]:
        """Outcome, the checks in words, and every quantity at the end with its unit."""
        found = {key: value for key, value in self.record.summary().items() if key != "at_end"}
        found |= {"checks": self.checks_text}
        return found | {name: float(values[-1]) for name, values in self._columns().items()}

    def _columns(self):
        record = self.record
        columns = {_named(record.prescribed_name, record.prescribed_unit): record.prescribed}
        return columns | {_named(name, unit): values for name, (unit, values) in record.measures.items()}

    def plot(self) -> Figure:
        """A matplotlib figure: the quantities of the test in the unit of the first, against what is prescribed."""
        from weavecell.report import pictures_coupon

        name, (unit, _) = next(iter(self.record.measures.items()))
        chosen = [each for each, (other, _) in self.record.measures.items() if other == unit]
        return figure(pictures_coupon.curves, self.record, chosen, name)

    def to_vtk(self, folder: FilePath) -> Path:
        """Write the fabric after every load step for ParaView: coupon.pvd with coupon-NNNN.vtu; returns its path."""
        from weavecell.results import paraview

        folder, files = Path(folder), {}
        folder.mkdir(parents=True, exist_ok=True)
        cells = paraview.topology(self.record.quads)
        for step, (x, shear) in enumerate(zip(self.record.x, self.record.shear)):
            name = f"coupon-{step:04d}.vtu"
            nodes = np.column_stack([x, np.zeros(len(x))])
            paraview.write_grid(folder / name, nodes, cells, {"shear_angle_rad": np.asarray(shear, float)})
            files[name] = float(step + 1)
        paraview.write_series(folder / "coupon.pvd", files)
        return folder / "coupon.pvd"


def _named(name, unit):
    return name.replace(" ", "_") + ("" if unit == "1" else f"_{unit}")


@dataclass(frozen=True, repr=False)
class PullOutResult(Result):
    """A yarn drawn out of held crossovers.

    Parameters
    ----------
    record : `weavecell.results.pull_out.PullOutRecord`
    """

    record: PullOutRecord

    @property
    def outcome(self) -> str:
        """ "complete"."""
        return self.record.outcome

    @property
    def peak(self) -> float:
        """[N] highest load."""
        return self.record.curve.peak

    @property
    def plateau(self) -> float | None:
        """[N] mean load while all crossovers slide; None where they never all do."""
        return self.record.curve.plateau

    @property
    def checks(self) -> tuple[Indicator, ...]:
        """Quality checks of the test."""
        return self.record.checks

    def _what(self):
        return self.record.title

    def summary(self) -> dict[str, Any]:
        """Set-up, loads, slip length and work of friction, each with its unit; the checks in words."""
        return self.record.summary() | {"checks": self.checks_text}

    def _columns(self):
        columns = {
            "time_s": "time",
            "displacement_m": "displacement",
            "load_N": "load",
            "crossovers_in_slip": "sliding",
        }
        columns |= {"crossovers_left": "left", "friction_work_J": "friction_work"}
        return {name: getattr(self.record.curve, key) for name, key in columns.items()}

    def plot(self) -> Figure:
        """A matplotlib figure: the load, and the crossovers in slip and left, against the displacement."""
        from weavecell.report import pictures_coupon

        return figure(pictures_coupon.pull_out, self.record)


@dataclass(frozen=True, repr=False)
class CalibrationResult(Result):
    """A compression law fitted to the 3D crossover.

    Parameters
    ----------
    fabric : Fabric with the fitted law, ready for `shoot`, and with its solid law
    calibration : `unitcell3d.identify.calibration.Calibration`
    assumed : lines that name the laws that are assumed
    failed : {"soft" or "stiff": why this end of the assumed range has no law}

    Examples
    --------
    >>> found = wc.calibrate("S-720", mesh="coarse")  # doctest: +SKIP
    >>> found.law.a, found.law.b  # doctest: +SKIP
    """

    fabric: Fabric
    calibration: Calibration
    assumed: tuple[str, ...] = ()
    failed: dict[str, str] = field(default_factory=dict)

    @property
    def law(self) -> CompressionLaw:
        """The fitted law, of both yarn families."""
        return self.calibration.law

    def summary(self) -> dict[str, Any]:
        """a and b with their 95 % intervals, rms of the fit, and the range over the assumed solid law.

        "outside" says at which forces the ends of that range do not bracket the law.
        """
        law = self.law
        found: dict[str, Any] = {
            "fabric": self.fabric.name,
            "a_m": law.a,
            "b_m_N^(1/3)": law.b,
            "rms_m": law.residual_rms,
        }
        for key, pair in (("a_interval", law.a_interval), ("b_interval", law.b_interval)):
            if pair is not None:
                found |= {f"{key}_low": pair[0], f"{key}_high": pair[1]}
        for end, (a, b) in zip(("soft", "stiff"), law.assumed_range or ()):
            found |= {f"a_{end}_m": a, f"b_{end}_m_N^(1/3)": b}
        if law.outside_ends():
            found["outside"] = "; ".join(law.outside_ends())
        if self.assumed:
            found["assumed"] = "; ".join(self.assumed)
        return found

    def _columns(self):
        units = {"d1": "m", "d2": "m", "T1": "N", "T2": "N", "F_c": "N", "d_c": "m"}
        histories = self.calibration.histories
        columns: dict[str, Any] = {"path": [name for name, path in histories.items() for _ in path.path]}
        for name, unit in units.items():
            columns[f"{name}_{unit}"] = np.concatenate([np.asarray(path[name]) for path in histories.values()])
        return columns

    def plot(self) -> Figure:
        """A matplotlib figure: compression of a yarn [um] against contact force [N], samples and laws."""
        from unitcell3d.identify.calibration import samples
        from weavecell.report import pictures

        done = self.calibration
        drawn = {name: samples(path) for name, path in done.histories.items() if path is not done.plates}
        laws = {"fitted": done.law} | ({} if done.published is None else {"published": done.published})
        return figure(pictures.fit, drawn, laws, (done.plates.F_c, done.plates.d_c))

    def to_vtk(self, folder: FilePath) -> Path:
        """Write the mesh of the crossover at rest, crossover.vtu; returns its path."""
        from meshing import crossover
        from meshing.formats import export

        path = Path(folder) / "crossover.vtu"
        path.parent.mkdir(parents=True, exist_ok=True)
        export.write(crossover.build(self.fabric, size=self.calibration.sizes[0], domain="whole"), path)
        return path

    def write(self, folder: FilePath) -> Path:
        """Write law.json and calibration.json, as `weavecell calibrate` does; returns the path of law.json.

        Raises
        ------
        InputError : the folder is a file
        """
        folder = Path(folder)
        if folder.is_file():
            raise InputError("is a file", file=folder)
        folder.mkdir(parents=True, exist_ok=True)
        self.calibration.write(folder)
        return folder / "law.json"
