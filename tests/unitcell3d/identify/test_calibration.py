"""Calibration of S-720 on a small mesh; on the least of meshes, how it is interrupted, goes on and reports."""

import itertools
import json
from concurrent.futures import Executor, Future
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from fabrics import assumed, catalogue
from fabrics.base.errors import InputError, UnstableError
from fabrics.base.record import Record
from fabrics.compression import CompressionLaw
from meshing.mesh_plan import Plan, with_room
from shellfabric.cell.model import CellModel
from shellfabric.membrane import quality
from unitcell3d.cases.biaxial_and_platens import first_reached
from unitcell3d.identify.calibrate import (
    BEYOND,
    BOTH,
    PATHS,
    calibrate,
    calibrate_all,
    path_jobs,
    run_job,
)
from unitcell3d.identify.calibration import ONE_LAW
from unitcell3d.identify.law_range import _ends_of_solid, _packed_later


@pytest.fixture(scope="module")
def found(calibrated):
    return calibrated.found


# stored: a and b of the law, the end of its range, a of warp and weft, travel of the contact
LAWS = (45.067e-6, 56.340e-6, 119.38, 32.664e-6, 50.547e-6, 162.71e-6)
COARSE = (44.731e-6, 57.137e-6, 120.5, 32.261e-6, 50.022e-6, 162.67e-6)


def assert_laws(found, stored):
    """Hold the laws to stored ones; the tolerance admits another compiler's rounding, not another answer."""
    warp, weft = found.yarn_laws
    law = found.law
    numbers = (law.a, law.b, law.F_range[1], warp.a, weft.a, found.contact.travel)
    assert numbers == pytest.approx(stored, rel=5e-3)
    # the looser yarn, Vf0 0.62, gives more
    assert warp.a < weft.a
    assert law.residual_rms < 1.1e-6
    assert found.ratio_law.residual_rms < 0.75e-6


def test_the_laws_stay(found):
    """The published law (a 0.045 mm, b 0.058 mm N^(1/3)) stands in the ledger."""
    assert_laws(found, LAWS)


def test_the_fitted_range_holds_the_forces_of_shots(found, s720):
    """Both yarns of the panel's cell at their strength press less on each other than those of the last path."""
    strain = found.histories[BOTH]["fibre_strain_mean"][-1] / [
        yarn.failure_strain for yarn in s720.weave.yarns
    ]
    assert strain == pytest.approx(BEYOND, rel=0.01)
    table = CellModel(s720, (found.law, found.law)).table(101)
    checks = {
        one.name: one
        for one in quality.of_cell(table, [yarn.strength for yarn in s720.weave.yarns])
    }
    assert checks["contact force over fitted range"].value < 1


@pytest.mark.parametrize(
    "name",
    [
        pytest.param("uhmwpe-1760", marks=pytest.mark.slow),
        "e-glass-300",
        pytest.param("aramid-3300", marks=pytest.mark.slow),
    ],
)
def test_a_fabric_of_a_family_is_pressed_to_one_and_a_half_times_its_limit(name):
    """Their shots press harder than 1.2 times the failure strain does, which is 1.16 to 1.19 times the force."""
    file = Path(__file__).parents[2] / "weavecell" / "own_fabrics" / f"{name}.toml"
    fabric = with_room(assumed.with_solid_laws(assumed.with_shear(catalogue.load(file))))
    history, _ = run_job(path_jobs(fabric, (2, 2, 2))[-1])
    limits = [yarn.failure_strain for yarn in fabric.weave.yarns]
    strain = np.max(history["fibre_strain_mean"] / limits, axis=1)
    assert not history.failed
    assert history["F_c"][-1] == pytest.approx(
        1.5 * np.interp(1.0, strain, history["F_c"]), rel=0.01
    )


