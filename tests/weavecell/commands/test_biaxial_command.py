"""`weavecell biaxial`: the cell at a ratio of strains to the strength of a yarn, alone and beside the 3D crossover."""

from pathlib import Path

import numpy as np
import pytest

from fabrics import catalogue
from fabrics.base.errors import InputError
from fabrics.compression import CompressionLaw
from shellfabric.cell.model import CellModel
from tests.weavecell.written import table_of
from weavecell.studies.biaxial_path import to_strength


@pytest.mark.parametrize("ratio", [(1, 1), (2, 1), (1, 0), (0, 3)])
def test_a_path_ends_at_the_strength(ratio):
    model = CellModel(catalogue.load("S-731"), cell_formulation="variational")
    path = to_strength(model, ratio, 11)
    yarns = model.fabric.weave.yarns
    k = ("warp", "weft").index(path.failed)
    assert path.tension[-1, k] == pytest.approx(yarns[k].strength, rel=1e-6)
    assert path.tension[-1, 1 - k] <= yarns[1 - k].strength
    assert path.strain[:, 0] * ratio[1] == pytest.approx(path.strain[:, 1] * ratio[0], abs=1e-15)
    assert path.strain[0].max() == 0
    alone = model.solve(*(1 + path.strain[5]))
    assert path.response["F"][5] == pytest.approx(alone["F"])


@pytest.mark.parametrize("ratio", [(0, 0), (1, -1), (1, np.nan), (1,)])
def test_paths_that_lead_nowhere(ratio):
    with pytest.raises(InputError, match="ratio"):
        to_strength(CellModel(catalogue.load("S-720"), cell_formulation="variational"), ratio)


def test_the_law_of_a_calibration(succeed, tmp_path):
    mine = Path(__file__).parents[3] / "examples" / "fabrics" / "mine.toml"
    law = CompressionLaw(4e-5, 5e-5)
    law.to_json(tmp_path / "law.json")
    succeed(f"biaxial {mine} --ratio 1:1 --law law.json --out b")
    told = table_of(tmp_path / "b", "biaxial.json")
    expected = to_strength(CellModel(catalogue.read(mine), (law, law)), (1, 1))
    assert told["paths"]["1:1"]["strain"] == pytest.approx(expected.strain[-1].tolist(), rel=1e-9)


def test_beside_the_3d_crossover(succeed, tmp_path):
    pytest.importorskip("dolfinx")
    succeed("biaxial S-720 --ratio 1:1 --compare-3d coarse --out b")
    assert (tmp_path / "b" / "1-1.h5").exists()
    rms = table_of(tmp_path / "b", "biaxial.json")["paths"]["1:1"]["rms_from_3d"]
    # another model of the same crossover, with the law that the source fitted to its own: near, and not the same
    assert 0 < max(rms) < 0.1 * catalogue.load("S-720").weave.warp.strength
