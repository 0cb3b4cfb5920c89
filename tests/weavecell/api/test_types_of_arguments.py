"""Every public function takes what its docstring says and refuses the rest in a line: values of all kinds
for each parameter of each function, which are found from the signatures."""

import inspect
from dataclasses import FrozenInstanceError, fields, is_dataclass, replace
from decimal import Decimal
from fractions import Fraction
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import weavecell as wc
from fabrics.base.errors import InputError
from fabrics.base.values import plain
from tests import commands
from weavecell import api
from weavecell.answers.result import Result
from weavecell.api import command, entrance
from weavecell.api.execution import ResumableKeywords
from weavecell.api.keywords import Keywords
from weavecell.report import installed
from weavecell.studies import ballistic_limit

ROOT = Path(__file__).parents[3]
SMALL = {"opening": "26 mm", "end_time": "12 us"}
PEAKS = "peak load [N]\n1.3\n1.2\n"
SHOTS = "velocity [m/s], outcome\n90, PP\n124, CP\n105, CP\n112, PP\n"
# the least that each function takes; of a command without a row it is its example
LEAST = {
    "biaxial": ("S-720",),
    "calibrate": ("S-720", {"mesh": "coarse"}),
    "compare": ("S-720", "S-728", SMALL),
    "coupon": ("S-720", "picture_frame", {"shear_angle": "4 deg"}),
    "critical_velocity": ("S-720", {"opening": "26 mm"}),
    "crossover.biaxial": ("S-720", {"end_displacement": "0.02 mm"}),
    "crossover.path": ("S-720", {"path": ROOT / "examples/crossover-path.csv"}),
    "crossover.platens": ("S-720",),
    "crossover.pull_out": ("S-720",),
    "crossover.shear": ("S-720",),
    "crossover.yarn": ("S-720",),
    "impact": ("S-720", "140 m/s", SMALL),
    "mesh": ("S-720",),
    "plies": ("S-720", {"stop": "FSP 1.10 g", "at": "250 m/s", "opening": "40 mm"}),
    "reduce_pull_out": ("S-728", "peaks.csv", {"crossings": 10}),
    "reduce_tests": ("tests.csv",),
    "run": (wc.draw("S-720", 2, velocity="140 m/s", **SMALL),),
    "surface": ("S-720",),
    "sweep": ("S-720", {"over": {"projectile.strike_velocity": ["90 m/s", "140 m/s"]}}),
    "v50": ("S-720", {"opening": "26 mm", "shots": 8}),
}
# what has no plan: computed at once
AT_ONCE = {
    "cite": ("S-720",),
    "draw": ("S-720", 2, {"velocity": "140 m/s", **SMALL}),
    "export": ("S-720", "lsdyna", "deck"),
    "fabric": ("S-720",),
    "fabrics": (),
    "backings": (),
    "load": ("none",),
    "measure_first": ("none",),
    "metals": (),
    "new_fabric": ("none.txt",),
    "new_shot": ("none.txt",),
    "projectiles": (),
    "reduce_compression": ("none.csv", {"platen_area": "361 mm^2"}),
    "reduce_shot": ("none.csv", {"mass": "3 g"}),
    "setup": ("S-720", "140 m/s", SMALL),
    "show": ("S-720",),
    "view": ("none",),
}
ODD = [True, object(), b"x", 2j, float("nan"), [], {}, "", Decimal("NaN"), pd.Series([1.5, np.nan])]


def fire(setup, velocity, time, stops_below=0.0):
    """An invented shot; nothing stops it above 104 m/s."""
    residual = max(velocity**2 - 104.0**2, 0.0) ** 0.5
    outcome = "perforated" if residual else "stopped"
    return ballistic_limit.Shot(velocity, residual, outcome, 1e-4, 3.0, (90.0, 70.0), 0.003, 0.5)


def list_functions():
    """{name: function} of all public functions, those of `crossover` too."""
    found = {}
    for name in dir(api):
        value = getattr(api, name)
        if inspect.isfunction(value):
            found[name] = value
    for name, value in vars(api.crossover).items():
        if inspect.isfunction(value) and hasattr(value, "plan"):
            found[f"crossover.{name}"] = value
    return found


FUNCTIONS = list_functions()
WALKED = sorted(set(FUNCTIONS) - {"overlay", "read_docstring"})


def list_parameters(function):
    """Its own parameters and, where it takes them, those of how runs are computed."""
    parameters = inspect.signature(function).parameters
    own = [name for name, one in parameters.items() if one.kind is not one.VAR_KEYWORD]
    more = ResumableKeywords.__annotations__ if len(own) < len(parameters) else ()
    return [name for name in dict.fromkeys([*own, *more]) if name != "check"]


