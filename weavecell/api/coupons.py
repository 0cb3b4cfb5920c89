"""Tests on a piece of fabric: quasi-static ones, and a yarn pull-out.

The folder of `weavecell coupon`
    scene.toml      the input file as it was given
    histories.h5    measures, nodes and shear after every step, tensions at the end (`results.coupon.CouponRecord`)
    summary.json    outcome, measures at the end, provenance
    pictures/       coupon.png, and curves (.svg)
    report.html     all of it on one page
    checkpoint.h5   only while the run goes on, or after it was interrupted: `--resume` goes on from it

A pull-out is dynamic: it has no load steps and no checkpoint, its histories.h5 holds the samples of the load
(`results.pull_out.PullOutRecord`), and load.csv holds them as text.

Everything but the checkpoint is written when the run has ended, also if it ended by becoming unstable.
"""

from __future__ import annotations

import os
import time
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fabrics import assumed, run_cache
from fabrics.checks import FilePath
from fabrics.compression import CompressionLaw
from fabrics.errors import InputError, UnstableError
from fabrics.fabric import Fabric
from weavecell.api import keywords, quantities, targets
from weavecell.api.result import Result, figure
from weavecell.report import checks
from weavecell.results import coupon as records
from weavecell.results import coupon_measures, progress, pull_out, run_folder
from weavecell.scenes import build, of_commands
from weavecell.scenes import coupon as scenes
from weavecell.scenes.build import Case

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from shellfabric.panel.quality import Indicator
    from weavecell.report.page import Section
    from weavecell.results.coupon import CouponRecord
    from weavecell.results.pull_out import PullOutRecord

__all__ = ["CouponResult", "PullOutResult", "coupon"]

_CODE = "shellfabric.coupon.quasistatic", "shellfabric.coupon.pull_out"


def coupon(
    target: Fabric | FilePath, test: str | None = None, *, out: FilePath | None = None, resume: bool = False,
    **options: Any,
) -> CouponResult | PullOutResult:  # fmt: skip
    """Test a piece of fabric: bias extension, picture frame, uniaxial or biaxial tension, or a yarn pull-out.

    All but the pull-out are quasi-static. The folder then holds report.html, summary.json, histories.h5, pictures/ and
    scene.toml; while the run goes on, checkpoint.h5.

    Parameters
    ----------
    target : input file of a coupon; in Python also a fabric as of `setup`
    test : of a fabric: "bias_extension", "picture_frame", "uniaxial", "biaxial" or "pull_out"
    out : folder of the results; in Python None writes nothing
    resume : whether to continue an interrupted run from the folder; the state of an unfinished run of another version
        of the code is refused
    **options : of a fabric, the keys of the input file of a coupon (docs/reference/input.md), numbers in SI units or
        texts with a unit: those of the table of the test, such as length, width and elongation, those of [run], such as
        steps, and those of [fabric], such as cell_model and bending. law as of `setup`

    Returns
    -------
    CouponResult; of a pull-out PullOutResult; where the folder holds the results of this very run
    `run_folder.Finished`

    Raises
    ------
    InputError : an unknown test or option, a value that is not allowed, or a law that is missing
    UnstableError : shear in bands, yarns that passed one another, or no equilibrium; its attribute `result` is the
        result up to then, which is written

    Examples
    --------
    >>> frame = wc.coupon("S-720", "picture_frame", shear_angle="5 deg", crossovers=2, steps=2)
    >>> frame.outcome, f"{frame.summary()['shear_stress_Pa'] / 1e6:.2f} MPa"
    ('complete', '0.84 MPa')
    """
    from_file = test is None and isinstance(target, (str, os.PathLike))
    if from_file:
        file = Path(target)  # type: ignore[arg-type]
        scene, text = scenes.load(file, of_commands.COUPON)
        case = build.build(scene, file, file.stem)
    else:
        case, text, file = _case(target, test, options), "", None
    key = run_cache.key((text, case.fabric, case.laws, case.scene.model_dump()), *_CODE)
    if out is not None and resume and (before := run_folder.finished(Path(out), key)):
        return before  # type: ignore[return-value]
    checkpoint = None if out is None else Path(out) / "checkpoint.h5"
    goes_on = resume and checkpoint is not None and checkpoint.exists()
    with targets.folder_of(out, goes_on) as folder, _in_file(case, file):
        run = _pull_out if case.scene.test == "pull_out" else _relaxed
        result, failure = run(case, text, key, checkpoint, goes_on)
        if folder is not None:
            with progress.bar("Writing results"):
                result.save(folder)
            (folder / "checkpoint.h5").unlink(missing_ok=True)
    if failure is not None:
        failure.result = result
        raise failure
    result.warn()
    return result


