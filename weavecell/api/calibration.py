"""The calibration of the 3D crossover.

The folder of `weavecell calibrate`
    solid.json          with --platen-curve or --fit-solid: E_c, V_c, K_r and what the plate curve determines
    law-interval.json   with the same: intervals of a and b that follow from those of E_c, V_c, K_r
    solid-runs          with the same: finished runs, for --resume
    law.json            the fitted law, for `law` in an input file, and the contact law of plies of a pack
    calibration.json    all numbers of the calibration, and provenance.json where they come from
    <path>.h5           histories of the loading paths and of the compression between plates
    crossover.*         the mesh, as `weavecell mesh` writes it, with quality.png and mesh.json
    report.html
"""

from __future__ import annotations

from concurrent.futures import Executor
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fabrics import assumed
from fabrics.base import run_cache
from fabrics.base.checks import FilePath
from fabrics.base.errors import InputError
from fabrics.base.executors import InProcess
from fabrics.fabric import Fabric
from fabrics.plate_curve import PlateCurve
from fabrics.variants import data_digest, with_linear_density
from weavecell.api import meshes, targets
from weavecell.api.result import Result, figure, saved
from weavecell.results import json_file, out_folder, progress

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from fabrics.compression import CompressionLaw
    from unitcell3d.identify.calibration import Calibration
    from unitcell3d.identify.chain import LawInterval
    from unitcell3d.identify.solid_record import SolidFit
    from weavecell.report.page import Section

__all__ = ["CalibrationResult", "calibrate"]

TRIALS = 20  # of a fit of the solid, about, for the progress bar
SOLID_RUNS = "solid-runs"


def calibrate(
    fabric: Fabric | FilePath,
    *,
    mesh: str | float | tuple[int, int, int] = "medium",
    platen_curve: FilePath | None = None,
    fit_solid: bool = False,
    friction: float = 0.0,
    assumed_range: bool = True,
    jobs: int = 1,
    executor: str | Executor = "local",
    out: FilePath | None = None,
    resume: bool = False,
) -> CalibrationResult:
    """Solve the 3D crossover and fit its compression law: law.json, histories and a report. Needs dolfinx and PETSc.

    The fabric has the linear density of its data sheet. With one job and the local executor everything runs in this
    process; else in several, and a script that calls needs the guard `if __name__ == "__main__":`. A finished path is
    kept at once, for resume.

    The curve of platen_curve is a CSV file headed, for example, "pressure [MPa], thickness [mm]": one ply between flat
    platens, loading only, at least five rows.

    Parameters
    ----------
    fabric : as of `mesh`
    mesh : of the 3D crossover, as of `mesh`
    platen_curve : first fit E_c, V_c and K_r to this platen curve (pressure and thickness); what the fabric lacks of
        its solid law is assumed by fibre family
    fit_solid : first fit E_c, V_c and K_r to the built-in pressure law of Kevlar plain weaves
    friction : Coulomb's coefficient between the yarns
    assumed_range : whether the law is fitted at both ends of an assumed solid law too, which triples the cost
    jobs, executor, resume : as of `v50`
    out : folder of the results; in Python None writes nothing

    Returns
    -------
    CalibrationResult

    Raises
    ------
    InputError : the fabric cannot be meshed, has no solid law that could be assumed, or a bad curve
    UnstableError : no path got far enough for a fit

    Examples
    --------
    >>> calibrated = wc.calibrate("S-720", mesh="coarse", assumed_range=False)  # doctest: +SKIP
    >>> wc.impact("S-720", "150 m/s", law=calibrated)  # doctest: +SKIP
    """
    from unitcell3d.identify import assumed_range as ends
    from unitcell3d.identify import calibrate as solver

    size = meshes.size(mesh)
    named = not isinstance(fabric, Fabric)
    solid = None
    fabric = meshes.of_3d(fabric)
    digest = data_digest(fabric)
    curve = None
    if platen_curve is not None or fit_solid:
        curve = curve_of(fabric, platen_curve)
    choices: dict[str, Any] = {"friction": friction, "jobs": jobs}
    if executor == "local" and jobs == 1:
        choices["executor"] = InProcess()
    else:
        choices["executor"] = executor
    place = out_folder.held(out, resume, [(fabric, size, friction, curve)])
    with place as folder, targets.kept_runs(folder, resume, SOLID_RUNS) as runs:
        if curve is not None:
            solid = _solid(fabric, curve, runs)
            fabric = assumed.given(solid.fabric, "solid")
        built = meshes.MeshResult(fabric, meshes.build(fabric, "whole", size=size))
        with progress.bar(f"Calibration of {fabric.name}") as advance:
            watch = progress.by_path(advance, solver.CASES)
            done = solver.calibrate(
                fabric,
                size=size,
                out=folder,
                laws=False,
                resume=resume,
                on_progress=watch,
                **choices,
            )
        failed: dict[str, str] = {}
        if assumed_range and assumed.solid_ends(fabric):
            with progress.bar(f"Assumed solid law of {fabric.name}, soft and stiff end") as advance:
                watch = progress.by_path(advance, 2 * solver.CASES)
                done, failed = ends.with_assumed_range(
                    fabric, done, size=size, on_progress=watch, **choices
                )
        done = replace(done, law=replace(done.law, fitted_data=digest))
        interval = None
        if solid is not None:
            interval = _interval(solid, runs, choices)
        shot_at = fabric
        if named:
            shot_at = with_linear_density(fabric, "effective")
        result = CalibrationResult(
            replace(shot_at, laws=(done.law, done.law)),
            done,
            built,
            failed,
            solid,
            interval,
            resumable=bool(folder),
        )
        return saved(result, folder)


