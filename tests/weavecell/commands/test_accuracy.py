"""An input file that says how well it wants to know something: what is told, kept and resumed."""

import re

import numpy as np
import pytest
from test_impact import datasets, small_scene

import weavecell as wc
from tests.weavecell.written import table_of
from weavecell.studies.window import FACTORS


@pytest.fixture
def scene(tmp_path):
    path = tmp_path / "scene.toml"
    text = small_scene('["report"]', '\n[accuracy]\nuncertainty = "5 %"\n')
    perforates = text.replace("[projectile]", "[projectile]\nfriction = 0")
    path.write_text(perforates.replace('"50 mm"', '"30 mm"'))
    return path


@pytest.mark.slow(16)
def test_the_target_is_kept_against_a_mesh_that_is_finer_everywhere_and_resumed(
    command, succeed, scene, interrupted, drawn_once, tmp_path
):
    out = succeed(f"impact {scene} --out results -v")
    with interrupted(0.45):
        assert command(f"impact {scene} --out resumed")[0] == 130
    assert [path.suffix for path in (tmp_path / "resumed").glob("[!.]*")] == [".h5"]
    succeed(f"impact {scene} --out resumed --resume")
    assert datasets(tmp_path / "results/histories.h5") == datasets(
        tmp_path / "resumed/histories.h5"
    )
    told = table_of(tmp_path / "results")
    accuracy = told["accuracy"]
    residual = told["discretisation"]["results"]["residual velocity"]
    assert accuracy["confirmed"] is True
    assert f"accuracy confirmed: {told['discretisation']['meshes'][-1]}; residual" in out
    assert "Meshes that were run" in (tmp_path / "results/report.html").read_text()
    assert not list((tmp_path / "results").glob("checkpoint*"))
    strike = told["strike_velocity_m_s"]
    shots = []
    plain = (
        scene.read_text()
        .split("[accuracy]")[0]
        .replace("end_time", "elements_per_crossover = 8\nend_time")
    )
    for factor in FACTORS:
        scene.write_text(
            re.sub("strike_velocity = .*", f'strike_velocity = "{factor * strike} m/s"', plain)
        )
        shots.append(wc.impact(scene).residual_velocity)
    velocity = np.polyfit(np.array(FACTORS) - 1, shots, 1)[1]
    assert 0.5 < velocity / strike < 0.95  # it has been slowed
    assert told["window"]["mean"]["residual_velocity_m_s"] == residual["value"]
    assert abs(residual["value"] - velocity) <= residual["uncertainty"] <= 0.05 * strike
