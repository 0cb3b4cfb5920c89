"""What a result says is read against the numbers beside it: options, counts, places and values of every summary."""

import json
import re

import h5py
import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

import weavecell as wc
from fabrics import catalogue
from fabrics.base.units import si
from tests.weavecell.session_runs import RUNS
from weavecell.decks import folder
from weavecell.decks.homogenised import MATCHES
from weavecell.report import chapters_discretisation, pictures_coupon, pictures_figure
from weavecell.studies.window import QUANTITIES, Window

AMOUNT = re.compile(r"(?<![\w.])(-?[0-9]+(?:\.[0-9]+)?) (m/s|mm|µm|MPa|kN|N|J|°|%)(?![\w/²³])")
UNITS = {"°": "deg", "µm": "um"}


def numbers_in(content):
    """All numbers of a table of JSON, of the tables of its texts too."""
    if isinstance(content, bool):
        return
    if isinstance(content, (int, float)):
        yield float(content)
    elif isinstance(content, dict):
        for part in content.values():
            yield from numbers_in(part)
    elif isinstance(content, list):
        for part in content:
            yield from numbers_in(part)


def numbers_of(out):
    """All numbers [SI] that the files of a folder hold, but those of its provenance; of histories ends and extremes."""
    found = []
    for path in out.glob("*.json"):
        content = json.loads(path.read_text())
        content.pop("provenance", None)
        found += numbers_in(content)
    for path in out.glob("*.csv"):
        table = np.genfromtxt(path, delimiter=",", skip_header=1, invalid_raise=False)
        found += np.ravel(table).tolist()
        # what is swept stands as it was given
        found += [si(f"{amount} {unit}", SI[unit]) for amount, unit in given(path.read_text())]
    for path in out.glob("*.h5"):
        with h5py.File(path) as file:
            names: list[str] = []
            file.visit(names.append)
            for part in (file[name] for name in names if hasattr(file[name], "dtype")):
                if part.dtype == float and part.size:
                    values = np.ravel(part[()])
                    found += [values[-1], values.min(), values.max()]
    return np.abs([number for number in found if np.isfinite(number)])


def given(text):
    """The amounts of a text, as (number, unit) of those units that SI has."""
    return [
        (amount, unit) for amount, unit in AMOUNT.findall(text) if unit in SI and unit not in UNITS
    ]


def said(text, numbers):
    """The amounts of a text that are none of some numbers, to the digits that are printed."""
    missing = []
    for amount, unit in AMOUNT.findall(text):
        factor = 0.01 if unit == "%" else si(f"1 {UNITS.get(unit, unit)}", SI[unit])
        digits = len(amount.partition(".")[2])
        off = np.abs(numbers / factor - abs(float(amount)))
        if not (off <= 0.51 * 10.0**-digits).any():
            missing.append(f"{amount} {unit}")
    return missing


SI = {"m/s": "m/s", "mm": "m", "µm": "m", "MPa": "Pa", "kN": "N", "N": "N", "J": "J", "°": "rad"}


@pytest.mark.parametrize("name", [name for name in RUNS if not RUNS[name].get("solid")])
def test_every_amount_of_an_answer_is_a_number_of_its_folder(results, name):
    out = results(name).folder
    content = json.loads((out / RUNS[name].get("summary", "summary.json")).read_text())
    text = content.get("answer", {"value": ""})["value"]
    if not AMOUNT.search(text):
        printed = results(name).out.splitlines()
        text = next(line for line in printed if AMOUNT.search(line) and "note: " not in line)
    assert AMOUNT.search(text)
    numbers = numbers_of(out)
    assert said(text, numbers) == [], text


def test_an_amount_that_is_none_of_the_numbers_is_found():
    numbers = np.array([141.27, 0.0187, 3.2e6])
    assert said("141.3 m/s, 18.7 mm, 3.2 MPa", numbers) == []
    assert said("141.4 m/s, 18.7 m/s, 19 mm", numbers) == ["141.4 m/s", "18.7 m/s"]


