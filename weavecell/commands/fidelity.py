"""A scene that says what it wants to know, and how well: the model chosen for it, in words, tables and files."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fabrics.errors import InputError, UnstableError
from weavecell.report.page import Section, Table
from weavecell.scenes import build, of_commands
from weavecell.scenes import impact as scenes_impact
from weavecell.scenes.impact import Scene

if TYPE_CHECKING:
    from shellfabric.impact.simulation import ImpactSetup
    from weavecell.analysis.fidelity.select import Answer

# keys of a scene that a model of the ladder would change; what is given there stays
_BY_HAND = {
    ("panel", "symmetry"): "symmetry",
    ("run", "elements_per_crossover"): "elements_per_crossover",
    ("fabric", "cell_model"): "cell_model",
    ("projectile", "body"): "projectile",
}


def by_hand(scene: Scene) -> frozenset[str]:
    """Names of the fields of ImpactSetup that the scene sets itself."""
    return frozenset(field for (table, key), field in _BY_HAND.items() if key in getattr(scene, table).model_fields_set)


def run(scene: Scene, setup: Any, shoot: Callable[..., Any], uncertainty: bool) -> tuple[Any, Any, Any]:
    """Run a scene as it is, with a model that is chosen by its [accuracy], or on a pair of meshes.

    Parameters
    ----------
    scene, setup, shoot : as of `answer`
    uncertainty : whether the scene is run on a finer mesh too

    Returns
    -------
    shot : (ImpactRecord, snapshots, failure) of the run that counts
    choice : as of `answer`; None without [accuracy]
    pair : `discretisation.Discretisation` of both meshes; None without `uncertainty`

    Raises
    ------
    InputError : the discretisation uncertainty of a scene with [accuracy], or of a mesh that cannot be refined
    """
    if uncertainty:
        from weavecell.analysis import discretisation

        if scene.accuracy is not None:
            allowed = "left out for a scene with [accuracy], which chooses its meshes and compares them"
            raise InputError(key="--uncertainty", value="given", allowed=allowed)
        shot, pair = discretisation.run_pair(setup, shoot)
        return shot, None, pair
    if scene.accuracy is None:
        return shoot(setup)[:3], None, None
    return (*answer(scene, setup, shoot), None)


def answer(scene: Scene, setup: ImpactSetup, shoot: Callable[..., Any]) -> tuple[Any, Answer | None]:
    """Choose, run and check.

    Parameters
    ----------
    scene : Scene with a table [accuracy]
    setup : ImpactSetup as the scene has it
    shoot : called as shoot(setup, table, name of the model) for a run with all its records; gives
        (ImpactRecord, snapshots, failure, ImpactResult)

    Returns
    -------
    shot : (ImpactRecord, snapshots, failure) of the run that counts
    choice : select.Answer, or None where that run became unstable
    """
    from weavecell.analysis.fidelity import select

    last = None

    def fire(option, table):
        nonlocal last
        audited = setup.audit_interval  # its histories are drawn
        this = replace(option.setup, audit_interval=audited)
        *last, result = shoot(this, table, option.model.name)
        if last[2] is not None:
            raise last[2]
        return result

    try:
        targets = scene.accuracy.targets  # type: ignore[union-attr]
        choice = select.answer(setup, targets, fixed=by_hand(scene), fire=fire, on_progress=print)
    except UnstableError:
        if last is None:
            raise
        choice = None
    return last, choice


def explain(path: Path) -> None:
    """Print what the scene at `path` could be answered with, what each is expected to be off by, and what is chosen.

    Raises
    ------
    InputError : the scene or what it names is wrong, or it has no accuracy targets
    """
    import rich
    from rich import box, table

    from weavecell.analysis.fidelity import error_database, select

    scene, _ = scenes_impact.load(path, of_commands.EXPLAIN)
    if scene.accuracy is None:
        raise InputError("is missing, so there is nothing to choose", file=path, key="accuracy")
    this = build.build(scene, path, path.stem)
    setup = build.setup(this, path)
    options = select.options(setup, scene.accuracy.targets, fixed=by_hand(scene))
    chosen = select.pick(options)
    targets = scene.accuracy.targets if setup.plies == 1 else {}  # errors of a pack are not known before its runs
    title = f"Models, the cheapest first{'; likely errors' if targets else ''}"
    shown = table.Table(box=box.SIMPLE_HEAD, title=title, title_justify="left")
    for column in ("", "model", "part", "elements", "cost", *targets):
        shown.add_column(column.replace("_", " "))
    for option in options:
        shown.add_row("->" if option is chosen else "", *_row(option, targets))
    wanted = ", ".join(f"{_plain(name)} {_percent(share)}" for name, share in scene.accuracy.targets.items())
    if setup.plies > 1:
        rich.print(shown)
        print(f"targets: {wanted}")
        print("errors of a pack are the differences of both meshes, which are known when both have been run")
        return
    known_errors = error_database.load()
    for name, known in known_errors.others.items():
        errors = (_percent(known["expected"][quantity]) for quantity in scene.accuracy.targets)
        shown.add_row("", name, "-", "-", f"{known['cost']:.3f}", *errors)
    rich.print(shown)
    print(f"targets: {wanted}")
    print("cost: process time over that of the full model, as the survey found it (docs/reports/fidelity.md)")
    print(
        "errors: four scenes in five of the survey stay below. A run looks at its own scene first, by two scouts, and"
    )
    print("may choose a cheaper or a dearer model; the cable net is there to compare with, and never chosen")
    known = ", ".join(f"{_plain(name)} {_percent(known_errors.own(name))}" for name in scene.accuracy.targets)
    print(f"the full model itself is only known to about: {known}")
    print(f"projectile: {_projectile(scene)}")


def _projectile(scene):
    if "body" in scene.projectile.model_fields_set:
        return f"{scene.projectile.body}, as the scene says"
    if scene.projectile.shape != "flat":
        return "rigid; only a flat cylinder of steel could be elastic"
    return "rigid if a scout's contact lasts long enough against its period, and an elastic bar if not"


def _row(option, targets):
    panel_elements = f"{option.elements:,}"
    expected = (_percent(option.expected[name]) if name in option.expected else "-" for name in targets)
    return option.model.name, option.setup.symmetry, panel_elements, f"{option.cost:.3f}", *expected


def _percent(share):
    return "not known" if share == float("inf") else f"{100 * share:.2g} %"


def _plain(name):
    return name.replace("_", " ")


def summary(choice: Answer | None) -> dict[str, Any]:
    """For summary.json."""
    if choice is None:
        return {}
    final = choice.final
    return {
        "accuracy": {
            "targets": choice.targets,
            "model": final.option.model.name,
            "symmetry": final.option.setup.symmetry,
            "compared_with": final.against,
            "values": {name: _number(final.values[name]) for name in choice.targets},
            "estimated_errors": {
                name: None if error == float("inf") else error for name, error in final.errors.items()
            },
            "reference_error": choice.own,
            "projectile": choice.body,
            "confirmed": choice.confirmed,
            "models_run": [attempt.option.model.name for attempt in choice.attempts],
        }
    }


def tell(choice: Answer) -> None:
    """Print whether the promise holds, and what the target quantities are."""
    final = choice.final
    found = ", ".join(f"{_plain(name)} {_percent(error)}" for name, error in final.errors.items())
    model = f"{final.option.model.name}, {final.option.setup.symmetry} panel"
    print(f"accuracy {_verdict(choice)}: {model}; errors {found}")
    if "peak_tension" in choice.targets and choice.regime == "held" and final.partner:
        warp, weft = final.values["peak_tension"]
        print(f"peak tension from this mesh and that of {final.partner}: warp {warp:.4g} N, weft {weft:.4g} N")
    for name, share in choice.targets.items():
        if choice.own[name] > share:
            print(f"{_plain(name)}: the full model itself is only known to about {_percent(choice.own[name])}")


def _verdict(choice):
    if not choice.confirmed:
        return "NOT confirmed: no model is known to do better"
    return "confirmed" if choice.final.against else "by definition: the full model, which all others are held against"


def _number(value):
    """For summary.json: shares, metres, newtons; None of what is not there."""
    if isinstance(value, tuple):
        return [_number(part) for part in value]
    return None if value != value else value


def chapter(choice: Answer) -> Section:
    """For the report."""
    final, targets = choice.final, choice.targets
    rows = tuple(
        (
            attempt.option.model.name,
            attempt.against or "-",
            *(_percent(attempt.errors[name]) for name in targets),
            "yes" if attempt.holds else "no",
        )
        for attempt in choice.attempts
    )
    options = tuple(_row(option, targets) for option in choice.options)
    names = tuple(_plain(name) for name in targets)
    wanted = ", ".join(f"{_plain(name)} within {_percent(share)}" for name, share in targets.items())
    return Section(
        "accuracy",
        "The model that was chosen",
        f"The targets of the scene are {wanted}. Accuracy {_verdict(choice)}; {final.option.model.name}, "
        f"{final.option.setup.symmetry} panel; {choice.body}.",
        (),
        (
            Table(("model", "held against", *names, "within"), rows, "Errors that the answers stay below"),
            Table(("model", "part", "elements", "cost", *names), options, "What could have been chosen", ("elements",)),
        ),
    )
