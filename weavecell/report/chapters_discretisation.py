"""The discretisation uncertainty of a scene's results (`--uncertainty`): words, summary, section."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from fabrics.base.counted import counted
from fabrics.base.tables import WORDS, read_table
from weavecell.report.page import Section, Table
from weavecell.results.named_value import NamedValue

if TYPE_CHECKING:
    from weavecell.studies.mesh_uncertainty import Discretisation

_INDEX = (
    "Uncertainty of the results on the mesh of the input file by the grid convergence index of ASME V&V 20, from two "
    "meshes with an assumed order of 2 and a safety factor of 3, of the largest difference of their histories{}."
)
AGAINST_TESTS = Path(__file__).with_name(
    "against_tests.csv"
)  # written by `python -m validation measured`
COLUMNS = "level", "quantity", "words", "n", "within 90 %", "bias", "sigma_model", "sigma_test"
_MEANS = "; for means their difference, to which their standard errors are added"


def summary(pair: Discretisation | None) -> dict[str, Any]:
    """Return the entries for summary.json."""
    if pair is None:
        return {}
    window = pair.windows[0]
    results: dict[str, dict[str, Any]] = {}
    for interval in pair.intervals:
        results[interval.name] = {
            "unit": interval.unit,
            "value": interval.value,
            "finer": interval.other,
            "uncertainty": interval.uncertainty,
        }
        if window is not None:
            of_value, of_other = interval.standard_errors
            results[interval.name] |= {
                "standard_error": of_value,
                "finer_standard_error": of_other,
            }
    entries: dict[str, Any] = {}
    if window is not None:
        entries["window"] = window.summary()
    entries["discretisation"] = {
        "meshes": list(pair.meshes),
        "outcomes": list(pair.outcomes),
        "results": results,
    }
    return entries


def in_answer(pair: Discretisation) -> str:
    """Write what two meshes say of the one number that an answer has: the velocity that is left, or the
    deflection of what stopped."""
    if not pair.same_outcome:
        return _outcomes(pair)[0]
    wanted = "residual velocity" if pair.outcomes[-1] == "perforated" else "peak deflection"
    mean = "mean " if pair.windows[0] is not None else ""
    for result, _ in _list_results(pair):
        if result.name == wanted:
            return f"mesh error: {mean}{result.name} {result.text()}"
    return "mesh error: no mean, as outcomes are mixed"


def words(pair: Discretisation) -> str:
    """Write means over the window and uncertainties, one line a result, and whether the target is
    met."""
    lines = []
    window = pair.windows[0]
    mean = ""
    if window is not None:
        mean = "mean "
        lines.append(f"mean and standard error, {_describe_window(window)}:")
        for average, value in _list_means(window):
            at_strike = f"{value.cell()} at {window.strike_velocity:g} m/s"
            lines.append(f"  {average.name} {average.text()} ({at_strike})")
    lines.append(f"discretisation uncertainty, from {' and '.join(pair.meshes)}:")
    lines += [f"  {line}" for line in _outcomes(pair)]
    for result, other in _list_results(pair):
        on_other = f"{other.cell()} on the finer mesh; no test"
        lines.append(f"  {mean}{result.name} {result.text()} ({on_other})")
    return "\n".join([*lines, *_compare_with_tests(pair)])


def _describe_window(window):
    """Velocities and outcomes of a window."""
    low, *_, high = (shot["strike_velocity_m_s"] for shot in window.shots)
    mixed = ": MIXED outcomes" if len(window.outcomes) > 1 else ""
    jump = f"; {window.jump.words}" if window.jump else ""
    return f"{counted(len(window.shots), 'shot')} at {low:.4g} to {high:.4g} m/s, {_counts(window)}{mixed}{jump}"


def _counts(window):
    return ", ".join(f"{count} {outcome}" for outcome, count in window.outcomes.items())


def _list_means(window):
    """List (mean with its standard error, value at the one velocity) of each quantity; of none over a
    jump."""
    from weavecell.studies.window import QUANTITIES

    if window.jump is not None:
        return []
    shot = next(
        shot for shot in window.shots if shot["strike_velocity_m_s"] == window.strike_velocity
    )
    listed = []
    for quantity, (key, words, unit) in QUANTITIES.items():
        mean, error = window.mean(quantity)
        average = NamedValue(words, mean, unit, error=error, margin=".2g")
        listed.append((average, NamedValue(words, shot[key], unit)))
    return listed


def _list_results(pair):
    """List (result with its uncertainty, the same on the other mesh)."""
    listed = []
    for one in pair.intervals:
        result = NamedValue(one.name, one.value, one.unit, error=one.uncertainty, margin=".2g")
        listed.append((result, NamedValue(one.name, one.other, one.unit)))
    return listed


def _outcomes(pair):
    """A line if the outcome, or the outcomes of the window, depend on the mesh."""
    if not pair.same_outcome:
        first, last = pair.outcomes
        return [f"the outcome depends on the mesh: {first}, and {last} on the finer one"]
    counts = [window and _counts(window) for window in (pair.windows[0], pair.windows[-1])]
    if counts[0] == counts[1]:
        return []
    words = "{}, and {} on the finer one".format(*counts)
    return [f"outcomes in the window depend on the mesh: {words}"]


def _compare_with_tests(pair):
    """A line of each quantity of such a shot that was compared with tests."""
    levels = {"ply" if pair.setup.plies == 1 else "pack", "backing" if pair.setup.backing else ""}
    return [
        f"against tests, {row['quantity']}: {row['words']}"
        for row in read_scored()
        if row["level"] in levels
    ]


def read_scored() -> list[dict[str, str]]:
    """Read the rows that were scored against tests, each {column: text}."""
    columns = dict.fromkeys(COLUMNS, WORDS)
    table = read_table(AGAINST_TESTS, columns, what="comparisons with tests", example="level")
    return [row for _, row in table.rows()]


def section(pair: Discretisation) -> Section:
    """Build the section of the report."""
    from pandas import DataFrame

    window = pair.windows[0]
    tables = []
    sentences = []
    for line in (*_outcomes(pair), *_compare_with_tests(pair)):
        sentences.append(f"{line[0].upper()}{line[1:]}.")
    if pair.intervals:
        heads = ["result", *pair.meshes, "uncertainty"]
        of_means = ""
        if window is not None:
            of_means = _MEANS
        sentences.append(_INDEX.format(of_means))
        rows = []
        for result, other in _list_results(pair):
            value, uncertainty = result.numbers()
            value_on_other, _ = other.numbers()
            rows.append((result.heading, value, value_on_other, uncertainty))
        tables.append(Table.from_frame(DataFrame(rows, columns=heads)))
    lead = " ".join(sentences)
    if window is not None:
        heads = ["result", "mean and standard error", f"at {window.strike_velocity:g} m/s"]
        means = [
            (average.name, average.text(), value.cell()) for average, value in _list_means(window)
        ]
        caption = f"Means: {_describe_window(window)}"
        tables.append(Table.from_frame(DataFrame(means, columns=heads), caption))
    return Section("discretisation", "Discretisation uncertainty", lead, (), tuple(tables))
