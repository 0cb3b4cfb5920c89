"""One run of each command a session, and the key that interrupts a run."""

from contextlib import contextmanager
from unittest import mock

import pytest

from tests.weavecell.session_runs import made


@pytest.fixture(scope="session")
def results(tmp_path_factory, worker_id):
    """The run of a name of `session_runs.RUNS`, made once for all processes of a session."""
    base = tmp_path_factory.getbasetemp()
    shared = base if worker_id == "master" else base.parent
    return lambda name: made(name, shared / f"run-{name}")


@contextmanager
def interrupted_at(share, least_wall=0.0):
    """The user presses Ctrl-C when `share` of a run is done; checkpoints may be `least_wall` [s] apart."""
    from shellfabric.output import checkpoint
    from weavecell.results import progress

    def advance(done, _text=""):
        if done >= share:
            raise KeyboardInterrupt

    @contextmanager
    def bar(*_, **__):
        yield advance

    with (
        mock.patch.object(progress, "bar", bar),
        mock.patch.object(checkpoint, "LEAST_WALL", least_wall),
    ):
        yield


@pytest.fixture
def interrupted():
    return interrupted_at
