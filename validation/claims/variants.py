"""Variants of the claims that rest on shots at one ply: does a verdict depend on a choice that the thesis leaves open?

A shot is computed with a rigid projectile, the variational cell formulation, the linear density that the thesis's
tables imply (erratum E-07) and one element per crossover. Each of the four VARIANTS changes one of these, in every run
of the claim that takes it, and the check is done again. Runs that state the quantity themselves keep it. A verdict
holds "in 5 of 5" if the claim is borne out as computed and in all four variants.

OPTIONS are variants that are checked apart from these, by `python -m validation.claims.sliding`: crossovers that slide
belong to no reading of the thesis, whose model pins them.

Packs are not varied: with two elements per crossover their runs alone would take longer than the ledger.
"""

from __future__ import annotations

from validation.claims.checks import CHECKS
from validation.claims.claims import Claim
from validation.claims.judge import NOT_TESTABLE, REPRODUCED, WRONG, Record
from validation.claims.registry import Run

VARIANTS = {  # name: argument of the runs, and its value
    "the thesis's cell formulation": ("form", "equilibrium"),
    "nominal denier": ("denier", "nominal"),
    "2 elements per crossover": ("elements", 2),
    "elastic-plastic bored projectile": ("body", "bored"),
}
OPTIONS = {"sliding crossovers": ("crossovers", 0.2)}  # the coefficient of friction of yarn on yarn
NOT_SLIDING = "pull", "bending", "elements", "form"  # of a shot: sides, laws, meshes that sliding crossovers refuse
TAKES = {  # run: arguments of VARIANTS that it takes
    "shot": ("form", "denier", "elements", "body", "crossovers"),
    "limit": ("form", "denier", "elements", "body", "crossovers"),
    "shots": ("form", "denier", "elements", "body", "crossovers"),
    "net": ("denier",),
}
SHOTS = ("shot", "limit", "shots")  # runs that make a claim one that rests on shots
_WORDS = {
    "form": {None: "variational cell formulation", "equilibrium": "the thesis's cell formulation"},
    "denier": {None: "effective denier (E-07)", "nominal": "nominal denier"},
    "elements": {None: "1 element per crossover"},
    "body": {None: "rigid projectile", "bored": "elastic-plastic bored projectile"},
}


def runs(claim: Claim, variant: str | None = None) -> dict[str, Run]:
    """{argument of the check: run} that a claim reads, in a variant or, where it is None, as computed."""
    needed = CHECKS[claim.check].needs(**(claim.arguments or {}))
    return {name: vary(run, variant) for name, run in needed.items()}


def vary(run: Run, variant: str | None) -> Run:
    """A run in a variant; the same one if it does not take what the variant changes, or states it itself."""
    if variant is None:
        return run
    key, value = (VARIANTS | OPTIONS)[variant]
    if key not in TAKES.get(run.name, ()) or key in run.keywords:
        return run
    return Run.of(run.name, **run.keywords, **{key: value})


def applies(claim: Claim) -> bool:
    """Whether a claim rests on shots at one ply."""
    return bool(claim.check) and any(run.name in SHOTS for run in runs(claim).values())


def varied(claim: Claim) -> list[str]:
    """The variants that change a run of a claim; none of a claim that rests on no shot."""
    if not applies(claim):
        return []
    return [name for name in VARIANTS if runs(claim, name) != runs(claim)]


def can_slide(claim: Claim) -> bool:
    """Whether a claim rests on shots at one ply all of which sliding crossovers allow."""
    if not applies(claim):
        return False
    return not any(set(NOT_SLIDING) & set(run.keywords) for run in runs(claim).values())


def setting(claim: Claim) -> str:
    """Projectile body, cell formulation, denier and mesh of a claim's shots, in words; "" if it rests on none."""
    if not applies(claim):
        return ""
    shots = [run.keywords for run in runs(claim).values() if run.name in SHOTS]
    parts = []
    for key in ("body", "form", "denier", "elements"):
        values = sorted({_words(key, keywords.get(key)) for keywords in shots})
        parts.append(" and ".join(values))
    return ", ".join(parts)


def _words(key, value):
    return _WORDS[key].get(value, f"{key} {value}")


def holds(verdict: str) -> bool:
    """Whether a verdict says that the conditions of the claim are met."""
    return verdict in (REPRODUCED, WRONG)


def summary(record: Record) -> str:
    """ "holds in 4 of 5; missed with nominal denier"; "" for a claim without variants or without a verdict."""
    if not record.variants or record.verdict == NOT_TESTABLE:
        return ""
    verdicts = [record.verdict, *record.variants.values()]
    text = f"holds in {sum(map(holds, verdicts))} of {len(verdicts)}"
    changed = changes(record)
    listed = ", ".join(f"{verdict} with {name}" for name, verdict in changed.items())
    return f"{text}; {listed}" if changed else text


def changes(record: Record) -> dict[str, str]:
    """{variant: its verdict} of the variants whose verdict is not that of the claim as computed."""
    return {name: verdict for name, verdict in record.variants.items() if verdict != record.verdict}
