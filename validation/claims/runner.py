"""Runs the ledger: first the computations that claims share, each once (`fabrics.base.run_cache`), then the conditions.

A shot at one ply is computed as the thesis has it: its cell formulation (equilibrium), a rigid projectile, the linear
density that its tables imply (erratum E-07) and one element per crossover. Each of the four VARIANTS has our
variational cell formulation in every shot at one ply that does not state another, the last three with one change
more, and the claim is judged again: does its verdict depend on a choice that the thesis leaves open, or that we made?
Packs are not varied and have the variational formulation: with two elements per crossover their runs alone would take
longer than the ledger.
"""

from __future__ import annotations

import json
import traceback
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from fabrics.base.errors import WeavecellError
from validation.claims import changed_fabrics, checks, judge, runs
from validation.claims.claims import Claim, Run, in_si, run_of
from validation.claims.judge import BROKEN, LEFT_OUT, MISSED, NOT_BUILT, NOT_TESTABLE, Record
from validation.filling import filled
from validation.values import Values, compute_each

# what is merged into the keywords of shots at one ply
OF_THESIS: Values = {"cell_formulation": "equilibrium"}
OURS: Values = {"cell_formulation": "variational"}
VARIANTS: dict[str, Values] = {
    "the variational cell formulation": OURS,
    "that and nominal denier": OURS | {"change": {"denier": "nominal"}},
    "that and 2 elements per crossover": OURS | {"elements_per_crossover": 2},
    "that and an elastic-plastic bored projectile": OURS | {"projectile": {"body": "elastic_bar"}},
}
SHOTS = ("shot", "limit", "shots")
FACTORS = "factors"  # keyword of a run whose fabrics are changed
LONG = (
    "limit",
    "shots",
    "bias",
    "pace",
    "pencil",
    "stretched",
    "plates",
    "lone",
    "meshes",
    "released",
    "woven",
)
NEEDS = dict.fromkeys(("stretched", "plates", "lone", "brick", "released"), "dolfinx")
NEEDS |= dict.fromkeys(("sections", "meshes", "woven"), "gmsh")


def validate(
    claims: Sequence[Claim],
    folder: Path,
    *,
    slow: bool = True,
    vary: bool = False,
    report: Callable[[int, int], object] | None = None,
    **pool: Any,
) -> list[Record]:
    """Judge the claims.

    Parameters
    ----------
    claims : of `claims.load`
    folder : where runs are kept, and taken from
    slow : whether those that are slow are not left out
    vary : also judge each claim that rests on shots at one ply in the variants that change them
    report, **pool : report, executor, jobs, resume of `run_cache.results`

    Returns
    -------
    One record a claim, in the order of the claims.
    """
    tasks: list[tuple[Claim, str | None]] = []
    for claim in claims:
        if claim.slow and not slow:
            continue
        tasks.append((claim, None))
        for name in VARIANTS:
            if vary and runs_of(claim, name) != runs_of(claim):
                tasks.append((claim, name))
    wanted: set[Run] = set()
    for task in tasks:
        wanted.update(run for run in _flat(runs_of(*task)) if not _missing(run))
    # the long ones first, so that no core waits for one at the end
    ordered = sorted(wanted, key=lambda run: (not _is_long(run), run))
    done = compute_each(compute, ordered, folder=folder, report=report, **pool)
    left_out = "slow: run with --slow"
    records = {claim.id: Record(claim.id, LEFT_OUT, note=left_out) for claim in claims}
    for claim, name in tasks:
        record = check(claim, done, name)
        if name is None:
            records[claim.id] = record
        else:
            records[claim.id].variants[name] = record.verdict
    return list(records.values())


def compute(run: Run) -> Any:
    """Compute what a run comes to; an error of weavecell is a result too, which the claims
    report."""
    keywords = json.loads(run.keywords)
    factors = keywords.pop(FACTORS, {})
    try:
        with changed_fabrics.change_inputs(factors):
            return getattr(runs, run.kind)(json.loads(run.of), **keywords)
    except WeavecellError as problem:
        return WeavecellError(f"{run.kind} {run.of} {run.keywords}: {problem}")


