"""What one impact came to: its numbers, pictures, files and report.

The folder of `weavecell impact`
    scene.toml, inputs/  the input file as it was given, and copies of the files that it names
    histories.h5    scalars, histories, every ply at the end (`results.impact.ImpactRecord`)
    summary.json    outcome, energies, provenance
    panel.pvd, body.pvd, block.pvd  ParaView series: plies (told by "ply"), metal projectile, face of the block
    pictures/       histories, cuts, energies (.svg), panel.png
    draws.csv       the drawn shots, where they were asked for
    report.html     all of it on one page
    checkpoint.h5   only while the run goes on, or after it was interrupted, for --resume
    window/, draws/  finished shots of --uncertainty at other velocities, and of draws.csv
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from fabrics.base import files
from fabrics.base.checks import FilePath
from fabrics.base.counted import counted
from fabrics.base.door import option
from fabrics.base.errors import InputError
from fabrics.base.extras import explain_missing
from fabrics.base.frozen import explain_frozen
from fabrics.fabric import Fabric
from weavecell.answers.result import WrittenResult, figure, remember_folder
from weavecell.answers.target import list_assumptions
from weavecell.answers.wording import Wording
from weavecell.report import installed
from weavecell.results import finding, keys, one_table, out_folder
from weavecell.results.finding import Answer, Mover
from weavecell.results.impact import ImpactRecord
from weavecell.results.impact_shapes import Shape
from weavecell.results.left_out import (
    LeftOut,
    find_left_out,
    say_nominal,
    summarise,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from pandas import DataFrame

    from shellfabric.impact.result import ImpactResult
    from weavecell.answers.target import Target
    from weavecell.report.page import Embedded
    from weavecell.results.result_folder import ResultFolder
    from weavecell.runs.measurement import Measurement
    from weavecell.runs.passing import Passing
    from weavecell.scenes.build import Case
    from weavecell.studies.mesh_uncertainty import Discretisation
    from weavecell.studies.window import Window

SURFACES = ("body.pvd", "body/body-*.vtu", "block.pvd", "block/block-*.vtu")
PANEL = ("panel.pvd", "panel/panel-*.vtu", *SURFACES)
NAMES = (
    *out_folder.INPUT,
    "histories.h5",
    "summary.json",
    f"{out_folder.DRAWS}.csv",
    *PANEL,
    "pictures/*",
    "report.html",
)


def shot_of(panel: Target, result: ImpactResult, message: str, **more: Any) -> ShotResult:
    """Return the ShotResult of what a run at a target came to; why it became unstable, or "";
    `more` of its fields."""
    shapes = tuple(tuple(map(Shape.from_snapshot, plies)) for plies in result.snapshots)
    fabric = panel.setup.fabric
    lines = list_assumptions(panel.setup)
    return ShotResult.from_result(
        result,
        panel.shot_title,
        panel.law_name,
        message,
        shapes=shapes,
        fabric=fabric,
        assumed=lines,
        **more,
    )


# what completion offers of a shot
OFFERED = (
    *(
        "answer",
        "outcome",
        "residual_velocity",
        "strike_velocity",
        "max_deflection",
        "absorbed_energy",
    ),
    *("strike_energy", "cut_yarns", "stop_time", "back_face_signature_mm", "peaks", "mass"),
    *("time", "velocity", "deflection", "nose_position", "contact_force", "energies", "plies"),
    *("cone_radius", "cut_times"),
    *("histories", "measured", "title", "fabric", "target", "summary", "to_dataframe"),
    *("to_xarray", "to_vtk", "plot", "plot_panel", "view", "save", "checks", "checks_table"),
    *("checks_text", "doubtful", "doubts", "assumed", "draws", "shots", "left_out", "measurements"),
    "wall_time",
)


@explain_frozen
@dataclass(frozen=True, repr=False, kw_only=True)
class ShotResult(ImpactRecord, WrittenResult):
    """One impact on one ply or on a pack, with all that `weavecell.results.impact.ImpactRecord`
    has.

    Parameters
    ----------
    shapes : of each instant of `snapshot_interval` the tuple of the plies' Shape
    fabric : Fabric, with the linear densities of the run
    assumed : lines that name the laws that are assumed
    draws : Passing, drawn shots of its velocity, or None
    target : `weavecell.answers.target.Target` that was shot at; None of a shot of a sweep
    pair : Discretisation of the meshes that were run, or None
    read_from : folder from which it was read; None of a shot that was fired now
    said : Answer of that folder, which may be of more runs than it holds

    Examples
    --------
    >>> shot = wc.impact("S-720", "150 m/s", opening="20 mm", end_time="10 us")
    >>> shot
    ShotResult(S-720, 150 m/s: in flight, residual velocity 148.3 m/s, checks ok)
    >>> f"{1e3 * shot.deflection[-1]:.1f} mm"
    '1.5 mm'
    >>> shot.to_vtk("shot").name
    'panel.pvd'
    """

    shapes: tuple[tuple[Shape, ...], ...] = ()
    fabric: Fabric | None = None
    assumed: tuple[str, ...] = ()
    draws: Passing | None = None
    target: Target | None = None
    pair: Discretisation | None = None
    read_from: Path | None = None
    said: Answer | None = None
    kind = "impact"

    @classmethod
    def of_folder(cls, found: ResultFolder, target: Target) -> ShotResult:
        """Read the result of a finished run at a target from its opened folder.

        It has scalars, histories, cuts and the shapes at the end; the shapes of the other instants
        are in panel.pvd, and range, meshes, window and draws of its options in summary.json.

        Raises
        ------
        InputError : no histories.h5 of an impact
        """
        read = cast(ShotResult, found.read_impact(cls))
        result = replace(
            read,
            said=found.read_answer(),
            fabric=target.setup.fabric,
            assumed=list_assumptions(target.setup),
            target=target,
            read_from=found.folder,
        )
        remember_folder(result, found.folder)
        return result

    @property
    def window(self) -> Window | None:
        """Shots about the strike velocity, with the means over them, on the mesh that counts; None
        without."""
        if self.pair is None:
            return None
        return self.pair.windows[0]

    @property
    def case(self) -> Case:
        """What was built from the input file.

        Raises
        ------
        InputError : a shot of a sweep, or of a set-up, whose panel no report can describe
        """
        if self.target is None or self.target.case is None:
            raise InputError(
                "a shot of a set-up has no report: give the fabric and its keywords, or an input file"
            )
        return self.target.case

    @property
    def left_out(self) -> tuple[LeftOut, ...]:
        """As of `Result`; empty of a shot of a sweep, whose table has them."""
        if self.target is None:
            return ()
        compared = self.pair is not None
        found = find_left_out(
            self.target.setup,
            mesh_compared=compared,
            drawn=self.draws is not None,
            one_shot=True,
        )
        if self.draws is not None:
            return found
        return (*say_nominal(self.target.setup, "--draws 16"), *found)

    @property
    def doubts(self) -> tuple[str, ...]:
        """As of `Result`, and how many of the drawn shots are doubtful."""
        if self.draws is None:
            return super().doubts
        return (*super().doubts, *self.draws.doubts)

    @property
    def measurements(self) -> tuple[Measurement, ...] | None:
        """What measurements leave of the share that passes, of drawn shots; None without."""
        return None if self.draws is None else self.draws.measurements

    @property
    def run_words(self) -> str:
        """What the run took of all that nobody gave."""
        from weavecell.studies import unknown

        said = "one run"
        if self.target is not None:
            said += f": {unknown.say_run(self.target.setup, self.target.is_placed)}"
        return said

    @property
    def answer(self) -> Answer:
        """What drawn shots of its velocity came to, or the one run; what moves it, and what it leaves out."""
        from weavecell.report import chapters_discretisation
        from weavecell.report.shot import chapters_shot
        from weavecell.studies import unknown

        if self.said is not None:
            return self.said
        value, outcome = chapters_shot.outcome(self), self.outcome
        if self.pair is not None:
            value = f"{value}; {chapters_discretisation.in_answer(self.pair)}"
        over = self.run_words
        moved: tuple[Mover, ...] = ()
        advice: tuple[str, ...] = ()
        if self.draws is not None:
            assert self.target is not None
            shots = counted(len(self.draws.shots), "drawn shot")
            over = f"{shots}: {unknown.say_drawn(self.target.setup)}"
            value, outcome = self.draws.words(), self.draws.outcome
            advice = tuple(one.advice for one in self.draws.measurements if one.is_worth)
        if self.rigid_check.endswith("elastic projectile"):
            moved += (Mover("yielding of the projectile", 'projectile.body = "elastic_bar"'),)
        return self._find_answer(self.title, value, moved, advice, outcome=outcome, over=over)

    @property
    def shots(self) -> DataFrame:
        """The table of the drawn shots beside it, a row each; without rows where there are none."""
        from weavecell.runs.table import list_drawn

        if self.draws is not None:
            drawn = self.draws.shots
            return one_table.frame(one_table.columns(drawn, "v50") | list_drawn(drawn), "v50")
        from weavecell.results.result_folder import open_folder

        name = f"{out_folder.DRAWS}.csv"
        if self.folder is None or not (self.folder / name).is_file():
            return one_table.frame({}, "v50")
        return open_folder(self.folder).read_table(name, "v50")

    def __dir__(self) -> list[str]:
        """The names that a user needs, for completion; the others of the record are there too."""
        absent = set()
        if self.backing is None:
            absent.add("back_face_signature_mm")
        if self.draws is None:
            absent |= {"draws", "measurements"}
        return [name for name in OFFERED if name not in absent]

    def summary(self) -> dict[str, Any]:
        """Return the entries of summary.json (docs/reference.md), the checks in words, the areal
        density of the first ply, and what is assumed."""
        from weavecell.report import chapters_discretisation

        known = self.facts() | {"checks": self.checks_text}
        known |= chapters_discretisation.summary(self.pair)
        known = {"answer": self.answer.value} | known
        if self.fabric is not None:
            known["areal_density_kg_m2"] = float(self.fabric.weave.areal_density)
        return known | self._say_in_words() | self._what_is_assumed()

    def _say_in_words(self):
        """What was shot at, what the run took for granted, and the settings that were chosen, as the report
        has them."""
        if self.target is None:
            return {}
        told: dict[str, Any] = {"velocity": True, "body": self.rigid_check}
        return Wording.of_setup(self.target.setup, self.target.scene, **told).summary()

    def _keys_of_summary(self):
        return keys.table("run", self.kind, *keys.OF_SOME.values(), "failure", "stacking")

    def __repr__(self) -> str:
        laws = self._list_assumed_laws()
        more = ""
        if laws:
            more = f", assumed: {counted(len(laws), 'law')}"
        velocity = f"residual velocity {self.residual_velocity:.4g} m/s"
        return f"ShotResult({self._what()}, {velocity}{more}, checks {self.checks_text})"

    def _what(self):
        return f"{self.fabric_name}, {self.strike_velocity:g} m/s: {self.outcome}"

    def _columns(self):
        histories = self.histories
        columns = {}
        for name, values in histories.columns.items():
            if np.ndim(values) == 1:
                unit = histories.unit(name).replace("/", "_")
                columns[name if unit == "1" else f"{name}_{unit}"] = values
        for name in ("reaction_warp", "reaction_weft"):
            columns[f"{name}_N"] = self.plies[name].sum(axis=1)
        return columns | {"checks": [self.checks_text] * len(self.time)}

    def plot(self) -> Figure:
        """Draw a matplotlib figure: velocity of the projectile [m/s] against time [us]."""
        from weavecell.report import pictures

        label = finding.tag(f"{self.fabric_name}, {self.strike_velocity:g} m/s", self.doubts)
        return figure(pictures.velocity, {label: (self.time, self.velocity)})

    @explain_missing()
    def plot_panel(self) -> Figure:
        """Draw a matplotlib figure: the whole panel or pack and the projectile at the end, from the
        side where this is.

        Colours are the higher of warp and weft tension over the strength [%].
        """
        from weavecell.report.shot import view

        return figure(view.end, self)

    @explain_missing()
    def plot_mushroom(self) -> Figure:
        """Draw a matplotlib figure: a projectile of metal at rest and at the end, cut along its axis
        and coloured by plastic strain, beside the velocities of tip, tail and centre of mass.

        Raises
        ------
        InputError : the projectile is no body of metal
        """
        from weavecell.report import pictures_body

        if self.metal is None:
            raise InputError('has no mushroom: the projectile is not of the body "metal"')
        return figure(pictures_body.mushroom, self.metal)

    @explain_missing()
    def view(self) -> Embedded:
        """Show the whole panel or pack and the projectile in motion, as a notebook does: instant,
        colours and the side that is seen are chosen there."""
        from weavecell.report.page import Embedded
        from weavecell.report.shot import moving

        return Embedded(moving.page(self, moving.collect_instants(self, self.instants)))

    @property
    def instants(self) -> list[tuple[Shape, ...]]:
        """The shapes of the plies at each snapshot and at the end."""
        return [*(plies for plies in self.shapes if plies[0].time < self.final[0].time), self.final]

    def to_vtk(self, folder: FilePath) -> Path:
        """Write the panel for ParaView: panel.pvd with ``panel/*.vtu``, all plies in each;
        a projectile of metal with its strains, body.pvd with ``body/*.vtu``; and the face of a block
        behind the last ply, block.pvd with ``block/*.vtu``, as far as it is modelled.

        Parameters
        ----------
        folder : to write to; it is made

        Returns
        -------
        path : of panel.pvd
        """
        from weavecell.results import vtk

        with out_folder.hold(folder, PANEL):
            vtk.write_panel(Path(folder), self.instants, self.quads)
            if bodies := self.bodies():
                vtk.write_body(Path(folder), bodies)
            vtk.write_faces(Path(folder), self.faces())
        return Path(folder) / "panel.pvd"

    _written = NAMES

    def _write(self, out):
        outputs = self.case.scene.run.outputs
        stamp = self.save_numbers(out)
        # of an earlier run, whose series may have been longer
        for names in ("panel/panel-*.vtu", *SURFACES):
            out_folder.remove_earlier(out, names)
        if not outputs or not installed.can_draw():
            return
        if "paraview" in outputs:
            self.to_vtk(out)
        if not {"pictures", "report"} & set(outputs):
            return
        # which loads a plotter
        from weavecell.report.shot import report_shot

        report_shot.write(self, out, stamp)

    def save_numbers(self, out: Path) -> dict[str, Any]:
        """Write the input, histories.h5 and summary.json to a folder; return the provenance."""
        from weavecell.report import chapters_discretisation, checks
        from weavecell.results import json_file, provenance
        from weavecell.scenes import words

        target = self.target
        assert target is not None
        projectile = self.case.scene.projectile
        stamp = provenance.stamp(target.text, setup=target.setup)
        target.keep_input(out)
        self.write(out / "histories.h5")
        content = (
            self.facts() | checks.summary(self.checks) | chapters_discretisation.summary(self.pair)
        )
        content |= summarise(self.left_out) | self._answered()
        if self.draws is not None:
            content["draws"] = self.draws.summary()
            content["measure_first"] = [one.entry() for one in self.draws.measurements]
            files.write(out / f"{out_folder.DRAWS}.csv", one_table.csv(self.shots))
        content |= {
            "projectile": words.shot_in_words(projectile),
            "provenance": stamp,
        }
        json_file.write_summary(out / "summary.json", content)
        return stamp

    def lines(self) -> list[str]:
        """Write the lines that are printed, without what is doubtful."""
        from weavecell.report import chapters_discretisation
        from weavecell.report.shot import chapters_shot

        lines = [self.answer.line]
        if self.read_from is not None:
            lines.append(f"read from {self.read_from}")
        if self.pack:
            cut = chapters_shot.cut(self.plies["cut_yarns"][-1])
            if self.which_fabric:
                lines.append(f"from the front: {self.which_fabric}")
            lines += [self.contact_words, f"by ply: {cut}", self.gap_words]
        if self.step_factor < 1.0:
            lines.append(
                f"run again with {self.step_factor:g} of the time step: the first run lost over 0.4 % of the energy"
            )
        if self.rigid_check:
            lines.append(self.rigid_check)
        if self.backing is not None:
            lines.append(chapters_shot.dent(self))
        if self.viscous_note:
            lines.append(self.viscous_note)
        if self.pair is not None:
            lines.append(chapters_discretisation.words(self.pair))
        elif self.outcome == "perforated":
            lines.append(
                f"values jump with the velocity, as yarns fail one by one: {option('uncertainty')} gives means"
            )
        return lines
