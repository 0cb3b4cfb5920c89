"""A scene that says what it wants to know, and how well: the model chosen for it, in words, tables and files."""

from __future__ import annotations

from fabrics.errors import InputError, UnstableError
from weavecell import case, scene
from weavecell.report import Section, Table

# keys of a scene that a model of the ladder would change; what is given there stays
_BY_HAND = {
    ("panel", "symmetry"): "symmetry",
    ("run", "elements_per_crossover"): "elements_per_crossover",
    ("fabric", "cell_model"): "cell_model",
}


def by_hand(asked):
    """Names of the fields of ImpactSetup that the scene sets itself."""
    return frozenset(field for (table, key), field in _BY_HAND.items() if key in getattr(asked, table).model_fields_set)


def answer(asked, setup, shoot):
    """Choose, run and check.

    Parameters
    ----------
    asked : Scene with a table [accuracy]
    setup : ImpactSetup as the scene has it
    shoot : called as shoot(setup, table, name of the model) for a run with all its records; gives
        (ImpactRecord, snapshots, failure, ImpactResult)

    Returns
    -------
    shot : (ImpactRecord, snapshots, failure) of the run that counts
    choice : choose.Answer, or None where that run became unstable
    """
    from validation.fidelity import choose

    last = None

    def fire(option, table):
        nonlocal last
        *last, result = shoot(option.setup, table, option.model.name)
        if last[2] is not None:
            raise last[2]
        return result

    try:
        choice = choose.answer(setup, asked.accuracy.asked, fixed=by_hand(asked), fire=fire, told=print)
    except UnstableError:
        if last is None:
            raise
        choice = None
    return last, choice


def explain(path):
    """Print what the scene at `path` could be answered with, what each is expected to be off by, and what is chosen.

    Raises
    ------
    InputError : the scene or what it names is wrong, or it asks for no accuracy
    """
    import rich
    from rich import box, table

    from validation.fidelity import choose

    asked, _ = scene.load(path)
    if asked.accuracy is None:
        raise InputError("is missing, so there is nothing to choose", file=path, key="accuracy")
    this = case.build(asked, path, path.stem)
    options = choose.options(case.setup(this, path), asked.accuracy.asked, fixed=by_hand(asked))
    chosen = choose.pick(options)
    shown = table.Table(box=box.SIMPLE_HEAD, title="Models, the cheapest first; expected errors", title_justify="left")
    for column in ("", "model", "part", "elements", "cost", *asked.accuracy.asked):
        shown.add_column(column.replace("_", " "))
    for option in options:
        shown.add_row("->" if option is chosen else "", *_row(option, asked.accuracy.asked))
    rich.print(shown)
    print("asked: " + ", ".join(f"{_plain(name)} {_percent(share)}" for name, share in asked.accuracy.asked.items()))
    print("cost: process time over that of the finest model, as the survey found it (docs/fidelity.md)")


def _row(option, asked):
    panel_elements = f"{option.elements:,}"
    expected = (_percent(option.expected[name]) if name in option.expected else "-" for name in asked)
    return option.model.name, option.setup.symmetry, panel_elements, f"{option.cost:.3f}", *expected


def _percent(share):
    return "not known" if share == float("inf") else f"{100 * share:.2g} %"


def _plain(name):
    return name.replace("_", " ")


def summary(choice):
    """For summary.json."""
    if choice is None:
        return {}
    final = choice.final
    return {
        "accuracy": {
            "asked": choice.asked,
            "model": final.option.model.name,
            "symmetry": final.option.setup.symmetry,
            "checked_by": final.against,
            "estimated": {name: None if error == float("inf") else error for name, error in final.errors.items()},
            "confirmed": choice.confirmed,
            "tried": [attempt.option.model.name for attempt in choice.attempts],
        }
    }


def tell(choice):
    """Print whether the promise holds."""
    final = choice.final
    found = ", ".join(f"{_plain(name)} {_percent(error)}" for name, error in final.errors.items())
    verdict = "confirmed" if choice.confirmed else "NOT confirmed: this is the finest model there is for it"
    print(f"accuracy {verdict}: {final.option.model.name}, {final.option.setup.symmetry} panel; estimated {found}")


def chapter(choice):
    """For the report."""
    final, asked = choice.final, choice.asked
    rows = tuple(
        (
            attempt.option.model.name,
            attempt.against or "-",
            *(_percent(attempt.errors[name]) for name in asked),
            "yes" if attempt.holds else "no",
        )
        for attempt in choice.attempts
    )
    options = tuple(_row(option, asked) for option in choice.options)
    names = tuple(_plain(name) for name in asked)
    verdict = "A coarser mesh confirms it" if choice.confirmed and final.against else "It is not confirmed"
    wanted = ", ".join(f"{_plain(name)} within {_percent(share)}" for name, share in asked.items())
    return Section(
        "accuracy",
        "The model that was chosen",
        f"The scene asks for {wanted}. {verdict}: {final.option.model.name}, {final.option.setup.symmetry} panel.",
        (),
        (
            Table(("model", "checked by", *names, "within"), rows, "Estimated errors of the answers"),
            Table(("model", "part", "elements", "cost", *names), options, "What could have been chosen", ("elements",)),
        ),
    )
