"""Processes of our own: one thread each whatever the program has, and its environment is as before."""

import os
from concurrent.futures import ThreadPoolExecutor

from fabrics.workers import THREADS, workers


def test_processes_have_one_thread_each(monkeypatch):
    monkeypatch.setenv(THREADS[0], "7")
    monkeypatch.delenv(THREADS[-1], raising=False)
    before = dict(os.environ)
    with workers(None, 1) as pool:
        assert {pool.submit(os.getenv, name).result() for name in THREADS} == {"1"}
    assert dict(os.environ) == before


def test_a_given_executor_is_used_and_left_open():
    with ThreadPoolExecutor(1) as given:
        with workers(given, 5) as pool:
            assert pool is given
        assert given.submit(int, "3").result() == 3