@pytest.mark.parametrize("match", MATCHES)
@pytest.mark.parametrize("to", folder.CODES)
def test_the_summary_of_a_deck_states_its_options_and_errors(tmp_path, to, match):
    shot = wc.setup("S-726", "100 m/s", opening="40 mm", elements_per_crossover=1)
    made = wc.export(shot, to, tmp_path, match=match)
    content = json.loads((tmp_path / "summary.json").read_text())
    assert (content["code"], content["match"], content["run_in_the_code"]) == (to, match, False)
    assert {row.pop("material"): row for row in content["error_over_strength"]} == made.errors
    (errors,) = made.errors.values()
    assert len(set(errors.values())) == len(errors)
    words = "rms {}, largest {} over the biaxial plane; {} in uniaxial tension, {} in shear until "
    stated = words.format(*(f"{100 * value:.1f} %" for value in errors.values()))
    deck = (tmp_path / folder.CODES[to].names("S-726")[0]).read_text()
    head = " ".join(line[1:].strip() for line in deck.splitlines() if line[:1] in "$#")
    assert stated in head
    assert "NOT RUN in it" in head
    page = (tmp_path / "report.html").read_text()
    assert f"errs by {100 * max(errors.values()):.1f} % of the strength at most" in page


def thickness_of(name):
    """[m] twice the heights of warp and weft: cosines whose length is that of the crimped yarn, by quadrature."""
    weave = catalogue.load(name).weave
    total = 0.0
    for yarn, count in zip(weave.yarns, (weave.weft_count, weave.warp_count)):
        cell = 1 / count  # the spacing of the family that crosses

        def excess(height):
            slope = lambda x: np.pi * height / cell * np.sin(np.pi * x / cell)  # noqa: B023, E731
            return quad(lambda x: np.hypot(1, slope(x)), 0, cell)[0] - cell * (1 + yarn.crimp)  # noqa: B023

        total += 2 * brentq(excess, 0, cell)
    return total


def test_plies_of_a_pack_are_as_thick_and_as_far_apart_as_the_result_says(results):
    """Three plies of two fabrics: their middle surfaces are half of both thicknesses and the gap apart."""
    shot = wc.load(results("pack").folder)
    thick = [thickness_of(name) for name in ("S-728", "S-726", "S-726")]
    assert shot.thickness == pytest.approx(thick, rel=1e-6)
    assert shot.gaps[1] == pytest.approx(5e-5)
    halves = 0.5 * np.add(thick[1:], thick[:-1])
    assert np.diff(shot.z_rest) == pytest.approx(halves + shot.gaps, rel=1e-6)


def test_a_deck_is_what_its_head_and_its_fabrics_say(tmp_path):
    """Nodes, sections, densities and masses of the written file: two unlike plies by heights, counts and crimps."""
    metre = kilogram = 1e3  # in mm and g
    plies = [{"name": "S-728"}, {"name": "S-726", "angle": "90 deg"}]
    options = {"opening": ("20 mm", "24 mm"), "ply_gap": "0.07 mm", "elements_per_crossover": 1}
    nose = {"shape": "sphere", "diameter": "5 mm", "mass": "0.6 g"}
    setup = wc.setup(None, "90 m/s", ply=plies, projectile=nose, **options)
    made = wc.export(setup, "lsdyna", tmp_path, units="g-mm-ms", match="uniaxial")
    (deck,) = tmp_path.glob("*.k")
    text = deck.read_text()
    words = (
        "*NODE",
        "*ELEMENT_SHELL",
        "*SECTION_SHELL_TITLE",
        "*MAT_FABRIC_TITLE",
        "*PART_INERTIA",
    )
    rows: dict[str, list[list[str]]] = {word: [] for word in words}
    for block in re.split(r"^(?=\*)", text, flags=re.MULTILINE):
        word, *lines = block.splitlines() or [""]
        rows.get(word, []).append([line for line in lines if line[:1] != "$"])
    nodes = {
        int(line[:8]): [float(line[start : start + 16]) / metre for start in (8, 24, 40)]
        for line in rows["*NODE"][0]
    }
    place = {int(line[8:16]): nodes[int(line[16:24])][2] for line in rows["*ELEMENT_SHELL"][0]}
    thick = [thickness_of(ply["name"]) for ply in plies]
    assert place[2] - place[1] == pytest.approx(0.5 * sum(thick) + 7e-5, rel=1e-4)
    for ply, wanted, (_, _, section), (_, card, *_) in zip(
        plies, thick, rows["*SECTION_SHELL_TITLE"], rows["*MAT_FABRIC_TITLE"]
    ):
        assert [float(section[10 * n : 10 * n + 10]) / metre for n in range(4)] == pytest.approx(
            [wanted] * 4, rel=1e-3
        )
        weave = catalogue.load(ply["name"]).with_effective_density().weave
        counts = (weave.warp_count, weave.weft_count)
        mass = sum(
            count * yarn.linear_density * (1 + yarn.crimp)
            for yarn, count in zip(weave.yarns, counts)
        )
        density = float(card[10:20]) * metre**3 / kilogram
        assert density * wanted == pytest.approx(mass, rel=1e-3)
    head = " ".join(line[1:].strip() for line in text.splitlines() if line[:1] == "$")
    assert "Units: g-mm-ms " in head
    assert max(x for x, *_ in nodes.values()) == pytest.approx(0.01, abs=1e-3)
    share = float(re.search(r"Symmetry: ([0-9.]+) of", head)[1])
    assert float(rows["*PART_INERTIA"][0][2][30:40]) / kilogram == pytest.approx(
        share * 6e-4, rel=1e-3
    )
    titles = [block[0].strip() for block in rows["*MAT_FABRIC_TITLE"]]
    said = re.findall(r"Law (\d) \((.*?)\) less the cell, over the strength: rms (\S+) %", head)
    assert [(int(number), name) for number, name, _ in said] == list(enumerate(titles, 1))
    for (_, name, rms), other in zip(said, titles[::-1]):
        assert float(rms) == pytest.approx(100 * made.errors[name]["rms"], abs=0.051)
        assert float(rms) != pytest.approx(100 * made.errors[other]["rms"], abs=0.1)


