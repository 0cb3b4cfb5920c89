"""The calibration of the 3D crossover.

The folder of `weavecell calibrate`
    law.json            the fitted law with its range, for `law`, and the contact law of plies of a pack
    law-range.json      the laws at the ends of all that is not known of the crossover
    calibration.json    all numbers of the calibration, and provenance.json where they come from
    <path>.h5           histories of the loading paths and between plates; paths.csv, one table of them
    crossover.*         the mesh, as `weavecell mesh` writes it, with quality.png and mesh.json
    solid.json, fabric-keys.toml  fitted solid (--platen-curve, --fit-solid), the second as a fabric file has it
    surface.h5          response surface of the solid (--biaxial with --fit-solid), for `fabric.surface`
    solid-runs          finished runs of the fit, for --resume
    report.html
"""

from __future__ import annotations

import json
import logging
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, Unpack

import numpy as np

from fabrics import assumed, plausible
from fabrics.base import files, run_cache
from fabrics.base.checks import FilePath
from fabrics.base.counted import counted
from fabrics.base.door import option
from fabrics.base.errors import InputError, UnstableError, placed
from fabrics.base.frozen import explain_frozen
from fabrics.fabric import Fabric
from fabrics.plate_curve import PlateCurve
from fabrics.variants import as_written, data_digest, with_linear_density
from weavecell.answers.mesh import MeshResult, names_of
from weavecell.answers.result import Result, figure
from weavecell.api import law_effect, meshes, quantities
from weavecell.api.biaxial_fit import BiaxialFitPlan, BiaxialFitResult, plan_fit
from weavecell.api.command import Plan, Running, command
from weavecell.api.execution import Execution, ResumableKeywords
from weavecell.api.keywords import explain_keywords
from weavecell.api.run_size import WorkSize
from weavecell.results import display, json_file, out_folder, progress
from weavecell.results.finding import Answer
from weavecell.results.named_value import NamedValue, tabulate
from weavecell.scenes import result_keys

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from fabrics.compression import CompressionLaw
    from shellfabric.membrane.indicator import Indicator
    from unitcell3d.identify.biaxial_states import PulledTest
    from unitcell3d.identify.calibration import Calibration
    from unitcell3d.identify.law_range import LawRange
    from unitcell3d.identify.solid_record import SolidFit
    from weavecell.api.law_effect import LawEffect
    from weavecell.report.page import Section
    from weavecell.studies.solid_tests import SolidTests

# a fit of the solid takes about so many trials; the progress bar needs a number
TRIALS = 20
SOLID_RUNS = "solid-runs"
# [-] to which fibre fractions of the mesh and of the fabric are the same
FRACTIONS_ALIKE = 0.02
YARNS = ("warp", "weft")
FABRIC_KEYS = "fabric-keys.toml"
SURFACE = "surface.h5"
RANGE = "law-range.json"
# of the surface of a fitted solid: so few lines are closer to the crossover than the law of a finer mesh
SURFACE_LINES = 5
NAMES_OF_SOLID = ("E_c", "V_c", "K_r")
SOLID_UNITS = {"E_a": " Pa", "E_c": " Pa", "K_r": "", "K_G": "", "V_c": "", "Vf0": ""}
FROM_FITTED = "rms from the fitted law"
OWN_CROSSINGS = "that of the plain crossing, as much softer or stiffer as its own cell is"
PLAIN_CROSSING = "assumed: that of the plain crossing of the same yarns"
WHOSE = {"mesh": "of the mesh", "stated": "that are stated"}


NAMES = (
    "law.json",
    "calibration.json",
    "paths.csv",
    "provenance.json",
    "solid.json",
    RANGE,
    FABRIC_KEYS,
    SURFACE,
    "report.html",
    *names_of("crossover", MeshResult.formats),
)