def test_each_path_has_its_own_law_near_the_joint_one(found):
    """The yarns' own compressions and what closes between their lenses (about 10 um) make up 2 d_c."""
    assert set(found.path_laws) == set(found.ratio_residuals) == {*PATHS, BOTH}
    for name, law in found.path_laws.items():
        assert law.a == pytest.approx(found.law.a, rel=0.15), name
        assert found.residuals[name] < 2e-6
        assert found.ratio_residuals[name] < 1.5e-6
        history = found.histories[name]
        between = 2 * history["d_c"] - history["d_yarns"].sum(axis=1)
        assert -1e-6 < between.min() <= between.max() < 12e-6, name
    for key in ("a", "b"):
        of_paths = [getattr(law, key) for law in found.path_laws.values()]
        assert found.spread[key] == (min(of_paths), max(of_paths))


def test_one_law_is_chosen_unless_it_leaves_too_much(found):
    for leaves, chosen in ((0.9 * ONE_LAW, "one law"), (1.1 * ONE_LAW, "law of the tension ratio")):
        assert replace(found, law=replace(found.law, residual_rms=leaves)).chosen == chosen
    assert (
        replace(found, ratio_law=None, law=replace(found.law, residual_rms=1e-5)).chosen
        == "one law"
    )


def test_plates_give_another_curve(found):
    """Section 4.3.4.2: platen and biaxial calibration differ; at the same compression plates need less force."""
    force = first_reached(found.plates["F_c"], found.plates["d_c"], 30e-6)
    assert force < 0.11 * float(found.law.F(30e-6))


def test_files_hold_it_all(calibrated):
    found = calibrated.found
    folder = calibrated.folder
    assert calibrated.progress == dict.fromkeys([*PATHS, BOTH, "plates"], 1.0)
    assert CompressionLaw.from_json(folder / "law.json") == found.law
    assert [found.law.fabric, *(law.fabric for law in found.yarn_laws)] == [found.fabric] * 3
    summary = json.loads((folder / "calibration.json").read_text())
    assert summary["law"]["a_m"] == found.law.a
    assert summary["failure"]["warp only"][0]["criterion"] == "worst bar"
    assert summary["ended_early"] == {}
    assert_array_equal(
        Record.read(folder / "warp-only.h5")["F_c"], found.histories["warp only"]["F_c"]
    )


# one that misses, one of another fibre, one between; the others run nightly
EACH_DAY = ("S-745", "glass-unbalanced", "S-731")


def calibrated_alone():
    """Fabrics but S-720, which `found` has, as cases."""
    for name in catalogue.list_names():
        marks = [pytest.mark.slow(20)]
        if name not in EACH_DAY:
            marks.append(pytest.mark.nightly)
        if name != "S-720":
            yield pytest.param(name, marks=marks)


@pytest.mark.parametrize("name", calibrated_alone())
def test_every_fabric_calibrates_unattended(name):
    """All paths to fibre failure; one law leaves at most 1.6 um, one that sees the tension ratio at most 1 um.

    Of glass, whose yarns are softer across by the biaxial test and close by 76 and 153 um, they leave at most 6 and
    3 % of the closure.
    """
    found = calibrate(catalogue.load(name), size=(8, 6, 2), plates_size="coarse")
    assert not any(history.failed for history in found.histories.values())
    for path in PATHS:  # conforming sections leave nothing to close but the penetration
        history = found.histories[path]
        assert (2 * history["d_c"] - history["d_yarns"].sum(axis=1)).max() < 5e-6, path
    if name == "S-745" and found.law.residual_rms >= 1.6e-6:
        pytest.xfail(
            "missed with the stated fibre fraction: one law leaves 2.49 um on this fabric, one that "
            "sees the tension ratio 1.09 um"
        )
    closure = max(history["d_c"].max() for history in found.histories.values())
    assert found.ratio_law.residual_rms < max(1e-6, 0.03 * closure)
    assert found.law.residual_rms < max(1.6e-6, 0.06 * closure)


@pytest.mark.slow(16)
def test_processes_beside_each_other_change_nothing(s720):
    """And the laws of the coarse mesh stay."""
    beside, alone = (calibrate(s720, size="coarse", jobs=jobs) for jobs in (2, 1))
    assert beside.law.a == pytest.approx(alone.law.a, rel=1e-9)
    assert_laws(alone, COARSE)


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


