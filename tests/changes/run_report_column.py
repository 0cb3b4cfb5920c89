"""The column stands in summary.json with the value of the history that it is made from."""

import json
import tempfile
from pathlib import Path

import weavecell as wc

folder = Path(tempfile.mkdtemp()) / "shot"
shot = wc.impact("S-720", "90 m/s", opening="60 mm", end_time="30 us", out=folder)
summary = json.loads((folder / "summary.json").read_text("utf-8"))
assert summary["foremost_nose_position_m"] == max(shot.nose_position) > 0
