"""Every figure by property (`told.py`): what is drawn on an axis is one field of the made-up data, in the unit of
the axis, under the words that name the field. No two numbers of the data are alike, so that nothing can be
exchanged unseen. Maps, pictures of places and bars look at their figure themselves."""

import ast
from collections import namedtuple
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace as Given

import numpy as np
import pandas as pd
import pytest
from matplotlib.colors import to_rgb
from numpy.testing import assert_allclose

from fabrics import catalogue
from fabrics.base.record import Record
from fabrics.surface import ResponseSurface
from shellfabric.loop.histories import YarnHistory
from tests.weavecell.report.told import fields_of, refuse_untold
from weavecell.answers import critical_velocity
from weavecell.decks import mismatch
from weavecell.report import (
    pictures,
    pictures_biaxial,
    pictures_body,
    pictures_comparison,
    pictures_coupon,
    pictures_crossover,
    pictures_figure,
    pictures_histories,
    pictures_records,
    pictures_surface,
    pictures_uncertainty,
)
from weavecell.report.pictures_style import ORANGE, STEEL
from weavecell.report.shot import pictures_shot
from weavecell.results.impact import ImpactRecord
from weavecell.results.impact_shapes import Cut
from weavecell.results.wave_fronts import Front
from weavecell.runs import table
from weavecell.runs.span import Span
from weavecell.runs.sweep import QUANTITIES
from weavecell.studies.ballistic_limit import Limit, Shot
from weavecell.studies.energy_map import EnergyMap
from weavecell.studies.pull_out_tests import PullOutTest

ROOT = Path(__file__).parents[3]
DRAWN = {}
rng = np.random.default_rng(7)


def numbers(*shape, low=1.0, high=9.0):
    """Numbers that are all different."""
    return rng.uniform(low, high, shape)


def rising(n, scale=1.0):
    return scale * np.cumsum(numbers(n))


def xy(x, y):
    return np.column_stack([x, y])


class Made(Given):
    """A record of whatever a figure asks of it: `size` numbers, all different, or rising with time."""

    def __init__(self, size=4, **given):
        super().__init__(**given)
        self._size = size

    def __getattr__(self, name):
        if name.startswith("_"):
            raise AttributeError(name)
        made = numbers(self._size)
        if name in ("t", "time"):
            made = rising(self._size, 1e-6)
        setattr(self, name, made)
        return made

    def __getitem__(self, name):
        return getattr(self, name)


# what figures call a time; "" is no word
SAID = {"t": "time", "_size": ""}


def case(function):
    """Register the case of a figure function. It returns the figure, its made-up data, {name: words for it} and
    names of what is not drawn; or None if it has looked itself."""

    def registered(draw):
        DRAWN[function] = draw
        return draw

    return registered


Pair = namedtuple("Pair", "warp weft")
Points = namedtuple("Points", "strain warp weft")


@case(pictures.fit)
def fit(pyplot):
    samples = {name: (numbers(4), numbers(4)) for name in ("biaxial", "uniaxial")}
    laws = {
        name: Given(d=lambda F, k=k: k * F) for name, k in (("fitted", 2e-6), ("published", 3e-6))
    }
    platen = numbers(3), numbers(3)
    figure = pictures.fit(pyplot, samples, laws, platen)
    return figure, {"3D crossover": samples, "": laws, "between rigid plates": platen}


@case(pictures.cell)
def cell(pyplot):
    cases = {}
    for title in ("warp extension", "both"):
        curves = {name: Pair(numbers(5), numbers(5)) for name in ("fitted", "published")}
        points = Points(rising(3, 1e-3), numbers(3), numbers(3))
        cases[title] = {"strain": rising(5, 1e-3), "curves": curves, "points": points}
    return pictures.cell(pyplot, cases), cases, {"curves": "", "points": "3D crossover"}


@case(pictures.velocity)
def velocity(pyplot):
    Run = namedtuple("Run", "time velocity")
    runs = {name: Run(rising(4, 1e-6), numbers(4)) for name in ("own", "finer mesh", "coarser")}
    return pictures.velocity(pyplot, runs), runs


SHOTS = (
    (81.0, 0.0, "stopped"),
    (92.0, 0.0, "stopped"),
    (87.0, 23.0, "perforated"),
    (96.0, 51.0, "perforated"),
    (105.0, 68.0, "perforated"),
)


def shots_of(rows=SHOTS):
    return tuple(Shot(v, left, outcome, 1e-4, 0, (1.0, 2.0), 0.0, 0.1) for v, left, outcome in rows)


def curve_of(name, k):
    """A fitted curve of residual velocities: its samples up to a velocity."""
    return Given(
        reason="",
        sample=lambda high: (np.linspace(80, high, 7), k * np.linspace(80, high, 7)),
        words=lambda between: name,
    )


@pytest.mark.parametrize("single", [True, False])
def test_a_limit(single):
    """A bracket, or a zone in which outcomes are mixed."""
    shots = shots_of([shot for shot in SHOTS if shot[0] != 87.0] if single else SHOTS)
    limit = Limit(92.0, 96.0, shots)
    with pictures_figure.plots() as pyplot:
        drawn = {"limit": limit, "lambert_jonas": curve_of("a 1", 0.5), "shots": shots}
        found = Given(title="S-720", interval=None, **drawn)
        figure = critical_velocity.plot_of(found).draw(pyplot)
    line = np.linspace(80, 1.02 * 105, 7)
    zone = {"bracket": (92.0, 96.0)} if single else {"mixed outcomes": (87.0, 92.0)}
    data = {}
    for outcome in ("stopped", "perforated"):
        struck = [shot for shot in shots if shot.outcome == outcome]
        data[outcome] = {
            "strike velocity": np.array([shot.strike_velocity for shot in struck]),
            "residual velocity": np.array([shot.residual_velocity for shot in struck]),
        }
    data |= {"no loss": lambda V: V, "Lambert-Jonas a 1": {"strike": line, "residual": 0.5 * line}}
    refuse_untold(figure, fields_of(data | zone), ["stopped residual"])


@case(pictures.draw_tests)
def shots_of_tests(pyplot):
    table = pd.DataFrame(
        {
            "strike_velocity_m_s": [70.0, 95.0, 110.0],
            "tested": ["stopped", "perforated", "perforated"],
            "tested_residual_velocity_m_s": [2.0, 31.0, 64.0],
        }
    )
    posterior = Given(velocities={"V50": Span(84.0, 79.0, 88.0)})
    tests = Given(table=table, posterior=posterior, lambert_jonas=curve_of("", 0.3))
    figure = pictures.draw_tests(pyplot, "both", tests)
    line = np.linspace(80, 1.02 * 110, 7)
    data = {
        "no loss": lambda V: V,
        "strike velocity": table["strike_velocity_m_s"],
        "test stopped": [2.0],
        "test perforated": [31.0, 64.0],
        "tests Lambert-Jonas": (line, 0.3 * line),
        "V50 of the tests": 84.0,
        "V50 interval": (79.0, 88.0, 0.9),
    }
    return figure, data


