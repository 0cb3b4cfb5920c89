"""Quasi-static tests on a piece of fabric, and a yarn pull-out."""

from __future__ import annotations

import os
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fabrics import assumed
from fabrics.base import run_cache
from fabrics.base.checks import FilePath
from fabrics.base.counted import counted
from fabrics.base.door import option
from fabrics.base.errors import InputError, UnstableError, interrupts, nearest, unknown_name
from fabrics.base.schema import PYTHON, read_toml
from fabrics.compression import CompressionLaw
from fabrics.fabric import Fabric
from fabrics.variants import rotated_90
from weavecell.answers.coupon import NAMES, CouponResult, PullOutResult
from weavecell.answers.saved import SavedResult
from weavecell.answers.wording import Wording
from weavecell.api import keywords, quantities
from weavecell.api.command import Plan, Running, command
from weavecell.api.run_size import WorkSize
from weavecell.api.target import resolve_fabric
from weavecell.report import pictures_coupon
from weavecell.results import coupon as coupon_results
from weavecell.results import progress, result_folder, run_folder
from weavecell.scenes import build, scene_text
from weavecell.scenes import coupon as scenes
from weavecell.scenes.build import Case
from weavecell.scenes.fabric_table import check_scene
from weavecell.studies import pull_out

if TYPE_CHECKING:
    from shellfabric.cell.model import CellTable
_CODE = "shellfabric.coupon.quasistatic", "shellfabric.coupon.pull_out"


@dataclass(frozen=True)
class CouponPlan(Plan[CouponResult | PullOutResult]):
    """A test on a piece of fabric that is about to be computed.

    Parameters
    ----------
    case : Case of the test
    text, file : of the input; "" and None of a fabric with keywords
    """

    files = (*NAMES, run_folder.CHECKPOINTS)
    runs = ""

    case: Case
    text: str
    file: Path | None

    @property
    def inputs(self) -> Sequence[object]:
        """The fabric, its laws and what is done to it."""
        unseen = {"title": True, "run": {"outputs"}}
        return [(self.case.fabric, self.case.laws, self.case.scene.model_dump(exclude=unseen))]

    def key(self) -> str:
        """Return the digest of input and code."""
        case = self.case
        return run_cache.key((self.text, case.fabric, case.laws, case.scene.model_dump()), *_CODE)

    def finished(self, folder: Path) -> Any:
        """Return what `load` returns of a folder that holds this very test; None of another."""
        found = result_folder.find_whole(folder, NAMES, self.key())
        return found and SavedResult.read(found, result_folder.SUMMARY)

    @contextmanager
    def name_problems(self) -> Iterator[None]:
        """Name the input file and its key in an InputError that is raised inside this block."""
        try:
            yield
        except InputError as problem:
            if self.file is None:
                raise
            scene = self.case.scene
            tables = {"fabric": type(scene.fabric), scene.test: type(scene.test_table)}
            raise build.name_file(problem, self.file, tables) from None

    def forecast(self) -> WorkSize:
        """Count the load steps."""
        from shellfabric.impact import in_words

        scene = self.case.scene
        amounts = {"load step": scene.run.steps}
        if scene.test == "pull_out":
            amounts = {"crossed yarn": scene.pull_out.crossings}
        table_of(self.case)
        case = self.case
        choices = {name: in_words.say(value) for name, value in scene.list_choices().items()}
        taken = [("compression of the yarns", case.law_name)]
        if scene.test == "pull_out" and scene.pull_out.crossover_friction is None:
            friction = assumed.friction_between_yarns(case.fabric).number
            low, high = friction.span
            taken.append(("friction between yarns", f"{friction:g}, assumed ({low:g} .. {high:g})"))
        said = Wording(
            (("", scene.say_test(case.fabric.name, scene.run.steps)),),
            tuple(taken),
            tuple(choices.items()),
        )
        return WorkSize(_title(case), amounts, tuple(assumed.lines(case.fabric)), said)

    def run(self, running: Running) -> CouponResult | PullOutResult:
        """Compute it, and write it; only then its checkpoint is no longer needed."""
        checkpoint = None
        if running.folder is not None:
            checkpoint = running.folder / "checkpoint.h5"
        compute = _relax
        if self.case.scene.test == "pull_out":
            compute = _pull_out
        resume = running.how.resume
        result, running.failure = compute(self.case, self.text, checkpoint, resume)
        if checkpoint is not None:
            with progress.bar("Writing results"):
                running.save(result)
            checkpoint.unlink(missing_ok=True)
        return result