def call(name, changed):
    """Plan, or call, a function with the least that it takes and some parameters changed."""
    function = FUNCTIONS[name]
    rows = LEAST | AT_ONCE
    row = rows[name] if name in rows else (commands.example(commands.WORDS[name]),)
    *arguments, given = (*row, {})
    if arguments and isinstance(arguments[-1], dict):
        given = arguments.pop()
    named = dict(zip(inspect.signature(function).parameters, arguments))
    given = {**named, **given, **changed}
    if hasattr(function, "plan"):
        taken = {
            key: given.pop(key) for key in ("jobs", "executor", "out", "resume") if key in given
        }
        own = inspect.signature(function.plan).parameters
        command.Execution(**taken)
        return function.plan(**given, **{key: taken[key] for key in taken if key in own})
    return function(**given)


def test_every_function_is_walked():
    assert {*LEAST, *AT_ONCE, *commands.WORDS} >= set(WALKED)
    for name in WALKED:
        assert FUNCTIONS[name].takes is entrance.take, name


def refused(name, parameter, value):
    """Whether a value is refused in a line that names it; any other exception is raised."""
    try:
        call(name, {parameter: value})
    except InputError as problem:
        return "\n" not in str(problem)
    return False


def kinds_of(function, parameter):
    """The annotation of a parameter."""
    if parameter in inspect.signature(function).parameters:
        return str(inspect.signature(function).parameters[parameter].annotation)
    return ResumableKeywords.__annotations__.get(parameter, "").__forward_arg__