def test_the_picture_of_a_coupon_is_its_piece():
    """Elements where their nodes are, yarns along their edges, borders of zones from the grips, numbers as computed."""
    from matplotlib.collections import LineCollection, PolyCollection

    made = wc.coupon(
        "S-720", "bias_extension", length="60 mm", width="25 mm", elongation="2 mm", steps=2
    )
    solved = made.solved
    x = 1e3 * solved.states[-1].x
    assert np.abs(x - 1e3 * solved.coupon.points).max() > 0.5
    figure = pictures_figure.drawn(pictures_coupon.sheared_coupon, made.record, solved)
    left, right = figure.axes[:2]
    (elements,) = [part for part in left.collections if isinstance(part, PolyCollection)]
    (yarns,) = [part for part in right.collections if isinstance(part, LineCollection)]
    for path, nodes in zip(elements.get_paths(), solved.coupon.quads):
        assert np.allclose(path.vertices[:4], x[nodes])
    assert np.allclose(elements.get_array(), np.degrees(np.abs(solved.shear())))
    ends = np.concatenate([x[family] for family in solved.coupon.edges])
    tension = np.concatenate(solved.coupon.tensions(solved.states[-1].x))
    order = np.argsort(tension)
    assert np.allclose(np.array(yarns.get_segments()), ends[order])
    assert np.allclose(yarns.get_array(), tension[order])
    gripped = x[solved.grips > 0]
    for line in left.get_lines():
        points = np.column_stack(line.get_data())
        assert (np.abs(points[:, None] - x[None]).max(axis=-1).min(axis=1) < 1e-9).all()
        nearest = np.abs(points[-1] - gripped).max(axis=-1).min()
        assert min(nearest, np.abs(points[0] - gripped).max(axis=-1).min()) < 3.0


def test_a_window_states_its_shots():
    rows = []
    for number, velocity in enumerate((141.0, 143.5, 146.0, 148.5, 151.0, 153.5)):
        outcome = "stopped" if number in (0, 2) else "perforated"
        row = {key: 1.0 + 0.3 * number + 0.05 * number**2 for key, *_ in QUANTITIES.values()}
        rows.append(row | {"strike_velocity_m_s": velocity, "outcome": outcome})
    window = Window(147.0, tuple(rows))
    text = chapters_discretisation._describe_window(window)
    assert text.startswith("6 shots at 141 to 153.5 m/s, 2 stopped, 4 perforated: MIXED outcomes")
    content = window.summary()
    assert content["stopped"] == sum(row["outcome"] == "stopped" for row in rows)
    assert content["shots"] == rows
    velocities = np.array([row["strike_velocity_m_s"] for row in rows])
    for key, value in content["mean"].items():
        if value is not None:
            line = np.polyfit(velocities - 147.0, [row[key] for row in rows], 1)
            assert value == pytest.approx(line[1])