@dataclass(frozen=True)
class CalibrationPlan(Plan["CalibrationResult"]):
    """A calibration that is about to be solved.

    Parameters
    ----------
    fabric : Fabric, with what a 3D crossover needs
    size : of the mesh, as `meshing` takes it
    evidence : Evidence to which the solid is fitted first; None without one
    friction : [-] between the yarns
    fraction : "mesh" or "stated", whose fibre fraction enters the law of the solid
    assumed_range : whether the range of the law is computed
    named : whether the fabric was given by a name, and has the linear density of shots afterwards
    woven : Fabric of a weave with floats, of whose yarns `fabric` is the plain crossing; else None
    """

    runs = SOLID_RUNS

    fabric: Fabric
    size: Any
    evidence: Evidence | None
    friction: float
    fraction: str
    assumed_range: bool
    named: bool
    woven: Fabric | None = None

    @property
    def files(self) -> tuple[str, ...]:  # type: ignore[override]
        """The names of what is written."""
        from unitcell3d.identify import calibrate as solver

        return (*NAMES, *solver.names())

    @property
    def inputs(self) -> Sequence[object]:
        """What the paths are solved of."""
        return [(self.fabric, self.size, self.friction, self.evidence, self.fraction)]

    @property
    def has_own_crossings(self) -> bool:
        """Whether the cell of a weave with floats is solved: its crossings are all alike."""
        if self.woven is None:
            return False
        pattern = self.woven.weave.pattern
        return pattern.has_like_crossings and pattern.holds_yarns

    def forecast(self) -> WorkSize:
        """Count the paths, those of the ends of an assumed law too, and hexahedra and nodes."""
        from unitcell3d.identify import calibrate as solver

        built = meshes.of_calibration(self.fabric, self.size)
        amounts = {"path": solver.CASES}
        if self.has_own_crossings:
            amounts["cell path"] = solver.CASES - 1
        if self.assumed_range and self.evidence is None:
            from unitcell3d.identify import law_range

            unknowns = law_range.list_unknowns(self.fabric, None, self.fraction)
            ends = sum(map(len, unknowns.values()))
            if ends:
                amounts["crossover of its range"] = 1 + ends
        return meshes.size_of_mesh(f"{self.fabric.name}, calibration", built.mesh, **amounts)

    def run(self, running: Running) -> CalibrationResult:
        """Fit the solid to what was measured, then the law to the crossover of that solid."""
        from unitcell3d.identify import calibrate as solver

        # a later run warns if the data that the law was fitted to have changed
        shot_at = self.woven or self.fabric
        digest = data_digest(shot_at)
        choices = {"friction": self.friction, **running.how.solver_pool}
        fabric = self.fabric
        solid = None
        if self.evidence is not None:
            solid = _solid(fabric, self.evidence, running.runs)
            fabric = assumed.given(solid.fabric, "solid")
        built = meshes.of_calibration(fabric, self.size)
        fractions = self._note_fractions(built, solid)
        with progress.bar(f"Calibration of {fabric.name}") as advance:
            done = solver.calibrate(
                fabric,
                size=self.size,
                out=running.folder,
                laws=False,
                resume=running.how.resume,
                fibre_fraction=self.fraction,
                on_progress=progress.count_paths(advance, solver.CASES),
                **choices,
            )
        around = self._find_range(fabric, solid, done.law, running)
        law = done.law
        if self.woven is not None:
            law = self._of_own_crossings(fabric, law, running)
            whose = OWN_CROSSINGS
            if law is done.law:
                law = replace(law, provenance=f"{law.provenance}, {PLAIN_CROSSING}")
                whose = PLAIN_CROSSING
            note = f"{fabric.name}: the compression law of a {self.woven.weave.pattern.name} is {whose}"
            built = replace(built, fabric=replace(fabric, notes=(*fabric.notes, note)))
        done = replace(done, law=law)
        if around is not None:
            done = replace(done, law=around.around(done.law))
        done = replace(done, law=replace(done.law, fitted_data=digest))
        surface = None
        if solid is not None and solid.pulls:
            surface = _surface(fabric, running.how.solver_pool)
        # the crossover may have more crimp, and has the data sheet's linear density; a shot has
        # what an input file that names the fabric would give it
        if self.woven is None:
            shot_at = as_written(fabric)
        if self.named:
            shot_at = with_linear_density(shot_at, "effective")
        result = CalibrationResult(
            replace(shot_at, laws=(done.law, done.law)),
            done,
            built,
            around,
            solid,
            resumable=bool(running.folder),
            fractions=fractions,
            surface=surface,
            effect=_find_effect(shot_at, done.law),
        )
        # what is doubtful of the law goes with it
        shot_at = replace(result.fabric, laws=(result.law, result.law))
        return running.save(replace(result, fabric=shot_at))

    def _of_own_crossings(self, crossing, law, running):
        """Return the law of the weave's own crossings; that of the plain one where they have none, or are
        of several kinds."""
        from unitcell3d.identify.own_crossings import of_own_crossings

        if not self.has_own_crossings:
            return law
        pattern = self.woven.weave.pattern
        try:
            with progress.bar(f"Cell of a {pattern.name}") as advance:
                return of_own_crossings(
                    law,
                    crossing,
                    pattern,
                    fraction=self.fraction,
                    folder=running.runs,
                    friction=self.friction,
                    report=lambda done, total: advance(done / total, f"{done} of {total} cells"),
                    **running.how.solver_pool,
                )
        except UnstableError as problem:
            logging.getLogger("weavecell").warning(str(problem))
            return law

    def _note_fractions(self, built, solid):
        """The note on fibre fractions, which is logged; "" without one."""
        fractions = fractions_note(built, self.fraction)
        if fractions and solid is None:
            other = {"mesh": "stated", "stated": "mesh"}[self.fraction]
            way = f"{option('fibre_fraction', '')} {other}"
            fractions += f"; {way} shows what the others change"
        if fractions:
            logging.getLogger("weavecell").info(fractions)
        return fractions

    def _find_range(self, fabric, solid, law, running):
        """Return the LawRange of a law; None where it is not asked for, or nothing is unknown."""
        from unitcell3d.identify import law_range

        unknowns = law_range.list_unknowns(fabric, solid, self.fraction)
        if not (unknowns and (self.assumed_range or solid is not None)):
            return None
        with progress.bar(f"Range of the law of {fabric.name}") as advance:
            return law_range.find_range(
                fabric,
                law,
                unknowns,
                fraction=self.fraction,
                folder=running.runs,
                friction=self.friction,
                report=lambda done, total: advance(
                    done / total, f"{done} of {counted(total, 'crossover')}"
                ),
                **running.how.solver_pool,
            )


@dataclass(frozen=True, eq=False)
class Evidence:
    """What the solid is fitted to.

    Parameters
    ----------
    curve : PlateCurve, or None
    tests : of biaxial_states.PulledTest
    fitted : names of those that are fitted; all if empty
    free : constants that are fitted
    """

    curve: PlateCurve | None
    tests: tuple[PulledTest, ...] = ()
    fitted: tuple[str, ...] = ()
    free: tuple[str, ...] = ("E_c", "V_c", "K_r")