def biaxial_tests():
    """A fit to two tests, of which the weft of the second was not measured."""
    found = []
    for name, role, families in (("k = 1", "fitted", (0, 1)), ("warp alone", "predicted", (0,))):
        load = np.full((5, 2), np.nan)
        load[:, families] = numbers(5, len(families))
        test = Given(strain=1e-3 * numbers(5, 2), load=load)
        one = Given(name=name, role=role, fitted=role == "fitted", test=test)
        found.append(Given(**vars(one), computed=numbers(5, 2)))
    return found


def measured_and_computed(comparisons):
    """Data of biaxial tests under the names of the families that were measured."""
    data = {}
    for one in comparisons:
        for m, family in enumerate(("warp", "weft")):
            if np.isfinite(one.test.load[:, m]).all():
                data[one.name, family] = {
                    "strain": one.test.strain[:, m],
                    "load": one.test.load[:, m],
                    "computed": one.computed[:, m],
                    "less": one.test.load[:, m] - one.computed[:, m],
                }
    return {f"{name} {family}": fields for (name, family), fields in data.items()}


@case(pictures_biaxial.draw_tests)
def fit_beside_biaxial_tests(pyplot):
    """The measured points have no name of their own: they lie about the curve of their colour."""
    comparisons = biaxial_tests()
    figure = pictures_biaxial.draw_tests(pyplot, Given(comparisons=comparisons), "a title")
    data = measured_and_computed(comparisons)
    for axes, m in zip(figure.axes, (0, 1), strict=True):
        names = [f"{one.name}, {one.role}" for one in comparisons[: 2 - m]]
        assert [text.get_text() for text in axes.get_legend().get_texts()] == names
    return figure, data, {"computed": ""}, ["less"]


@case(pictures_biaxial.draw_pulls)
def solid_beside_biaxial_tests(pyplot):
    """Measured points and the solid of the file, dotted, have the colour of the named curve."""
    pulls = [
        Given(name=name, role=role, fitted=role == "fitted", strain=numbers(6, 2))
        for name, role in (("one to one", "fitted"), ("one to two", "predicted"))
    ]
    for one in pulls:
        one.load, one.before, one.computed = (numbers(6, 2) for _ in range(3))
    figure = pictures_biaxial.draw_pulls(pyplot, Given(pulls=pulls))
    for m, (axes, family) in enumerate(zip(figure.axes, ("warp", "weft"), strict=True)):
        assert axes.get_xlabel() == f"strain along the {family} [%]"
        assert axes.get_ylabel() == f"load of a {family} yarn [N]"
        *lines, _ = axes.lines
        for k, one in enumerate(pulls):
            drawn = lines[3 * k : 3 * k + 3]
            assert drawn[2].get_label() == f"{one.name}, {one.role}"
            assert len({line.get_color() for line in drawn}) == 1
            for line, load in zip(drawn, (one.load, one.before, one.computed)):
                assert_allclose(line.get_xydata(), xy(100 * one.strain[:, m], load[:, m]))


@case(pictures_biaxial.draw_residuals)
def residuals_of_biaxial_tests(pyplot):
    comparisons = biaxial_tests()
    figure = pictures_biaxial.draw_residuals(pyplot, Given(comparisons=comparisons))
    said = {"less": "measured less computed"}
    said |= {f"{one.name} {family}": one.name for one in comparisons for family in ("warp", "weft")}
    return figure, measured_and_computed(comparisons), said, ["load", "computed"]


@case(pictures_biaxial.draw_profiles)
def profiles_of_constants(pyplot):
    """The curve of each constant, and the ends of its interval where they are found."""
    profiles = {name: (1e-5 * rising(7), numbers(7)) for name in ("a", "b")}
    values = {"a": Given(low=2e-5, high=6e-5), "b": Given(low=1e-5, high=np.inf)}
    figure = pictures_biaxial.draw_profiles(pyplot, Given(profiles=profiles, values=values))
    labels = "a [mm]", "b [mm N^(1/3)]"
    for axes, label, ends, name in zip(figure.axes, labels, ((0.02, 0.06), (0.01,)), profiles):
        places, rises = profiles[name]
        assert axes.get_xlabel() == label
        curve, *found = axes.lines
        assert_allclose(curve.get_xydata(), xy(1e3 * places, rises))
        assert_allclose([line.get_xdata()[0] for line in found], ends)
    assert figure.axes[0].get_ylabel() == "rise of the sum of squares / s²"


@case(pictures_body.bar)
def bar(pyplot):
    history = Made()
    figure = pictures_body.bar(pyplot, history)
    from_centre = {name: getattr(history, name) - history.centre for name in ("tip", "tail")}
    said = {"centre_velocity": "centre of mass velocity"}
    return figure, [history, {"from the centre": from_centre}], said, ["tip", "tail", "centre"]


@case(pictures_body.mushroom)
def mushroom(pyplot):
    """Two elements of a body, whose jacket is framed: places at rest and at the end, strains at the end alone."""
    names = ("tip_velocity", "tail_velocity", "centre_velocity")
    corners = np.array([[0, 1, 3, 2], [2, 3, 5, 4]])
    body = Given(
        t=rising(4, 1e-6),
        **{name: numbers(4) for name in names},
        width=9e-3,
        width_at_rest=5e-3,
        length_at_rest=12e-3,
        corners=corners,
        rest=numbers(6, 2) * 1e-3,
        places=numbers(6, 2) * 1e-3,
        plastic=np.array([0.3, 0.7]),
        jacketed=np.array([True, False]),
    )
    figure = pictures_body.mushroom(pyplot, body)
    rest, end, _, bar = figure.axes
    for axes, title, places, strain in (
        (rest, "at rest", body.rest, [0, 0]),
        (end, "at the end", body.places, body.plastic),
    ):
        assert axes.get_title(loc="left") == title
        wanted = 1e3 * (places - [0, places[:, 1].max()])[corners]
        for drawn, way in zip(axes.collections, (1, -1), strict=True):
            assert_allclose(drawn.get_array(), strain)
            found = [path.vertices[:4] for path in drawn.get_paths()]
            assert_allclose(found, wanted * [way, 1])
    assert bar.get_xlabel() == "plastic strain [-]"
    drawn = {name: getattr(body, name) for name in ("t", *names)}
    return figure, drawn, {"centre_velocity": "centre of mass velocity"}


def posterior_of(shift=0.0):
    """Shares that pass, rising by half a percent a m/s, with ends a tenth off."""
    spans = {
        name: Span(v + shift, v - 5, v + 6)
        for name, v in (("V10", 82.0), ("V50", 88.0), ("V90", 97.0))
    }

    def share(V):
        return (np.asarray(V) - shift) / 200

    def passing(V):
        return [Span(p, p - 0.1, p + 0.1) for p in share(V)]

    return Given(velocities=spans, passing=passing, share=share)


