"""Many scenes in processes of their own, which are ended where they take too long or die.

Each process takes one scene after the other through a pipe. A scene whose process is ended by the wall-clock limit is a
"timeout", one whose process dies a "crash"; the others are told by `runs.outcome`.
"""

from __future__ import annotations

import time
from multiprocessing.connection import wait

from fabrics.executors import CONTEXT, one_thread_each

WALL_LIMIT = 300.0  # [s] a scene, kernels compiled in its time
_SCENES_A_PROCESS = 100  # then a fresh one starts, so that memory cannot pile up


def outcomes(function, arguments, *, jobs=2, limit=WALL_LIMIT):
    """Yield (arguments, row) of function(*arguments) as they end; the function returns a dict."""
    waiting, workers = list(reversed(list(arguments))), []
    with one_thread_each():
        try:
            while waiting or any(worker.task is not None for worker in workers):
                for worker in [w for w in workers if w.task is None and (w.done >= _SCENES_A_PROCESS or not w.alive)]:
                    workers.remove(worker)
                    worker.end()
                while len(workers) < min(jobs, len(workers) + len(waiting)):
                    workers.append(_Worker(function))
                for worker in workers:
                    if worker.task is None and waiting:
                        worker.give(waiting.pop())
                busy = [worker for worker in workers if worker.task is not None]
                wait([worker.pipe for worker in busy], timeout=1.0)
                for worker in busy:
                    found = worker.look(limit)
                    if found is not None:
                        yield found
        finally:
            for worker in workers:
                worker.end()


class _Worker:
    """One process and the task that it is at."""

    def __init__(self, function):
        self.pipe, other = CONTEXT.Pipe()
        self.process = CONTEXT.Process(target=_serve, args=(other, function), daemon=True)
        self.process.start()
        other.close()
        self.task, self.done, self.began = None, 0, 0.0

    @property
    def alive(self):
        return self.process.is_alive()

    def give(self, task):
        self.task, self.began = task, time.monotonic()
        self.pipe.send(task)

    def look(self, limit):
        """(task, row) if the task has ended, else None."""
        task, row = self.task, None
        try:
            if self.pipe.poll():
                row = self.pipe.recv()
        except EOFError:
            self.process.join()
            row = {"outcome": "crash", "message": f"the process ended with exit code {self.process.exitcode}"}
        if row is None and time.monotonic() - self.began > limit:
            self.process.kill()
            self.process.join()
            row = {"outcome": "timeout", "message": f"ended after {limit:g} s"}
        if row is None:
            return None
        self.task, self.done = None, self.done + 1
        return task, row

    def end(self):
        self.pipe.close()
        if self.process.is_alive():
            self.process.terminate()
        self.process.join()


def _serve(pipe, function):
    while True:
        try:
            task = pipe.recv()
        except EOFError:
            return
        pipe.send(function(*task))
