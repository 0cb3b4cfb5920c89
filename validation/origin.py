"""The first line of a CSV in docs/reports/data: what made it.

    # python -m validation study edges, commit 0123456789ab, 2026-11-29 09:12 UTC, AMD EPYC, 2 cores; inputs
    0123456789ab; numpy 1.24.2, numba 0.60.0; 45.2 CPU s; golden rows 3, 12

What stands before the first semicolon is shown with tables and figures. `inputs` is a digest of all that decides which
numbers the file has, but for the code. The golden rows (`validation.golden`) are counted from the first row.
Of a file that is older than this rule, "unknown" stands where nobody knows. One that no command makes again has

    # history, not repeated: WHAT IT IS
"""

from __future__ import annotations

import os
import re
import subprocess
from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path

from fabrics.base import run_cache
from fabrics.base.errors import InputError
from validation import csv_file
from validation.study import Study
from weavecell.results import provenance

ROOT = Path(__file__).parents[1]
CODE = (*run_cache.LIBRARIES, "weavecell", "validation")  # folders whose state is the commit's
# in these folders, no code: what the programs of validation write themselves, and pages
WRITTEN = ("validation/moved.csv", "validation/reports", "weavecell/report/against_tests.csv")
UNKNOWN = "unknown"
HISTORY = "history, not repeated: "
WORDS = (
    "question",
    "picture",
    "expect",
    "golden",
    "quick",
    "columns",
)  # of a study, that change no number
DIGITS = 12  # of a digest or a commit
LINE = re.compile(
    r"(?P<command>python -m validation [^;]+?), commit (?P<commit>[^,;]+), (?P<date>[^,;]+), (?P<processor>[^;]+)"
    r"; inputs (?P<inputs>[^;]+); numpy (?P<numpy>[^,;]+), numba (?P<numba>[^,;]+)"
    r"; (?P<cpu_s>[^;]+) CPU s; golden rows (?P<golden>[^;]+)"
)


def write(words: str, inputs: str, cpu_s: str, golden_rows: Sequence[int] = ()) -> str:
    """Write the first line of a CSV.

    Parameters
    ----------
    words : arguments of `python -m validation`
    inputs : their digest
    cpu_s : [s] CPU time of all that was computed for it, as text
    golden_rows : their numbers in the file, from 1
    """
    versions = provenance.versions()
    stamp = (
        f"{datetime.now(UTC):%Y-%m-%d %H:%M UTC}, {provenance.processor()}, {os.cpu_count()} cores"
    )
    return "; ".join(
        (
            f"python -m validation {words}, commit {commit()}, {stamp}",
            f"inputs {inputs}",
            f"numpy {versions['numpy']}, numba {versions['numba']}",
            f"{cpu_s} CPU s",
            f"golden rows {', '.join(map(str, golden_rows)) or 'none'}",
        )
    )


def read(made: str) -> dict[str, str]:
    """Read a first line, without its mark: {part: text}; empty if it is none, or history."""
    found = LINE.fullmatch(made)
    if found is None:
        return {}
    return found.groupdict()


def digest(inputs: object) -> str:
    """Digest what decides the numbers of a file."""
    return run_cache.inputs_digest(inputs)[:DIGITS]


def inputs_of(chosen: Study) -> str:
    """Digest the file of a study, without what changes no number."""
    return digest({key: value for key, value in chosen.content.items() if key not in WORDS})


def digest_of_files(*files: Path) -> str:
    """Digest files, by their names and bytes."""
    return digest([(file.name, file.read_bytes()) for file in sorted(files)])


def spent() -> str:
    """Say how much CPU time [s] this process and those that it has waited for have taken; kept results took theirs
    before."""
    seconds = sum(os.times()[:4])
    return f"at least {seconds:.3g}"


def changes() -> list[str]:
    """List the files of the code that are not as they were committed, new ones too; none outside of a checkout.

    What is no code (WRITTEN) is none.
    """
    if not (ROOT / ".git").exists():
        return []
    written = [f":(exclude){name}" for name in WRITTEN]
    lines = _git("status", "--porcelain", "--", *CODE, *written).splitlines()
    return [line.split(maxsplit=1)[1] for line in lines]


def commit() -> str:
    """Return the commit of the code, "+ changes" if it is not as committed; "unknown" outside of a checkout."""
    if not (ROOT / ".git").exists():
        return UNKNOWN
    head = _git("rev-parse", f"--short={DIGITS}", "HEAD")
    if changes():
        head += " + changes"
    return head


def refuse_changes(folder: Path) -> None:
    """Refuse to write data of the documentation with code that no commit has.

    Raises
    ------
    InputError : files of the code are changed or new, and the folder is docs/reports/data
    """
    if folder.resolve() == csv_file.DATA.resolve() and changes():
        raise InputError(
            f"takes files of committed code alone, and {', '.join(changes())} is not as committed",
            file=csv_file.DATA,
            allowed="after a commit, or another folder by --out",
        )


def _git(*words):
    return subprocess.run(
        ["git", "-C", str(ROOT), *words], check=True, capture_output=True, text=True, timeout=20
    ).stdout.strip()
