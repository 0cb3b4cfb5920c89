"""The demonstration end to end: mesh, 3D calibration, four impacts, summary and report; and its parts used again."""

import json
import tomllib
from html.parser import HTMLParser
from importlib import resources

import pytest

from fabrics.compression import CompressionLaw
from weavecell.results.impact import ImpactRecord
from weavecell.scenes import build
from weavecell.scenes import impact as scenes_impact

pytest.importorskip("gmsh")
pytest.importorskip("dolfinx")

IMPACTS = {
    "stops-fitted": "stopped",
    "stops-table": "stopped",
    "perforates-fitted": "perforated",
    "perforates-table": "perforated",
}
CHAPTERS = ["impact", "summary", "mesh", "fit", "cell", "panel-mesh", "assumptions", "sources", "making"]


def test_plan_holds_a_good_scene():
    plan = tomllib.loads((resources.files("weavecell") / "scenes" / "demo.toml").read_text("utf-8"))
    asked = scenes_impact.check(plan["scene"], "demo.toml")
    assert build.build(asked, "demo.toml", "demo").fabric.name == plan["calibration"]["fabric"]


class _Page(HTMLParser):
    def __init__(self):
        super().__init__()
        self.ids, self.links = [], []

    def handle_starttag(self, tag, attributes):
        found = dict(attributes)
        self.ids += [found["id"]] if "id" in found else []
        self.links += [found[name] for name in ("src", "href") if name in found]


@pytest.mark.slow(40)
def test_demonstration(command, tmp_path):
    code, out, _ = command("demo", "--mesh", "coarse", "--out", "demo")
    folder = tmp_path / "demo"
    assert code == 0
    rows = {row["quantity"]: row for row in json.loads((folder / "summary.json").read_text())["rows"]}
    assert all(row["met"] == "yes" for quantity, row in rows.items() if " law (" in quantity)
    assert sum(" law (" in quantity for quantity in rows) == 4
    for name, outcome in IMPACTS.items():
        record = ImpactRecord.read(folder / name / "histories.h5")
        assert record.outcome == outcome
        assert record.energy_error_max < 0.01
    law = CompressionLaw.from_json(folder / "calibration" / "law.json")
    assert f"a = {1e3 * law.a:.4f} mm" in out
    assert out.count("stopped") == out.count("perforated") == 2
    assert out.splitlines()[-1] == "report: demo/report.html"
    assert "wall time" not in out
    page = _Page()
    page.feed((folder / "report.html").read_text("utf-8"))
    assert page.ids == CHAPTERS
    assert all(link.startswith(("data:image/", "#")) for link in page.links)

    # an impact of the demonstration can be repeated from its scene alone
    assert command("impact", folder / "stops-fitted" / "scene.toml", "--out", "again")[0] == 0
    again = ImpactRecord.read(tmp_path / "again" / "histories.h5")
    first = ImpactRecord.read(folder / "stops-fitted" / "histories.h5")
    assert again.velocity.tobytes() == first.velocity.tobytes()