def test_two_panels_side_by_side():
    """Shots and curves under the name of their own panel, in its colour; the difference and its ends."""
    sides = []
    for shift in (0.0, 20.0):
        shots = tuple(
            Given(velocity=v + shift, perforated=hit)
            for v, hit in ((80, False), (90, True), (85, False), (95, True))
        )
        study = Given(shots=shots, posterior=posterior_of(shift))
        sides.append(Given(study=study, v50=88.0 + shift))
    result = Given(
        names=("A one", "B other"),
        a=sides[0],
        b=sides[1],
        difference=Given(value=-20.0, span=Span(-20.0, -27.0, -11.0)),
    )
    with pictures_figure.plots() as pyplot:
        figure = pictures_comparison.difference(pyplot, result)
    axis, lower = figure.axes
    for name, side in zip(result.names, sides):
        colour = pictures_comparison.COLOURS[name[0]]
        curve, stopped, through = [line for line in axis.lines if line.get_color() == colour]
        struck = [shot.velocity for shot in side.study.shots]
        V, share = curve.get_xydata().T
        assert len(V) > 20
        assert (V[0], V[-1]) == (min(struck), max(struck))
        assert_allclose(share, side.study.posterior.share(V))
        assert curve.get_label() == f"{name}: V50 {side.v50:.3g} m/s"
        assert list(stopped.get_xdata()) == [struck[0], struck[2]]
        assert list(through.get_xdata()) == [struck[1], struck[3]]
        assert max(stopped.get_ydata()) < 0 < 1 < min(through.get_ydata())
    assert [-27.0, -11.0] in [list(line.get_xdata()) for line in lower.lines]
    assert lower.get_xlabel() == "A less B [m/s]: above 0, A is better"


@case(pictures_comparison.difference)
def difference(pyplot):
    return None  # the test above


@case(pictures_comparison.draw_shots)
def several_shots(pyplot):
    shots = {title: Made() for title in ("one", "other")}
    return pictures_comparison.draw_shots(pyplot, shots), shots


@case(pictures_comparison.draw_residuals)
def several_residuals(pyplot):
    Rows = namedtuple("Rows", "strike residual")
    tables = {title: Rows(numbers(3), numbers(3)) for title in ("one", "other")}
    return pictures_comparison.draw_residuals(pyplot, tables), tables


@case(pictures_body.crater)
def crater(pyplot):
    """Two bricks side by side at y = 0, the second eroded; strain and profile under each title."""
    x = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
    brick = np.concatenate([x, x + np.array([0, 0, 1])]) * 1e-3
    nodes = np.concatenate([brick, brick + np.array([1e-3, 0, 0])])
    bricks = np.array([range(8), range(8, 16)])
    blocks = {
        title: Given(
            nodes=nodes * np.array([1, 1, k]),
            bricks=bricks,
            gone=np.array([False, True]),
            plastic=np.array([0.1 * k, 9.0]),
            depth=2e-3 * k,
            half_width=1e-3,
            face=0.0,
            share=1.0,
            crater=xy(rising(3, 1e-3), (numbers(3, high=2.0) - 9.0) * 1e-3),
        )
        for k, title in enumerate(("first", "second"), 1)
    }
    figure = pictures_body.crater(pyplot, blocks)
    for axes, (title, block) in zip(figure.axes, blocks.items()):
        (faces,) = axes.collections
        assert axes.get_title(loc="left") == title
        assert_allclose(faces.get_array(), block.plastic[:1])
        assert_allclose(axes.lines[0].get_xydata(), 1e3 * block.crater)
        below, above = axes.get_ylim()
        assert above < 1e3 * block.crater[:, 1].min()
        assert below > 1e3 * block.crater[:, 1].max()
        assert_allclose(axes.lines[1].get_xydata(), 1e3 * block.crater * [-1, 1])
    assert figure.axes[-1].get_ylabel() == "effective plastic strain"
    return None


@case(pictures_body.drawings)
def drawings(pyplot):
    """Two bodies of two elements, the outer one of the jacket that one of them has."""
    corners = np.array([[0, 1, 4, 3], [1, 2, 5, 4]])
    outline = np.array([[0, 0], [1, 0], [1.5, 0], [0, 9], [1, 8], [1.5, 7]]) * 1e-3
    bodies = {}
    for k, (title, jacket) in enumerate((("a bullet", "brass"), ("a pellet", "")), 1):
        given = Given(
            places=outline * k,
            corners=corners,
            jacketed=np.array([False, bool(jacket)]),
            radius=1.5e-3 * k,
            length=9e-3 * k,
            jacket_thickness=0.5e-3,
            drawn_mass=7e-3 + 0.1e-3 * k,
        )
        bodies[title] = given, f"lead {k}", jacket
    figure = pictures_body.drawings(pyplot, bodies)
    orange, grey = (to_rgb(colour) for colour in (ORANGE, STEEL))
    measures = "3 x 9 mm, 7.1 g", "6 x 18 mm, 7.2 g"
    for axes, (title, (body, core, jacket)), measure in zip(
        figure.axes, bodies.items(), measures, strict=True
    ):
        assert axes.get_title(loc="left") == f"{title}\n{measure}"
        right, left = axes.collections
        expected = 1e3 * (body.places[corners] - [0, body.length])
        for half, way in ((right, 1), (left, -1)):
            for element, path in zip(expected, half.get_paths(), strict=True):
                assert_allclose(path.vertices[:4], element * [way, 1], atol=1e-12)
            assert_allclose(half.get_facecolor()[:, :3], [grey, orange if jacket else grey])
        words = [text.get_text() for text in axes.get_legend().get_texts()]
        assert words == [core, *([f"{jacket}, 0.5 mm"] if jacket else [])]
    return None


def record_of(facts, **columns):
    return Record(columns, dict.fromkeys(columns, "[-] made up"), facts)


FABRIC = catalogue.load("S-726")


@case(pictures_crossover.yarn)
def yarn(pyplot):
    record = record_of(
        {"crimp": 0.02, "yarn": 1}, strain=rising(4, 1e-3), T_taut=numbers(4), T=numbers(4)
    )
    said = {"T_taut": "fibres without bending tension", "T": "solid and bars tension"}
    data = [record.columns, {"": record.facts["crimp"]}]
    return pictures_crossover.yarn(pyplot, FABRIC, record), data, said


@case(pictures_crossover.stack)
def stack(pyplot):
    from fabrics.plate_curve import PlateCurve

    law = PlateCurve.pressure_law(FABRIC.areal_density_measured, 4)
    pressure = np.concatenate([[0.0], np.linspace(0.9, 3.0, 6) * law.pressure[3]])
    closure = np.concatenate([[0.0], rising(6, 1e-6)])
    record = record_of(
        {"plies": 4}, pressure=pressure, closure=closure, closure_ply=np.array(closure) / 3.7
    )
    # the curve of the law begins where the record has its first pressure
    inside = (pressure >= law.pressure[0]) & (pressure <= law.pressure[-1])
    first = np.interp(np.log(law.pressure[0]), np.log(pressure[1:]), closure[1:])
    start = closure[np.searchsorted(pressure, pressure[inside][0])] - (closure[inside][0] - first)
    data = {
        "3D yarns": {"closure per ply": record["closure_ply"], "mean pressure": pressure},
        "law": {"closure per ply": (law.closure + start) / 4, "pressure": law.pressure},
    }
    return pictures_crossover.stack(pyplot, FABRIC, record), data


@case(pictures_crossover.tensions)
def tensions(pyplot):
    names = ("T1", "T2", "F_c", "d1", "d2")
    record = record_of(
        {"case": "a path"}, path=rising(4, 0.1), **{name: numbers(4) for name in names}
    )
    said = {"T1": "warp tension force", "T2": "weft tension force", "F_c": "contact force"}
    said |= {"d1": "d 1 displacement", "d2": "d 2 displacement"}
    return pictures_crossover.tensions(pyplot, FABRIC, record), record.columns, said