@command(CalibrationPlan, BiaxialFitPlan)
@explain_keywords(ResumableKeywords)
def calibrate(
    fabric: Fabric | FilePath,
    *,
    mesh: str | float | tuple[int, int, int] = meshes.SOLVED,
    platen_curve: FilePath | None = None,
    fit_solid: bool = False,
    friction: float = 0.0,
    fibre_fraction: Literal["mesh", "stated"] | None = None,
    assumed_range: bool = True,
    biaxial: FilePath | None = None,
    fitted: list[str] | None = None,
    constants: str | None = None,
    centreline: Literal["cosine", "straight"] | None = None,
    yarn_curve: list[str] | None = None,
    check: bool = False,
    **options: Unpack[ResumableKeywords],
) -> Plan[CalibrationResult | BiaxialFitResult]:
    """Solve the 3D crossover and fit its compression law: law.json, histories and a report. Needs
    dolfinx and PETSc. Or fit the law to measured biaxial tests, which needs neither.

    With both keywords the solid of the yarns is fitted to such tests first. The fabric has the
    linear density of its data sheet. With one job and the local executor everything runs in this
    process; else in several, and a script that calls needs the guard `if __name__ == "__main__":`.
    A finished path is kept at once, for resume.

    The curve of platen_curve is a CSV file headed, for example, "pressure [MPa], thickness [mm]":
    one ply between flat platens, loading only, at least five rows.

    The file of biaxial is a CSV file headed "test, warp strain [%], weft strain [%], warp load [N],
    weft load [N]": loads of one yarn, or per width in N/m, a row a state, the name of its test or its
    ratio first; the strain of a free direction is empty. Loads are those of the unit cell
    (`weavecell biaxial`), or with fit_solid those of the 3D crossover; tests that are not fitted are
    predicted.

    Parameters
    ----------
    fabric : name of the catalogue, or path of a fabric file; in Python also a Fabric
    mesh : auto, coarse, medium or fine, the numbers of hexahedra along, across and through a
        quarter yarn, such as 8,6,4, an edge length, or a .msh file that gmsh made of the script of
        weavecell mesh --format geo
    platen_curve : first fit E_c, V_c and K_r to this platen curve (pressure and thickness); what
        the fabric lacks of its solid law is assumed by fibre family
    fit_solid : first fit E_c, V_c and K_r to the tests of biaxial, and to the curve of platen_curve if
        both are given; without biaxial to the built-in pressure law of Kevlar plain weaves
    friction : Coulomb's coefficient between the yarns
    fibre_fraction : whose fibre fraction at rest enters the solid law, that of the mesh or the one
        that the fabric states; if not given the stated one where its source gives V_c too, else
        that of the mesh
    assumed_range : whether the law gets a range, that of an assumed solid law, thickness, crimp, fibre
        fraction and mesh together, from small crossovers at the ends of each
    biaxial : file of biaxial tests (``*.csv``), which the law is fitted to in place of the 3D
        crossover, or with fit_solid the solid of the yarns
    fitted : name of a test of that file that is fitted, may be given again, in Python a list; all
        if none is given
    constants : what is fitted to them, separated by commas: a, b, stiffening (of the law of
        compression with the yarn's strain), h (both heights at rest), warp crimp, weft crimp, start
        (where each test begins); "a, b" if not given. With fit_solid E_c, V_c, K_r, all if not given
    centreline : cosine, or straight from crossing to crossing as Kawabata has it, for loose weaves
    yarn_curve : tensile curve of a yarn whose foot at low strain counts, FAMILY=FILE such as
        warp=yarn.csv, or both=yarn.csv; a CSV file headed, for example, "strain [%], force [N]"; may
        be given again, in Python a list
    check : solve nothing and write nothing: count paths and hexahedra
    **options : jobs, executor, out and resume

    Returns
    -------
    CalibrationResult, or BiaxialFitResult with `biaxial`

    Raises
    ------
    InputError : the fabric cannot be meshed, has no solid law that could be assumed, or a bad curve
    UnstableError : no path got far enough for a fit

    Examples
    --------
    >>> calibrated = wc.calibrate("S-720", mesh="coarse", assumed_range=False)  # doctest: +SKIP
    >>> wc.impact("S-720", "150 m/s", law=calibrated)  # doctest: +SKIP
    """
    Execution.refuse_others("calibrate", options)
    of_tests = {
        "fitted": fitted or None,
        "constants": constants,
        "centreline": centreline,
        "yarn_curve": yarn_curve or None,
    }
    if biaxial is not None and not fit_solid:
        of_crossover: dict[str, Any] = {
            "platen_curve": platen_curve,
            "friction": friction or None,
            "fibre_fraction": fibre_fraction,
        }
        if mesh != meshes.SOLVED:
            of_crossover["mesh"] = mesh
        solves = f"without {option('fit_solid', '')}".rstrip()
        where = f"with {option('biaxial', 'FILE')} {solves}, which solves no 3D crossover"
        quantities.refuse_unused(of_crossover, where)
        return plan_fit(fabric, biaxial, fitted, constants, centreline, yarn_curve)
    if biaxial is None:
        quantities.refuse_unused(of_tests, f"without {option('biaxial', 'FILE')}")
    else:
        of_cell = {name: of_tests[name] for name in ("centreline", "yarn_curve")}
        where = f"with {option('fit_solid', '')}".rstrip()
        quantities.refuse_unused(of_cell, f"{where}, which fits no cell of cosines")
    from unitcell3d.material.numerics import fraction_of
    from unitcell3d.model.crossover import Numerics

    size = meshes.size(mesh)
    named = not isinstance(fabric, Fabric)
    with meshes.of_fabric(fabric):
        woven = meshes.read_fabric(fabric)
    crossing = _take_plain_crossing(woven)
    if crossing is not woven:
        fabric = crossing
    # by its name or file, which a refusal says
    fabric = meshes.resolve_fabric_for_3d(fabric)
    if platen_curve is not None and fit_solid and biaxial is None:
        raise InputError(
            key="fit_solid", allowed="left out with a platen curve, which is fitted to"
        )
    evidence = None
    if crossing is not woven:
        where = "of a weave with floats, whose plain crossing is solved"
        unused = {"platen_curve": platen_curve, "fit_solid": fit_solid or None}
        quantities.refuse_unused(unused, where)
    if biaxial is not None:
        evidence = _read_evidence(fabric, platen_curve, biaxial, fitted, constants)
    elif platen_curve is not None or fit_solid:
        evidence = Evidence(curve_of(fabric, platen_curve))
    if evidence is not None and fibre_fraction == "stated":
        allowed = (
            "mesh if the solid is fitted: its V_c then belongs to the fibre fraction of the mesh"
        )
        raise InputError(key="fibre_fraction", value=fibre_fraction, allowed=allowed)
    fraction: str = fibre_fraction or fraction_of(fabric)
    if evidence is not None:
        fraction = "mesh"
    Numerics(friction=friction)  # refuses what is not allowed
    floats = None
    if crossing is not woven:
        floats = assumed.with_solid_laws(woven)
    return CalibrationPlan(fabric, size, evidence, friction, fraction, assumed_range, named, floats)


