"""Tables of survey and trial for the documentation."""

from __future__ import annotations

from fabrics.errors import InputError
from fabrics.files import write_whole
from validation.fidelity import quantities


def survey_table(models):
    """Lines of Markdown: each model's cost and expected errors."""
    names = quantities.NAMES
    lines = [
        "| model | cost | " + " | ".join(name.replace("_", " ") for name in names) + " |",
        "|---|---:|" + "---:|" * len(names),
    ]
    for model, found in sorted(models.items(), key=lambda item: item[1]["cost"]):
        errors = (f"{100 * found[name]['expected']:.2g} %" for name in names)
        lines.append(f"| {model} | {found['cost']:.3f} | " + " | ".join(errors) + " |")
    return lines


def trial_table(rows):
    """Lines of Markdown: each scene, what was asked, chosen and found."""
    lines = [
        "| scene | asked | outcome | model | confirmed | worst error | met | cost |",
        "|---|---:|---|---|---|---:|---|---:|",
    ]
    for row in rows:
        worst = max((error for error in row.found.values() if error == error), default=0.0)
        found = "other outcome" if worst == float("inf") else f"{100 * worst:.2g} %"
        lines.append(
            f"| {row.fabric}, {row.shape}, {row.velocity:.0f} m/s | {100 * row.asked:.0f} % | {row.outcome}"
            f" | {row.model} | {'yes' if row.confirmed else 'no'} | {found} | {'yes' if row.met else 'no'}"
            f" | {row.seconds / row.full_seconds:.3f} |"
        )
    return lines


def put(path, name, lines):
    """Put lines between a page's marks; nothing where no page is given.

    Raises
    ------
    InputError : a page without the marks
    """
    if path is None:
        return
    marks = f"<!-- {name} of validation.fidelity -->", "<!-- end of the table -->"
    text = path.read_text("utf-8")
    before, mark, rest = text.partition(marks[0])
    _, end, after = rest.partition(marks[1])
    if not mark or not end:
        raise InputError(f"has no place for a table between {marks[0]!r} and {marks[1]!r}", file=path)
    with write_whole(path) as file:
        file.write("\n".join([before + mark, *lines, end + after]))