@case(pictures_crossover.shear)
def shear(pyplot):
    pytest.importorskip("dolfinx")
    from unitcell3d.identify import shear_fit

    gamma = np.linspace(0.0, 0.8, 9)
    tau = FABRIC.shear.stress(gamma) * 1.3
    record = record_of({}, gamma=gamma, tau=tau, F_c=numbers(9), F_side=numbers(9, 2))
    law = shear_fit.fit(gamma, tau).law
    data = {
        "γ": gamma,
        "3D yarns shear stress": tau,
        f"fit γ 1 {law.gamma1:.2f} 2 {law.gamma2:.2f}": law.stress,
        f"data γ 1 {FABRIC.shear.gamma1:g} 2 {FABRIC.shear.gamma2:g}": FABRIC.shear.stress,
        "contact force at a crossing": record["F_c"],
        "contact force between parallel": Given(
            **dict(zip(("warps", "wefts"), record["F_side"].T))
        ),
    }
    return pictures_crossover.shear(pyplot, FABRIC, record), data


@case(pictures_crossover.pull_out)
def crossover_pull_out(pyplot):
    pytest.importorskip("dolfinx")
    from unitcell3d.cases import pull_out as case

    load = np.repeat([1, 2], 3)
    pull = np.array([0.0, 1.0, 2.0, 0.0, 1.5, 2.5]) * 1e-6
    record = record_of(
        {"friction": 0.2, "pulled": 1, "loads": 2, "pull": 1e-6},
        load=load,
        pull=pull,
        P=np.array([0.1, 0.5, 0.9, 0.2, 1.1, 1.9]),
        F_c=np.array([2.0, 2.1, 2.2, 5.0, 5.1, 5.3]),
        mobilised=np.array([0.0, 0.6, 1.0, 0.0, 0.7, 1.0]),
    )
    F_c, T_f = case.thresholds(record)
    law = case.fit(record)
    data = {
        f"{last:.3g} N": {"pull": pull[load == number], "force": record["P"][load == number]}
        for number, last in ((1, 2.2), (2, 5.3))
    }
    data |= {"last of the first": 2.2, "last of the second": 5.3, "constant": round(law.c0, 2)}
    data["full sliding"] = {"contact force": F_c, "slip threshold": T_f}
    data[f"T f {law.mu_eff:.3f} F c"] = law.threshold
    return pictures_crossover.pull_out(pyplot, FABRIC, record), data


@case(pictures_crossover.plates)
def plates(pyplot):
    found = Made()
    said = {"before": "before the fit", "computed": "fitted"}
    return pictures_crossover.plates(pyplot, found), found, said


def yarn_history(family, offset):
    X = np.linspace(-4.5, 4.5, 10) * 1e-3
    one = numbers(6, 10), numbers(6, 11), numbers(6, 11)
    return YarnHistory(family, offset, 5e4 + 1e4 * offset, 100.0, 0.01, X, *one)


@case(pictures_histories.tensions)
def yarn_tensions(pyplot):
    t = rising(6, 1e-6)
    yarns = yarn_history("warp", 1e-3), yarn_history("weft", 2e-3)
    data = [{"time": t}]
    for yarn in yarns:
        name = f"{yarn.family} {1e3 * yarn.offset:.1f} mm"
        places = {f"{1e3 * yarn.X[k]:.1f} mm tension": yarn.tension[:, k] for k in (5, 8)}
        data += [{name: places}, {yarn.family: {"": yarn.X[[5, 8]], "off": yarn.offset}}]
    return (
        pictures_histories.tensions(pyplot, t, yarns, (0.4e-3, 3.6e-3)),
        data,
        {},
        ["warp", "weft"],
    )


@case(pictures_histories.fronts)
def fronts(pyplot):
    t = rising(6, 1e-6)
    yarns = yarn_history("warp", 1e-3), yarn_history("weft", 2e-3)
    waves = [
        Front(kind, family, rising(3, 1e-6), rising(3, 1e-4), speed, (0, 1), k * 1e-6, 1.0)
        for k, (kind, family, speed) in enumerate(
            (
                ("longitudinal", "warp", 5000.0),
                ("transverse", "warp", 300.0),
                ("longitudinal", "weft", 6000.0),
                ("transverse", "weft", 400.0),
            ),
            1,
        )
    ]
    figure = pictures_histories.fronts(pyplot, t, yarns, waves)
    for axes, yarn in zip(figure.axes, yarns):
        own = [wave for wave in waves if wave.family == yarn.family]
        assert axes.get_title(loc="left").startswith(yarn.family)
        side = yarn.X > 0
        (image,) = axes.collections
        assert_allclose(np.ravel(image.get_array()), yarn.tension[:, side].ravel())
        for wave, (dots, line, key) in zip(own, zip(*[iter(axes.lines)] * 3)):
            assert_allclose(dots.get_xydata(), xy(1e3 * wave.place, 1e6 * wave.time))
            ends = np.array([0.0, wave.place.max()])
            assert_allclose(
                line.get_xydata(), xy(1e3 * ends, 1e6 * (wave.start + ends / wave.speed))
            )
            assert key.get_label() == f"{wave.kind}, {wave.speed:.0f} m/s"
            assert key.get_color() == dots.get_color()
    assert figure.axes[-1].get_ylabel() == "tension [N]"
    return None


@case(pictures_histories.strains)
def strains(pyplot):
    """Eight of eleven instants, one scale for both yarns, and the foot of a cone that spreads."""
    t = rising(11, 1e-6)
    yarns = []
    for family, offset in (("warp", 1e-3), ("weft", 2e-3)):
        made = yarn_history(family, offset)
        nodes = np.linspace(-5e-3, 5e-3, 41)
        place = np.broadcast_to(nodes, (11, 41))
        cone = 3e-4 * np.arange(11)[:, None] * (1 + 100 * offset) - np.abs(place)
        more = {"place": place, "deflection": np.maximum(cone, 0), "tension": numbers(11, 40)}
        yarns.append(replace(made, X=0.5 * (nodes[1:] + nodes[:-1]), **more))
    figure = pictures_histories.strains(pyplot, t, yarns)
    chosen = [1, 2, 4, 5, 6, 8, 9, 10]
    data = [{"instant": float(time)} for time in t]
    for yarn in yarns:
        side = yarn.X > 0
        data.append(
            {
                f"{yarn.family} {1e3 * yarn.offset:.1f} mm": {
                    **{f"{1e6 * t[k]:.0f} µs strain": yarn.strain[k, side] for k in chosen},
                    "at rest": yarn.X[side],
                    "strength": float(100 / yarn.EA),
                }
            }
        )
        data.append({"off": yarn.offset})
    assert len({axes.get_ylim() for axes in figure.axes}) == 1
    for axes, yarn in zip(figure.axes, yarns):
        feet = [line for line in axes.lines if line.get_marker() == "o" and line.get_xdata().size]
        places = np.concatenate([line.get_xdata() for line in feet])
        radius = yarn.cone_radius
        seen = [k for k in chosen if np.isfinite(radius[k])]
        assert len(seen) >= 3
        assert_allclose(places, 1e3 * radius[seen])
        for line in feet:
            line.remove()
    return figure, data


