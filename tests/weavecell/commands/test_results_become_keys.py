"""What a command writes as keys of a fabric file is read by the reader of these keys, or refused with the name of the
curve: nothing that no input file could name is written."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import weavecell as wc
from fabrics import catalogue
from fabrics.base.errors import InputError
from fabrics.compression import CompressionLaw
from shellfabric.shot_keys import FASTEST
from weavecell.runs import laboratory_tests
from weavecell.scenes import result_keys

AREA = 0.019**2
S728 = Path(catalogue.__file__).with_name("S-728.toml").read_text()


def write_record(path, K, start, most=7000.0, slope=0.0, sign=1.0):
    """A compression record [N, mm] of the pressure law, with a share that is linear in the force."""
    load = np.geomspace(start, most, 40)
    left = np.cbrt(K * AREA / load)
    closed = sign * (left[0] - left) + slope * load
    rows = "\n".join(f"{F:.9g}, {1e3 * d:.9g}" for F, d in zip(load, closed))
    path.write_text("force [N], displacement [mm]\n" + rows)


def fabric_with(keys, path):
    """S-728 with the keys that a command wrote in place of its own."""
    gap, _, law = keys.partition("[compression]")
    text = S728
    for line in gap.splitlines():
        if line.startswith("interlayer_gap"):
            text = re.sub(r"\ninterlayer_gap.*", "\n" + line, text)
    if law:
        text = text[: text.index("[compression]")] + "[compression]" + law
    path.write_text(text)
    return catalogue.load(path)


def reduced(out=None):
    """(What the records of one and of four plies give, why they are refused)."""
    pack = ["4=four.csv"]
    try:
        return wc.reduce_compression(
            "one.csv", platen_area=AREA, pack=pack, cell_of="S-728", out=out
        ), None
    except InputError as problem:
        return None, problem


# what is wrong with the records of one ply and of four, of which S-728 has K'' 1.14e-7 and 4.5e-6 Pa m3
WRONG = {
    "exchanged": ((4.5e-6, 12), (1.14e-7, 10)),
    "one twice": ((1.14e-7, 10), (1.14e-7, 10)),
    "a pack as one ply": ((4.5e-4, 10), (9e-3, 12)),
    "millimetres as centimetres": ((1.14e-4, 10), (4.5e-3, 12)),
    "a pack of one": ((1.14e-7, 10), (1.2e-7, 10)),
    "a ply of steel": ((1.14e-7, 10), (1.15e-7, 12)),
    "thick": ((1.14e-5, 10), (4.5e-4, 12)),
    "pulled": ((1.14e-7, 10, 7000, 0, -1.0), (4.5e-6, 12)),
    "newtons as kilonewtons": ((1.14e-1, 10), (4.5, 12)),
    "another platen": ((1.14e-6, 10), (4.5e-8, 12)),
}


@pytest.mark.parametrize("case", ["right", *WRONG])
def test_records_give_keys_that_are_read_or_are_refused_by_name(case, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    one, four = WRONG.get(case, ((1.14e-7, 10), (4.5e-6, 12)))
    write_record(Path("one.csv"), *one)
    write_record(Path("four.csv"), *four)
    found, problem = reduced(out="r")
    assert case != "right" or not problem
    if problem:
        assert problem.file in ("one.csv", "four.csv")
        assert not Path("r", "fabric-keys.toml").exists()
        return
    own = fabric_with(Path("r/fabric-keys.toml").read_text(), tmp_path / "own.toml")
    assert own.interlayer_gap == pytest.approx(next(iter(found.gaps.values())).value, rel=1e-3)
    assert own.laws[0].a == pytest.approx(0.5 * found.cell["a"].value, rel=1e-3)


def test_records_of_any_law_give_keys_that_are_read_or_are_refused(tmp_path, monkeypatch):
    """Random pairs of records; some are taken, some refused."""
    monkeypatch.chdir(tmp_path)
    rng = np.random.default_rng(7)
    taken = 0
    for _ in range(24):
        K = 10 ** rng.uniform(-8.5, -5.5)
        pack = K * 10 ** rng.uniform(0, 3)
        slope = rng.choice([0.0, 1e-9])
        write_record(Path("one.csv"), K, rng.uniform(5, 20), slope=slope)
        write_record(Path("four.csv"), pack, rng.uniform(5, 20), slope=slope)
        found, problem = reduced()
        if problem:
            assert problem.file in ("one.csv", "four.csv")
            continue
        fabric_with(found.fabric_keys(), tmp_path / "own.toml")
        taken += 1
    assert 5 < taken < 24


# time [us] and displacement [mm] of what is no flight through a fabric
FLIGHTS = {
    "at rest": lambda t: 0 * t + 3.0,
    "backwards": lambda t: -0.15 * t + 1e-4 * t**2,
    "faster and faster": lambda t: 0.05 * t + 4e-4 * t**2,
    "from rest": lambda t: 3e-4 * t**2,
    "no number twice": lambda t: -0.002 * t,
}


@pytest.mark.parametrize("case", FLIGHTS)
def test_a_record_that_is_no_flight_is_refused(case, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    t = np.arange(0, 200, 4.0)
    rows = "\n".join(f"{a}, {b:.6g}" for a, b in zip(t, FLIGHTS[case](t)))
    Path("f.csv").write_text("time [us], displacement [mm]\n" + rows)
    with pytest.raises(InputError, match=r"f\.csv") as caught:
        wc.reduce_shot("f.csv", mass="3 g", bandwidth="20 kHz", out="r")
    assert len(str(caught.value).splitlines()) == 1
    assert not Path("r").exists()


def reduce_tests(velocity, through):
    table = {"velocity": velocity, "outcome": np.where(through, "perforated", "stopped")}
    table["residual velocity"] = np.where(through, np.nan, 0.0)
    return laboratory_tests.reduce(pd.DataFrame(table))


def test_v50_of_tests_is_a_velocity_that_a_key_takes_or_has_a_reason():
    """Of random lists, of which one has slow perforations and puts it at 1,281 m/s."""
    rng = np.random.default_rng(3)
    reasons = []
    for _ in range(10):
        velocity = np.sort(rng.uniform(5, 995, 8))
        found = reduce_tests(velocity, rng.random(8) < 0.3)
        assert bool(found.reason) == np.isnan(found.v50)
        assert found.reason or 0 < found.v50 <= FASTEST
        reasons.append(found.reason)
    [told] = filter(None, reasons)
    assert told.startswith("these tests put it at 12")
    assert told.endswith("1000 m/s at most, as projectile.strike_velocity")


def test_a_fitted_law_that_no_shot_could_have_is_refused():
    fabric = catalogue.load("S-728")
    thickness = fabric.weave.thickness

    def check(a, b):
        law = CompressionLaw(a, b)
        result_keys.check_fabric(replace(fabric, laws=(law, law)), fabric, "tests.csv")

    check(0.2 * thickness, 6e-5)
    for a, b in ((0.6 * thickness, 6e-5), (0.2 * thickness, 6.0), (1e-9, 6e-5)):
        with pytest.raises(InputError, match=r"^tests\.csv: "):
            check(a, b)
