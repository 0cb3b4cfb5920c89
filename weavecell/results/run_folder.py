"""What a folder holds of a run: the results of a finished one, checkpoints of one that was
interrupted."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fabrics.base.errors import WeavecellError
from weavecell.results import finding, json_file
from weavecell.results.file_list import FileList


class Interrupted(WeavecellError):
    """The user stopped a run that can be gone on with."""

    exit_code = 130


@dataclass(frozen=True)
class Finished:
    """Results that a folder holds of the very run that is asked for.

    Parameters
    ----------
    folder : of the results
    content : of its summary.json
    """

    folder: Path
    content: dict[str, Any]

    @property
    def doubtful(self) -> bool:
        """Whether a quality check is beyond its limit."""
        return self.content["checks"]["status"] == "doubtful"

    def __str__(self) -> str:
        doubts = filter(None, self.content.get("doubts", "").split("; "))
        said = say_done(self.content["title"], self.content["outcome"], self.folder)
        return finding.mark(said, doubts)


def say_done(title: str, outcome: str, folder: Path) -> str:
    """Say that a run is not repeated, since its folder has the results."""
    return f"{title}: {outcome}; done before with the same input and code, in {folder}"


def find_finished(out: Path, names: Iterable[str], key: str) -> Finished | None:
    """Return the results that a folder holds of the run with a `run_cache.key`; None if it has not
    ended, was unstable, or if a file is missing or not what was written.

    Parameters
    ----------
    names : of the files of the run, with wildcards
    """
    listed = FileList.read(out)
    if listed.whole != key or listed.damaged(out, names):
        return None
    content = json_file.read_summary(out / "summary.json")
    if content["outcome"] == "unstable":
        return None
    return Finished(out, content)


def checkpoints(out: Path) -> list[Path]:
    """List the checkpoints in a folder: one, or one for each model that has been tried."""
    return sorted(out.glob("checkpoint*.h5"))