@case(pictures_histories.cone)
def cone(pyplot):
    Radii = namedtuple("Radii", "time radius")
    radii = {name: Radii(rising(5, 1e-6), rising(5, 1e-3)) for name in ("warp", "weft")}
    return pictures_histories.cone(pyplot, radii), radii


@case(pictures_coupon.sheared_coupon)
def sheared_coupon(pyplot):
    """Shear at the left, tension at the right, each by its elements and edges."""
    x = np.array([[0, 0], [1, 0], [2, 0], [0, 1], [1, 1], [2, 1]]) * 1e-3
    sheared = np.radians([3.0, -7.0])
    edges = np.array([[0, 1], [1, 2]]), np.array([[0, 3], [1, 4], [2, 5]])
    tension = numbers(2), numbers(3)
    coupon = Given(
        quads=np.array([[0, 1, 4, 3], [1, 2, 5, 4]]), edges=edges, tensions=lambda _: tension
    )
    solved = Given(coupon=coupon, states=[Given(x=x)], shear=lambda: sheared, force_floor=0.1)
    name = "shear angle"
    record = record_of(
        {"test": "picture_frame", "prescribed_name": name}, **{name: np.radians([1.0, 12.0])}
    )
    figure = pictures_coupon.sheared_coupon(pyplot, record, solved)
    left, right, shears, pulls = figure.axes
    assert_allclose(left.collections[0].get_array(), [3.0, 7.0])
    order = np.argsort(np.concatenate(tension))
    assert_allclose(right.collections[0].get_array(), np.concatenate(tension)[order])
    drawn = np.array(right.collections[0].get_segments())
    assert_allclose(drawn, 1e3 * x[np.concatenate(edges)[order]])
    assert left.get_title(loc="left") == "shear, shear angle 12 °"
    assert (shears.get_xlabel(), pulls.get_xlabel()) == (
        "shear angle [°]",
        "tension of a yarn [N]",
    )
    return None


@case(pictures_coupon.curves)
def curves(pyplot):
    names = ["load of a warp yarn", "load of a weft yarn"]
    names += [f"cell at these strains, {family}" for family in ("warp", "weft")]
    across = next(key.name for key in pictures_coupon.COUPON_MEASURES.values() if key.unit == "%")
    record = record_of(
        {"prescribed_name": across},
        **{across: rising(4, 1e-3)},
        **{name: numbers(4) for name in names},
        unloaded=np.array([0, 1, 1, 0]),
    )
    figure = pictures_coupon.curves(pyplot, record, names, "load of a yarn")
    drawn = {name: record[name] for name in (across, *names)}
    for line in figure.axes[0].lines:
        name, comma, _ = line.get_label().partition(", unloaded")
        if comma:
            assert_allclose(line.get_ydata(), record[name][1:3])
    return figure, drawn


@case(pictures_coupon.relaxation)
def relaxation(pyplot):
    states = [
        Given(history=xy(numbers(n, high=2.0), numbers(n)), iterations=10 * n) for n in (3, 4)
    ]
    figure = pictures_coupon.relaxation(pyplot, Given(states=states, force_floor=0.1), 1e-3)
    (axes,) = figure.axes
    out, reaction = np.concatenate([state.history for state in states]).T
    ratio, tolerance, *ends = axes.lines
    assert_allclose(ratio.get_xydata(), xy(range(1, 8), out / reaction))
    assert (tolerance.get_label(), tolerance.get_ydata()[0]) == ("tolerance", 1e-3)
    assert [line.get_xdata()[0] for line in ends] == [30, 70]
    return None


@case(pictures_coupon.pull_out)
def coupon_pull_out(pyplot):
    curve = Made(plateau=3.5)
    said = {"sliding": "in slip crossovers", "left": "left by the end crossovers"}
    return pictures_coupon.pull_out(pyplot, curve), curve, said


@case(pictures_records.draw_compression)
def compression(pyplot):
    laws = []
    data = []
    for plies in (1, 4):
        drawn = numbers(5), numbers(5)
        law = Made(6, plies=plies, exponent=0.1 * plies, rms=plies * 1e-6)
        law.curve = lambda drawn=drawn: drawn
        laws.append(law)
        name = f"1 ply n {law.exponent:.2f}" if plies == 1 else f"4 plies n {law.exponent:.2f}"
        data.append({name: {"pressure": drawn[0], "closed": drawn[1], "rms": law.rms}})
    figure = pictures_records.draw_compression(pyplot, laws, "packs")
    data += [{"closed": law.closed, "pressure": law.pressure} for law in laws]
    return figure, data


@case(pictures_records.draw_pull_outs)
def pull_outs(pyplot):
    """Peaks against the number of crossings: points measured, a line computed; of records the loads."""

    def coupon(crossings):
        return Given(crossings=crossings, pre_tension=2.0, changed=coupon)

    tests = [PullOutTest("", "weft", n, 2.0, peak) for n, peak in ((8, 0.9), (8, 1.1), (24, 5.5))]
    groups = [
        Given(coupon=coupon(n), tests=[one for one in tests if one.crossings == n]) for n in (8, 24)
    ]
    friction = Given(
        groups=groups, tests=tests, mu=0.2, computed=lambda one: 0.01 * one.crossings**2
    )
    figure = pictures_records.draw_pull_outs(pyplot, friction, "peaks")
    measured, computed = figure.axes[0].lines
    assert (measured.get_label(), computed.get_label()) == (
        "weft, measured",
        "weft, computed, 2 N",
    )
    assert measured.get_xydata().tolist() == [[8, 0.9], [8, 1.1], [24, 5.5]]
    assert computed.get_ydata()[[0, -1]] == pytest.approx([0.64, 5.76])
    moved = np.linspace(0, 1e-3, 11)
    loaded = PullOutTest("", "weft", 8, 2.0, 1.0, moved + 2e-4, 1e3 * moved)
    alone = Given(coupon=coupon(8), tests=[loaded])
    friction = Given(groups=[alone], tests=[loaded], mu=None)
    line, name = pictures_records.draw_pull_outs(pyplot, friction, "a record").axes[0].lines
    assert line.get_xdata() == pytest.approx(1e3 * moved)
    assert name.get_label() == "8 crossings, weft, 2 N: measured"
    return None


@case(pictures_records.draw_motion)
def motion(pyplot):
    record = Made(bandwidth=25e3)
    computed = Made(3)
    figure = pictures_records.draw_motion(pyplot, record, "a shot", computed)
    data = {
        "time": record.time,
        "record": {"up": 25e3, "less curve": record.measured - record.displacement},
    }
    for name in ("velocity", "force"):
        value, error = getattr(record, name), getattr(record, f"{name}_error")
        data[name] = {
            "record": value,
            "95": np.concatenate([value - error, value + error]),
            "confidence": 0.95,
        }
    data["computed"] = computed
    return figure, data, {"contact_force": "force"}


def response():
    axes = rising(5, 1e-6), rising(6, 1e-6)
    surface = ResponseSurface(*axes, *(numbers(5, 6) for _ in range(5)))
    return surface, lambda name, x, y: getattr(surface, name)[0, 0] * (1 + 1e5 * x + 2e5 * y)