def _case(target, test, options):
    """The Case of a fabric and keywords."""
    if test not in scenes.TESTS:
        raise InputError(key="test", value=test, allowed=f"one of {', '.join(scenes.TESTS)}")
    fabric, rest = targets.as_fabric(target), dict(options)
    law = rest.pop("law", None)
    tables = {name: tuple(keywords.fields_of(scenes.CouponScene, name)) for name in (test, "run")}
    tables["fabric"] = "bending", "cell_model", "cell_formulation", "cell_profile", "crossover_gap"
    table: dict[str, Any] = {"fabric": {"name": fabric.name}, test: {}, "run": {"outputs": []}}
    for key, value in rest.items():
        name = next((name for name, keys in tables.items() if key in keys), None)
        if name is None:
            known = sorted({"law", *(key for keys in tables.values() for key in keys)} - {"outputs"})
            raise InputError(key=key, value=value, allowed=f"one of {', '.join(known)}")
        table[name][key] = value
    try:
        scene = scenes.check(keywords.written(table, scenes.CouponScene), None, of_commands.COUPON)
    except InputError as problem:
        raise keywords.named(problem, (test, "run", "fabric")) from None
    if scene.trellis_law == "needed":
        fabric = assumed.with_shear(fabric)
    if scene.fabric.cell_model != "compressible":
        return Case("", fabric, 2 * (CompressionLaw.incompressible(),), scene.fabric.cell_model, scene)
    laws = quantities.laws(fabric, law)
    return Case("", fabric, laws, laws[0].provenance, scene)


@contextmanager
def _in_file(case, file):
    """An InputError inside this block names the input file and its key."""
    scene = case.scene
    try:
        yield
    except InputError as problem:
        if file is None:
            raise
        raise build.in_file(problem, file, {scene.test: type(scene.test_table)}) from None


def _pull_out(case, text, key, *_):
    """(PullOutResult, the UnstableError that ended the run or None)."""
    began, scene, failure = time.perf_counter(), case.scene, None
    title = _title(case)
    with progress.bar(title) as advance:
        hooks = [lambda solver: advance(solver.time / solver.end_time)]
        try:
            curve = pull_out.run(_table(case), scene.pull_out, hooks, scene.fabric.bending)
        except UnstableError as problem:
            failure, curve = problem, problem.result
    record = pull_out.PullOutRecord.of(
        curve, title=title, law_name=case.law_name, failure_message=str(failure or ""),
        wall_time=time.perf_counter() - began,
    )  # fmt: skip
    return PullOutResult(record, case, text, _assumed(case), key), failure


def _relaxed(case, text, key, checkpoint, goes_on):
    """(CouponResult, the UnstableError that ended the run or None), with a bar and checkpoints."""
    began, scene, table, failure = time.perf_counter(), case.scene, _table(case), None
    stamp, title = _stamp(table, scene), _title(case)
    states = list(records.read_states(checkpoint, stamp)) if goes_on else []
    with progress.bar(title) as advance:

        def keep(state):
            states.append(state)
            if checkpoint is not None:
                records.write_states(checkpoint, stamp, states)
            advance(state.load, f"{state.iterations} iterations")

        try:
            result = coupon_measures.relaxed(
                table, scene.test, dict(scene.test_table), **scene.run.model_dump(exclude={"outputs"}), progress=keep,
                done=tuple(states),
            )  # fmt: skip
        except UnstableError as problem:
            failure, result = problem, problem.result
        except KeyboardInterrupt:
            kept = checkpoint is not None and checkpoint.exists()
            raise run_folder.Interrupted("interrupted" + "; --resume goes on from its last step" * kept) from None
    record = records.CouponRecord.of(
        result, coupon_measures.measures(scene.test, scene.test_table, result), coupon_measures.PRESCRIBED[scene.test],
        title=title, fabric=case.fabric.name, law_name=case.law_name, test=scene.test,
        failure_message=str(failure or ""), wall_time=time.perf_counter() - began,
        checks=coupon_measures.indicators(result, table, scene.run.tolerance),
    )  # fmt: skip
    return CouponResult(record, case, text, _assumed(case), key), failure


def _title(case):
    from weavecell.report.coupon_page import WORDS

    return case.scene.title or f"{case.fabric.name}, {WORDS[case.scene.test]}"


def _assumed(case):
    return tuple(assumed.lines(case.fabric))