SMALL = {
    "size": (2, 2, 2),
    "plates_size": (2, 2, 2),
    "paths": {"warp only": (1, 0), "equibiaxial": (1, 1)},
}


@pytest.fixture(scope="module")
def small(s720, tmp_path_factory):
    """(Calibration, folder) on the least of meshes."""
    folder = tmp_path_factory.mktemp("small")
    return calibrate(s720, executor=Here(), out=folder, **SMALL), folder


def numbers(found):
    """All numbers of the histories but the times, as bytes."""
    return {
        (name, key): np.asarray(values).tobytes()
        for name, history in found.histories.items()
        for key, values in (*history.columns.items(), *history.last.items())
        if key != "seconds"
    }


def test_an_interrupted_calibration_goes_on_to_the_same_bits(small, s720, tmp_path):
    done = []

    def interrupt(fabric, path, share):
        done.append(path)
        if len(done) == 2:
            raise KeyboardInterrupt

    def go_on(**changes):
        """(Calibration, names of the paths that were solved)"""
        executor = Here()
        return calibrate(
            s720, executor=executor, out=tmp_path, resume=True, **SMALL | changes
        ), executor.names

    with pytest.raises(KeyboardInterrupt):
        calibrate(s720, executor=Here(), out=tmp_path, on_progress=interrupt, **SMALL)
    kept = {path.stem.replace("-", " ") for path in tmp_path.iterdir()}
    assert kept == set(done)
    found, solved = go_on()
    assert set(solved) == {*SMALL["paths"], "plates"} - kept
    assert numbers(found) == numbers(small[0])
    assert (tmp_path / "law.json").read_bytes() == (small[1] / "law.json").read_bytes()
    again, solved = go_on()
    assert again.law == found.law
    assert solved == []
    _, solved = go_on(size=(3, 2, 2))  # asked for in another way, nothing of it is taken
    assert solved == [*SMALL["paths"]]


def test_friction_reaches_the_law_and_is_reported(small, s720, tmp_path):
    """Yarns that stick to each other press harder on each other; what a law was made with stands beside it."""
    without = small[0]
    with_it = calibrate(s720, executor=Here(), out=tmp_path, friction=0.3, **SMALL)
    for name in SMALL["paths"]:
        assert (
            1.01 < with_it.histories[name]["F_c"][-1] / without.histories[name]["F_c"][-1] < 1.15
        ), name
    assert with_it.law.provenance.endswith("friction 0.3")
    assert "friction" not in without.law.provenance
    assert json.loads((tmp_path / "calibration.json").read_text())["friction"] == 0.3


def test_one_fabric_that_fails_does_not_end_the_others(small, s720):
    wide = replace(catalogue.load("S-731"), section="sine", solid_laws=None)
    executor = Here()
    folders = {"S-720": small[1]}
    found = calibrate_all([wide, s720], executor=executor, folder=folders.get, resume=True, **SMALL)
    assert isinstance(found["S-731"], InputError)
    assert found["S-720"].law == small[0].law
    assert executor.names == []


def test_the_ends_of_an_assumed_solid_are_packed_later_than_the_mesh(tmp_path):
    """The densest mesh has a fibre volume fraction of 0.907, the stiff end of UHMWPE is packed at 0.9."""
    file = Path(__file__).parents[2] / "weavecell" / "own_fabrics" / "uhmwpe-1760.toml"
    thin = tmp_path / "thin.toml"
    thin.write_text(file.read_text().replace("0.55 mm", "0.51 mm"))
    fabric = with_room(assumed.with_solid_laws(catalogue.load(thin)))
    dense = Plan.of(fabric, size="coarse", shift=True).section_fit.Vf0
    assert max(dense) > 0.9
    for end in itertools.chain.from_iterable(_ends_of_solid(fabric).values()):
        laws = _packed_later(end, "coarse").solid_laws
        assert all(law.V_c > Vf0 for law, Vf0 in zip(laws, dense))