def check(claim: Claim, done: dict[Run, Any], variant: str | None = None) -> Record:
    """Check a claim by what its runs have come to, and return its record; `variant` of VARIANTS, or
    None for it as it stands."""
    if not claim.conditions:
        verdict = NOT_TESTABLE
        if claim.unbuilt:
            verdict = NOT_BUILT
        return Record(claim.id, verdict, note=claim.unbuilt or claim.untestable)
    try:
        specs = runs_of(claim, variant)
        for run in _flat(specs):
            if package := _missing(run):
                return Record(claim.id, NOT_TESTABLE, note=f"{package} is not installed")
            if isinstance(done[run], WeavecellError):
                raise done[run]
        results = {}
        for name, spec in specs.items():
            if isinstance(spec, dict):
                results[name] = {key: done[run] for key, run in spec.items()}
            else:
                results[name] = done[spec]
        with changed_fabrics.change_inputs(claim.factors):
            return judge.judge(claim, values(claim, results))
    except WeavecellError as problem:
        return Record(claim.id, MISSED, miss=str(problem), note=str(problem))
    except Exception:
        return Record(claim.id, BROKEN, note=traceback.format_exc(limit=-3))


def values(claim: Claim, results: Values) -> Values:
    """Evaluate what is found for each of the conditions, {name: value}; the expressions are Python,
    in our own files."""
    names = checks.names() | {"__builtins__": __builtins__} | results
    for name, expression in claim.let.items():
        names[name] = eval(in_si(expression), names)
    found: Values = {}
    for condition in claim.conditions:
        if condition.expression:
            found[condition.name] = eval(condition.expression, names)
    return found


def runs_of(claim: Claim, variant: str | None = None) -> Values:
    """List the runs that a claim reads, as it stands or in a variant: {name: Run, or dict of
    Runs}."""
    names = checks.names()
    changes = OF_THESIS
    if variant is not None:
        changes = VARIANTS[variant]
    found = {name: _specified(spec, names, changes) for name, spec in claim.run.items()}
    if claim.factors:
        return {name: _with_factors(spec, claim.factors) for name, spec in found.items()}
    return found


def _with_factors(spec, factors):
    """A run, or each of a dict of runs, with changed inputs."""
    if isinstance(spec, dict):
        return {key: _with_factors(run, factors) for key, run in spec.items()}
    keywords = json.loads(spec.keywords)
    of_fabrics = dict(factors)
    factor = of_fabrics.pop("velocity", 1.0)
    for name in ("velocity", "velocities"):
        if name in keywords:
            keywords[name] = np.multiply(keywords[name], factor).tolist()
    if of_fabrics:
        keywords[FACTORS] = of_fabrics
    return replace(spec, keywords=json.dumps(keywords, sort_keys=True))


def is_long(claim: Claim) -> bool:
    """Tell whether a run of it takes more than a few seconds."""
    return any(map(_is_long, _flat(runs_of(claim))))


def _specified(spec, names, changes):
    if "for" not in spec:
        return _varied(run_of(spec, names), changes)
    rows = spec["for"]
    if isinstance(rows, str):
        rows = names[rows]
    rest = {key: value for key, value in spec.items() if key != "for"}
    found: Values = {}
    for row in rows:
        key = row
        chosen = {"": row}
        if isinstance(row, list):
            key = tuple(row)
            chosen = {f"{place}": part for place, part in enumerate(row)}
        found[key] = _varied(run_of(filled(rest, chosen, shown=str), names), changes)
    return found


def _varied(run, changes):
    """A run with the keywords of a variant that it takes and does not state itself."""
    keywords = json.loads(run.keywords)
    if run.kind == "net":
        keywords = changes.get("change", {}) | keywords
    elif run.kind in SHOTS and keywords.get("plies", 1) == 1:
        for name, value in changes.items():
            own = keywords.get(name) or {}
            keywords[name] = own or value
            if name == "change":
                keywords[name] = value | own
    return replace(run, keywords=json.dumps(keywords, sort_keys=True))


def _flat(specs: Values) -> Iterator[Run]:
    for spec in specs.values():
        if isinstance(spec, dict):
            yield from spec.values()
        else:
            yield spec


def _is_long(run):
    return run.kind in LONG or json.loads(run.keywords).get("plies", 1) > 1


def _missing(run):
    """The package that a run needs and that is not installed, or ""."""
    package = NEEDS.get(run.kind, "")
    if package and find_spec(package) is None:
        return package
    return ""
