"""The cheapest model that the survey says will do, its answer, and a cheap second one that checks the promise.

A model is taken if the errors that the survey has seen from it are within what is asked (`book`). Its answer is held
against that of a coarser mesh; how far apart the two may be was measured too. If they are too far apart, or do not
agree on whether the panel holds, the next finer model is asked, whose check is the answer that there is already.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import inf, isnan

from fabrics.errors import InputError
from shellfabric import impact
from validation.fidelity import book as books
from validation.fidelity import quantities
from validation.fidelity.models import LADDER, Model, Tables, effort, simplest

BY_HAND = Model("as set by hand", ())


@dataclass(frozen=True)
class Option:
    """A model that a scene could be answered with.

    Parameters
    ----------
    model : Model
    setup : ImpactSetup as the model runs it
    elements : of the modelled part
    effort : elements times steps, to the end time
    cost : [-] over that of the full model, as the survey found it
    expected : {quantity: [-] error}
    enough : whether these are within what is asked
    """

    model: Model
    setup: impact.ImpactSetup
    elements: int
    effort: float
    cost: float
    expected: dict
    enough: bool


@dataclass(frozen=True)
class Attempt:
    """A model's answer.

    Parameters
    ----------
    option : Option
    result : ImpactResult
    values : quantities of it
    against : name of the model that it was checked by; empty if it had none
    errors : {quantity: [-]} estimated; infinite where the two do not agree on the outcome
    holds : whether these are within what is asked
    """

    option: Option
    result: impact.ImpactResult
    values: dict
    against: str
    errors: dict
    holds: bool


@dataclass(frozen=True)
class Answer:
    """What came of it: the last attempt counts. `options` are all that could have been chosen, the cheapest first."""

    asked: dict
    options: tuple[Option, ...]
    attempts: tuple[Attempt, ...]

    @property
    def final(self):
        return self.attempts[-1]

    @property
    def confirmed(self):
        """Whether the promise holds, as far as the check can tell."""
        return self.final.holds


def options(setup, asked, *, fixed=frozenset(), tables=None, book=None):
    """All models that leave alone what the user has set by hand, the cheapest first.

    Parameters
    ----------
    setup : ImpactSetup
    asked : {quantity: [-] error at most}
    fixed : names of fields of ImpactSetup that are to stay

    Raises
    ------
    InputError : a quantity that is not known, an accuracy that is not above 0, or a set-up that cannot be run
    """
    for name, share in asked.items():
        if name not in quantities.NAMES:
            raise InputError(key=name, allowed=f"one of {', '.join(quantities.NAMES)}")
        if not share > 0:
            raise InputError(key=name, value=share, allowed="above 0")
    tables, book = tables or Tables(), book or books.load()
    if setup.surface is not None:  # it has its own cell
        fixed = fixed | {"cell_model"}
    base = setup if "symmetry" in fixed else simplest(setup, tables)
    found = []
    for model in LADDER:
        panel = model.panel(base, tables.cheap(base)) if model.leaves(base, fixed) else None
        if panel is not None:
            expected = {name: book.expected(model, name) for name in asked}
            enough = all(expected[name] <= share for name, share in asked.items())
            work = effort(panel, base.end_time)
            found.append(Option(model, model.of(base), panel.elements, work, book.cost(model), expected, enough))
    if not found:  # all meshes of the ladder differ from what is set by hand: it is run as it is
        panel = base.panel(tables.cheap(base))
        expected = dict.fromkeys(asked, inf)
        found = [Option(BY_HAND, base, panel.elements, effort(panel, base.end_time), 1.0, expected, False)]
    return tuple(sorted(found, key=lambda option: (option.cost, option.effort)))


def pick(options):
    """The cheapest that is enough, or the finest mesh if none is."""
    cheap = (option for option in options if option.enough and option.model.answers)
    return next(cheap, max(options, key=lambda option: option.effort))


def answer(setup, asked, *, fixed=frozenset(), fire: Callable | None = None, tables=None, book=None, told=None):
    """Run the chosen model, check it, and refine until the estimated errors are within what is asked.

    Parameters
    ----------
    setup, asked, fixed : as in `options`
    fire : called as fire(Option, CellTable) for an answer that may be the last; gives its ImpactResult
    told : called as told(text) with what is chosen, and why

    Returns
    -------
    Answer; its last attempt counts, confirmed or not

    Raises
    ------
    InputError, UnstableError : as `options` and `impact.run`
    """
    tables, book, told = tables or Tables(), book or books.load(), told or (lambda text: None)
    fire = fire or (lambda option, table: impact.run(option.setup, table=table))
    found = options(setup, asked, fixed=fixed, tables=tables, book=book)
    by_name, done = {option.model.name: option for option in found}, {}
    option, attempts = pick(found), []
    told(_why(option, asked))
    while True:
        checker = by_name.get(option.model.check)
        if checker is not None and checker.model.name not in done:
            done[checker.model.name] = quantities.of(impact.run(checker.setup, table=tables.of(checker.setup)))
        result = fire(option, tables.of(option.setup))
        values = done[option.model.name] = quantities.of(result)
        errors = _errors(option.model, values, done.get(option.model.check), asked, book)
        holds = all(errors[name] <= share for name, share in asked.items())
        against = checker.model.name if checker is not None else ""
        attempts.append(Attempt(option, result, values, against, errors, holds))
        finer = by_name.get(option.model.finer)
        if holds or finer is None:
            return Answer(dict(asked), found, tuple(attempts))
        told(f"{option.model.name}: {_in_words(errors)} against {against or 'nothing'}; on with {finer.model.name}")
        option = finer


def _errors(model, values, coarser, asked, book):
    """Estimated error of each quantity: from the check, or what is expected where there is none."""
    if coarser is None:
        return {name: book.expected(model, name) for name in asked}
    if values["outcome"] != coarser["outcome"]:
        return dict.fromkeys(asked, inf)
    apart = quantities.differences(values, coarser)
    # what is not there, such as the deflection of a panel that is perforated, is not wrong
    return {name: 0.0 if isnan(apart[name]) else book.estimate(model, name, apart[name]) for name in asked}


def _why(option, asked):
    if not option.enough:
        return f"{option.model.name}: no model is known to be as accurate as asked; this is the finest"
    expected = ", ".join(f"{name} {100 * error:.2g} %" for name, error in option.expected.items())
    return f"{option.model.name}: the cheapest with the expected errors as asked ({expected})"


def _in_words(errors):
    return ", ".join(
        f"{name} within {100 * error:.2g} %" if error < inf else f"{name} not known: outcomes differ"
        for name, error in errors.items()
    )
