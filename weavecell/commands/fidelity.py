"""A scene that says what it wants to know, and how well: the model chosen for it, in words, tables and files."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from fabrics.errors import InputError, UnstableError
from weavecell.report.page import Section, Table
from weavecell.scenes import build
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
            raise InputError(key="uncertainty", allowed=allowed)
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
        choice = select.answer(setup, targets, fixed=by_hand(scene), fire=fire, on_progress=build.LOG.info)
    except UnstableError:
        if last is None:
            raise
        choice = None
    return last, choice


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


def words(choice: Answer) -> str:
    """Whether the promise holds, and what the target quantities are, a line each."""
    final = choice.final
    errors = ", ".join(f"{_plain(name)} {_percent(error)}" for name, error in final.errors.items())
    model = f"{final.option.model.name}, {final.option.setup.symmetry} panel"
    lines = [f"accuracy {_verdict(choice)}: {model}; errors {errors}"]
    if "peak_tension" in choice.targets and choice.regime == "held" and final.partner:
        warp, weft = final.values["peak_tension"]
        lines.append(f"peak tension from this mesh and that of {final.partner}: warp {warp:.4g} N, weft {weft:.4g} N")
    for name, share in choice.targets.items():
        if choice.own[name] > share:
            known = _percent(choice.own[name])
            lines.append(f"{_plain(name)}: the full model itself is only known to about {known}")
    return "\n".join(lines)


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
