"""Each option of a command that fires no series of shots is refused by its own name, with what is allowed, or makes
another plan or result."""

import inspect
from pathlib import Path

import numpy as np
import pytest

import weavecell as wc
from fabrics.base.errors import InputError
from tests.weavecell.api.test_types_of_arguments import FUNCTIONS, LEAST, PEAKS, SHOTS, SMALL, call
from weavecell.api.crossover import CaseKeywords
from weavecell.api.meshes import Geometry

STUDIES = {"critical_velocity", "v50", "compare", "sweep", "impact", "plies"}
# how a command is run, not what; and its input, which other tests change
NOT_WALKED = {
    "check",
    "out",
    "resume",
    "jobs",
    "executor",
    "fabric",
    "target",
    "tests",
    "path",
    "record",
}
SHARED = {"CaseKeywords": CaseKeywords, "Geometry": Geometry}
# a value that is no default, of each option
OTHER = {
    "assumed_range": False,
    "bars": 7,
    "bending": "1e-6 N m^2",
    "biaxial": "none.csv",
    "centreline": "straight",
    "compare_3d": "coarse",
    "constants": "a, b, stiffening",
    "crimp": "3 %",
    "crossings": 8,
    "d1": "0 mm .. 0.02 mm",
    "d2": "0 mm .. 0.02 mm",
    "domain": "periodic",
    "duration": "30 us",
    "end_displacement": "0.03 mm",
    "end_shells": "0.1 mm",
    "failure": True,
    "fibre_fraction": "mesh",
    "fit_solid": True,
    "fitted": ["a"],
    "format": "vtu",
    "friction": 0.17,
    "law": "none.toml",
    "mesh": "3,2,2",
    "more": ["20=peaks.csv"],
    "overlap": "refuse",
    "patch": "3x2",
    "platen_curve": "none.csv",
    "plies": 3,
    "points": 11,
    "pressure": "3 MPa",
    "pull": "0.02 mm",
    "pulled": "weft",
    "ratio": ["3:2"],
    "reduced_integration": True,
    "section": "ellipse",
    "shear_angle": "0.3 rad",
    "struck": "crossover",
    "table": wc.draw("S-720", 1, velocity="130 m/s", **SMALL),
    "tension": "3 N",
    "test": "uniaxial",
    "tip_thickness_ratio": 0.3,
    "tolerance": "3 m/s",
    "velocity": "90 m/s",
    "width": "1.1 mm",
    "yarn": "weft",
    "yarn_curve": ["none.csv"],
    "yarn_gap": "0.02 mm",
}
WRONG = ["nonsense", -1, 0.3, 1e9]
# where an error names another thing than the option: a file that is none; keys that go with a test
BY_FILE = {"platen_curve", "biaxial", "law", "yarn_curve"}
BY_TEST = {("coupon", "test")}


def options_of(name):
    """The options of a function, those that it shares with others too."""
    found = []
    for option, one in inspect.signature(FUNCTIONS[name]).parameters.items():
        if one.kind is not one.VAR_KEYWORD:
            found.append(option)
        for shared, keywords in SHARED.items():
            if shared in str(one.annotation):
                found += keywords.__annotations__
    return [option for option in found if option not in NOT_WALKED]


def plan_of(name, changed):
    """What a plan holds, as a text."""
    return repr(vars(call(name, changed)))


@pytest.mark.filterwarnings("ignore::UserWarning")
@pytest.mark.parametrize("name", sorted(LEAST.keys() - STUDIES))
def test_an_option_is_refused_by_its_name_or_makes_another_plan(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("tests.csv").write_text(SHOTS)
    Path("peaks.csv").write_text(PEAKS)
    usual = plan_of(name, {})
    # what is compared has no address of an object
    assert plan_of(name, {}) == usual
    silent = []
    for option in options_of(name):
        for value in (OTHER[option], *WRONG):
            try:
                if plan_of(name, {option: value}) == usual:
                    silent.append((option, value))
            except InputError as problem:
                by_another = option in BY_FILE or (name, option) in BY_TEST
                if option not in str(problem) and not by_another:
                    silent.append((option, value, str(problem)))
    assert silent == []


RECORDS = {
    "flight.csv": ("time [us], displacement [mm]", lambda k: (2 * k, 0.19 * k - 4e-4 * k**2)),
    "press.csv": ("force [N], displacement [mm]", lambda k: (9.0 * k**2, 0.11 * k / (k + 3))),
    "four.csv": ("force [N], displacement [mm]", lambda k: (9.0 * k**2, 0.43 * k / (k + 3))),
    "rig.csv": ("force [N], displacement [mm]", lambda k: (9.0 * k**2, 0.0004 * k)),
}
REDUCED = {
    "reduce_shot": ("flight.csv", {"mass": "3 g"}, {"mass": "5 g", "bandwidth": "20 kHz"}),
    "reduce_compression": (
        "press.csv",
        {"platen_area": "361 mm^2"},
        {"platen_area": "700 mm^2", "rig": "rig.csv", "cell_of": "S-728", "pack": ["4=four.csv"]},
    ),
}


@pytest.mark.parametrize("name", REDUCED)
def test_an_option_of_a_reduction_is_refused_or_makes_another_result(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for path, (heading, row) in RECORDS.items():
        rows = "".join("{:.8g},{:.8g}\n".format(*row(k)) for k in range(1, 41))
        Path(path).write_text(f"{heading}\n{rows}")
    record, least, options = REDUCED[name]

    def reduced(changed):
        found = FUNCTIONS[name](record, **least | changed)
        return repr(found.summary()) + found.to_dataframe().to_csv()

    usual = reduced({})
    for option, value in options.items():
        assert reduced({option: value}) != usual, option
        for wrong in ("nonsense", -1):
            with pytest.raises(InputError):
                reduced({option: wrong})


@pytest.mark.slow(6)
def test_each_option_of_a_deck_makes_another_deck(tmp_path):
    shot = wc.setup("S-720", "140 m/s", opening="14 mm", end_time="10 us", elements_per_crossover=1)
    decks = {}
    for options in ({}, {"units": "g-mm-ms"}, {"match": "uniaxial"}, {"to": "radioss"}):
        folder = tmp_path / str(len(decks))
        wc.export(shot, **{"to": "lsdyna", "out": folder} | options)
        texts = [path.read_bytes() for path in sorted(folder.glob("*.[kr]*"))]
        decks[str(options)] = b"".join(texts)
    assert len(set(decks.values())) == len(decks)
    for option in ("to", "units", "match"):
        with pytest.raises(InputError, match=f"{option} = 'nonsense': must be"):
            wc.export(shot, **{"to": "lsdyna", "out": tmp_path / "x", option: "nonsense"})
    assert not (tmp_path / "x").exists()
    assert np.all([len(deck) > 1000 for deck in decks.values()])
