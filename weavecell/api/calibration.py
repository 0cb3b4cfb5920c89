"""The calibration of the 3D crossover."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal, Unpack

from fabrics import assumed
from fabrics.base.checks import FilePath
from fabrics.base.counted import counted
from fabrics.base.door import option
from fabrics.base.errors import InputError, UnstableError
from fabrics.fabric import Fabric
from fabrics.variants import as_written, data_digest, with_linear_density
from weavecell.answers.biaxial_fit import BiaxialFitResult
from weavecell.answers.calibration import NAMES, CalibrationResult
from weavecell.answers.mesh import MeshResult
from weavecell.api import law_effect, meshes, quantities
from weavecell.api.biaxial_fit import BiaxialFitPlan, plan_fit
from weavecell.api.command import Plan, Running, command
from weavecell.api.execution import Execution, ResumableKeywords
from weavecell.api.keywords import explain_keywords
from weavecell.api.run_size import WorkSize
from weavecell.api.solid_evidence import (
    Evidence,
    curve_of,
    fit_to_evidence,
    read_evidence,
    sample_surface,
)
from weavecell.results import progress

SOLID_RUNS = "solid-runs"
# [-] to which fibre fractions of the mesh and of the fabric are the same
FRACTIONS_ALIKE = 0.02
OWN_CROSSINGS = "that of the plain crossing, as much softer or stiffer as its own cell is"
PLAIN_CROSSING = "assumed: that of the plain crossing of the same yarns"
WHOSE = {"mesh": "of the mesh", "stated": "that are stated"}


@dataclass(frozen=True)
class CalibrationPlan(Plan[CalibrationResult]):
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
            solid = fit_to_evidence(fabric, self.evidence, running.runs)
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
            surface = sample_surface(fabric, running.how.solver_pool)
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
        evidence = read_evidence(fabric, platen_curve, biaxial, fitted, constants)
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


def _find_effect(fabric, law):
    """Return what the range of a law does to a shot, or None."""
    if law.assumed_range is None:
        return None
    with progress.bar(f"Shots over the range of the law of {fabric.name}") as advance:
        return law_effect.find_effect(fabric, law, advance)
