"""The cheapest model that the survey says will do, its answer, and a check that can object.

Two scouts, the coarsest meshes, are run first. They tell whether the panel holds and how hard the scene is
(`quantities.scale`); the survey has found how far each model goes wrong in proportion to that. The cheapest model is
taken whose errors are so within the targets. Its answer is held against its partner's, the scout of the next coarser
mesh: where the two are further apart than they ever were in the survey, or do not agree on whether the panel holds, the
scene is not like the survey's, and the promise is void. Then the next model that would do is run, and what it is held
against is the answer before it: being the coarser, that may be off by no more than the target. Peak tensions are mixed
with the partner's (`quantities.mixed`).

A pack is answered on the finer of two meshes, and held against the coarser, its default: their difference is the error
that the targets are compared with.

A scout also tells whether a flat steel projectile may be rigid (`ImpactResult.rigidity`), where nobody has said so.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace
from math import inf, isnan
from typing import Any

from fabrics.errors import InputError, UnstableError
from shellfabric.impact import simulation
from shellfabric.impact.simulation import ImpactResult, ImpactSetup
from weavecell.analysis.fidelity import error_database as books
from weavecell.analysis.fidelity import quantities
from weavecell.analysis.fidelity.ladder import Model, Tables, effort, ladder_of, partner, scouts, simplest

BY_HAND = Model("as set by hand", ())
_PAYS = 0.8  # of the least error, over the target, that a dearer model has to get below to be worth its time


@dataclass(frozen=True)
class Option:
    """A model that a scene could be answered with.

    Parameters
    ----------
    model : Model
    setup : ImpactSetup as the model runs it
    elements : of the modelled part, of all plies
    effort : elements times steps, to the end time
    cost : [-] over that of the full model, as the survey found it
    expected : {quantity: [-] error}: its bound, or what is likely where nothing has been run yet
    targets : {quantity: [-] error at most}
    """

    model: Model
    setup: ImpactSetup
    elements: int
    effort: float
    cost: float
    expected: dict
    targets: dict

    @property
    def enough(self) -> bool:
        """Whether the expected errors are within the targets."""
        return self.short <= 1

    @property
    def short(self) -> float:
        """[-] the expected error over the target, of the quantity for which it is largest."""
        return max((self.expected[name] / share for name, share in self.targets.items()), default=0.0)


@dataclass(frozen=True)
class Attempt:
    """A model's answer.

    Parameters
    ----------
    option : Option
    result : ImpactResult
    values : quantities of it, peak tensions mixed with the partner's
    against : name of the model that it was held against; empty if there was none
    partner : name of the model whose peak tensions are mixed in; empty if there was none
    errors : {quantity: [-]} what the survey says they are below; infinite where the other answer objects
    holds : whether these are within the targets
    """

    option: Option
    result: ImpactResult
    values: dict
    against: str
    partner: str
    errors: dict
    holds: bool


@dataclass(frozen=True)
class Answer:
    """What came of it: the last attempt counts.

    Parameters
    ----------
    targets : {quantity: [-] error at most}
    regime : what the scouts made of the scene; empty without them
    body : why the projectile is rigid or elastic, in words
    options : all that could have been chosen, the cheapest first
    attempts : the answers, in their order
    own : {quantity: [-]} what the full model, which all errors are against, is itself expected to be off by
    """

    targets: dict
    regime: str
    body: str
    options: tuple[Option, ...]
    attempts: tuple[Attempt, ...]
    own: dict

    @property
    def final(self) -> Attempt:
        return self.attempts[-1]

    @property
    def confirmed(self) -> bool:
        """Whether the promise holds, as far as survey and check can tell."""
        return self.final.holds


def options(
    setup: ImpactSetup, targets: dict[str, float], *, fixed: Collection[str] = frozenset(),
    tables: Tables | None = None, book: books.Book | None = None, seen: Sequence[dict[str, Any]] | None = None,
) -> tuple[Option, ...]:  # fmt: skip
    """All models that leave alone what the user has set by hand, the cheapest first.

    Parameters
    ----------
    setup : ImpactSetup
    targets : {quantity: [-] error at most}
    fixed : names of fields of ImpactSetup that are to stay
    seen : what two scouts found, the finer first; None before they are run

    Raises
    ------
    InputError : a quantity that is not known, an accuracy that is not above 0, or a set-up that cannot be run
    """
    for name, share in targets.items():
        if name not in quantities.NAMES:
            raise InputError(key=name, allowed=f"one of {', '.join(quantities.NAMES)}")
        if not share > 0:
            raise InputError(key=name, value=share, allowed="above 0")
    tables, book = tables or Tables(), book or _book(setup)
    base = setup if "symmetry" in fixed else simplest(setup, tables)
    if setup.surface is not None:  # it has its own cell
        fixed = frozenset(fixed) | {"cell_model"}

    def option(model):
        this = model.of(base)
        panel, plies = this.panel(tables.cheap(base)), base.plies
        work, expected = plies * effort(panel, base.end_time), _expected(book, model, targets, seen)
        return Option(model, this, plies * panel.elements, work, book.cost(model), expected, targets)

    models = ladder_of(base)
    found = [option(model) for model in models if model.leaves(base, fixed) and model.panel(base, tables.cheap(base))]
    if not any(one.model.answers for one in found):  # all meshes of the ladder differ from what is set by hand
        found = [replace(option(BY_HAND), cost=1.0)]
    return tuple(sorted(found, key=lambda one: (one.cost, one.effort)))


def _book(setup):
    return books.load(packs=setup.plies > 1)


def _expected(book, model, targets, seen):
    if model.full:
        return dict.fromkeys(targets, 0.0)  # by definition
    if seen is None:
        return {name: book.expected(model, name) for name in targets}
    return {name: book.bound(model, name, seen) for name in targets}


def pick(options: Sequence[Option]) -> Option:
    """The cheapest that is enough; if none is, the cheapest beyond which no dearer one takes a fifth off the error."""
    options = [option for option in options if option.model.answers]
    for option in options:
        if option.enough:
            return option
    best = options[0]
    for option in options[1:]:
        if option.short < _PAYS * best.short:
            best = option
    return best if best.short < inf else max(options, key=lambda option: option.effort)


def answer(
    setup: ImpactSetup, targets: dict[str, float], *, fixed: Collection[str] = frozenset(),
    fire: Callable | None = None, tables: Tables | None = None, book: books.Book | None = None,
    on_progress: Callable[[str], object] | None = None,
) -> Answer:  # fmt: skip
    """Run the scouts, the model chosen by them, and others where the first answer is objected to.

    Parameters
    ----------
    setup, targets, fixed : as in `options`; "projectile" among the fields says that its body is as it is to be
    fire : called as fire(Option, CellTable) for an answer that may be the last; gives its ImpactResult
    on_progress : called as on_progress(text) with what is chosen, and why

    Returns
    -------
    Answer; its last attempt counts, confirmed or not

    Raises
    ------
    InputError, UnstableError : as `options` and `simulation.run`
    """
    tables, book, on_progress = tables or Tables(), book or _book(setup), on_progress or (lambda text: None)
    fire = fire or (lambda option, table: simulation.run(option.setup, table=table))
    options(setup, targets, fixed=fixed, tables=tables, book=book)  # wrong targets are refused before anything is run
    base = setup if "symmetry" in fixed else simplest(setup, tables)
    shot = setup.projectile
    seen, body = _look(base, tables), f"projectile: {_kind(shot)}, as set"
    if "projectile" not in fixed and seen:
        shot, body = _body(shot, seen[0].result)
        if shot != setup.projectile:
            setup, base = replace(setup, projectile=shot), replace(base, projectile=shot)
            seen = _look(base, tables)  # rigid scouts are no check of an elastic projectile
    on_progress(body)
    both = tuple(scout.values for scout in seen) if len(seen) == 2 else None
    found = options(setup, targets, fixed=fixed, tables=tables, book=book, seen=both)
    attempts, option, before = [], pick(found), None
    on_progress(_why(option))
    while True:
        result = fire(option, tables.of(option.setup))
        values = quantities.of(result)
        other = _partner(option.model, seen)
        errors, against = _checked(option, values, before, other, seen, book)
        weight = book.weight(option.model, quantities.regime(values))
        if other is not None:
            values = quantities.mixed(values, other.values, weight)
        holds = all(errors[name] <= share for name, share in targets.items())
        mixed = other.model.name if other is not None and weight > 0 else ""
        attempts.append(Attempt(option, result, values, against, mixed, errors, holds))
        finer = next((one for one in found if one.enough and one.cost > option.cost and one.model.answers), None)
        if holds or finer is None:
            regime = quantities.regime(values)
            own = {name: book.own(name, regime) for name in targets}
            if "projectile" not in fixed and shot.bar is None and not _stays_rigid(result):
                body = f"{body}; but in the answer itself {result.rigidity}"
            return Answer(dict(targets), regime, body, found, tuple(attempts), own)
        on_progress(
            f"{option.model.name}: {_in_words(errors)}, held against {against or 'nothing'}; on with {finer.model.name}"
        )
        option, before = finer, attempts[-1]


@dataclass(frozen=True)
class _Scout:
    model: Model
    result: ImpactResult
    values: dict


def _look(base, tables):
    """What the pilot runs find, the finer first; empty where not all of them can be meshed and run."""
    meshed = [model.name for model in ladder_of(base) if model.panel(base, tables.cheap(base)) is not None]
    found = []
    for model in scouts(meshed):
        this = model.of(replace(base, snapshot_interval=None, history=None))
        try:
            result = simulation.run(this, table=tables.of(this))
        except UnstableError:
            return ()
        found.insert(0, _Scout(model, result, quantities.of(result)))
    return tuple(found) if len(found) == 2 or base.plies > 1 else ()


def _kind(shot):
    return "rigid" if shot.bar is None else "an elastic bar"


def _body(shot, scout):
    """(the projectile as elastic as it needs to be, why)."""
    if scout.rigidity is None:
        return shot, f"projectile: {_kind(shot)}; only a flat cylinder of steel could be elastic"
    if scout.rigidity.enough:
        return replace(shot, body="rigid"), f"projectile: rigid; {scout.rigidity}"
    return replace(shot, body="elastic_bar"), f"projectile: an elastic bar; {scout.rigidity}"


def _partner(model, seen):
    """The scout that is next to a model; None of those that have none."""
    if not seen or model.name == BY_HAND.name:
        return None
    if len(seen) == 1:
        return seen[0]
    if model.full:
        return None
    wanted = partner(model, tuple(scout.model for scout in reversed(seen)))
    return next(scout for scout in seen if scout.model.name == wanted.name)


def _stays_rigid(result):
    return result.rigidity is None or result.rigidity.enough


def _checked(option, values, before, other, seen, book):
    """({quantity: [-]} what the errors are below, name of what they were held against)."""
    expected, model = option.expected, option.model
    if model.full and other is not None:  # of a pack
        return _apart(values, other.values, option.targets), other.model.name
    if model.full:
        return expected, ""
    if before is not None:
        return _apart(values, before.values, option.targets), before.option.model.name
    if other is None:
        return dict.fromkeys(option.targets, inf), ""
    apart = _apart(values, other.values, option.targets)
    most = {name: book.apart(model, name, tuple(scout.values for scout in seen)) for name in option.targets}
    return {name: expected[name] if apart[name] <= most[name] else inf for name in option.targets}, other.model.name


def _apart(values, others, names):
    """{quantity: [-]} between two answers; infinite where their outcomes differ, 0 of what is in neither."""
    if quantities.regime(values) != quantities.regime(others):
        return dict.fromkeys(names, inf)
    found = quantities.differences(values, others)
    return {name: 0.0 if isnan(found[name]) else found[name] for name in names}


def _why(option):
    if option.model.near is not None:
        return f"{option.model.name}: held against the default mesh"
    if not option.enough:
        name = option.model.name
        return f"{name}: no model is known to be as accurate as the targets; of none finer much more is expected"
    expected = ", ".join(f"{name} {100 * error:.2g} %" for name, error in option.expected.items())
    return f"{option.model.name}: the cheapest with errors within the targets ({expected})"


def _in_words(errors):
    return ", ".join(
        f"{name} within {100 * error:.2g} %" if error < inf else f"{name} unlike the survey"
        for name, error in errors.items()
    )
