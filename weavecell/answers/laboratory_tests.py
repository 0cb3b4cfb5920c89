"""What the tests of a laboratory say of V50.

The folder of `weavecell reduce tests`
    tests.json           V10, V50, V90, V50 of six shots, Lambert-Jonas fit, provenance
    shots.csv            every test
    tests.svg            residual against strike velocity
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from fabrics.base.frozen import explain_frozen
from weavecell.answers.study_result import DrawnResult

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from weavecell.runs.laboratory_tests import ReducedTests


NAMES = ("tests.json", "shots.csv", "tests.svg")


@explain_frozen
@dataclass(frozen=True, repr=False)
class TestsResult(DrawnResult):
    """Tests of a laboratory; the table has a row a test.

    Parameters
    ----------
    reduced : `weavecell.runs.laboratory_tests.ReducedTests`
    tests : name of their file

    Examples
    --------
    >>> from pathlib import Path
    >>> _ = Path("tests.csv").write_text("velocity [m/s], outcome\\n60, PP\\n80, CP\\n70, CP\\n75, PP\\n")
    >>> wc.reduce_tests("tests.csv").reduced.table.shape
    (4, 3)
    """

    # pytest would take a class of this name for tests
    __test__ = False

    kind = "tests"

    reduced: ReducedTests
    tests: str

    def summary(self) -> dict[str, Any]:
        """Return V10, V50 and V90, V50 of six shots, and the Lambert-Jonas fit, with intervals."""
        return self.reduced.summary() | self._what_is_doubtful()

    def _columns(self):
        return self.reduced.table

    def draw(self, pyplot: Any) -> Figure:
        """Draw residual against strike velocity [m/s]."""
        from weavecell.report import pictures

        return pictures.draw_tests(pyplot, self.tests, self.reduced)

    @property
    def doubts(self) -> tuple[str, ...]:
        """What is doubtful of the tests."""
        return self.reduced.doubts

    _written = NAMES

    def files(self) -> dict[str, Any]:
        """Return {file: what it holds}: V50 and the fit as JSON, a row a test as CSV, and the
        picture."""
        return {
            "tests.json": {"format": "weavecell tests 1", **self.summary()},
            "shots.csv": self.to_csv(),
            "tests.svg": None,
        }

    def lines(self) -> list[str]:
        """Write the lines that are printed, without what is doubtful."""
        return self.reduced.lines(self.tests)
