"""The column stands in summary.json with the value of the history that it is made from."""

import json
import tempfile
from pathlib import Path

import weavecell as wc

folder = Path(tempfile.mkdtemp())
scene = folder / "scene.toml"
scene.write_text(
    """fabric.name = "S-720"
projectile = { name = "FSP 1.10 g", strike_velocity = "90 m/s" }
panel.opening = "40 mm"
run = { end_time = "30 us", outputs = [] }
"""
)
shot = wc.impact(scene, out=folder / "shot")
summary = json.loads((folder / "shot" / "summary.json").read_text("utf-8"))
assert summary["foremost_nose_position_m"] == max(shot.nose_position) > 0