def _read_evidence(fabric, platen_curve, biaxial, fitted, constants):
    """Return the Evidence of a file of biaxial tests, and of a platen curve if there is one."""
    from unitcell3d.identify.solid_record import NAMES as SOLID
    from weavecell.studies import biaxial_tests, solid_tests

    tests = biaxial_tests.read(biaxial, fabric.weave.yarn_spacing)
    chosen = tuple(fitted or ())
    known = [test.name for test in tests]
    for name in chosen:
        if name not in known:
            allowed = f"a test of {biaxial}: {', '.join(known)}"
            raise InputError(key="fitted", value=name, allowed=allowed)
    free = SOLID
    if constants is not None:
        free = tuple(dict.fromkeys(part.strip() for part in constants.split(",")))
    for name in free:
        if name not in SOLID:
            allowed = f"of {', '.join(SOLID)}, which are the solid's"
            raise InputError(key="constants", value=name, allowed=allowed)
    curve = None if platen_curve is None else PlateCurve.read(platen_curve)
    with placed(biaxial):
        return Evidence(curve, solid_tests.take_tests(tests, chosen), chosen, free)


def _take_plain_crossing(fabric):
    """The fabric, or the plain crossing of the yarns of a weave with floats."""
    if fabric.weave.pattern.is_plain:
        return fabric
    return replace(
        fabric,
        weave=fabric.weave.of_plain_crossing(),
        thickness=fabric.weave.thickness,
    )


def fractions_note(built: MeshResult, used: str) -> str:
    """Say that the fibre fractions of the mesh are not those that the fabric states.

    Parameters
    ----------
    built : MeshResult
    used : "mesh" or "stated", which enters the law of the solid

    Returns
    -------
    note : "" where they differ by no more than FRACTIONS_ALIKE
    """
    meshed = built.mesh.Vf0
    stated = [law.Vf0 for law in built.fabric.solid_laws or ()]
    if all(abs(mesh / own - 1) <= FRACTIONS_ALIKE for mesh, own in zip(meshed, stated)):
        return ""
    whose = "assumed are" if "solid" in built.fabric.assumed else "the fabric states"
    return (
        f"note: the sections of the mesh have fibre fractions of {_pair(meshed)}, {whose} {_pair(stated)}: "
        f"the solid law has those {WHOSE[used]}, and its V_c counts from there"
    )


def _pair(fractions):
    """Fibre fractions of warp and weft as text."""
    return " / ".join(f"{fraction:.3f}" for fraction in fractions)


def curve_of(fabric: Fabric, path: FilePath | None) -> PlateCurve:
    """Read the plate curve of a file, or without one take the pressure law at the fabric's measured
    areal density.

    Raises
    ------
    InputError : a bad file, or no measured areal density
    """
    if path is not None:
        return PlateCurve.read(path)
    if fabric.areal_density_measured is None:
        needs = f"has no areal_density_measured, which the pressure law needs: give {option('platen_curve', '')}"
        raise InputError(f"fabric {fabric.name} {needs}")
    return PlateCurve.pressure_law(fabric.areal_density_measured)


def _solid(fabric, evidence, runs):
    """Return the SolidFit of what was measured; an earlier run's if it is kept."""
    from unitcell3d.identify import solid_fit

    kept = run_cache.RunCache(runs)
    given = {"tests": evidence.tests, "fitted": evidence.fitted, "free": evidence.free}
    key = run_cache.key(("fit", fabric, evidence.curve, given), solid_fit.fit_solid.__module__)
    # the fit takes minutes: an interrupted calibration goes on behind it
    if key not in kept:
        with progress.bar(f"Solid of {fabric.name} from tests") as advance:
            kept[key] = solid_fit.fit_solid(
                fabric,
                evidence.curve,
                **given,
                on_progress=lambda trials: advance(
                    min(trials / TRIALS, 0.99), counted(trials, "trial")
                ),
            )
    return kept[key]


def _surface(fabric, pool):
    """Return the ResponseSurface of a fitted solid up to the failure of both yarns, on a coarse
    mesh; the exception of one that finds no equilibrium there."""
    from unitcell3d.cases.biaxial_and_platens import displacements_at_failure
    from unitcell3d.identify import response_surface

    try:
        with progress.bar(f"Response surface of {fabric.name}") as advance:
            return response_surface.sample(
                fabric,
                **{
                    key: (0.0, end)
                    for key, end in zip(("d1", "d2"), displacements_at_failure(fabric))
                },
                points=(SURFACE_LINES, SURFACE_LINES),
                size="coarse",
                **pool,
                on_progress=advance,
                provenance=f"3D crossover of {fabric.name}, its solid fitted to biaxial tests",
            ).surface
    except UnstableError as problem:
        return problem


def _find_effect(fabric, law):
    """Return what the range of a law does to a shot, or None."""
    if law.assumed_range is None:
        return None
    with progress.bar(f"Shots over the range of the law of {fabric.name}") as advance:
        return law_effect.find_effect(fabric, law, advance)


def range_numbers(around: LawRange) -> dict[str, Any]:
    """Return a LawRange as plain types, for law-range.json."""
    return {
        "unknowns": {
            name: [{"a_m": law.a, "b_m_N^(1/3)": law.b} for law in laws]
            for name, laws in around.ends.items()
        },
        "law_of_the_best_values": {"a_m": around.law.a, "b_m_N^(1/3)": around.law.b},
        "shares_of_the_variance_of_the_compression": around.shares(),
        "covariance_of_ln_a_ln_b": around.covariance.tolist(),
        "without_a_law": around.failed,
    }