@command(CouponPlan)
def coupon(
    target: Fabric | FilePath,
    test: str | None = None,
    *,
    check: bool = False,
    out: FilePath | None = None,
    resume: bool = False,
    **options: Any,
) -> CouponPlan:
    """Test a piece of fabric: bias extension, picture frame, uniaxial or biaxial tension, or a yarn
    pull-out.

    The folder then holds report.html, summary.json, histories.h5, pictures/ and
    scene.toml; while the run goes on, checkpoint.h5.

    Parameters
    ----------
    target : input file of a coupon; in Python also a fabric
    test : of a fabric: "bias_extension", "picture_frame", "uniaxial", "biaxial" or "pull_out"
    check : compute nothing and write nothing: count the load steps
    out : folder of the results; in Python None writes nothing
    resume : whether to continue an interrupted run from the folder; the state of an unfinished run
        of another version of the code is refused
    **options : of a fabric, the keys of the input file of a coupon (docs/reference.md), numbers in
        SI units or texts with a unit: those of the table of the test, such as length, width and
        elongation, those of [run], such as steps, and those of [fabric], such as cell_model and
        bending. law may be an object, as in `setup`

    Returns
    -------
    CouponResult; of a pull-out PullOutResult; with `resume`, where the folder holds the results of
    this very run, nothing is computed: the SavedResult of `load`, which has numbers and table

    Raises
    ------
    InputError : an unknown test or option, a value that is not allowed, or a law that is missing
    UnstableError : shear in bands, yarns that passed one another, or no equilibrium; its attribute
        `result` is the result up to then, which is written

    Examples
    --------
    >>> frame = wc.coupon("S-720", "picture_frame", shear_angle="5 deg", crossovers=2, steps=2)
    >>> frame.outcome, f"{frame.summary()['shear_stress_Pa'] / 1e6:.2f} MPa"
    ('complete', '0.84 MPa')
    """
    from_file = test is None and isinstance(target, (str, os.PathLike))
    if from_file:
        file = Path(target)  # type: ignore[arg-type]
        text, table = read_toml(file, what="input")
        scene = check_scene(scenes.CouponScene, table, file, "coupon")
        case = build.build(scene, file, file.stem)
    else:
        case = case_of(target, test, options)
        text = ""
        file = None
    quantities.note(scenes.list_numbers(case.scene, case.fabric), file)
    return CouponPlan(case, text, file)


def case_of(target: Fabric | FilePath, test: str | None, options: Mapping[str, Any]) -> Case:
    """Make the Case of a fabric and keywords, which are those of `coupon`."""
    if test not in scenes.TESTS:
        raise unknown_name("test", str(test), scenes.TESTS, key="test")
    fabric = resolve_fabric(target)
    rest = dict(options)
    law = rest.pop("law", None)
    tables = {name: tuple(scene_text.fields_of(scenes.CouponScene, name)) for name in (test, "run")}
    tables["fabric"] = "bending", "cell_model", "cell_formulation", "crossover_gap"
    table: dict[str, Any] = {"fabric": {"name": fabric.name}, test: {}, "run": {"outputs": []}}
    for key, value in rest.items():
        name = next((name for name, keys in tables.items() if key in keys), None)
        if name is None:
            known = sorted(
                {"law", *(key for keys in tables.values() for key in keys)} - {"outputs"}
            )
            near = nearest(key, known)
            hint = ";"
            if near:
                hint = f", did you mean {near}?"
            message = f"is not a keyword of a coupon's {test}{hint} keywords: {', '.join(known)}"
            raise InputError(message, key=key, value=value)
        table[name][key] = value
    try:
        scene = check_scene(
            scenes.CouponScene, keywords.plain(table), None, "coupon", context=PYTHON
        )
    except InputError as problem:
        raise keywords.name_as_keywords(problem, (test, "run", "fabric")) from None
    if scene.trellis_law == "needed":
        fabric = assumed.with_shear(fabric)
    if scene.fabric.cell_model != "compressible":
        return Case(
            fabric, 2 * (CompressionLaw.incompressible(),), scene.fabric.cell_model, scene=scene
        )
    if law is None and fabric.laws is None and not scene.presses_yarns:
        laws = 2 * (CompressionLaw.incompressible(),)
        return Case(fabric, laws, build.NOT_PRESSED, scene=scene)
    laws = build.laws_of(fabric, law)
    return Case(fabric, laws, laws[0].provenance, scene=scene)


