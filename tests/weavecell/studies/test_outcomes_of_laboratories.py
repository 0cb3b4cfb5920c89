"""Tables of tests as laboratories write outcomes and headings: one reading, or one line."""

import pytest

from fabrics.base.errors import InputError
from weavecell.runs import laboratory_tests

READ = ["stopped", "perforated", "perforated"]
# heading of the outcome: cells of a stop and two perforations
FORMS = {
    "outcome": ("PP", "CP", "cp"),
    "Outcome": ("stop", "perforation", "through"),
    "Result": ("partial", "complete", "Complete"),
    "perforated": ("no", "yes", "Yes"),
    "PERFORATED": ("0", "1", "1"),
    "Perforation": ("n", "y", "Y"),
    "Complete penetration": ("false", "true", "TRUE"),
    "stopped": ("yes", "no", "No"),
    " Stopped ": ("y", "n", "n"),
    "Partial penetration": ("1", "0", "0"),
}


def write(path, heading, cells, velocity="velocity [m/s]"):
    rows = "\n".join(f"{v}, {cell}" for v, cell in zip((100, 120, 140), cells))
    path.write_text(f"{velocity}, {heading}\n{rows}\n")
    return path


@pytest.mark.parametrize("heading", FORMS)
def test_outcomes_are_read_in_any_form(heading, tmp_path):
    table = laboratory_tests.read(write(tmp_path / "t.csv", heading, FORMS[heading]))
    assert table["outcome"].tolist() == READ


@pytest.mark.parametrize(
    "velocity", ["Vs [m/s]", "V_s (m/s)", "Muzzle velocity [m/s]", "VELOCITY in m/s"]
)
def test_headings_of_the_velocity(velocity, tmp_path):
    path = write(tmp_path / "t.csv", "outcome", FORMS["outcome"], velocity)
    assert laboratory_tests.read(path)["velocity"].tolist() == [100.0, 120.0, 140.0]


@pytest.mark.parametrize("heading", ["outcome", "result", "penetration"])
@pytest.mark.parametrize("cells", [("0", "1", "1"), ("no", "yes", "yes")])
def test_yes_of_what_is_asked(heading, cells, tmp_path):
    """A penetration may be a partial one: a wrong reading is worse than none."""
    with pytest.raises(InputError, match=r"stands below a heading that says of what") as caught:
        laboratory_tests.read(write(tmp_path / "t.csv", heading, cells))
    assert caught.value.key == "line 2, outcome"