def interpolant():
    surface, evaluate = response()

    class Interpolant:
        def __call__(self, name, x, y):
            return evaluate(name, x, y)

    made = Interpolant()
    made.surface = surface
    return made


@case(pictures_surface.surfaces)
def surfaces(pyplot):
    made = interpolant()
    figure = pictures_surface.surfaces(pyplot, made)
    for axes, (name, title) in zip(figure.axes, pictures_surface.FORCES):
        assert axes.get_title() == f"{title} [N]"
        first = np.array(axes.lines[0].get_data_3d())
        samples = getattr(made.surface, name)
        assert_allclose(first[2], samples[0])
        assert_allclose(first[1], 1e6 * made.surface.d2)
        assert (axes.get_xlabel(), axes.get_ylabel()) == ("d$_1$ [µm]", "d$_2$ [µm]")
    return None


@case(pictures_surface.contours)
def contours(pyplot):
    """Levels of each quantity under its name: limits of the colours are those of its values."""
    made = interpolant()
    figure = pictures_surface.contours(pyplot, made)
    drawn = dict(zip(pictures_surface.FORCES + pictures_surface.HEIGHTS, figure.axes))
    for (name, title), axes in drawn.items():
        factor, unit = (1.0, "N") if name in ("T1", "T2", "F_c") else (1e6, "µm")
        assert axes.get_title(loc="left") == f"{title} [{unit}]"
        x, y = (axis[[0, -1]] for axis in (made.surface.d1, made.surface.d2))
        values = factor * made(name, x[:, None], y[None, :])
        filled = axes.collections[0].norm
        steps = (values.max() - values.min()) / 12
        assert abs(filled.vmin - values.min()) < steps
        assert abs(filled.vmax - values.max()) < steps
    points = figure.axes[5].lines
    found = np.concatenate([line.get_xydata() for line in points])
    a, b = np.meshgrid(1e6 * made.surface.d1, 1e6 * made.surface.d2)
    assert sorted(map(tuple, found)) == sorted(zip(a.ravel(), b.ravel()))
    return None


