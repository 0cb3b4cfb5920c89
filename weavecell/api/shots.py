"""One impact on one ply or several, from its input file or keywords to its folder of results.

The folder of `weavecell impact`
    scene.toml      the input file as it was given
    projectile.stl  a copy of the STL file of the projectile, where the input file names one
    histories.h5    scalars, histories, every ply at the end (`results.impact.ImpactRecord`)
    summary.json    outcome, energies, provenance
    panel.pvd       the ParaView series of panel/panel-*.vtu: all plies, distinguished by "ply"
    pictures/       histories, cuts, energies, reactions, of several plies their shares (.svg), panel.png
    report.html     all of it on one page
    checkpoint.h5   only while the run goes on, or after it was interrupted: `--resume` goes on from it

Where the input says how accurate its results are to be, finer and finer meshes are run (`analysis.discretisation`):
summary.json and the report then tell which, and whether the targets were met.

Everything but the checkpoint is written when the run has ended, also if it ended by becoming unstable.
"""

from __future__ import annotations

import shutil
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, Unpack, cast

from fabrics import run_cache
from fabrics.checks import FilePath, FloatArray
from fabrics.errors import InputError
from fabrics.fabric import Fabric
from weavecell.api import targets
from weavecell.api.keywords import Keywords
from weavecell.api.result import Result, figure
from weavecell.api.run_size import RunSize
from weavecell.results import progress, run_folder
from weavecell.scenes import honoured

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from shellfabric.impact.simulation import ImpactSetup
    from shellfabric.panel.quality import Indicator
    from weavecell.results.impact import ImpactRecord
    from weavecell.results.impact_shapes import Shape
    from weavecell.scenes.target import Target
    from weavecell.studies.assumed_range import AssumedRange
    from weavecell.studies.mesh_uncertainty import Discretisation

__all__ = ["ShotResult", "impact"]

Outcome = Literal["stopped", "perforated", "in flight", "unstable"]


def impact(
    target: Fabric | FilePath | ImpactSetup | None, velocity: float | str | None = None, *,
    assumed_range: bool = False, uncertainty: bool = False, check: bool = False, out: FilePath | None = None,
    resume: bool = False, **options: Unpack[Keywords],
) -> ShotResult:  # fmt: skip
    """Fire a projectile at a panel: histories, ParaView series, pictures and a report.

    A shot that is still in flight at the end time is a result with the outcome "in flight". An input file with a table
    [accuracy] says how well it wants to know something: it is run on finer and finer meshes, until two of them agree so
    far. A key of the input file that cannot be honoured is rejected.

    The folder then holds report.html, summary.json, histories.h5, panel.pvd with panel/*.vtu, pictures/ and scene.toml;
    while the run goes on, checkpoint.h5.

    Parameters
    ----------
    target : input file of a ply or pack; in Python also a fabric as of `setup`, or a set-up of it
    velocity : of a fabric, [m/s] of the strike
    assumed_range : of one ply where a law of the fabric is assumed, repeat the shot with both ends of its range
    uncertainty : run a finer mesh too, and report the discretisation uncertainty of each result
    check : run nothing and write nothing: tell elements, steps, memory, CPU time, and what is assumed
    out : folder of the results; in Python None writes nothing
    resume : whether to continue an interrupted run from the folder; the state of an unfinished run of another version
        of the code is refused
    **options : of a fabric, as of `setup`

    Returns
    -------
    ShotResult, one with a quality check beyond its limit (docs/reports/checks.md) is `doubtful` and warns with
    `DoubtfulResult`; of `check` RunSize; where the folder holds the results of this very run `run_folder.Finished`

    Raises
    ------
    InputError : as `setup`
    UnstableError : the run became unphysical; its attribute `result` is the ShotResult up to then, which is written

    Examples
    --------
    >>> shot = wc.impact("S-720", "150 m/s", opening="20 mm", end_time="10 us")
    >>> shot.outcome, round(shot.residual_velocity)  # [m/s]
    ('in flight', 148)
    """
    panel = targets.of(target, options, honoured.IMPACT, velocity, one_shot=True)
    climbs = panel.case is not None and panel.case.scene.accuracy is not None
    if climbs and uncertainty:
        raise InputError(key="uncertainty", allowed="left out with [accuracy], which compares its meshes")
    if panel.case is None and out is not None:
        raise InputError(key="out", allowed="left out beside a set-up: an input file, or a fabric, has a report")
    if check:
        with panel.named():
            size = RunSize.of(panel.setup, panel.shot_title, targets.assumed_of(panel.setup))
        return size  # type: ignore[return-value]
    key = run_cache.key((panel.text, panel.setup, assumed_range, uncertainty), "shellfabric.impact.simulation")
    if out is not None and resume and (before := run_folder.finished(Path(out), key)):
        return before  # type: ignore[return-value]
    goes_on = out is not None and resume and bool(run_folder.checkpoints(Path(out)))
    with targets.folder_of(out, goes_on) as folder:
        with panel.named():
            result, failure = _answer(panel, key, folder, resume, uncertainty)
            if assumed_range and failure is None and not climbs and panel.setup.plies == 1:
                result = replace(result, range=_range(panel.setup, result))
        if folder is not None:
            with progress.bar("Writing results"):
                result.save(folder)
            for checkpoint in run_folder.checkpoints(folder):
                checkpoint.unlink()
    if failure is not None:
        failure.result = result
        raise failure
    result.warn()
    return result