@explain_frozen
@dataclass(frozen=True, repr=False)
class CalibrationResult(Result):
    """A compression law fitted to the 3D crossover.

    Parameters
    ----------
    fabric : Fabric with the fitted law, ready for `impact`, and with its solid law; of a fabric
        that was named with the linear densities of `weavecell.fabric`
    calibration : `unitcell3d.identify.calibration.Calibration`
    mesh : MeshResult of the crossover, with the fabric that was calibrated
    around : `unitcell3d.identify.law_range.LawRange` of what is not known; None if it was not computed
    solid : `unitcell3d.identify.solid_record.SolidFit` of the measurements, or None
    fractions : note on fibre fractions of the mesh that are not those of the fabric, or ""
    surface : ResponseSurface of a solid that was fitted to biaxial tests; an exception if it has no
        equilibrium; or None
    effect : `LawEffect` of the range on a shot; None without a range, or where the shots perforate
    resumable : whether the folder holds the histories of the paths already, with what `resume`
        needs

    Examples
    --------
    >>> calibrated = wc.calibrate("S-720", mesh="coarse")  # doctest: +SKIP
    >>> calibrated.law.a, calibrated.law.b  # doctest: +SKIP
    """

    fabric: Fabric
    kind = "law"
    uses = ("crossover",)

    calibration: Calibration
    mesh: MeshResult
    around: LawRange | None = None
    solid: SolidFit | None = None
    resumable: bool = False
    fractions: str = ""
    surface: Any = None
    effect: LawEffect | None = None

    @property
    def law(self) -> CompressionLaw:
        """The fitted law, of both yarn families, with what is doubtful of it."""
        return replace(self.calibration.law, doubts="; ".join(self.doubts))

    @property
    def tests(self) -> SolidTests | None:
        """Biaxial tests beside the fitted crossover; None without any."""
        from weavecell.studies.solid_tests import SolidTests

        if self.solid is None or not self.solid.pulls:
            return None
        return SolidTests.of(self.solid)

    @property
    def checks(self) -> tuple[Indicator, ...]:
        """As in `Result`: how far the law misses its samples, those of the mesh, and of tests that the
        solid was fitted to."""
        from shellfabric.membrane import quality

        law = self.calibration.law
        of_mesh = self.mesh.checks
        if self.tests is not None:
            of_mesh = (*self.tests.checks, *of_mesh)
        if law.residual_rms is None or not law.a > 0:
            return of_mesh
        return (quality.indicator("misfit of the law", law.residual_rms / law.a), *of_mesh)

    @property
    def doubts(self) -> tuple[str, ...]:
        """As in `Result`; a law that no woven yarn has, and a range without one of its ends."""
        found = [*super().doubts, *["implausible law"] * bool(self._judge_law())]
        return (*found, *(f"end of {name} missing in the range" for name in self._failed))

    @property
    def _failed(self):
        """{unknown: why an end of it has no law}"""
        return {} if self.around is None else self.around.failed

    @property
    def answer(self) -> Answer:
        """The law, and whether to use it."""
        law = self.law
        a, b, _ = _name_constants(law.a, law.b)
        ends = _name_constants(law.a_interval, law.b_interval)
        value = "; ".join(
            f"{one.line()} ({' to '.join(end.ends())})" if law.a_interval else one.line()
            for one, end in zip((a, b), ends)
        )
        rms = display.text(law.residual_rms or 0, "fine m", ".2f")
        over = f"{counted(len(self._stretched), 'path')} of the 3D crossover"
        if self.effect is not None:
            over += f", {self.effect.line()}"
        over += f", {self._forces}, missed by {rms} rms"
        if self.around is not None:
            over += f"; the range from {_say_shares(self.around.shares())}"
        for name, text in self._say_tests():
            over += f"; {name} {text}"
        bad = (*self._judge_law(), *law.outside_ends())
        use = "weavecell impact with fabric.law = law.json"
        advice = (
            ("press the fabric between platens (`weavecell reduce compression`)",) if bad else ()
        ) + (() if self._refusal else (use,))
        return self._find_answer(
            f"{self.fabric.name}, compression law of the yarns", value, advice=advice, over=over
        )

    def _judge_law(self):
        """A line about each constant of the law that is not plausible."""
        numbers = plausible.of_laws((self.calibration.law,), self.mesh.fabric, "law")
        if self._refusal:
            return [self._refusal]
        return list(plausible.judge(numbers))

    @cached_property
    def _refusal(self):
        """Why no input file could name the law; "" if one can. What was solved is kept all the same."""
        try:
            fabric = self.mesh.fabric
            law = self.calibration.law
            result_keys.check_fabric(replace(fabric, laws=(law, law)), fabric, "3D crossover")
        except InputError as problem:
            return str(problem)
        return ""

    @property
    def assumed(self) -> tuple[str, ...]:
        """Lines that name the laws that are assumed."""
        return (
            *self.mesh.fabric.notes,
            *assumed.lines(assumed.given(self.mesh.fabric, "failure_length")),
            *filter(None, [self.fractions]),
        )

    def summary(self) -> dict[str, Any]:
        """Return a and b with their 95 % intervals, rms of the fit, and the range over the assumed
        solid law.

        "outside" says at which forces the ends of that range do not bracket the law.
        """
        law = self.law
        numbers: dict[str, Any] = {"fabric": self.fabric.name}
        for value in _name_constants(law.a, law.b, law.residual_rms):
            numbers |= value.entries()
        numbers["checks"] = self.checks_text
        a, b, _ = _name_constants(law.a_interval, law.b_interval)
        for value, interval in ((a, law.a_interval), (b, law.b_interval)):
            if interval is not None:
                numbers |= value.entries()
        for end, constants in zip(("soft", "stiff"), law.assumed_range or ()):
            a, b, _ = _name_constants(*constants)
            numbers |= a.entries(end) | b.entries(end)
        # an assumed range that does not bracket its own law deserves a word
        if law.outside_ends():
            numbers["outside"] = "; ".join(law.outside_ends())
        return numbers | self._what_is_assumed()

    def _what(self):
        return f"{self.mesh.fabric.name}, compression law"

    def _columns(self):
        units = {"d1": "m", "d2": "m", "T1": "N", "T2": "N", "F_c": "N", "d_c": "m"}
        histories = self.calibration.histories
        # paths are of different lengths: one column names the path of each row
        lengths = [len(history["path"]) for history in histories.values()]
        columns: dict[str, Any] = {"path": np.repeat(list(histories), lengths)}
        for name, unit in units.items():
            parts = [np.asarray(history[name]) for history in histories.values()]
            columns[f"{name}_{unit}"] = np.concatenate(parts)
        return columns

    @property
    def _stretched(self):
        """{path: Record} without the plates."""
        done = self.calibration
        return {name: path for name, path in done.histories.items() if path is not done.plates}

    @property
    def _fitted(self):
        """{label: law} of the fit and of the publication, if there is one."""
        laws = {"fitted": self.calibration.law}
        if self.calibration.published is not None:
            laws["published"] = self.calibration.published
        return laws

    def _collect_picture_data(self):
        """Arguments of `report.pictures.fit`."""
        from unitcell3d.identify.calibration import samples

        points = {name: samples(path) for name, path in self._stretched.items()}
        plates = self.calibration.plates
        return points, self._fitted, (plates["F_c"], plates["d_c"])

    def plot(self) -> Figure:
        """Draw a matplotlib figure: compression of a yarn [um] against contact force [N], samples
        and laws."""
        from weavecell.report import pictures

        return figure(pictures.fit, *self._collect_picture_data())

    def to_vtk(self, folder: FilePath) -> Path:
        """Write the mesh of the crossover at rest, crossover.vtu; returns its path."""
        return self.mesh.to_vtk(folder)

    def _list_laws(self):
        """List (name, (a, b, rms) as `NamedValue`s): the law with intervals and spread, what it
        leaves out."""
        done = self.calibration
        law = self.law
        rows = [
            ("fitted", _name_constants(law.a, law.b, law.residual_rms)),
            ("95 % interval", _name_constants(law.a_interval, law.b_interval)),
        ]
        if done.published is not None:
            published = done.published
            constants = _name_constants(published.a, published.b, published.residual_rms)
            rows.append(("published", constants))
        if done.spread:
            rows.append(("each path", _name_constants(**done.spread)))
        for name, own in zip(("warp alone", "weft alone"), done.yarn_laws):
            if own is not None:
                rows.append((name, _name_constants(own.a, own.b, own.residual_rms)))
        for end, constants in zip(("soft", "stiff"), law.assumed_range or ()):
            rows.append((f"{end} end", _name_constants(*constants)))
        if done.ratio_law is not None:
            rows.append(("alternative", _name_constants(None, None, done.ratio_law.residual_rms)))
        return rows

    def _notebook_table(self):
        return tabulate("law", self._list_laws())

    @property
    def _forces(self):
        """Over which forces the law was fitted, in words."""
        low, high = self.law.F_range or (np.nan, np.nan)
        return f"over F = {low:.2g} to {high:.3g} N"

    def lines(self) -> list[str]:
        """Write the lines that are printed, without what is doubtful."""
        done = self.calibration
        law = self.law
        lines = []
        if done.friction:
            lines.append(("friction", f"{done.friction:g}"))
        if self.solid is not None:
            for fitted, before, determined in _list_solid(self.solid):
                remark = ""
                if not determined:
                    remark = ", not determined by what was measured"
                if fitted.name in NAMES_OF_SOLID and fitted.name not in self.solid.free:
                    lines.append(
                        (fitted.name, f"{fitted.text()}, kept ({_say_kept(fitted, determined)})")
                    )
                    continue
                interval = f"{fitted.interval()}, 95 %{remark}"
                lines.append((fitted.name, f"{fitted.text()} ({interval}); from {before.text()}"))
            lines += [("misfit", text) for text in _misfits(self.solid)]
            lines += self._say_tests()
        for name, (a, b, rms) in self._list_laws():
            text = f"{a.line()}, {b.line()}"
            if name == "alternative":
                text = "compliance that depends on the ratio of warp and weft tension"
            if rms.value is not None:
                text += f", {rms.text()} rms"
            lines.append((name, text))
        residual = display.text(law.residual_rms or 0, "fine m", ".2f")
        lines.append(("residual", f"{residual} rms {self._forces}"))
        used = "the fitted law"
        if done.chosen != "one law":
            used += ", although the alternative fits the paths better"
        lines.append(("impacts use", used))
        lines += [("note", line) for line in (*self._judge_law(), *law.outside_ends())]
        if self.around is not None:
            lines.append(("range from", _say_shares(self.around.shares())))
        if self.effect is not None:
            lines.append(("shots", self.effect.line()))
        for name, why in self._failed.items():
            lines.append(("no end", f"an end of {name} has no compression law: {why}"))
        if done.contact is not None:
            lines.append(("plies", done.contact.words()))
        for name, path in done.histories.items():
            if path.failed:
                share = display.text(path["path"][-1], "%", ".1f")
                lines.append((name, f"ended at {share} of its path: {path.failed}"))
        return [f"{name:<13} {text}" for name, text in lines]

    def _say_tests(self):
        """Return (name, text) of each biaxial test."""
        lines = []
        tests = self.tests
        if tests is None:
            return lines
        for one, before in zip(tests.comparisons, tests.before):
            text = f"{one.role}, strains {one.ratio}: rms {_shares(one.shares)} of the greatest"
            text += f", before the fit {_shares(before)}"
            if not one.fitted:
                text += f": {one.verdict}"
            lines.append((f"test {one.name}", text))
        if isinstance(self.surface, Exception):
            lines.append(("no surface", str(self.surface)))
        return lines

    def save(self, out: FilePath) -> None:
        """Write the files that stand at the top of this module to a folder."""
        from unitcell3d.identify.calibrate import file_of

        with out_folder.hold(out, (*NAMES, *map(file_of, self.calibration.histories))):
            self._write(Path(out))

    def _write(self, folder):
        from unitcell3d.identify.calibrate import file_of
        from weavecell.report import chapters, checks
        from weavecell.results import provenance

        done = self.calibration
        fabric = self.mesh.fabric
        if self.solid is not None:
            self.solid.write(folder / "solid.json")
            files.write(folder / FABRIC_KEYS, fabric_keys(self.solid))
        if self.surface is not None and not isinstance(self.surface, Exception):
            self.surface.write(folder / SURFACE)
        if self.around is not None:
            effect = self.effect.entries() if self.effect else None
            json_file.write(folder / RANGE, range_numbers(self.around) | {"shots": effect})
        if not self.resumable:
            for name, path in done.histories.items():
                path.write(folder / file_of(name))
        self.mesh.save(folder)
        stamp = provenance.stamp("", fabric)
        json_file.write(folder / "provenance.json", {**stamp, **self._what_is_doubtful()})
        files.write(folder / "paths.csv", self.to_csv())
        lead = (
            "The crossover is stretched along several biaxial paths until its fibres fail; one law is fitted to "
            "the thickness that its yarns lose under their contact force."
        )
        if done.friction:
            lead += f" Coulomb friction between the yarns: {done.friction:g}."
        picture = (folder / "crossover.png").read_bytes()
        of_mesh = chapters.mesh(self.mesh.words(), picture)
        sections = (*self.sections(), of_mesh, checks.section(self.checks))
        chapters.write(folder, lead, (fabric,), sections, stamp, done.seconds, self.answer)
        # law.json comes last: a folder that has it is complete
        replace(done, law=self.law).write(folder)

    def sections(self) -> tuple[Section, ...]:
        """Return the chapters of the report: the fit, the solid if it was fitted, the response of
        the shells' cell."""
        from weavecell.report import chapters

        fabric = self.mesh.fabric
        w1, w2 = fabric.weave.w
        paths = {}
        for name, path in self._stretched.items():
            paths[name] = (path["d1"] / w1, path["d2"] / w2, path["T1"], path["T2"])
        laws = {label: (law, law) for label, law in self._fitted.items()}
        chapters_of_fit = [self._fit()]
        if self.solid is not None:
            chapters_of_fit.append(self._list_solid_constants())
        return (*chapters_of_fit, chapters.cell(fabric, laws, paths=paths))

    def _fit(self):
        """Samples and laws, each path alone, and fibre failure."""
        from weavecell.report import pictures
        from weavecell.report.page import Section, Table

        done = self.calibration
        caption = f"Fitted laws, {self._forces}; impacts use the fitted one"
        ratio = done.ratio_law
        if ratio is not None:
            ends = [ratio.compliance(m) for m in ratio.m_range]
            compliance = NamedValue("c", None, "m/N", *ends, form=".3f")
            caption += f"; alternative: c F / (1 + F / {ratio.F0:.3g} N), {compliance.line()}, all weft .. all warp"
        lead = "Each point is a converged state of the 3D crossover, to which d_c = a - b / (F + F0)^(1/3) is fitted."
        for line in self.law.outside_ends():
            lead += f" Note: {line}."
        drawn = pictures.draw_figure(
            "fit",
            "Compression of one yarn against the contact force.",
            pictures.fit,
            *self._collect_picture_data(),
        )
        tables = (
            Table.from_frame(self._notebook_table(), caption),
            Table.from_frame(self._each_path(), "Each path"),
            Table.from_frame(
                self._failures(), "Where the fibre strain first reaches the failure strain"
            ),
        )
        return Section("fit", "Transverse compression: the fit", lead, (drawn,), tables)

    def _each_path(self):
        """The law of each path alone, why the path ended, and how long it took."""
        done = self.calibration
        rows = []
        ends = []
        for name, path in done.histories.items():
            constants = _name_constants(None, None, rms_name=FROM_FITTED)
            law = done.path_laws.get(name)
            if law is not None:
                residual = done.residuals.get(name)
                constants = _name_constants(law.a, law.b, residual, rms_name=FROM_FITTED)
            rows.append((name, constants))
            ends.append(_explain_end(name, path))
        table = tabulate("path", rows)
        table["ended"] = ends
        table["time [s]"] = [done.seconds[name] for name in done.histories]
        return table

    def _failures(self):
        """The state of each path in which a fibre first fails, by each criterion."""
        paths = []
        states = []
        for name, failures in self.calibration.failures.items():
            paths += [name] * len(failures)
            states += failures
        columns = {
            "path": ("", paths),
            "criterion": ("", [state.criterion for state in states]),
            "yarn": ("", [YARNS[state.yarn] for state in states]),
        }
        for way, yarn in enumerate(("1", "2")):
            columns[f"d{yarn}"] = ("fine m", [state.d[way] for state in states])
        for way, yarn in enumerate(("1", "2")):
            columns[f"T{yarn}"] = ("N", [state.T[way] for state in states])
        columns["F_c"] = ("N", [state.F_c for state in states])
        return display.frame(columns)

    def _list_solid_constants(self):
        """Return the constants of the solid, which of them the measurements determine, and how it
        meets these."""
        from pandas import DataFrame

        from weavecell.report import pictures, pictures_biaxial, pictures_crossover
        from weavecell.report.page import Section, Table

        solid = self.solid
        rows = []
        loose = []
        for fitted, before, determined in _list_solid(solid):
            answer = "yes"
            if not determined:
                answer = "no"
                loose.append(fitted.name)
            value, _ = fitted.numbers()
            value_before, _ = before.numbers()
            rows.append((fitted.name, value, value_before, fitted.interval(), answer))
        columns = [
            "parameter",
            "fitted [SI]",
            "the fabric's file",
            "95 % interval",
            "determined",
        ]
        lead = f"{', '.join(solid.free)} of both yarns, fitted to {solid.source}. "
        drawn = []
        tables = [Table.from_frame(DataFrame(rows, columns=columns))]
        if solid.platens is not None:
            platens = solid.platens
            lead += f"Misfit {_misfit(platens.misfit)}, before the fit {_misfit(platens.misfit_before)}. "
            caption = "Closure of the platens against their pressure."
            drawn.append(pictures.draw_figure("solid", caption, pictures_crossover.plates, platens))
        if self.tests is not None:
            caption = (
                "Load of a yarn against the strain along it: points measured, lines the crossover with the fitted "
                "solid, dashed if predicted, dotted with the solid before the fit."
            )
            drawn.append(pictures.draw_figure("tests", caption, pictures_biaxial.draw_pulls, solid))
            tables.append(Table.from_frame(self._table_of_tests(), "Biaxial tests"))
        if loose:
            lead += f"What was measured does not determine {' and '.join(loose)}."
        else:
            lead += "What was measured determines all of them."
        for one in _name_constants(self.law.a_interval, self.law.b_interval)[:2]:
            lead += f" {one.name} of the law is then between {' and '.join(one.ends())} {one.unit_shown} (95 %)."
        return Section("solid", "The solid yarn from tests", lead, tuple(drawn), tuple(tables))

    def _table_of_tests(self):
        """Return the biaxial tests with their misfit, as a DataFrame."""
        from pandas import DataFrame

        tests = self.tests
        rows = []
        for one, before, checked in zip(tests.comparisons, tests.before, tests.checked):
            row = {"test": one.name, "strains": one.ratio, "role": one.role}
            row["rms, warp / weft, of the greatest load"] = _shares(one.shares)
            row["before the fit"] = _shares(before)
            row[f"on the mesh {self.solid.sizes[1]}"] = _shares(checked)
            row["verdict"] = "" if one.fitted else one.verdict
            rows.append(row)
        return DataFrame(rows)


