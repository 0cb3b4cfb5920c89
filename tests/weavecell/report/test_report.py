"""The report: every chapter is there, nothing is fetched, and what is said is what was recorded."""

import re
from dataclasses import replace
from html.parser import HTMLParser

import numpy as np
import pytest

import weavecell
from fabrics import catalogue
from fabrics.compression import CompressionLaw
from fabrics.errors import InputError
from shellfabric.panel.quality import Indicator
from shellfabric.projectile.projectile import Projectile
from weavecell.report import chapters, pictures
from weavecell.report import page as report_page
from weavecell.report.shot import chapters_shot, tables_shot
from weavecell.results import provenance
from weavecell.results.impact import ImpactRecord
from weavecell.results.impact_shapes import Cut, Shape


def small_record(**changes):
    """A made-up impact on a panel of four cells: only its bookkeeping is real."""
    t = np.linspace(0, 1e-4, 30)
    v = 100.0 - 5e5 * t
    strike = 0.5 * 3e-3 * 100.0**2
    kinetic = 0.5 * 3e-3 * v**2
    lost = strike - kinetic
    energies = {"kinetic_projectile": kinetic, "yarn_strain": 0.8 * lost, "viscous": 0.15 * lost}
    energies["kinetic_fabric"] = 0.048 * lost
    energies["error"] = 0.002 * lost
    x = np.linspace(0, 0.01, 3)
    nodes = np.stack([*(axis.ravel() for axis in np.meshgrid(x, x, indexing="ij")), np.zeros(9)], axis=1)
    quads = np.array([[0, 3, 4, 1], [3, 6, 7, 4], [1, 4, 5, 2], [4, 7, 8, 5]])
    broken = np.array([[1, 1, 1], [1, 0, 0], [0, 0, 0], [0, 0, 0]], bool)
    shape = Shape(
        1e-4, 0.0075, np.array([0.0, 0.0, 0.0075]), nodes, np.full((4, 2), 100.0), broken,
        pressure=np.full((9, 1), 1e6, np.float32), area=np.full(9, 2.5e-5),
        failed_segments=np.zeros((9, 2), np.float32), slip=np.empty((9, 0)),
    )  # fmt: skip
    record = ImpactRecord(
        title="100 m/s, fitted law", fabric="S-720", law_name="fitted", strike_velocity=100.0, outcome="perforated",
        residual_velocity=50.0, mass=3e-3, failure_message="", mirror_x=True, mirror_y=True,
        projectile=Projectile().surface(), wall_time=1.5, ns_per_element_step=20.0, elements=4, steps=29,
        time=t, velocity=v, nose_position=100 * t, contact_force=np.full(30, 1500.0), deflection=75 * t,
        failed_segments=np.arange(30), energies=energies,
        plies={"reaction_warp": 10 * t[:, None], "reaction_weft": 20 * t[:, None]}, quads=(quads,),
        strength=np.array([[315.0, 315.0]]), half_energy=(shape,), final=(shape,),
        peak_tension=np.array([[300.0, 310.0]]), max_deflection=0.0075,
        peak_tension_time=np.array([[4e-5, 5e-5]]), peak_tension_place=np.array([[[1e-3, 0.0], [0.0, 2e-3]]]),
        z_rest=np.zeros(1), gaps=np.zeros(0), max_penetration_ratio=np.zeros(0), torn_contact=np.zeros(2),
        thickness=np.array([2.5e-4]), cuts=(Cut(1e-4, 0.0075, (np.array([[0.0, 0.005], [0.005, 0.0], [0.01, 0.0]]),)),),
        checks=(Indicator("energy error", 0.001, 0.01),),
    )  # fmt: skip
    return replace(record, **changes)


class _Links(HTMLParser):
    def __init__(self):
        super().__init__()
        self.links, self.tags, self.ids = [], [], []

    def handle_starttag(self, tag, attributes):
        self.tags.append(tag)
        for name, value in attributes:
            if name in ("src", "href", "srcset", "data", "action", "poster"):
                self.links.append(value)
            if name == "id":
                self.ids.append(value)


@pytest.fixture(scope="module")
def page():
    fabric = catalogue.load("S-720")
    law = CompressionLaw(4.45e-5, 6.47e-5, residual_rms=6.6e-7, F_range=(0.5, 100.0))
    force = np.linspace(0.5, 100, 12)
    record = small_record()
    laws = {"fitted": law, "published": fabric.laws[0]}
    picture = pictures.render(pictures.velocity, {"a": (record.time, record.velocity)}, kind="png")
    sections = (
        chapters.comparison([("155 m/s", "perforated", "perforated", "yes")]),
        chapters.mesh({"worst scaled Jacobian": "0.93"}, picture),
        chapters.fit({"equibiaxial": (force, law.d(force))}, laws),
        chapters.cell(fabric, {label: (law, law) for label, law in laws.items()}),
        chapters_shot.chapter([record]),
        chapters.sources(fabric),
        chapters.making(provenance.stamp("title = 'a < b'"), {"impact": 1.5}),
    )
    cards = ((chapters.fabric_card(fabric), chapters.law_card(law)), (chapters_shot.card(record),))
    return report_page.render(
        report_page.Report(
            "A title & more", "A subtitle", cards, sections, outcome=chapters_shot.outcome(record), tone=record.outcome
        )
    )


def test_all_chapters(page):
    seen = _Links()
    seen.feed(page)
    assert seen.ids == ["summary", "mesh", "fit", "cell", "impact", "sources", "making"]
    assert seen.tags.count("img") == 8
    assert [link for link in seen.links if link.startswith("#")] == [f"#{key}" for key in seen.ids]