shoot = impact  # the name of earlier releases, which goes with the next one

# keys of an input file that [accuracy] would change; what is given there stays
_BY_HAND = {("panel", "symmetry"): "symmetry", ("projectile", "body"): "projectile"}


def _answer(panel, key, folder, resume, uncertainty):
    """(ShotResult, the UnstableError that ended the run or None), of the finest mesh that [accuracy] asks for where
    there is one, or of a pair of meshes."""
    from weavecell.results.impact import ImpactRecord
    from weavecell.studies import mesh_uncertainty

    scene, setup = None if panel.case is None else panel.case.scene, panel.setup

    def shoot(setup, table=None, mesh=""):
        if folder is None:
            return _run(panel, setup, table=table)
        name = f"checkpoint{'-' + mesh.replace(' ', '-') if mesh else ''}.h5"
        return _run(panel, setup, folder / name, scene.run.checkpoint_interval, resume, table)

    try:
        if scene is None or scene.accuracy is None:
            shot, pair = mesh_uncertainty.run_pair(setup, shoot) if uncertainty else (shoot(setup), None)
        else:
            fixed = {field for (table, key), field in _BY_HAND.items() if key in getattr(scene, table).model_fields_set}
            shot, pair = mesh_uncertainty.climb(setup, scene.accuracy.targets, shoot, fixed=fixed)
    except KeyboardInterrupt:
        kept = folder is not None and run_folder.checkpoints(folder)
        hint = "; --resume goes on from its last checkpoint" if kept else ""
        raise run_folder.Interrupted(f"interrupted{hint}") from None
    record = ImpactRecord.of(shot.result, panel.shot_title, panel.law_name, str(shot.failure or ""))
    shapes, lines = shapes_of(shot.result.snapshots), targets.assumed_of(setup)
    return ShotResult(record, shapes, setup.fabric, lines, None, panel, pair, key), shot.failure


def shapes_of(snapshots: Any) -> tuple[tuple[Shape, ...], ...]:
    """The Shapes of a run's snapshots, of each instant those of all plies."""
    from weavecell.results.impact_shapes import Shape

    return tuple(tuple(map(Shape.of, plies)) for plies in snapshots)


def _run(panel, setup, checkpoint=None, every=None, resume=False, table=None):
    """The `mesh_uncertainty.Shot` of a set-up."""
    from shellfabric.impact import simulation
    from shellfabric.output.checkpoint import LEAST_WALL, Checkpoints
    from shellfabric.plies import memory
    from weavecell.studies.mesh_uncertainty import Shot

    table = table or setup.table(kept=checkpoint is not None)
    memory.check([setup.panel(table)] * setup.plies, setup.snapshots, written=checkpoint is not None)
    hooks = () if checkpoint is None else (Checkpoints(checkpoint, every, LEAST_WALL),)
    again = checkpoint if resume and checkpoint.exists() else None
    return Shot(
        *progress.watched(
            lambda hooks: simulation.run(setup, hooks=hooks, resume=again, table=table), panel.shot_title, hooks
        )
    )