def curve_of(fabric: Fabric, path: FilePath | None) -> PlateCurve:
    """The plate curve of a file, or without one the pressure law at the fabric's measured areal density.

    Raises
    ------
    InputError : a bad file, or no measured areal density
    """
    if path is not None:
        return PlateCurve.read(path)
    if fabric.areal_density_measured is None:
        raise InputError(
            f"fabric {fabric.name} has no areal_density_measured, which the pressure law needs: give --platen-curve"
        )
    return PlateCurve.pressure_law(fabric.areal_density_measured)


def _solid(fabric, curve, runs):
    """The SolidFit of a plate curve; an earlier run's where it is kept."""
    from unitcell3d.identify import solid_fit

    kept = run_cache.RunCache(runs)
    key = run_cache.key(("fit", fabric, curve), solid_fit.fit_solid.__module__)
    if key not in kept:
        with progress.bar(f"Solid of {fabric.name} from platens") as advance:
            kept[key] = solid_fit.fit_solid(
                fabric,
                curve,
                on_progress=lambda trials, rms: advance(
                    min(trials / TRIALS, 0.99), f"misfit {1e6 * rms:.1f} µm"
                ),
            )
    return kept[key]


def _interval(solid, runs, choices):
    """The LawInterval of the ends of a solid's intervals, or the exception of one whose paths give no law."""
    from unitcell3d.identify.chain import law_intervals

    with progress.bar(f"Intervals of {solid.fabric.name}") as advance:
        report = lambda done, total: advance(done / total, f"{done} of {total} paths")  # noqa: E731
        return law_intervals([solid], folder=runs, report=report, **choices)[0]


def interval_numbers(
    interval: LawInterval, around: dict[str, tuple[float, float]]
) -> dict[str, Any]:
    """A LawInterval as plain types, for law-interval.json; `around` of `LawInterval.around`."""
    ends = [
        [None if law is None else {"a_m": law.a, "b_m_N^(1/3)": law.b} for law in pair]
        for pair in interval.ends
    ]
    return {
        "a_interval_m": around["a"],
        "b_interval_m_N^(1/3)": around["b"],
        "laws_of_the_limits_of_solid.json": ends,
        "law_of_their_middle": {"a_m": interval.law.a, "b_m_N^(1/3)": interval.law.b},
    }


