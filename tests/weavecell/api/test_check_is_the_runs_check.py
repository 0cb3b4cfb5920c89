"""What a run refuses before it computes, its forecast (`check`) refuses in the same words: each option of
each study, each key of a scene."""

import pytest

import weavecell as wc
from fabrics.base.errors import InputError

SMALL = {"opening": "30 mm", "end_time": "10 us"}
WRONG = [0, -1, 1.5, "20", None, True, float("nan"), "slurm", "", [], object()]
OPTIONS = {
    "v50": [
        "shots",
        "batch",
        "seed",
        "jobs",
        "executor",
    ],
    "critical_velocity": [
        "tolerance",
        "residual_shots",
        "jobs",
        "executor",
    ],
}
TABLES = [
    {"history": {"interval": "1 us", "warp": ["500 mm"]}},
    {"history": {"interval": "1 us", "plies": [3]}},
    {"snapshot_interval": "0 us"},
    {"plies": 10**9},
    {"yarn_failure": False},
    {"strength": {"shape": 5, "seed": 2}},
]


class Computed(Exception):
    """Something is computed."""


@pytest.fixture
def not_computed(monkeypatch):
    def computed(*_, **__):
        raise Computed

    for where in (
        "weavecell.runs.v50.study",
        "weavecell.studies.limit.search",
        "shellfabric.impact.run._run_recorded",
        "shellfabric.impact.run._make_solver",
        "fabrics.base.run_cache.results",
    ):
        monkeypatch.setattr(where, computed)


def answer(function, *arguments, **options):
    """What is raised as text; "" if something is computed, or a forecast returned."""
    try:
        function(*arguments, **options)
    except Computed:
        return ""
    except InputError as problem:
        return str(problem)
    return ""


@pytest.mark.parametrize("name, option", [(name, key) for name in OPTIONS for key in OPTIONS[name]])
def test_options_of_a_study(not_computed, name, option):
    for value in WRONG:
        given = {option: value} | SMALL
        run = answer(getattr(wc, name), "S-720", **given)
        assert answer(getattr(wc, name), "S-720", check=True, **given) == run, value


@pytest.mark.parametrize("table", TABLES, ids=lambda table: next(iter(table)))
@pytest.mark.parametrize("name", ["impact", "v50", "critical_velocity"])
def test_keys_of_a_scene(not_computed, name, table):
    velocity = ("90 m/s",) if name == "impact" else ()
    given = SMALL | table
    run = answer(getattr(wc, name), "S-720", *velocity, **given)
    assert answer(getattr(wc, name), "S-720", *velocity, check=True, **given) == run
    if table.keys() <= {"history", "plies"} and name == "impact":
        assert run


@pytest.mark.parametrize("quantity", ["shot", "critical-velocity", "v50"])
@pytest.mark.parametrize(
    "option", ["over", "quantity", "tolerance", "shots", "seed", "jobs", "executor"]
)
def test_options_of_a_sweep(not_computed, quantity, option):
    over = {"panel.opening": ["30 mm"], "run.end_time": ["10 us"]}
    if quantity == "shot":
        over["projectile.strike_velocity"] = ["90 m/s"]
    for value in WRONG:
        given = {"over": over, "quantity": quantity} | {option: value}
        if option == "over":
            given["over"] = over | {"panel.plies": value}
        run = answer(wc.sweep, "S-720", **given)
        assert answer(wc.sweep, "S-720", check=True, **given) == run, value


@pytest.mark.parametrize("quantity", ["v50", "critical-velocity"])
@pytest.mark.parametrize("option", ["quantity", "tolerance", "shots", "seed", "jobs", "executor"])
def test_options_of_a_comparison(not_computed, quantity, option):
    for value in WRONG:
        given = {"quantity": quantity} | {option: value} | SMALL
        run = answer(wc.compare, "S-720", "S-728", **given)
        assert answer(wc.compare, "S-720", "S-728", check=True, **given) == run, value
