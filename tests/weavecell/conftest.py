"""One run of each command a session."""

import pytest

from tests.weavecell.session_runs import made


@pytest.fixture(scope="session")
def results(tmp_path_factory, worker_id):
    """The run of a name of `session_runs.RUNS`, made once for all processes of a session."""
    base = tmp_path_factory.getbasetemp()
    shared = base if worker_id == "master" else base.parent
    return lambda name: made(name, shared / f"run-{name}")