@dataclass(frozen=True, repr=False)
class CalibrationResult(Result):
    """A compression law fitted to the 3D crossover.

    Parameters
    ----------
    fabric : Fabric with the fitted law, ready for `impact`, and with its solid law; of a fabric that was named with the
        linear densities of `weavecell.fabric`
    calibration : `unitcell3d.identify.calibration.Calibration`
    mesh : MeshResult of the crossover, with the fabric that was calibrated
    failed : {"soft" or "stiff": why this end of the assumed range has no law}
    solid : `unitcell3d.identify.solid_record.SolidFit` of the platen curve, or None
    interval : `unitcell3d.identify.chain.LawInterval` of that fit; an exception where its paths give no law; or None
    resumable : whether the folder holds the histories of the paths already, with what `resume` needs

    Examples
    --------
    >>> calibrated = wc.calibrate("S-720", mesh="coarse")  # doctest: +SKIP
    >>> calibrated.law.a, calibrated.law.b  # doctest: +SKIP
    """

    fabric: Fabric
    calibration: Calibration
    mesh: meshes.MeshResult
    failed: dict[str, str] = field(default_factory=dict)
    solid: SolidFit | None = None
    interval: Any = None
    resumable: bool = False

    @property
    def law(self) -> CompressionLaw:
        """The fitted law, of both yarn families."""
        return self.calibration.law

    @property
    def assumed(self) -> tuple[str, ...]:
        """Lines that name the laws that are assumed."""
        return (
            *self.mesh.fabric.notes,
            *assumed.lines(assumed.given(self.mesh.fabric, "failure_length")),
        )

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
        return found | self._what_is_assumed()

    def _columns(self):
        units = {"d1": "m", "d2": "m", "T1": "N", "T2": "N", "F_c": "N", "d_c": "m"}
        histories = self.calibration.histories
        columns: dict[str, Any] = {
            "path": [name for name, path in histories.items() for _ in path["path"]]
        }
        for name, unit in units.items():
            columns[f"{name}_{unit}"] = np.concatenate(
                [np.asarray(path[name]) for path in histories.values()]
            )
        return columns

    @property
    def _stretched(self):
        """{path: Record} without the plates."""
        done = self.calibration
        return {name: path for name, path in done.histories.items() if path is not done.plates}

    def _drawn(self):
        """Arguments of `report.pictures.fit`."""
        from unitcell3d.identify.calibration import samples

        done = self.calibration
        laws = {"fitted": done.law} | (
            {} if done.published is None else {"published": done.published}
        )
        return (
            {name: samples(path) for name, path in self._stretched.items()},
            laws,
            (done.plates["F_c"], done.plates["d_c"]),
        )

    def plot(self) -> Figure:
        """A matplotlib figure: compression of a yarn [um] against contact force [N], samples and laws."""
        from weavecell.report import pictures

        return figure(pictures.fit, *self._drawn())

    def to_vtk(self, folder: FilePath) -> Path:
        """Write the mesh of the crossover at rest, crossover.vtu; returns its path."""
        return self.mesh.to_vtk(folder)

    def _around(self):
        """{"a", "b": (low, high)} of the law, from the intervals of the solid's constants; {} where there are none."""
        known = self.interval is not None and not isinstance(self.interval, Exception)
        if known:
            return self.interval.around(self.law)
        return {}

    def _laws(self):
        """(name, a [mm], b [mm N^(1/3)], rms [um]) as texts: the law with intervals and spread, what it leaves out."""
        done = self.calibration
        law = self.law
        pairs = [("fitted", law), ("published", done.published)]
        rows = [
            _row(name, pair.a, pair.b, pair.residual_rms)
            for name, pair in pairs
            if pair is not None
        ]
        rows.insert(1, _row("95 % interval", law.a_interval, law.b_interval))
        if done.spread:
            rows.append(_row("each path", done.spread["a"], done.spread["b"]))
        alone = zip(("warp alone", "weft alone"), done.yarn_laws)
        rows += [
            _row(name, own.a, own.b, own.residual_rms) for name, own in alone if own is not None
        ]
        rows += [
            _row(f"{end} end", *ends)
            for end, ends in zip(("soft", "stiff"), law.assumed_range or ())
        ]
        if around := self._around():
            rows.append(_row("of the solid", around["a"], around["b"]))
        if (ratio := done.ratio_law) is not None:
            rows.append(("alternative", "-", "-", f"{1e6 * ratio.residual_rms:.2f}"))
        return rows

    def _shown(self):
        from pandas import DataFrame

        return DataFrame(self._laws(), columns=("law", "a [mm]", "b [mm N^(1/3)]", "rms [µm]"))

    def __str__(self) -> str:
        done = self.calibration
        law = self.law
        lines = []
        if done.friction:
            lines.append(("friction", f"{done.friction:g}"))
        if self.solid is not None:
            lines += [(name, _known(self.solid, name)) for name in self.solid.values]
            lines += [("misfit", text) for text in _misfits(self.solid)]
            if isinstance(self.interval, Exception):
                lines.append(("intervals", f"none: {self.interval}"))
        for name, a, b, rms in self._laws():
            text = "compliance that depends on the ratio of warp and weft tension"
            if name != "alternative":
                text = f"a = {a} mm, b = {b} mm N^(1/3)"
            lines.append((name, text + (f", {rms} um rms" if rms else "")))
        low, high = law.F_range or (np.nan, np.nan)
        lines.append(
            (
                "residual",
                f"{1e6 * (law.residual_rms or 0):.2f} um rms over F = {low:.2g} to {high:.3g} N",
            )
        )
        better = ", although the alternative fits the paths better"
        if done.chosen == "one law":
            better = ""
        lines.append(("impacts use", f"the fitted law{better}"))
        lines += [("note", line) for line in law.outside_ends()]
        for end, why in self.failed.items():
            lines.append(
                (
                    "no range",
                    f"the {end} end of the assumed solid law has no compression law: {why}",
                )
            )
        if done.contact is not None:
            lines.append(("plies", done.contact.words()))
        for name, path in done.histories.items():
            if path.failed:
                lines.append(
                    (name, f"ended at {100 * path['path'][-1]:.1f} % of its path: {path.failed}")
                )
        return "\n".join(f"{name:<13} {text}" for name, text in lines)

    def save(self, out: FilePath) -> None:
        """Write the files that stand at the top of this module to a folder."""
        from weavecell.report import chapters, page
        from weavecell.results import provenance

        done = self.calibration
        fabric = self.mesh.fabric
        folder = Path(out)
        if self.solid is not None:
            self.solid.write(folder / "solid.json")
        if around := self._around():
            json_file.write(folder / "law-interval.json", interval_numbers(self.interval, around))
        for name, path in {} if self.resumable else done.histories.items():
            path.write(folder / f"{name.replace(' ', '-')}.h5")
        self.mesh.save(folder)
        stamp = provenance.stamp("", fabric)
        json_file.write(folder / "provenance.json", stamp)
        lead = (
            "The crossover is stretched along several biaxial paths until its fibres fail; one law is fitted to "
            "the thickness that its yarns lose under their contact force."
        ) + (f" Coulomb friction between the yarns: {done.friction:g}." if done.friction else "")
        card = chapters.law_card(done.law, done.published, "fitted to the 3D crossover")
        title = f"{fabric.name}: compression law from the 3D crossover"
        picture = folder / "crossover.png"
        sections = *self.sections(), chapters.mesh(self.mesh.summary(), picture.read_bytes())
        report = chapters.report(title, lead, (fabric,), (card,), sections, stamp, done.seconds)
        page.write(report, folder / "report.html")
        done.write(folder)  # law.json, the last: what is there is whole

    def sections(self) -> tuple[Section, ...]:
        """Chapters of the report: the fit, the solid where it was fitted, the response of the shells' cell."""
        from weavecell.report import chapters

        fabric = self.mesh.fabric
        _, laws, _ = self._drawn()
        w1, w2 = fabric.weave.w
        paths = {
            name: (path["d1"] / w1, path["d2"] / w2, path["T1"], path["T2"])
            for name, path in self._stretched.items()
        }
        cell = chapters.cell(
            fabric, {label: (law, law) for label, law in laws.items()}, paths=paths
        )
        return (self._fit(), *([] if self.solid is None else [self._of_the_solid()]), cell)

    def _fit(self):
        """Samples and laws, each path alone, and fibre failure."""
        from pandas import DataFrame

        from weavecell.report import pictures
        from weavecell.report.page import Figure, Section, Table

        done = self.calibration
        law = self.law
        rms = "rms [µm]"
        low, high = law.F_range or (np.nan, np.nan)
        laws = f"Fitted laws, over F = {low:.2g} to {high:.3g} N; impacts use the fitted one"
        if (ratio := done.ratio_law) is not None:
            c = " .. ".join(f"{1e6 * ratio.compliance(m):.3f}" for m in ratio.m_range)
            laws += f"; alternative: c F / (1 + F / {ratio.F0:.3g} N), c = {c} µm/N, all weft .. all warp"
        paths = []
        for name, path in done.histories.items():
            own = done.path_laws.get(name)
            off = done.residuals.get(name)
            if own is None:
                row = (name, "-", "-", "")
            else:
                row = _row(name, own.a, own.b, off)
            paths.append((*row, _ended(name, path), done.seconds[name]))
        failures = [
            (
                name,
                one.criterion,
                ("warp", "weft")[one.yarn],
                *(1e6 * d for d in one.d),
                *one.T,
                one.F_c,
            )
            for name, of_path in done.failures.items()
            for one in of_path
        ]
        heads = ("path", "criterion", "yarn", "d1 [µm]", "d2 [µm]", "T1 [N]", "T2 [N]", "F_c [N]")
        ab = ("a [mm]", "b [mm N^(1/3)]")
        tables = {
            laws: self._shown(),
            "Each path": DataFrame(
                paths, columns=("path", *ab, f"{rms} from the fitted law", "ended", "time [s]")
            ),
            "Where the fibre strain first reaches the failure strain": DataFrame(
                failures, columns=heads
            ),
        }
        notes = "".join(f" Note: {line}." for line in law.outside_ends())
        drawn = pictures.render(pictures.fit, *self._drawn())
        return Section(
            "fit",
            "Transverse compression: the fit",
            "Each point is a converged state of the 3D crossover, to which d_c = a - b / (F + F0)^(1/3) is fitted."
            + notes,
            (Figure(drawn, "svg", "Compression of one yarn against the contact force.", "fit"),),
            tuple(Table.of(table, caption) for caption, table in tables.items()),
        )

    def _of_the_solid(self):
        """The constants of the solid, and which of them the platen curve determines."""
        from pandas import DataFrame

        from weavecell.report import pictures, pictures_crossover
        from weavecell.report.page import Figure, Section, Table

        solid = self.solid
        names = tuple(solid.values)
        table = DataFrame(
            {
                "parameter": names,
                "fitted [SI]": solid.values.values(),
                "the fabric's file": [_before(solid.started, name) for name in names],
                "95 % interval": [
                    "{:.3g} to {:.3g}".format(*solid.intervals[name]) for name in names
                ],
                "determined by the curve": [
                    "yes" if solid.determined[name] else "no" for name in names
                ],
            }
        )
        loose = [name for name, known in solid.determined.items() if not known]
        lead = f"E_c, V_c and K_r of both yarns, fitted to {solid.curve.source}; misfit {_misfit(solid.misfit)}, "
        lead += f"before the fit {_misfit(solid.misfit_before)}. "
        lead += (
            f"The curve does not tell {' and '.join(loose)}."
            if loose
            else "The curve tells all three."
        )
        for (key, (low, high)), unit in zip(self._around().items(), ("mm", "mm N^(1/3)")):
            lead += f" What it leaves open makes {key} of the law {1e3 * low:.4f} to {1e3 * high:.4f} {unit} (95 %)."
        caption = "What the platens close against their pressure; zero is free."
        drawn = Figure(pictures.render(pictures_crossover.plates, solid), "svg", caption, "solid")
        return Section(
            "solid", "The solid yarn from a plate test", lead, (drawn,), (Table.of(table),)
        )


