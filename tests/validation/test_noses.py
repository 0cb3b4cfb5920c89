"""The friction on the nose of a study's shots: none as in the thesis, what users get, or what the file gives."""

import pytest

import weavecell as wc
from fabrics.base.assumed_number import is_assumed
from validation import golden, study
from validation.cases import impact

SHOT = {"fabric": "S-731", "velocity": 140.0, "opening": "60 mm"}


def friction(**keywords):
    """Friction on the nose of a case, and whether it is assumed."""
    found = impact.setup(**SHOT | keywords).projectile.friction
    return float(found), is_assumed(found)


def test_a_nose_of_a_study_has_no_friction_unless_its_file_says_so():
    given = {"name": "FSP 1.10 g", "friction": 0.17}
    assert friction() == (0.0, False)
    assert friction(projectile="FSP 1.10 g") == (0.0, False)
    assert friction(projectile=given) == (0.17, False)
    assert friction(projectile=given, nose_friction="assumed") == (0.17, False)
    assert friction(nose_friction="assumed") == (0.1, True)
    assert friction(nose_friction=0.05) == (0.05, False)


@pytest.mark.parametrize(
    "name",
    [
        "one-ply",
        "published-critical-velocities",
        "pack-limits",
        "pack-mass",
        "pack-angles",
        "panel-plies",
        "panel-mass",
        "panel-angles",
    ],
)
def test_a_study_beside_tests_is_of_the_shots_that_users_get(name):
    row = golden.rows(study.load(name))[0]
    of_search = ("tolerance", "guess", "step", "multiples")
    shot = {key: value for key, value in row.keywords.items() if key not in of_search}
    users = wc.setup(SHOT["fabric"], SHOT["velocity"])  # para-aramid, as those of the studies
    assert impact.setup(**shot).projectile.friction == users.projectile.friction > 0