def _table(case):
    """The table of the cell."""
    from shellfabric.cell.model import CellModel

    return CellModel(case.fabric, case.laws, *build.cell_of(case.scene.fabric)).table(coupon_measures.TABLE_SIZE)


def _stamp(table, scene):
    """Digests of all that the states of a run depend on, the code among it."""
    fabric = table.model.fabric
    inputs = (scene.test, scene.test_table.model_dump(), scene.run.model_dump(exclude={"outputs"}))
    inputs += (fabric.weave, fabric.shear, table.model.toes, table.potential)
    return run_cache.stamp(inputs, "shellfabric.coupon.quasistatic")


class _Test(Result):
    """What the results of all tests share; a derived class has record, case, text and key, and what stands here."""

    record: Any
    case: Case
    text: str
    key: str

    @property
    def outcome(self) -> str:
        """ "complete", "yarn at its strength" or "unstable"."""
        return self.record.outcome

    @property
    def checks(self) -> tuple[Indicator, ...]:
        """Quality checks of the test."""
        return self.record.checks

    def _what(self):
        return self.record.title

    def _lines(self) -> list[str]:
        """What the test came to."""
        raise NotImplementedError

    def _chapter(self) -> Section:
        """The chapter of the report."""
        raise NotImplementedError

    def _lead(self) -> str:
        """The sentence at the top of the report."""
        raise NotImplementedError

    def save(self, out: FilePath) -> None:
        """Write the files that stand at the top of this module to a folder, but the checkpoint."""
        from weavecell.report import coupon_page, page
        from weavecell.results import provenance, run_folder

        out, outputs = Path(out), self.case.scene.run.outputs
        stamp = provenance.stamp(self.text, self.case.fabric)
        more = checks.summary(self.checks) | {"run_key": self.key}
        run_folder.write(out, self.text, self.record, more, stamp)
        if not outputs:
            return
        section = self._chapter()
        if "pictures" in outputs:
            page.write_pictures([section], out / "pictures")
        if "report" in outputs:
            report = coupon_page.page(self.case, self.record, section, stamp, self._lead(), self._lines())
            page.write(report, out / "report.html")

    def __str__(self) -> str:
        return "\n".join((f"{self.record.title}: {self.outcome}", *self._lines()))


@dataclass(frozen=True, repr=False)
class CouponResult(_Test):
    """A quasi-static test on a piece of fabric.

    Parameters
    ----------
    record : `weavecell.results.coupon.CouponRecord`
    case : `weavecell.scenes.build.Case` of the test
    text : of the input file, "" where there is none
    assumed : lines that name the laws that are assumed
    key : of the run, by which it is not repeated

    Examples
    --------
    >>> frame = wc.coupon("S-720", "picture_frame", shear_angle="5 deg", crossovers=2, steps=2)
    >>> [round(float(angle), 3) for angle in frame.record.prescribed]  # [rad]
    [0.044, 0.087]
    """

    record: CouponRecord
    case: Case
    text: str = ""
    assumed: tuple[str, ...] = ()
    key: str = ""

    def _lines(self):
        from weavecell.report import coupon_page

        return coupon_page.lines(self.record)

    def _chapter(self):
        from weavecell.report import coupon_page

        return coupon_page.chapter(self.record, self.case.scene.run.tolerance)

    def _lead(self):
        steps = len(self.record.prescribed)
        return (
            f"A coupon of {self.record.fabric}, {self.record.elements} elements, in {steps} load steps, each relaxed "
            f"to {self.case.scene.run.tolerance:g} of the reaction."
        )

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
class PullOutResult(_Test):
    """A yarn drawn out of held crossovers.

    Parameters
    ----------
    record : `weavecell.results.pull_out.PullOutRecord`
    case, text, assumed, key : as of `CouponResult`
    """

    record: PullOutRecord
    case: Case
    text: str = ""
    assumed: tuple[str, ...] = ()
    key: str = ""

    def _lines(self):
        return self.record.lines()

    def _chapter(self):
        from weavecell.report import coupon_page

        return coupon_page.pull_out_chapter(self.record)

    def _lead(self):
        return f"One yarn of {self.record.fabric} drawn through {self.record.curve.coupon.crossings} held crossovers."

    def save(self, out: FilePath) -> None:
        """Write the files that stand at the top of this module to a folder."""
        super().save(out)
        self.record.write_csv(Path(out) / "load.csv")

    @property
    def peak(self) -> float:
        """[N] highest load."""
        return self.record.curve.peak

    @property
    def plateau(self) -> float | None:
        """[N] mean load while all crossovers slide; None where they never all do."""
        return self.record.curve.plateau

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
