"""A fabric file made from a data sheet as its maker prints it (`weavecell.scenes.printed_sheet`).

Each line of the sheet stands in the file as a comment, with the keys that it is used for or why it is not.
What the sheet lacks is assumed by the fibre family; a value that contradicts the others is left out. Four
lines say what was read, what was assumed, what is missing, and where the file is.
"""

from __future__ import annotations

from collections.abc import Collection
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

from fabrics import assumed
from fabrics.base.checks import FilePath
from fabrics.base.counted import counted
from fabrics.base.door import option
from fabrics.base.errors import InputError
from fabrics.base.files import write
from weavecell.scenes import printed_sheet
from weavecell.scenes.fabric_file import INSTEAD, REQUIRED, TYPICAL, Draft, left_open
from weavecell.scenes.missing_values import BREAKING, complete
from weavecell.scenes.sheet_names import ALL


def read_draft(path: FilePath, name: str, family: str | None = None) -> tuple[Draft, str]:
    """Return the draft of a sheet, and a line about what was read.

    Parameters
    ----------
    name : of the fabric, which also says which of several is meant
    family : that the user names; None takes the one that the sheet says

    Raises
    ------
    InputError : no file, or nothing of it is understood
    """
    sheet = printed_sheet.read(path, (name,))
    family = family or sheet.family
    kept, contradictions = _without_contradictions(Draft(name, sheet.values, family=family))
    remarks = []
    unused = 0
    for line in sheet.lines:
        keys = [key for key in line.keys if key not in contradictions]
        why = line.why or "; ".join(
            contradictions[key] for key in line.keys if key in contradictions
        )
        text = " ".join(line.text.split())
        shown = text if len(text) <= 90 else f"{text[:87]}..."
        unused += not keys and why != printed_sheet.A_HEADING
        remarks.append(f"{', '.join(keys) or f'not used ({why})'}: {shown}")
    texts = [
        f"{key} {' / '.join(dict.fromkeys(filter(None, (value.warp, value.weft))))}"
        for key, value in kept.items()
    ]
    if family is not None:
        texts.append(f"family {family}")
    left = counted(unused, "line") if unused else "no line"
    summary = f"{Path(path).name}: {', '.join(texts)}; not used: {left}"
    if contradictions:
        summary += f"; left out, for they contradict the rest: {', '.join(contradictions)}"
    draft = Draft(name, _completed(kept, family), file=path, family=family)
    return replace(draft, remarks=(f"Of {Path(path).name}:", *remarks)), summary


def write_draft(draft: Draft, path: FilePath, fitted: Collection[str] = ()) -> list[str]:
    """Write the file of a draft, which may lack what makes a fabric; return lines about what is assumed,
    what is missing and where the file is."""
    stands_in = []
    for key, value in draft.values.items():
        if value.stands_in:
            low, high = value.ranges.get("warp", ("", ""))
            ends = f" ({low} .. {high})" if low else ""
            stands_in.append(f"{key} {value.warp}{ends}")
    missing = _missing(draft, fitted)
    try:
        fabric = draft.fabric()
        with suppress(InputError):  # of no fibre family, which `left_open` says
            fabric = assumed.with_solid_laws(assumed.with_shear(fabric))
        stands_in += [name for name in fabric.assumed if name != "failure_length"]
        open_lines = [line for line in left_open(fabric, path) if line.startswith("missing: ")]
        more = "; ".join(line.removeprefix("missing: ") for line in open_lines)
    except InputError as problem:
        first = getattr(problem, "problems", (problem,))[0]
        more = missing or str(first.changed(file=None, line=0))
    remarks = (*draft.remarks, *([f"missing: {missing}"] if missing else []))
    write(path, replace(draft, remarks=remarks).text())
    return [
        f"assumed: {', '.join(stands_in) or 'nothing'}",
        f"missing: {more}",
        f"written to {path}, with a comment on each line of the sheet",
    ]


def _completed(values, family):
    """Return the values with those that stand in; as they are where too little is known."""
    try:
        return complete(values, family)
    except InputError:
        return dict(values)


def _without_contradictions(draft):
    """Return (the values that a fabric takes, {key: why} of the others)."""
    kept = dict(draft.values)
    dropped: dict[str, str] = {}
    for _ in draft.values:
        try:
            replace(draft, values=_completed(kept, draft.family)).fabric()
            break
        except InputError as problem:
            for part in getattr(problem, "problems", (problem,)):
                key = (part.key or "").rpartition(".")[2]
                # the strength of a yarn may be made of that of a strip
                key = BREAKING if key == "strength" and key not in kept else key
                if key in kept:
                    del kept[key]
                    dropped[key] = str(part.changed(file=None, line=0))
                    break
            else:
                break
    return kept, dropped


def _missing(draft, fitted):
    """Say what a fabric needs and neither the sheet nor its family gives; "" if that is nothing."""
    lacks = [key for key in REQUIRED if not {key, *INSTEAD.get(key, ())} & {*draft.values, *fitted}]
    words = [
        f'{key}, such as "{ALL[key].example}"' for key in lacks if key not in (*TYPICAL, "crimp")
    ]
    if "crimp" in lacks:
        words.append('thickness, such as "0.30 mm", or areal_density or crimp')
    of_family = [key for key in lacks if key in TYPICAL]
    if of_family and draft.family is None:
        again = f"or run again with {option('family', 'NAME')}, which has typical ones"
        words.append(f"{', '.join(of_family)}, {again}")
    elif of_family:
        words.append(" and ".join(of_family))
    return "; ".join(words)
