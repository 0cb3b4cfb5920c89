"""The choices that the study varies, each alone about the base; those with a limit carry what goes to zero."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

from unitcell3d.model.crossover import Numerics
from unitcell3d.solver.load_stepping import Steps
from validation.verification.crossover_convergence import ends
from validation.verification.crossover_convergence.cases import EQUAL, TRIBUTARY, Case

ROOT = (4, 3, 1)  # elements along, across and through a quarter yarn that the meshes are multiples of
BASE = Case(size=(8, 6, 2))  # coarse
REFINEMENTS = {"quick": (1, 2, 3), "full": (1, 2, 3, 4), "fine": (1, 2, 3, 4, 6)}
TOGETHER = ((3, 3),)  # multiples of ROOT, factors on the penalty
METHOD, MODEL = "method", "model"


@dataclass(frozen=True)
class Axis:
    """One choice.

    Parameters
    ----------
    name : of the choice
    kind : METHOD: another way to the same answer, which has an error; MODEL: another question, which has an effect
    cases : {label: Case}
    x : {label: number} that goes to zero as the method gets exact; None where there is no such number
    unit : of x, for the reader
    counted : the reference is moved by its limit; False where another axis has the same error
    """

    name: str
    kind: str
    cases: dict
    x: dict | None = None
    unit: str = ""
    counted: bool = True


NAMED = {"toe": "smoothing length"}  # of fields of model.crossover.Numerics


def axes(level: str = "full") -> list[Axis]:
    """All axes, the mesh first; `level`: of `REFINEMENTS`."""
    base = BASE
    return [
        _meshes(base, REFINEMENTS[level]),
        _together(base),
        _direction("elements along", 0, base),
        _direction("elements across", 1, base),
        _direction("elements through", 2, base),
        *_numerics(base),
        _steps(base),
        Axis("domain", METHOD, {name: replace(base, domain=name) for name in ("quarter", "whole")}),
        Axis("integration", METHOD, {"full": base, "one point": replace(base, one_point=True)}),
        Axis(
            "end condition",
            MODEL,
            {end: replace(base, end=end) for end in (ends.TWO_FOLD, ends.CLAMPED, ends.UPRIGHT, ends.PIN)},
        ),
        Axis("section", MODEL, {"sine": base} | {s: replace(base, section=s) for s in ("ellipse", "conforming")}),
        _tips(base),
        Axis("bars", MODEL, {bars: replace(base, bars=bars) for bars in (TRIBUTARY, EQUAL)}),
        *_friction(base),
        _moduli("shear modulus G", "K_G", base),
        _moduli("axial modulus E_a", "E_a", base),
    ]


def _times(n):
    return tuple(n * part for part in ROOT)


def _label(size):
    return " x ".join(map(str, size))


def _meshes(base, refinements):
    cases = {_label(_times(r)): replace(base, size=_times(r)) for r in refinements}
    x = {_label(_times(r)): 1 / r for r in refinements}
    return Axis("mesh", METHOD, cases, x, f"element size, of {_label(ROOT)}")


def _together(base):
    cases = {_label(base.size): base}
    for n, factor in TOGETHER:
        label = f"{_label(_times(n))}, penalty x {factor}"
        cases[label] = replace(base, size=_times(n), numerics=(_scaled("penalty", factor),))
    return Axis("mesh and penalty", METHOD, cases)


def _direction(name, axis, base):
    sizes = [tuple(n * f if i == axis else n for i, n in enumerate(base.size)) for f in (0.5, 1, 2)]
    sizes = [tuple(map(int, size)) for size in sizes]
    return Axis(name, METHOD, {_label(size): replace(base, size=size) for size in sizes})


def _numerics(base):
    """Axes of the fields of model.crossover.Numerics; those with a limit are varied by factors that tend to it."""
    levels = {
        # within the smoothing length (`toe`) a pressure p leaves the penetration sqrt(2 toe p / penalty)
        "penalty": ((1 / 100, 1 / 30, 1 / 10, 1 / 3, 1, 3), -0.5, "root of the default penalty over the penalty"),
        "toe": ((4, 2, 1, 1 / 2, 1 / 4), 0.5, "root of the smoothing length over the default one"),
        "slack_stiffness": ((4, 1, 1 / 4), 1, "over the default"),
        "slack_width": ((4, 2, 1, 1 / 2), 1, "over the default"),
    }
    there = {field.name for field in fields(Numerics)}
    for name, (factors, power, unit) in levels.items():
        if name in there:
            cases = {_factor(f): base if f == 1 else replace(base, numerics=(_scaled(name, f),)) for f in factors}
            yield Axis(
                NAMED.get(name, name.replace("_", " ")),
                METHOD,
                cases,
                {_factor(f): f**power for f in factors},
                unit,
                name != "toe",
            )


def _scaled(name, factor):
    """A field of Numerics, and its default times a factor."""
    return name, getattr(Numerics(), name) * factor


def _friction(base):
    """Coulomb's coefficient, where the contact knows one."""
    if "friction" in {field.name for field in fields(Numerics)}:
        cases = {f"{mu:g}": replace(base, numerics=(("friction", mu),)) for mu in (0.1, 0.2, 0.4)}
        yield Axis("friction", MODEL, {"0": base} | cases)


def _factor(f):
    return "default" if f == 1 else f"x {f:g}" if f > 1 else f"/ {1 / f:g}"


def _steps(base):
    default = Steps().largest
    cases = {}
    for largest in (0.4, 0.2, default, 0.05, 0.025):
        label = f"{100 * largest:g} %"
        cases[label] = base if largest == default else replace(base, steps=(("largest", largest),))
    return Axis("load step", METHOD, cases, unit="largest step, of the path")


def _tips(base):
    return Axis(
        "tip bluntness", MODEL,
        {"0.075": base} | {f"{b:g}": replace(base, tip_thickness_ratio=b) for b in (0.02, 0.05, 0.1, 0.2)},
    )  # fmt: skip


def _moduli(name, field, base):
    return Axis(
        name, MODEL, {_factor(f): base if f == 1 else replace(base, solids=((field, f),)) for f in (1, 0.1, 10)}
    )