def test_nothing_is_fetched(page):
    seen = _Links()
    seen.feed(page)
    assert all(link.startswith(("data:image/", "#")) for link in seen.links)
    text = re.sub(r"data:image/[a-z+]+;base64,[A-Za-z0-9+/=]+", "", page)
    assert "http" not in text
    assert "@import" not in text
    assert "url(" not in text
    assert "script" not in set(seen.tags)
    assert "link" not in set(seen.tags)


def test_text_is_escaped(page):
    assert "A title &amp; more" in page
    assert "a &lt; b" in page


def test_every_source_is_reported(page):
    for key, entry in catalogue.load("S-720").sources.items():
        assert f'<td data-column="key">{key}</td>' in page
        assert f'<td data-column="value">{entry["value"]}</td>' in page


def test_outcome_in_one_line(page):
    line = "Perforated: COMPLETE PENETRATION, 100 m/s, residual velocity 50.0 m/s"
    assert f'<p class="outcome perforated">{line}, 29 failed yarn segments.</p>' in page
    assert 'class="card perforated"' in page
    assert "contact force up to 1.5 kN" in page
    none = np.zeros(30)
    held = small_record(outcome="stopped", residual_velocity=-1.0, failed_segments=none)
    assert chapters_shot.outcome(held) == (
        "Stopped: PARTIAL PENETRATION, 100 m/s, back-face deflection 7.5 mm, peak tension 98 % of the strength (weft)."
    )
    doubtful = replace(held, checks=(Indicator("energy error", 0.1, 0.01),))
    assert chapters_shot.outcome(doubtful).endswith("(weft). DOUBTFUL: energy error.")
    assert "Not decided: 100 m/s, still moving with 50.0 m/s" in chapters_shot.outcome(
        small_record(outcome="in flight")
    )
    broken = small_record(outcome="unstable", failure_message="a node moves at 1e5 m/s")
    assert chapters_shot.outcome(broken).startswith("UNSTABLE at 100 m/s")


def test_results_have_peaks_with_time_and_place(page):
    assert ">300.0 (95 %)</td>" in page
    assert ">40.0, 1.0 and 0.0</td>" in page
    assert ">50.0, 0.0 and 2.0</td>" in page


def test_developers_numbers_are_folded(page):
    assert page.index('<details class="folded">') > page.index('id="sources"')


def test_a_stopped_projectile_has_no_residual_velocity():
    assert tables_shot.residual(small_record(outcome="stopped", residual_velocity=0.0)) == "residual velocity 0 m/s"


def test_record_survives_its_file(tmp_path):
    record = small_record()
    record.write(tmp_path / "histories.h5")
    again = ImpactRecord.read(tmp_path / "histories.h5")
    for name, value in vars(record).items():
        other = getattr(again, name)
        if name in ("half_energy", "final"):
            value, other = vars(value[0]), vars(other[0])
        if name == "quads":
            value, other = value[0], other[0]
        if name == "cuts":
            np.testing.assert_array_equal(value[0].lines[0], other[0].lines[0])
            continue
        if isinstance(value, dict):
            assert set(value) == set(other)
            for key, column in value.items():
                np.testing.assert_array_equal(other[key], column)
        elif isinstance(value, np.ndarray):
            np.testing.assert_array_equal(other, value)
        else:
            assert other == value


def test_another_file_is_refused(tmp_path):
    (tmp_path / "histories.h5").write_text("not HDF5")
    with pytest.raises(InputError, match="not a readable HDF5 file"):
        ImpactRecord.read(tmp_path / "histories.h5")


def test_failing_record_leaves_nothing(tmp_path):
    with pytest.raises(TypeError):
        replace(small_record(), time=object()).write(tmp_path / "histories.h5")
    assert list(tmp_path.iterdir()) == []


def test_pictures_repeat_to_the_byte():
    record = small_record()
    runs = {"a": (record.time, record.velocity)}
    assert pictures.render(pictures.velocity, runs) == pictures.render(pictures.velocity, runs)


def test_stamp_tells_versions_and_no_paths(monkeypatch):
    monkeypatch.setenv("OMP_NUM_THREADS", "1")
    stamp = provenance.stamp("a scene")
    assert stamp["weavecell"] == weavecell.__version__
    assert f"numpy {np.__version__}" in stamp["packages"]
    assert "matplotlib" in stamp["packages"]
    assert stamp["threads"].startswith("OMP_NUM_THREADS 1")
    assert stamp["scene"] == "a scene"
    assert not [value for key, value in stamp.items() if value.startswith("/") or " /" in value]


def test_parts_of_the_energy_picture_add_up():
    """The equilibrium form's forces do other work than the yarns store; the picture shows the work."""
    energies = {
        "kinetic_projectile": np.array([10.0, 4.0]),
        "yarn_strain": np.array([0.0, 6.5]),
        "formulation_residual": np.array([0.0, -0.5]),
    }
    drawn = chapters_shot.parts(energies)
    assert drawn["kinetic_projectile"] + drawn["yarn_strain"] == pytest.approx([10.0, 10.0])
    assert energies["yarn_strain"][1] == 6.5


def test_a_cut_shows_an_oblique_projectile_where_it_is():
    straight = small_record()
    shape = replace(straight.final[0], projectile_position=np.array([2e-3, 0.0, 0.0075]))
    oblique = small_record(half_energy=(shape,), final=(shape,))
    views = [chapters_shot.cut_view(record, record.cuts[0], "") for record in (straight, oblique)]
    np.testing.assert_allclose(views[1].projectile - views[0].projectile, [[2e-3, 0.0]] * len(views[0].projectile))
