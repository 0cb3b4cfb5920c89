"""The files that every run leaves in its folder, whatever it was of: the scene, the record and the summary."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fabrics import files
from fabrics.errors import WeavecellError
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
        title, outcome = self.content["title"], self.content["outcome"]
        return f"{title}: {outcome}; done before with the same input and code, in {self.folder}"


def finished(out: Path, key: str) -> Finished | None:
    """The results that a folder holds of the run with a `run_cache.key`, if it has ended and was not unstable."""
    file = out / "summary.json"
    content = json_file.read_summary(file) if file.exists() and not checkpoints(out) else {}
    return None if content.get("run_key") != key or content["outcome"] == "unstable" else Finished(out, content)


def checkpoints(out: Path) -> list[Path]:
    """The checkpoints in a folder: one, or one for each model that has been tried."""
    return sorted(out.glob("checkpoint*.h5"))


def write(out: Path, scene_text: str, record: Any, more: Mapping[str, Any], stamp: Mapping[str, str]) -> None:
    """Write scene.toml, histories.h5 and summary.json.

    Parameters
    ----------
    out : folder
    scene_text : the scene as it was written, "" where there is none
    record : with write(path) and summary(), such as `results.impact.ImpactRecord`
    more : further entries of the summary
    stamp : of `results.provenance`
    """
    if scene_text:
        files.write(out / "scene.toml", scene_text)
    record.write(out / "histories.h5")
    json_file.write_summary(out / "summary.json", record.summary() | dict(more) | {"provenance": stamp})
