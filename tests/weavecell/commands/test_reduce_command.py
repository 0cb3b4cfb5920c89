"""`weavecell reduce`: files and lines of both, keys that a fabric file takes, and a computed shot beside a record."""

import re
import tomllib
from pathlib import Path

import h5py
import numpy as np
import pytest

from fabrics import catalogue
from fabrics.plate_curve import PlateCurve
from tests.weavecell.written import table_of

AREA = 0.019**2


def write_compression(path, K, start, rig=0.0):
    load = np.geomspace(start, 7000, 60)
    left = np.cbrt(K * AREA / load)
    closed = left[0] - left + rig * load
    rows = "\n".join(f"{F:.9g}, {1e3 * d:.9g}" for F, d in zip(load, closed))
    path.write_text("force [N], displacement [mm]\n" + rows)


def test_compression_gives_keys_and_a_platen_curve(succeed, tmp_path):
    """Of S-728, whose file then loads with them; the rig closes 10 nm a newton."""
    write_compression(tmp_path / "one.csv", 1.14e-7, 10, 1e-8)
    write_compression(tmp_path / "four.csv", 4.5e-6, 12, 1e-8)
    load = np.geomspace(5, 8000, 50)
    rows = "\n".join(f"{F:.9g}, {1e-5 * F:.9g}" for F in load)
    (tmp_path / "rig.csv").write_text("force [N], displacement [mm]\n" + rows)
    out = succeed(
        "reduce compression one.csv --pack 4=four.csv --rig rig.csv --platen-area '361 mm^2' --cell-of S-728 --out r"
    )
    assert "1 ply       n 3.00" in out
    found = table_of(tmp_path / "r", "compression.json")
    weave = catalogue.load("S-728").weave
    b = np.cbrt(1.14e-7 * weave.cell_area)
    assert found["b_of_a_ply_m_N^(1/3)"] == pytest.approx(b, rel=1e-3)
    curve = PlateCurve.read(tmp_path / "r" / "platen-curve.csv")
    assert curve.pressure[[0, -1]] * AREA == pytest.approx([10, 7000], rel=1e-4)
    text = (Path(catalogue.__file__).with_name("S-728.toml")).read_text()
    keys = (tmp_path / "r" / "fabric-keys.toml").read_text()
    gap, law = keys.split("[compression]")
    text = re.sub(r"\ninterlayer_gap.*", "\n" + gap.splitlines()[1], text)
    text = text[: text.index("[compression]")] + "[compression]" + law
    (tmp_path / "own.toml").write_text(text)
    own = catalogue.load(tmp_path / "own.toml")
    assert own.interlayer_gap == pytest.approx(found["gap_of_4_plies_m"], rel=1e-3)
    assert own.laws[0].b == pytest.approx(b / 2, rel=1e-3)


def test_a_flight_is_reduced_and_drawn_beside_a_computed_one(succeed, command, tmp_path):
    t = np.arange(0, 200e-6, 1e-6)
    z = 100 * t - 1e5 * t**2
    rows = "\n".join(f"{1e6 * a:.6g}, {1e3 * b:.9g}" for a, b in zip(t, z))
    (tmp_path / "flight.csv").write_text("time [us], displacement [mm]\n" + rows)
    (tmp_path / "shot").mkdir()
    with h5py.File(tmp_path / "shot" / "histories.h5", "w") as file:
        for name, values in (
            ("time", t),
            ("velocity", 100 - 2e5 * t),
            ("contact_force", 0 * t + 600),
        ):
            file[f"histories/{name}"] = values
    line = "reduce shot flight.csv --mass '3 g' --bandwidth '20 kHz'"
    out = succeed(f"{line} --computed shot --out r")
    assert "first velocity   100 " in out
    found = table_of(tmp_path / "r", "shot.json")
    assert found["last_velocity_m_s"] == pytest.approx(100 - 2e5 * t[-1], abs=1e-3)
    assert found["greatest_force_N"] == pytest.approx(600, rel=1e-3)
    assert found["bandwidth_Hz"] == pytest.approx(20e3)
    table = (tmp_path / "r" / "motion.csv").read_text().splitlines()
    assert len(table) == len(t) + 1
    for wrong, said in (
        ("--computed none", "--computed = 'none': must be a folder of weavecell impact"),
        ("--mass '3 mm'", "mass"),
    ):
        code, _, err = command(f"{line} {wrong} --out again")
        assert code == 2
        assert said in err
    assert not (tmp_path / "again").exists()


def test_pull_outs_give_the_friction_of_an_input_file(succeed, command, tmp_path):
    """The folder, the answer in eight lines, and the key as an input file reads it; a table with one length
    says which pairs it leaves."""
    rows = "".join(f"{n}; {k}; {p}\n" for n, p in ((10, 130), (20, 655)) for k in (1, 2))
    rows = rows.replace("130", "131,5", 1).replace("655", "641,25", 1)
    (tmp_path / "peaks.csv").write_text("Crossings;Specimen;Max load (gf)\n" + rows)
    out = succeed("reduce pull-out S-728 peaks.csv --tension '2 N' --out r")
    lines = out.splitlines()
    assert lines[1].startswith("answer      friction between yarns 0.196 ± ")
    assert "4 tests with 10 and 20 crossings" in lines[2]
    assert len(lines) <= 8
    found = table_of(tmp_path / "r", "pull-out.json")
    low, high = found["crossover_friction_interval"]
    assert low < 0.2 < high
    keys = tomllib.loads((tmp_path / "r" / "friction-keys.toml").read_text())
    assert keys["panel"]["crossover_friction"] == pytest.approx(
        found["crossover_friction"], rel=1e-3
    )
    written = (tmp_path / "r" / "friction-keys.toml").read_text()
    shot = '[projectile]\nname = "FSP 1.10 g"\nstrike_velocity = "90 m/s"\n'
    (tmp_path / "scene.toml").write_text(
        f'[fabric]\nname = "S-728"\n{shot}{written}opening = "30 mm"\n'
    )
    assert "friction" in succeed("impact scene.toml --check")
    (tmp_path / "one.csv").write_text("crossings, peak load [N]\n20, 6.4\n20, 6.9\n")
    out = succeed("reduce pull-out S-728 one.csv --tension '2 N' --out one")
    assert "is not told by one length: mu 0.1 with c0 " in out
    assert "[panel]" not in (tmp_path / "one" / "friction-keys.toml").read_text()
    (tmp_path / "zero.csv").write_text(
        "displacement [mm], force [N]\n" + "".join(f"{0.06 * k:.2f}, 0\n" for k in range(40))
    )
    code, _, err = command("reduce pull-out S-728 zero.csv --crossings 34 --out zero")
    assert code == 2
    assert "peak load of test 1 = '0 N': must be above 0" in err
    assert not (tmp_path / "zero").exists()
