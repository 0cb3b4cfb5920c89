"""The files that every run leaves in its folder, whatever it was of: the scene, the record and the summary."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from fabrics import files
from weavecell.results import json_file


def write(out: Path, scene_text: str, record: Any, more: Mapping[str, Any], stamp: Mapping[str, str]) -> None:
    """Write scene.toml, histories.h5 and summary.json.

    Parameters
    ----------
    out : folder
    scene_text : the scene as it was written
    record : with write(path) and summary(), such as `results.impact.ImpactRecord`
    more : further entries of the summary
    stamp : of `results.provenance`
    """
    files.write(out / "scene.toml", scene_text)
    record.write(out / "histories.h5")
    json_file.write_summary(out / "summary.json", record.summary() | dict(more) | {"provenance": stamp})