@pytest.mark.parametrize("name", WALKED)
def test_values_of_all_kinds_are_refused_in_a_line(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("tests.csv").write_text(SHOTS)
    Path("peaks.csv").write_text(PEAKS)
    taken = []
    for parameter in list_parameters(FUNCTIONS[name]):
        kinds = kinds_of(FUNCTIONS[name], parameter)
        for value in ODD:
            asks_nothing = isinstance(value, list) and "list[str]" in kinds
            if (value is True and "bool" in kinds) or asks_nothing:
                continue
            if not refused(name, parameter, value):
                taken.append((parameter, value))
    assert taken == []
    assert {path.name for path in tmp_path.iterdir()} == {"tests.csv", "peaks.csv"}


def test_keywords_of_a_set_up_of_all_kinds():
    taken = []
    for key in Keywords.__annotations__:
        for value in ODD:
            is_flag = value is True and "bool" in Keywords.__annotations__[key].__forward_arg__
            if isinstance(value, (list, dict)) or is_flag:
                continue
            if not refused("setup", key, value):
                taken.append((key, value))
    assert taken == []


@pytest.mark.parametrize(
    "given, meant",
    [
        (Decimal("0.026"), 0.026),
        (Decimal("2"), 2),
        (Fraction(13, 500), 0.026),
        (Fraction(4, 2), 2),
        (np.float64(0.026), 0.026),
        (np.int64(3), 3),
        (np.array(0.026), 0.026),
        (np.bool_(True), True),
        (np.array([2, 5]), [2, 5]),
        (pd.Series([0.5, 1.5]), [0.5, 1.5]),
        ({"mass": Decimal("0.003")}, {"mass": 0.003}),
        ((Fraction(1, 4), "2 mm"), (0.25, "2 mm")),
        (True, True),
        ("92.5 m/s", "92.5 m/s"),
    ],
)
def test_numbers_of_any_library(given, meant):
    found = plain(given)
    assert found == meant
    assert type(found) is type(meant)


def test_a_set_up_of_numbers_of_any_library():
    usual = wc.setup("S-720", 92.5, opening=0.026, plies=2, ply_friction=0.25, end_time=12e-6)
    other = wc.setup(
        Path("S-720"),
        Decimal("92.5"),
        opening=Fraction(13, 500),
        plies=np.int64(2),
        ply_friction=np.array(0.25),
        end_time=Decimal("12e-6"),
    )
    assert other == usual
    with pytest.raises(InputError, match="opening = True"):
        wc.setup("S-720", 92.5, opening=np.bool_(True))


def list_frozen():
    """Classes of results, of set-ups, and of what stands in a set-up."""
    import shellfabric.impact.setup as setups

    waiting, kinds = [Result], {setups.ImpactSetup, api.Citations}
    while waiting:
        for kind in waiting.pop().__subclasses__():
            waiting.append(kind)
            if is_dataclass(kind) and kind.__module__.startswith("weavecell"):
                kinds.add(kind)
    whole = wc.setup(
        "S-720",
        92.5,
        opening="40 mm",
        symmetry="whole",
        plies=2,
        backing="gelatine 10 %",
        history={"interval": "1 us"},
        strength={"weibull_shape": 14.0, "seed": 3},
    )
    for name in ("fabric", "projectile", "backing", "history", "strength", "numerics"):
        kinds.add(type(getattr(whole, name)))
    return sorted(kinds, key=lambda kind: kind.__name__)


def test_an_attribute_that_does_nothing_cannot_be_set():
    kinds = list_frozen()
    assert len(kinds) > 25
    for kind in kinds:
        one = object.__new__(kind)
        name = next(entry.name for entry in fields(kind) if entry.init)
        with pytest.raises(FrozenInstanceError, match=f"replace.*{name}="):
            setattr(one, name, 3)
        with pytest.raises(FrozenInstanceError, match=f"has no xqz; it has .*{name}"):
            one.xqz = 3
        with pytest.raises(FrozenInstanceError):
            del one.xqz


def test_a_mistyped_attribute_is_told_what_it_may_mean():
    setup = wc.setup("S-720", 92.5, **SMALL)
    with pytest.raises(FrozenInstanceError, match="no plie, did you mean plies"):
        setup.plie = 2
    with pytest.raises(FrozenInstanceError, match="areal_density cannot be set: it fol"):
        setup.areal_density = 0.3
    assert replace(setup, plies=2).plies == 2


@pytest.mark.filterwarnings("ignore::weavecell.DoubtfulResult")
def test_results_are_arguments(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    # no pictures, which take longer than the rest
    monkeypatch.setattr(installed, "can_draw", lambda: False)
    shot = wc.impact("S-720", "140 m/s", **SMALL)
    assert shot.folder is None
    with pytest.raises(InputError, match="a result that was written"):
        wc.load(shot)
    with pytest.raises(InputError, match="two results of v50"):
        wc.compare(shot, shot)
    cited = wc.cite(shot)
    assert [row.number for row in cited.sources if row.of == "S-720"]
    assert cited.sources == wc.cite(shot.target.setup).sources
    shot.save("there")
    assert shot.folder == Path("there")
    assert wc.load(shot).residual_velocity == wc.load(shot.folder).residual_velocity
    assert wc.load(shot).folder == Path("there")
    # a changed result stands in no folder
    assert replace(shot, assumed=()).folder is None
    assert set(wc.cite(shot).sources) >= set(cited.sources)


def test_a_sweep_of_one_set_up():
    setup = wc.setup("S-720", 92.5, **SMALL)
    over = {
        "panel.opening": ["26 mm", Decimal("0.03")],
        "projectile.mass": ["3 g"],
        "projectile.strike_velocity": [140],
        "modulus": [1.1],
    }
    made = wc.sweep.plan(setup, over=over)
    assert [panel.setup.opening for panel in made.panels] == pytest.approx([0.026, 0.03])
    first = made.panels[0].setup
    assert (first.projectile.mass, first.strike_velocity) == (3e-3, 140.0)
    assert first.end_time == setup.end_time
    modulus = setup.fabric.weave.warp.E
    assert first.fabric.weave.warp.E == pytest.approx(1.1 * modulus, rel=1e-12)


@pytest.mark.parametrize(
    "key, value, words",
    [
        ("panel.opening", "26 s", "must be a length|side"),
        ("projectile.name", "FSP 1.10 g", "left out of a sweep over a set-up"),
        ("panel.crossovers", "yarns", "left out of a sweep over a set-up"),
        ("panel.plies", 2.5, "a whole number"),
        ("panel.plies", True, "a whole number"),
    ],
)
def test_a_sweep_of_one_set_up_refuses_what_it_cannot_vary(key, value, words):
    with pytest.raises(InputError, match=words):
        wc.sweep.plan(wc.setup("S-720", 92.5, **SMALL), over={key: [value]})


def test_a_fabric_is_swept_as_by_its_name():
    over = {"projectile.strike_velocity": ["90 m/s", "140 m/s"], "panel.opening": ["26 mm"]}
    by_name = wc.sweep.plan("S-720", over=over)
    by_object = wc.sweep.plan(wc.fabric("S-720"), over=over)
    for named, given in zip(by_name.panels, by_object.panels):
        assert replace(given.setup, snapshot_interval=named.setup.snapshot_interval) == named.setup