def _range(setup, shot):
    """The AssumedRange of a shot; None where nothing is assumed, or where the user interrupts it."""
    from weavecell.studies import assumed_range

    if not assumed_range.corners(setup.fabric, setup.laws):
        return None
    try:
        with progress.bar("Range over the assumed laws") as advance:
            return assumed_range.residual_velocity(setup, shot.outcome, shot.residual_velocity, advance)
    except KeyboardInterrupt:
        return None


@dataclass(frozen=True, repr=False)
class ShotResult(Result):
    """One impact on one ply or on a pack.

    Parameters
    ----------
    record : `weavecell.results.impact.ImpactRecord`
    shapes : of each instant of `snapshot_interval` the tuple of the plies' Shape
    fabric : Fabric, with the linear densities of the run
    assumed : lines that name the laws that are assumed
    range : AssumedRange of the residual velocity over the assumed laws, or None
    target : `weavecell.scenes.target.Target` that was shot at; None of a shot of a sweep
    pair : Discretisation of the meshes that were run, or None
    key : of the run, by which it is not repeated

    Examples
    --------
    >>> shot = wc.impact("S-720", "150 m/s", opening="20 mm", end_time="10 us")
    >>> shot
    ShotResult(S-720, 150 m/s: in flight, residual velocity 148.1 m/s, checks ok)
    >>> f"{1e3 * shot.deflection[-1]:.1f} mm"
    '1.6 mm'
    >>> shot.to_vtk("shot").name
    'panel.pvd'
    """

    record: ImpactRecord
    shapes: tuple[tuple[Shape, ...], ...] = ()
    fabric: Fabric | None = None
    assumed: tuple[str, ...] = ()
    range: AssumedRange | None = None
    target: Target | None = None
    pair: Discretisation | None = None
    key: str = ""

    @property
    def outcome(self) -> Outcome:
        """ "stopped", "perforated", "in flight" (the end time came first) or "unstable"."""
        return cast("Outcome", self.record.outcome)

    @property
    def checks(self) -> tuple[Indicator, ...]:
        """Quality checks of the shot."""
        return self.record.checks

    @property
    def strike_velocity(self) -> float:
        """[m/s]"""
        return float(self.record.strike_velocity)

    @property
    def residual_velocity(self) -> float:
        """[m/s] at the end, along the panel's normal; 0 of a projectile that has stopped."""
        return float(self.record.residual_velocity)

    @property
    def time(self) -> FloatArray:
        """(n,) [s] of the histories `deflection` and `contact_force`."""
        return self.record.time

    @property
    def deflection(self) -> FloatArray:
        """(n,) [m] of the back face: largest displacement along the normal, of a pack that of its last ply."""
        return self.record.deflection

    @property
    def contact_force(self) -> FloatArray:
        """(n,) [N] on the projectile along the panel's normal, against its flight; the mean since the time before."""
        return self.record.contact_force

    def summary(self) -> dict[str, Any]:
        """The entries of summary.json (docs/reference/input.md), the checks in words, the areal density of the first
        ply, and what is assumed."""
        found = self.record.summary() | {"checks": self.checks_text}
        if self.fabric is not None:
            found["areal_density_kg_m2"] = float(self.fabric.weave.areal_density)
        return found | self._what_is_assumed()

    def __repr__(self) -> str:
        more = f", assumed: {len(self.assumed)} laws" if self.assumed else ""
        velocity = f"residual velocity {self.residual_velocity:.4g} m/s"
        return f"ShotResult({self._what()}, {velocity}{more}, checks {self.checks_text})"

    def _what(self):
        return f"{self.record.fabric}, {self.strike_velocity:g} m/s: {self.outcome}"

    def _columns(self):
        record = self.record
        columns = {
            "time_s": record.time, "velocity_m_s": record.velocity, "nose_position_m": record.nose_position,
            "deflection_m": record.deflection, "contact_force_N": record.contact_force,
            "failed_yarn_segments": record.failed_segments,
        }  # fmt: skip
        columns |= {f"energy_{name}_J": values for name, values in record.energies.items()}
        columns |= {f"reaction_{name}_N": record.plies[f"reaction_{name}"].sum(axis=1) for name in ("warp", "weft")}
        return columns | {"checks": [self.checks_text] * len(record.time)}

    def plot(self) -> Figure:
        """A matplotlib figure: velocity of the projectile [m/s] against time [us]."""
        from weavecell.report import pictures

        label = f"{self.record.fabric}, {self.strike_velocity:g} m/s"
        return figure(pictures.velocity, {label: (self.record.time, self.record.velocity)})

    def plot_panel(self) -> Figure:
        """A matplotlib figure: the whole panel or pack and the projectile at the end, seen from behind.

        Colours are the higher of warp and weft tension over the strength [%].
        """
        from weavecell.report.shot import view

        return figure(view.end, self.record)

    def to_vtk(self, folder: FilePath) -> Path:
        """Write the panel for ParaView: panel.pvd with ``panel/*.vtu``, all plies in each.

        Parameters
        ----------
        folder : to write to; it is made

        Returns
        -------
        path : of panel.pvd
        """
        from weavecell.results import vtk

        folder, final = Path(folder), self.record.final
        before = [plies for plies in self.shapes if plies[0].t < final[0].t]
        vtk.write_panel(folder, [*before, final], self.record.quads)
        return folder / "panel.pvd"

    def save(self, out: FilePath) -> None:
        """Write the files that stand at the top of this module to a folder, but the checkpoint.

        Raises
        ------
        InputError : a shot of a sweep, or of a set-up, whose panel no report can describe
        """
        from weavecell.report import chapters_assumed, chapters_discretisation, checks, page
        from weavecell.report.shot import shot_page
        from weavecell.results import provenance
        from weavecell.scenes import words

        if self.target is None or self.target.case is None:
            raise InputError("a shot of a set-up has no report: give the fabric and its keywords, or an input file")
        out, case, record, setup = Path(out), self.target.case, self.record, self.target.setup
        outputs, shot = case.scene.run.outputs, case.scene.projectile
        stamp = provenance.stamp(self.target.text, setup=setup)
        more = checks.summary(record.checks) | chapters_assumed.summary(self.range)
        more |= chapters_discretisation.summary(self.pair) | {"projectile": words.shot_in_words(shot)}
        run_folder.write(out, self.target.text, record, more | {"run_key": self.key}, stamp)
        if shot.stl is not None:
            shutil.copyfile(shot.stl, out / "projectile.stl")
        shutil.rmtree(out / "panel", ignore_errors=True)  # of an earlier run, whose series may have been longer
        if "paraview" in outputs:
            self.to_vtk(out)
        if not {"pictures", "report"} & set(outputs):
            return
        used = setup if self.pair is None else self.pair.setup
        sections = shot_page.sections(case, used, record, self.range, self.pair)
        if "pictures" in outputs:
            page.write_pictures(sections, out / "pictures")
        if "report" in outputs:
            page.write(shot_page.page(case, used, record, sections, stamp), out / "report.html")

    def __str__(self) -> str:
        from weavecell.report import chapters_discretisation
        from weavecell.report.shot import tables_shot

        record = self.record
        lines = [f"{record.title}: {record.outcome}, {tables_shot.residual(record)}"]
        if record.pack:
            lines.append(record.contact_words)
            by_ply = ", ".join(f"{n:g}" for n in record.plies["failed_yarns"][-1])
            lines += [f"failed yarn segments by ply: {by_ply}", record.gap_words]
        error = 100 * record.energy_error_max
        lines.append(f"energy error at most {error:.3f} % of the strike energy, {record.strike_energy:.2f} J")
        if record.rigid_check:
            lines.append(record.rigid_check)
        if record.backing is not None:
            moving = 100 * record.energies["backing_kinetic"][-1] / record.strike_energy
            signature = 1e3 * record.backing.back_face_signature
            said = f"back-face signature {signature:.3g} mm"
            lines.append(f"{said}; the block still moves with {moving:.2g} % of the strike energy")
        share, absorbed = 100 * record.viscous_energy_fraction, record.absorbed_energy
        lines.append(f"viscous energy {share:.1f} % of the {absorbed:.2f} J absorbed")
        if self.range is not None:
            lines.append(f"assumed laws: {self.range.words()}")
        if self.pair is not None:
            lines.append(chapters_discretisation.words(self.pair))
        return "\n".join(lines)
