"""examples/demo.py, the script of `make demo`: its shots are those of a user, digit by digit; end to end: mesh, 3D
calibration, four impacts and report."""

import re
import runpy
import subprocess
import sys
from dataclasses import fields
from pathlib import Path

import pytest

import weavecell as wc
from fabrics.base.schema import read_toml
from fabrics.compression import CompressionLaw
from weavecell.results.result_folder import read_record
from weavecell.scenes import build
from weavecell.scenes import impact as scene_files

pytest.importorskip("gmsh")
pytest.importorskip("dolfinx")

ROOT = Path(__file__).parents[3]
SCRIPT = ROOT / "examples" / "demo.py"
CHAPTERS = [
    "motion",
    "impact",
    "summary",
    "v50",
    "mesh",
    "fit",
    "cell",
    "panel-mesh",
    "assumptions",
    "sources",
    "making",
    "words",
]


def test_its_shots_are_those_of_the_example(tmp_path):
    """But for the velocity, which README and the guide print at 155 m/s too."""
    demo = runpy.run_path(str(SCRIPT))
    used = wc.fabric("S-720")
    setups = {}
    for velocity in demo["TARGETS"]:
        text = (ROOT / "examples" / "S-720-stops.toml").read_text("utf-8")
        scene = tmp_path / "shot.toml"
        scene.write_text(
            text.replace('strike_velocity = "92.5 m/s"', f'strike_velocity = "{velocity}"')
        )
        setups[velocity] = wc.setup(used, velocity, law=used.laws[0], **demo["OPTIONS"])
        asked = scene_files.check(read_toml(scene, what="input")[1], scene)
        theirs = build.setup(build.build(asked, scene, "shot"), scene)
        mine = setups[velocity]
        unlike = [
            field.name
            for field in fields(mine)
            if repr(getattr(mine, field.name)) != repr(getattr(theirs, field.name))
        ]
        assert not unlike
    assert setups["92.5 m/s"] != setups["155 m/s"]


@pytest.mark.slow(40)
def test_demonstration(tmp_path):
    words = [sys.executable, SCRIPT, tmp_path / "demo", "coarse"]
    done = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, timeout=3000)
    assert done.returncode == 0, done.stderr
    assert done.stdout.endswith(f"report: {tmp_path / 'demo' / 'report.html'}\n")
    for velocity, outcome in (("92.5", "stopped"), ("155", "perforated")):
        for law in ("fitted", "published"):
            record = read_record(tmp_path / "demo" / f"{velocity}-{law}" / "histories.h5")
            assert record.outcome == outcome
            assert record.energy_error_max < 0.01
            left = f"residual velocity {record.residual_velocity:.4g} m/s"
            assert f"{velocity} m/s, {law} law: {outcome}, {left} (thesis Figure" in done.stdout
    record = read_record(tmp_path / "demo" / "155-published" / "histories.h5")
    left = f"{record.residual_velocity:.4g} m/s"
    mine = wc.impact("S-720", "155 m/s", end_time="600 us", length_effect=False)
    assert f"{mine.residual_velocity:.4g} m/s" == left
    told = f"with the published law a shot at 155 m/s leaves the ply at {left}"
    assert told in (ROOT / "README.md").read_text("utf-8")
    # lines for a reader, no repr
    assert "(a=" not in done.stdout
    assert "Result(" not in done.stdout
    law = CompressionLaw.from_json(tmp_path / "demo" / "calibration" / "law.json")
    text = (tmp_path / "demo" / "report.html").read_text("utf-8")
    assert f"a = {1e3 * law.a:.4f} mm" in text
    assert "The 3D crossover: coarse mesh, a +" in text
    assert "All are met." in text
    assert re.findall(r'<[^>]* id="([^"]*)"', text) == CHAPTERS