def fabric_keys(solid: SolidFit) -> str:
    """Return fabric-keys.toml: the fitted solid as a fabric file has it."""
    lines = [f"# from {solid.source} by `weavecell calibrate`"]
    for name, law in zip(YARNS, solid.fabric.solid_laws or ()):
        lines += ["", f"[solid.{name}]"]
        for key, unit in SOLID_UNITS.items():
            value = f"{getattr(law, key):.6g}{unit}"
            source = {"source": f"as before the fit to {solid.source}", "status": "assumed"}
            if key in solid.free:
                low, high = solid.intervals[key]
                words = f"fitted to {solid.source}, 95 %: {low:.4g} to {high:.4g}{unit}"
                source = {"source": words, "status": "fitted"}
            known = solid.started.sources.get(f"solid.{name}.{key}")
            if key not in solid.free and known:
                source = {part: known[part] for part in ("source", "status")}
            entry = {"value": value} | source
            parts = ", ".join(f"{part} = {json.dumps(text)}" for part, text in entry.items())
            lines.append(f"{key} = {{ {parts} }}")
    return "\n".join(lines) + "\n"


def _shares(pair):
    """Return the shares of warp and weft as "1.9 / 1.7 %"."""
    return display.number(pair, "%", ".2g").replace(", ", " / ") + " %"


