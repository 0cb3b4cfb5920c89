"""One run of each command a session, and the key that interrupts a run."""

from contextlib import contextmanager
from functools import partial
from unittest import mock

import pytest

from tests.weavecell.session_runs import make, run_in


@pytest.fixture(scope="session")
def results(shared):
    """The run of a name of `session_runs.RUNS`, made once for all processes of a session."""
    from weavecell.report import pictures

    render = pictures.render

    def drawn(name, folder):
        # its own pictures, whatever `drawn_once` has put there
        with mock.patch.object(pictures, "render", render):
            make(name, folder)

    return lambda name: run_in(shared(f"run-{name}", partial(drawn, name)))


@contextmanager
def interrupted_at(share, least_wall=0.0):
    """The user presses Ctrl-C when `share` of a run is done; checkpoints may be `least_wall` [s] apart."""
    from shellfabric.loop import checkpoint
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


_DRAWN = {}  # pictures of `drawn_once`


@pytest.fixture
def drawn_once(monkeypatch):
    """Draw each kind of picture once a process, whatever it shows: for tests that run a scene many times and look at
    which files there are."""
    from weavecell.report import pictures

    def once(name, draw):
        if name not in _DRAWN:
            _DRAWN[name] = draw()
        return _DRAWN[name]

    render = pictures.render
    monkeypatch.setattr(
        pictures,
        "render",
        lambda draw, *given, kind="svg": once(
            (draw.__module__, draw.__qualname__, kind), lambda: render(draw, *given, kind=kind)
        ),
    )


@pytest.fixture
def interrupted():
    return interrupted_at