@case(pictures_surface.slices)
def slices(pyplot):
    surface, _ = response()
    theirs = {name: numbers(5, 6) for name in ("T1", "T2", "F_c")}
    figure = pictures_surface.slices(pyplot, surface, theirs, "own cell")
    for number, axes in enumerate(figure.axes):
        row, column = divmod(number, 3)
        name, title = pictures_surface.FORCES[column]
        along, across = (surface.d1, surface.d2)[:: 1 if row == 0 else -1]
        ours, others = (
            values if row else values.T for values in (getattr(surface, name), theirs[name])
        )
        assert axes.get_title(loc="left") == ("" if row else title)
        assert axes.get_xlabel() == f"d$_{row + 1}$ [µm]"
        for cut, points, line in zip((0, across.size // 2, -1), axes.lines[::2], axes.lines[1::2]):
            assert_allclose(points.get_xydata(), xy(1e6 * along, ours[cut]))
            assert_allclose(line.get_xydata(), xy(1e6 * along, others[cut]))
            assert points.get_label() == f"3D, d$_{2 - row}$ = {1e6 * across[cut]:.0f} µm"
    return None


@case(pictures_surface.energy_map)
def energy_map(pyplot):
    """Strains of warp along x, of weft along y; the mark of a path is at its named state or at its end."""
    warp, weft = np.linspace(0, 0.03, 31), np.linspace(0, 0.02, 21)
    share = np.stack(np.broadcast_arrays(warp[:, None] / 0.025, weft / 0.015), axis=2)
    energy = 1e3 * (warp[:, None] * 40 + weft * 90)
    found = EnergyMap("S-720", warp, weft, energy, share)
    paths = {
        "first": (np.array([0, 0.002, 0.004]), np.array([0, 0.006, 0.007]), 1),
        "second": (np.array([0, 0.011, 0.013]), np.array([0, 0.001, 0.005])),
    }
    figure = pictures_surface.energy_map(pyplot, found, paths)
    axes, bar = figure.axes
    named = {line.get_label(): line.get_xydata() for line in axes.lines}
    assert_allclose(named["first"], [[0.2, 0.6]])
    assert_allclose(named["second"], [[1.3, 0.5]])
    _, *at = found.most
    assert_allclose(named["most energy"], [[100 * strain for strain in at]])
    whole = [line.get_xydata() for line in axes.lines if len(line.get_xdata()) == 3]
    for drawn, (x, y, *_) in zip(whole, paths.values(), strict=True):
        assert_allclose(drawn, 100 * xy(x, y))
    labels = axes.get_xlabel(), axes.get_ylabel(), bar.get_ylabel()
    assert labels[:2] == ("strain along the warp [%]", "strain along the weft [%]")
    assert labels[2] == "energy over the area at rest [kJ/m²]"
    colours = [line.get_color() for line in axes.lines if "strength" in line.get_label()]
    assert colours == [pictures_surface.WARP, pictures_surface.WEFT]
    edges = [
        each
        for each in axes.collections
        if len(each.get_paths())
        and len(each.get_paths()[0].vertices) > 1
        and each.get_linewidth()[0] > 2
    ]
    for drawn, axis, at_strength in zip(edges, (0, 1), (2.5, 1.5)):
        assert_allclose(drawn.get_paths()[0].vertices[:, axis], at_strength, rtol=1e-6)
    return None


@case(pictures_surface.draw_misses)
def misses(pyplot):
    surface, _ = response()
    errors = {name: Given(lines=(numbers(5), numbers(6))) for name in ("T1", "T2", "F_c")}
    data = [{"bound": 3e-4}]
    for number, axis in enumerate((surface.d1, surface.d2)):
        shares = {
            title: errors[name].lines[number] / getattr(surface, name).max()
            for name, title in pictures_surface.FORCES
        }
        data += [{f"left-out line at d {number + 1}": axis}, shares]
    return pictures_surface.draw_misses(pyplot, surface, errors), data


def drawn_shots():
    return tuple(
        table.Shot(v, left, left > 1, n, dict(zip(FRICTIONS, of)), balance=0.0)
        for n, (v, left, of) in enumerate(
            ((80.0, 0.5, (0.11, 0.03)), (90.0, 11.0, (0.23, 0.07)), (95.0, 47.0, (0.29, 0.19)))
        )
    )


FRICTIONS = "friction_between_yarns", "friction_on_nose"


@case(pictures_uncertainty.perforation)
def perforation(pyplot):
    study = Given(shots=drawn_shots(), posterior=posterior_of())
    figure = pictures_uncertainty.perforation(pyplot, study)
    (axis,) = figure.axes
    labels = [line.get_label() for line in axis.lines]
    assert [labels[0], *labels[-2:]] == ["share that passes", "stopped", "perforated"]
    assert list(axis.lines[-2].get_xdata()) == [80.0]
    assert list(axis.lines[-1].get_xdata()) == [90.0, 95.0]
    curve = axis.lines[0].get_xydata()
    assert_allclose(curve[:, 1], study.posterior.share(curve[:, 0]))
    named = [text.get_text().strip() for text in axis.texts]
    assert named == ["V10 82", "V50 88", "V90 97"]
    return None


@case(pictures_uncertainty.draw_passing)
def draw_passing(pyplot):
    unknown = {"friction between yarns": (0.1, 0.3), "friction on the nose": (0.0, 0.2)}
    figure = pictures_uncertainty.draw_passing(pyplot, Given(shots=drawn_shots(), unknown=unknown))
    (axis,) = figure.axes
    stopped, through = axis.lines
    assert_allclose(stopped.get_xydata(), [(0.11, 0.03)])
    assert_allclose(through.get_xydata(), [(0.23, 0.07), (0.29, 0.19)])
    assert [text.get_text() for text in axis.texts] == ["11", "47"]
    assert axis.get_xlabel() == "friction between yarns [-]"
    assert axis.get_ylabel() == "friction on the nose [-]"
    return None


@case(pictures_uncertainty.plies)
def plies_that_stop(pyplot):
    """Of two plies that stop by the model alone and three with what tests say: 9 in 10 is asked for."""
    stops = {"tested": [0.3, 0.6, 0.9, 0.95], "model": [0.5, 0.92, 0.97, 0.99]}
    shares = pd.DataFrame({"fabric": "S-728", "plies": [1, 2, 3, 4]} | stops)
    for name in stops:
        shares = shares.assign(
            **{f"{name}_low": shares[name] - 0.05, f"{name}_high": shares[name] + 0.01}
        )
    ends = {"plies": 3, "plies_low": 2, "plies_high": 5}
    alone = {"plies_by_model": 2, "plies_by_model_low": 1, "plies_by_model_high": 4}
    counts = pd.DataFrame([{"fabric": "S-728"} | ends | alone])
    (axis,) = pictures_uncertainty.plies(pyplot, shares, counts, 0.9).axes
    drawn = {line.get_label(): line.get_xydata() for line in axis.lines}
    for label, name in {
        "with what tests say of the model": "tested",
        "by the model alone": "model",
    }.items():
        assert drawn[label].tolist() == [[n + 1, share] for n, share in enumerate(stops[name])]
    assert [line.get_xdata()[0] for line in axis.lines if line.get_ls() == "--"] == [3, 2]
    assert axis.get_title("left") == "S-728: plies 3 (2 to 5), by the model 2 (1 to 4)"
    return None


@case(pictures_uncertainty.sweep)
def sweep(pyplot):
    table = pd.DataFrame(
        {
            "mass": ["1 g", "2 g", "1 g", "2 g"],
            "v50_m_s": [90.0, 70.0, 130.0, 110.0],
            "v50_low_m_s": [85.0, 62.0, 121.0, 108.0],
            "v50_high_m_s": [96.0, 71.0, 133.0, 117.0],
        }
    )
    x = [1, 1.5, 2, 3]
    figure = pictures_uncertainty.sweep(pyplot, x, "plies", table, ["mass"], QUANTITIES["v50"])
    (axes,) = figure.axes
    found = {bars.get_label(): bars for bars in axes.containers}
    for name, rows in (("mass = 1 g", [0, 2]), ("mass = 2 g", [1, 3])):
        line, _, (bars,) = found[name]
        assert_allclose(line.get_xydata(), xy(np.take(x, rows), table["v50_m_s"][rows]))
        ends = table.loc[rows, ["v50_low_m_s", "v50_high_m_s"]].to_numpy()
        assert_allclose([segment[:, 1] for segment in bars.get_segments()], ends)
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("plies", "V50 [m/s], 90 % interval")
    return None


@case(pictures_shot.histories)
def histories(pyplot):
    record = Made()
    said = {"deflection": "deflection of the back face", "nose_position": "nose of the projectile"}
    return pictures_shot.histories(pyplot, record), record, said


class Pack(Given):
    """Of a record what names its plies."""

    ply_fabrics = ImpactRecord.ply_fabrics
    ply_name = ImpactRecord.ply_name
    which_fabric = ImpactRecord.which_fabric


PACKS = {
    "one ply": [],
    "one fabric": ["S-728"] * 9,
    "two of one ply": ["S-728", "S-726"],
    "two of many": ["S-728"] * 14 + ["S-726"] * 7,
    "between": ["S-728"] * 3 + ["S-726"] * 8 + ["S-728"] * 2,
    "three": ["S-728", "S-726", "S-720", "S-726"],
    "more than the ramps": list("ABCDEFG"),
}


@pytest.mark.parametrize("fabrics", PACKS.values(), ids=PACKS)
def test_each_ply_of_a_hybrid_is_told_by_its_fabric(fabrics):
    """In the legend, by its colour and in words: the front ply and the rear one of each fabric are
    named, no two neighbours of different fabrics are alike, and the words give every ply once."""
    count = len(fabrics) or 1
    columns = {name: numbers(4, count) for name in ("deflection", "push", "energy")}
    record = Pack(time=rising(4, 1e-6), count=count, plies=columns, pack={"ply_fabrics": fabrics})
    with pictures_figure.plots() as pyplot:
        figure = pictures_shot.plies(pyplot, record)
        labels = [text.get_text() for text in figure.axes[0].get_legend().get_texts()]
        drawn = [line.get_label() for line in figure.axes[0].lines]
    hybrid = len(set(fabrics)) > 1
    of_fabric = [f", {name}" for name in fabrics] if hybrid else [""] * count
    assert drawn == [f"ply {k + 1}{of_fabric[k]}" for k in range(count)]
    assert len(labels) <= 6 + 2 * len(set(fabrics))
    if not hybrid:
        assert record.which_fabric == "" == "".join(record.ply_fabrics)
        return
    for name in set(fabrics):
        of_it = [k for k, fabric in enumerate(fabrics) if fabric == name]
        assert f"ply {of_it[0] + 1}, {name}" in labels
        assert f"ply {of_it[-1] + 1}, {name}" in labels
    colours = [to_rgb(colour[:3]) for colour in pictures_shot.shades(fabrics)]
    assert colours == [to_rgb(line.get_color()[:3]) for line in figure.axes[0].lines]
    for one, other in pairwise(colours):
        assert np.abs(np.subtract(one, other)).max() > 0.02
    told = []
    for part in record.which_fabric.split(", "):
        where, _, name = part.rpartition(" ")
        ends = [int(word) for word in where.split() if word.isdigit()]
        told += [name] * (ends[-1] - ends[0] + 1)
    assert told == fabrics


@case(pictures_shot.plies)
def plies(pyplot):
    columns = {name: numbers(4, 3) for name in ("deflection", "push", "energy")}
    record = Pack(
        time=rising(4, 1e-6), count=3, plies=columns, pack={"ply_fabrics": ["A", "B", "A"]}
    )
    figure = pictures_shot.plies(pyplot, record)
    of_ply = {
        f"ply {k + 1} {fabric}": {name: column[:, k] for name, column in columns.items()}
        for k, fabric in enumerate("ABA")
    }
    return figure, {"time": record.time} | of_ply, {"push": "force of the nose"}


@case(pictures_shot.cuts)
def cuts(pyplot):
    """Each row has its lines, the close-up the same and their thickness; z is up."""
    rows = []
    for title in ("first", "second"):
        lines = tuple(xy(np.linspace(1e-3, 9e-3, 5), numbers(5) * 1e-3) for _ in range(2))
        cut = Cut(1e-6, numbers(1)[0] * 1e-3, lines)
        body = np.array([[-1.0, -1.5], [1.0, -2.0], [0.5, 0.0]]) * 1e-3
        thickness = np.array([0.2e-3, 0.5e-3])
        rows.append(pictures_shot.CutView(title, cut, thickness, False, body, ("A", "B")))
    figure = pictures_shot.cuts(pyplot, rows, 5e-3)
    (legend,) = figure.legends
    assert [text.get_text() for text in legend.get_texts()] == ["A, ply 1", "B, ply 2"]
    swatches = [patch.get_facecolor() for patch in legend.get_patches()]
    assert swatches == [line.get_color() for line in figure.axes[0].lines]
    for number, row in enumerate(rows):
        whole, near = figure.axes[2 * number : 2 * number + 2]
        assert whole.get_title(loc="left") == row.title
        for axes in (whole, near):
            for line, drawn in zip(row.cut.lines, axes.lines, strict=True):
                assert_allclose(drawn.get_xydata(), 1e3 * line)
        body = row.projectile + np.array([0, row.cut.nose_position])
        assert_allclose(whole.patches[0].get_xy()[:-1], 1e3 * body)
        # the band of a line, of whose ends the distance is the thickness
        for band, thickness in zip(near.patches[1:], row.thickness, strict=True):
            corners = band.get_xy()
            assert np.linalg.norm(corners[0] - corners[9]) == pytest.approx(1e3 * thickness)
    assert figure.axes[-1].get_xlabel() == "x [mm]"
    assert figure.axes[0].get_ylabel() == "z [mm]"
    return None


@case(pictures_shot.energies)
def energies(pyplot):
    """The height of each band is the energy of its name."""
    parts = [name for name, *_ in pictures.ENERGIES if name not in ("recoil_of_cut_yarns",)]
    known = {name: numbers(4) for name in parts} | {"error": numbers(4)}
    known |= {name: numbers(4) for name in ("formulation_residual", "ply_contact", "ply_friction")}
    record = Given(
        time=rising(4, 1e-6), energies=known, strike_energy=500.0, recoil_of_cut_yarns=0.0
    )
    figure = pictures_shot.energies(pyplot, record)
    top, low = figure.axes
    (legend,) = figure.legends
    wanted = dict(known)
    wanted["yarn_strain"] = known["yarn_strain"] + known["formulation_residual"]
    for name in ("contact", "friction"):
        wanted[name] = known[name] + known[f"ply_{name}"]
    wanted["viscous"] = np.minimum(known["viscous"], known["viscous"][-1])
    wanted["recoil_of_cut_yarns"] = known["viscous"] - wanted["viscous"]
    drawn = [row for row in pictures.ENERGIES if np.any(wanted[row[0]])]
    assert [text.get_text() for text in legend.get_texts()] == [label for _, label, _ in drawn]
    t = 1e6 * record.time
    below = 0.0
    for (name, _, _), band in zip(drawn, top.collections, strict=True):
        corners = band.get_paths()[0].vertices
        heights = [np.ptp(corners[np.isclose(corners[:, 0], at), 1]) for at in t]
        assert_allclose(heights, wanted[name], atol=1e-9)
        below = below + wanted[name]
    assert_allclose(low.lines[0].get_xydata(), xy(t, 100 * known["error"] / 500.0))
    assert (top.get_ylabel(), low.get_ylabel()) == ("energy [J]", "error [%]")
    return None


@case(mismatch.plot)
def law_mismatch(pyplot):
    stretch = 1 + rising(3, 1e-3), 1 + rising(3, 1e-3)
    grids = np.meshgrid(*stretch, indexing="ij")
    inside = np.ones((3, 3), bool)
    found = mismatch.Mismatch(*grids, inside, numbers(2, 3, 3, low=0.01, high=0.05), 0.1, 0.1)
    figure = mismatch.plot(pyplot, found)
    for axes, family, values in zip(figure.axes, ("warp", "weft"), found.difference):
        assert axes.get_title(loc="left") == f"stress along the {family}"
        assert axes.get_xlabel() == "strain along the warp [%]"
        (image,) = axes.collections
        assert_allclose(np.ravel(image.get_array()), 100 * values.ravel())
        corners = image.get_coordinates()
        assert np.ptp(corners[..., 0]) == pytest.approx(150 * np.ptp(stretch[0]), rel=0.5)
    assert figure.axes[0].get_ylabel() == "strain along the weft [%]"
    return None


def reach(patch, axis):
    """From where to where an area reaches along an axis, in data."""
    corners = patch.get_patch_transform().transform_path(patch.get_path()).vertices
    return corners[:, axis].min(), corners[:, axis].max()


@pytest.mark.parametrize("function", DRAWN, ids=lambda f: f"{f.__module__}.{f.__name__}")
def test_what_is_drawn_is_what_its_label_says(function):
    with pictures_figure.plots() as pyplot:
        found = DRAWN[function](pyplot)
    if found is not None:
        figure, data, *more = found
        said, not_drawn = (*more, {}, ())[:2]
        refuse_untold(figure, fields_of(data, SAID | said), not_drawn)


IMAGES = {
    "snapshot",
    "end",
    "end_near",
    "half_way",
    "compose",
    "cut_figure",
}  # of one picture in space, or of `cuts`


def test_no_figure_is_left_out():
    """Every function of the application that draws on `pyplot` is above."""
    known = {(function.__module__, function.__name__) for function in DRAWN}
    for path in ROOT.glob("weavecell/**/*.py"):
        module = ".".join(path.relative_to(ROOT).with_suffix("").parts)
        for node in ast.parse(path.read_text("utf-8")).body:
            if not isinstance(node, ast.FunctionDef) or node.name.startswith("_"):
                continue
            first = [each.arg for each in node.args.args[:1]]
            if first == ["pyplot"] and node.name not in IMAGES:
                assert (module, node.name) in known, f"{module}.{node.name} has no data here"


FAULTS = {
    "exchanged names": {"names": ("tail", "tip")},
    "one line twice": {"drawn": ("tip", "tip")},
    "another unit": {"label": "velocity [mm]"},
    "a number of its own": {"title": "after 7.3 mm"},
    "a line without a name": {"names": ("tip", "_")},
    "x and y exchanged": {"order": -1},
}


@pytest.mark.parametrize("fault", FAULTS.values(), ids=FAULTS)
def test_a_figure_that_tells_something_else_is_refused(fault):
    """One figure that is right, and each way to be wrong."""
    given = Given(time=rising(4, 1e-6), tip=numbers(4), tail=numbers(4), gap=7.2e-3)

    def draw(
        names=("tip", "tail"), drawn=("tip", "tail"), label="velocity [m/s]", title="", order=1
    ):
        with pictures_figure.plots() as pyplot:
            figure, axes = pyplot.subplots()
            for name, field in zip(names, drawn, strict=True):
                points = 1e6 * given.time, getattr(given, field)
                axes.plot(*points[::order], label=name)
            axes.set(xlabel="time [µs]", ylabel=label, title=title or "after 7.2 mm")
            axes.legend()
        refuse_untold(figure, fields_of(given))

    draw()
    with pytest.raises(AssertionError):
        draw(**fault)
