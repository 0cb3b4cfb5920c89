"""Tests of a laboratory."""

from __future__ import annotations

from fabrics.base.checks import FilePath
from weavecell.answers.laboratory_tests import NAMES, TestsResult
from weavecell.answers.result import save_to
from weavecell.api.entrance import public
from weavecell.results import out_folder


@public
@out_folder.reading
def reduce_tests(tests: FilePath, *, out: FilePath | None = None) -> TestsResult:
    """Reduce the shots of a laboratory: V10, V50 and V90, V50 of six shots (MIL-STD-662F), and the fit
    of Lambert and Jonas to the residual velocities, with intervals.

    TESTS has a row a shot, and the columns velocity, outcome (PP or CP, or stopped or perforated)
    and, where it was measured, residual velocity, each speed with its unit in the heading:
    "velocity [m/s]". `v50` computes the same numbers of a panel.

    Parameters
    ----------
    tests : table of tests (``*.csv``), a row a shot
    out : folder of the results; in Python None writes nothing

    Returns
    -------
    TestsResult

    Raises
    ------
    InputError : a wrong table

    Examples
    --------
    >>> from pathlib import Path
    >>> _ = Path("tests.csv").write_text("velocity [m/s], outcome\\n60, PP\\n80, CP\\n70, CP\\n75, PP\\n")
    >>> round(wc.reduce_tests("tests.csv").reduced.v50)  # [m/s]
    72
    """
    from weavecell.runs import laboratory_tests as studies

    fired = studies.read(tests)
    with out_folder.hold(out, NAMES) as folder:
        return save_to(TestsResult(studies.reduce(fired), str(tests)), folder)
