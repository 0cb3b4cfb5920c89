"""What a folder holds of a run: the results of a finished one, checkpoints of one that was
interrupted."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fabrics.base.errors import WeavecellError
from weavecell.results import json_file


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
        title = self.content["title"]
        outcome = self.content["outcome"]
        return f"{title}: {outcome}; done before with the same input and code, in {self.folder}"


def find_finished(out: Path, key: str) -> Finished | None:
    """The results that a folder holds of the run with a `run_cache.key`, if it has ended and was
    not unstable."""
    file = out / "summary.json"
    content = {}
    if file.exists() and not checkpoints(out):
        content = json_file.read_summary(file)
    if content.get("run_key") != key or content["outcome"] == "unstable":
        return None
    return Finished(out, content)


def checkpoints(out: Path) -> list[Path]:
    """The checkpoints in a folder: one, or one for each model that has been tried."""
    return sorted(out.glob("checkpoint*.h5"))