def _pull_out(case, text, *_):
    """(PullOutResult, None: it never ends early)."""
    began = time.perf_counter()
    scene = case.scene
    curve = pull_out.run(table_of(case), scene.pull_out, scene.fabric.bending)
    facts = _facts(case, None, began) | {"outcome": "complete"}
    record = coupon_results.pull_out_record(curve, **facts)
    checks = coupon_results.pull_out_indicators(curve)
    return PullOutResult(record, curve, case, checks, text), None


def _relax(case, text, checkpoint, resume):
    """(CouponResult, the UnstableError that ended the run or None), with a bar and checkpoints."""
    from shellfabric.coupon import quasistatic

    began = time.perf_counter()
    scene = case.scene
    table = table_of(case)
    inputs = scene.test_table
    options = scene.run.model_dump(exclude={"outputs"})
    fabric = table.model.fabric
    cell = (fabric.weave, fabric.shear, table.spline)
    stamp = run_cache.stamp(
        (scene.test, inputs.model_dump(), options, *cell), "shellfabric.coupon.quasistatic"
    )
    states = []
    if resume and checkpoint and checkpoint.exists():
        states = run_folder.read_states(checkpoint, stamp)
    failure = None
    with progress.bar(_title(case)) as advance:

        def keep(state):
            states.append(state)
            if checkpoint is not None:
                run_folder.write_states(checkpoint, stamp, states)
            advance(state.load, counted(state.iterations, "iteration"))

        try:
            relax = getattr(quasistatic, scene.test)
            with interrupts():
                solved = relax(table, **dict(inputs), **options, progress=keep, done=tuple(states))
        except UnstableError as problem:
            failure = problem
            solved = problem.result
        except KeyboardInterrupt:
            message = "interrupted"
            if checkpoint is not None and checkpoint.exists():
                message += f"; {option('resume')} goes on from its last step"
            raise run_folder.Interrupted(message) from None
    record = coupon_results.record(inputs, solved, **_facts(case, failure, began))
    checks = coupon_results.indicators(solved, scene.run.tolerance)
    if scene.test == "picture_frame":
        checks += coupon_results.indicate_locking(solved)
    return CouponResult(record, solved, case, checks, text), failure


def _title(case):
    return case.scene.title or f"{case.fabric.name}, {pictures_coupon.TESTS[case.scene.test]}"


def _facts(case, failure, began):
    """What the records of all tests begin with."""
    names = {
        "title": _title(case),
        "fabric": case.fabric.name,
        "law_name": case.law_name,
        "test": case.scene.test,
    }
    facts = names | {
        "failure_message": str(failure or ""),
        "wall_time_s": time.perf_counter() - began,
    }
    if lines := assumed.lines(case.fabric):
        facts["assumed"] = "; ".join(lines)
    return facts


def table_of(case: Case, pulled: str = "warp") -> CellTable:
    """Compute the table of the cell; `pulled` is the family that is drawn out, the warp of the table."""
    from shellfabric.cell.model import CellModel

    fabric, laws = case.fabric, case.laws
    if pulled == "weft":
        fabric, laws = rotated_90(fabric), laws[::-1]
    # what a yarn that is drawn out rubs on are all its crossings, in the mean
    drawn_out = case.scene.test == "pull_out"
    gap, kind, form = build.cell_of(case.scene.fabric)
    model = CellModel(fabric, laws, gap, kind, form, mean_crossing=drawn_out)
    return model.table(coupon_results.TABLE_SIZE)