def _say_shares(shares):
    """Say what makes the range, the largest first."""
    parts = [
        f"{name} {display.number(share, '%', '.0f')} %"
        for name, share in shares.items()
        if share >= 0.005
    ]
    return ", ".join(parts) + " of its variance"


def _say_kept(fitted, determined):
    """Say what the measurements say of a constant that was not fitted."""
    if determined:
        return f"they would tell it: {fitted.interval()}, 95 %; {option('constants', '')}"
    return "they do not tell it"


def _name_constants(a, b, rms=None, rms_name="rms"):
    """Name a and b of a law, each a number [m], [m N^(1/3)], the (low, high) of one, or None, and
    the rms [m] of its fit."""
    constants = []
    for name, given, unit in (("a", a, "m"), ("b", b, "m N^(1/3)")):
        if np.ndim(given):
            low, high = given
            constants.append(NamedValue(name, None, unit, low, high, form=".4f"))
        else:
            constants.append(NamedValue(name, given, unit, form=".4f"))
    return (*constants, NamedValue(rms_name, rms, "fine m", form=".2f"))


def _list_solid(solid):
    """List (constant of the solid with its interval, the same in the fabric's file, whether the
    curve determines it)."""
    listed = []
    for name, value in solid.values.items():
        fitted = NamedValue(name, value, "1", *solid.intervals[name], margin=".3g")
        before = NamedValue(name, _read_value_of_file(solid.started, name), "1")
        listed.append((fitted, before, solid.determined[name]))
    return listed


def _explain_end(name, path):
    """Why a path ended."""
    from unitcell3d.identify.calibrate import BOTH

    if path.failed:
        return path.failed
    if name == BOTH:
        return "beyond the failure strain"
    if name != "plates":
        return "at fibre failure"
    if path["path"][-1] < 1:
        return "at the test's pressure"
    return "with the plates at half their distance"


def _misfits(solid):
    platens = solid.platens
    if platens is None:
        return
    yield f"{_misfit(platens.misfit)}, before {_misfit(platens.misfit_before)}, to {platens.curve.source}"
    if platens.misfit_checked is not None:
        yield f"on the mesh {solid.sizes[1]}: {_misfit(platens.misfit_checked)}"


def _misfit(of):
    """A PlatenMisfit as a text."""
    closure = display.text(of.closure, "fine m", ".1f")
    pressure = display.text(of.pressure, "%", ".0f")
    return f"{closure} and {pressure} of the pressure (rms)"


def _read_value_of_file(fabric, name):
    """The value of the fabric's file, of the warp."""
    law = fabric.solid_laws[0]
    if name == "K_r E_c":
        return law.K_r * law.E_c
    return getattr(law, name)
