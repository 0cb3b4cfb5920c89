"""`weavecell impact --uncertainty`: the discretisation uncertainty of a scene's results, in words, tables and files."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from fabrics.errors import InputError
from weavecell.report.page import Section, Table

if TYPE_CHECKING:
    from collections.abc import Callable

    from weavecell.analysis.discretisation import Discretisation
    from weavecell.scenes.impact import Scene


def refuse_accuracy(scene: Scene, path: Any) -> None:
    """InputError for a scene with [accuracy], whose model is chosen and checked by other meshes."""
    if scene.accuracy is not None:
        allowed = "left out for a scene with [accuracy], which chooses its meshes and compares them"
        raise InputError(file=path, key="--uncertainty", value="given", allowed=allowed)


def run_pair(setup: Any, shoot: Callable[..., Any]) -> tuple[tuple[Any, Any, Any], Discretisation]:
    """Run a scene on its mesh and on the finer one.

    Parameters
    ----------
    setup : ImpactSetup or PackSetup of the scene
    shoot : called as shoot(setup, table, name of the mesh), gives (record, snapshots, failure, result)

    Returns
    -------
    shot : (record, snapshots, failure) on the scene's mesh
    pair : Discretisation

    Raises
    ------
    InputError : as `discretisation.finer`; nothing has been run
    """
    from weavecell.analysis import discretisation
    from weavecell.analysis.fidelity.ladder import ply_of

    table = ply_of(setup).table(kept=True)
    refined = discretisation.finer(setup, table)
    *shot, result = shoot(setup, table)
    if shot[2] is not None:
        return tuple(shot), discretisation.compare(result, result)
    *_, other = shoot(refined, table, "finer mesh")
    return tuple(shot), discretisation.compare(result, other)


def summary(pair: Discretisation | None) -> dict[str, Any]:
    """For summary.json."""
    if pair is None:
        return {}
    results = {
        one.name: {"unit": one.unit, "value": one.value, "finer": one.finer, "uncertainty": one.uncertainty}
        for one in pair.intervals
    }
    meshes, outcomes = list(pair.meshes), list(pair.outcomes)
    return {"discretisation": {"meshes": meshes, "outcomes": outcomes, "results": results}}


def tell(pair: Discretisation) -> None:
    """Print the uncertainties."""
    print(f"discretisation uncertainty, from {pair.meshes[0]} and {pair.meshes[1]}:")
    if not pair.same_outcome:
        print(f"  the outcome depends on the mesh: {pair.outcomes[0]}, and {pair.outcomes[1]} on the finer one")
    for one in pair.intervals:
        print(f"  {one.name} {one.value:.4g} +- {one.uncertainty:.2g} {one.unit} ({one.finer:.4g} on the finer mesh)")


def chapter(pair: Discretisation) -> Section:
    """For the report."""
    rows = tuple(
        (f"{one.name} [{one.unit}]", f"{one.value:.4g}", f"{one.finer:.4g}", f"{one.uncertainty:.2g}")
        for one in pair.intervals
    )
    lead = (
        "Uncertainty of the results on the scene's mesh by the grid convergence index of ASME V&V 20, from two meshes "
        "with an assumed order of 2 and a safety factor of 3."
    )
    if not pair.same_outcome:
        lead = f"The outcome depends on the mesh: {pair.outcomes[0]} on the scene's, {pair.outcomes[1]} on the finer."
    columns = ("result", pair.meshes[0], pair.meshes[1], "uncertainty")
    tables = (Table(columns, rows, numeric=columns[1:]),) if rows else ()
    return Section("discretisation", "Discretisation uncertainty", lead, (), tables)
