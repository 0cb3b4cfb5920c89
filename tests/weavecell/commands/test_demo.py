"""examples/demo.py, the script of `make demo`, end to end: mesh, 3D calibration, four impacts and report."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from fabrics.compression import CompressionLaw
from weavecell.results.impact import ImpactRecord

pytest.importorskip("gmsh")
pytest.importorskip("dolfinx")

SCRIPT = Path(__file__).parents[3] / "examples" / "demo.py"
CHAPTERS = [
    "motion",
    "impact",
    "summary",
    "mesh",
    "fit",
    "cell",
    "panel-mesh",
    "assumptions",
    "sources",
    "making",
    "words",
]


@pytest.mark.slow(40)
def test_demonstration(tmp_path):
    words = [sys.executable, SCRIPT, tmp_path / "demo", "coarse"]
    done = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, timeout=3000)
    assert done.returncode == 0, done.stderr
    assert done.stdout.endswith(f"report: {tmp_path / 'demo' / 'report.html'}\n")
    for velocity, outcome in (("92.5", "stopped"), ("155", "perforated")):
        for law in ("fitted", "published"):
            record = ImpactRecord.read(tmp_path / "demo" / f"{velocity}-{law}" / "histories.h5")
            assert record.outcome == outcome
            assert record.energy_error_max < 0.01
            left = f"residual velocity {record.residual_velocity:.4g} m/s"
            assert f"{velocity} m/s, {law} law: {outcome}, {left} (thesis Figure" in done.stdout
    # lines for a reader, no repr
    assert "(a=" not in done.stdout
    assert "Result(" not in done.stdout
    law = CompressionLaw.from_json(tmp_path / "demo" / "calibration" / "law.json")
    text = (tmp_path / "demo" / "report.html").read_text("utf-8")
    assert f"a = {1e3 * law.a:.4f} mm" in text
    assert "All are met." in text
    assert re.findall(r'<[^>]* id="([^"]*)"', text) == CHAPTERS
