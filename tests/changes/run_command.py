"""The command prints the mass, its help and the list of commands name it, and what is tested of every command holds of
it without a row of its own."""

import contextlib
import io
import sys
from pathlib import Path

import pytest

import weavecell as wc
from weavecell.cli import app

# the tests are those of the checkout, the packages those of the copy that is run in
sys.path.insert(1, str(Path(__file__).parents[2]))
from tests.installed import test_wheel
from tests.weavecell.api import test_command, test_types_of_arguments
from tests.weavecell.golden_texts import test_eight_lines
from tests.weavecell.results import test_nothing_is_overwritten


def printed(*words):
    """What a command prints."""
    with contextlib.redirect_stdout(io.StringIO()) as out, contextlib.suppress(SystemExit):
        app.main(list(words))
    return out.getvalue()


assert "1012" in str(wc.weigh("S-720", plies=4))
assert "1012" in printed("weigh", "S-720", "--plies", "4")
assert "Weigh plies" in printed("--help")
assert "weigh S-720 --plies 4" in printed("weigh", "--help")
assert test_wheel.OTHERS == ["weigh S-720 --plies 4"]
test_command.test_all_that_compute_have_a_plan_and_a_check()
test_eight_lines.test_every_command_is_among_them()
test_nothing_is_overwritten.test_the_walk_has_every_command()
test_types_of_arguments.test_every_function_is_walked()
for parameter in ("fabric", "plies"):
    for value in test_types_of_arguments.ODD:
        assert test_types_of_arguments.refused("weigh", parameter, value), (parameter, value)
with pytest.raises(wc.InputError, match="plies"):
    wc.weigh("S-720", plies=2.5)
