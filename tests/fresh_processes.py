"""Processes that have numba loaded and nothing of a test, as a new Python would have after two seconds.

They are forks of one process, the server, which has compiled one kernel of its own: each knows what the server knows,
and nothing of those before it.
"""

import json
import os
import subprocess
import sys
import tempfile
import traceback
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[1]


class Ended(NamedTuple):
    """How a process ended: its exit code, and what it printed."""

    code: int
    out: str
    err: str


class FreshProcesses:
    """The server, as those see it who have code run in its forks."""

    def __init__(self):
        variables = {"PATH": "/usr/bin", "PYTHONPATH": str(ROOT), "PYTHONHASHSEED": "1"}
        self.server = subprocess.Popen(
            [sys.executable, "-m", "tests.fresh_processes"],
            env=variables,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )

    def run(self, code, *words, folder, cache=""):
        """Run Python code as `python -c CODE WORDS` would in a folder whose packages it imports.

        cache : NUMBA_CACHE_DIR, beside the source if there is none
        """
        order = {"code": code, "words": words, "folder": str(folder), "cache": str(cache)}
        print(json.dumps(order), file=self.server.stdin, flush=True)
        return Ended(*json.loads(self.server.stdout.readline()))

    def close(self):
        """End the server."""
        self.server.stdin.close()
        self.server.wait()


def serve():
    """Run what is asked for, line by line, each in a fork."""
    import numba

    import shellfabric.jit.compile  # noqa: F401 - loaded once for all

    numba.njit(lambda x: x + 1)(1.0)
    for line in sys.stdin:
        with tempfile.TemporaryFile("w+") as out, tempfile.TemporaryFile("w+") as err:
            child = os.fork()
            if child == 0:
                _run(json.loads(line), out, err)
            _, status = os.waitpid(child, 0)
            told = []
            for file in (out, err):
                file.seek(0)
                told.append(file.read())
        print(json.dumps([os.waitstatus_to_exitcode(status), *told]), flush=True)


def _run(order, out, err):
    """Run the code in this process, and end it."""
    import numba

    code = 1
    try:
        os.dup2(out.fileno(), 1)
        os.dup2(err.fileno(), 2)
        os.chdir(order["folder"])
        os.environ["NUMBA_CACHE_DIR"] = numba.config.CACHE_DIR = order["cache"]
        # a source that is changed within a second is compiled again
        sys.dont_write_bytecode = True
        sys.path.insert(0, order["folder"])
        sys.argv = ["-c", *order["words"]]
        exec(order["code"], {"__name__": "__main__"})
        code = 0
    except BaseException:
        traceback.print_exc()
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(code)


if __name__ == "__main__":
    serve()