def _row(name, a, b, rms=None):
    """Two constants, or two intervals of them, and the rms of a fit, in mm and µm as texts."""
    texts = [" .. ".join(f"{1e3 * v:.4f}" for v in np.atleast_1d(value)) for value in (a, b)]
    return (name, *texts, "" if rms is None else f"{1e6 * rms:.2f}")


def _ended(name, path):
    """Why a path ended."""
    from unitcell3d.identify.calibrate import BOTH

    if path.failed:
        return path.failed
    if name != "plates":
        if name == BOTH:
            return "beyond the failure strain"
        return "at fibre failure"
    if path["path"][-1] < 1:
        return "at the test's pressure"
    return "with the plates at half their distance"


def _known(solid, name):
    """A fitted constant with its interval, and what it was before."""
    low, high = solid.intervals[name]
    known = ", not determined by the curve"
    if solid.determined[name]:
        known = ""
    value = solid.values[name]
    before = _before(solid.started, name)
    return f"{value:.4g} ({low:.3g} .. {high:.3g}, 95 %{known}); from {before:.4g}"


def _misfits(solid):
    yield f"{_misfit(solid.misfit)}, before {_misfit(solid.misfit_before)}, to {solid.curve.source}"
    if solid.misfit_checked is not None:
        yield f"on the mesh {solid.sizes[1]}: {_misfit(solid.misfit_checked)}"


def _misfit(of):
    """A PlatenMisfit as a text."""
    return f"{1e6 * of.closure:.1f} um and {100 * of.pressure:.0f} % of the pressure (rms)"


def _before(fabric, name):
    """The value of the fabric's file, of the warp."""
    law = fabric.solid_laws[0]
    if name == "K_r E_c":
        return law.K_r * law.E_c
    return getattr(law, name)
