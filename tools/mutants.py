"""Do the tests find planted defects? Each of `mutants.toml` is planted in a copy of the tree, and tests are run.

    nice python tools/mutants.py --out results/mutants.csv [--suite] [--slow] [--only ID ...] [--check]
    nice python tools/mutants.py --out results/drawn.csv --draw 40 --seed 1   # drawn from the code, `draw_mutants`

The copy is a git worktree of a commit that is kept: a file is changed, and put back with its time of change,
so that compiled kernels, which are lent to it, stay valid. The tests of a defect run one path after the
other, each in a process of its own, until one fails. A line is added to the CSV file for each defect; those
that have one are skipped. A defect counts only if the test that finds it passes without it: `--check`.
"""

from __future__ import annotations

import argparse
import contextlib
import csv
import importlib
import os
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import tomllib
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import NoReturn

import draw_mutants
import pytest

ROOT = Path(__file__).parents[1]
COLUMNS = ("id", "file", "outcome", "test", "paths", "cpu_s", "wall_s", "commit")
FAILED = re.compile(r"^(?:FAILED|ERROR) (\S+(?:\[.*?\])?)", re.MULTILINE)
LIBRARIES = (
    "numba",
    "scipy.stats",
    "scipy.optimize",
    "pandas",
    "matplotlib.figure",
    "pydantic",
    "h5py",
)
NOTHING_COLLECTED, NO_SUCH_PATH = 5, 4  # exit codes of pytest
STOPPED = (
    signal.SIGINT,
    signal.SIGTERM,
    signal.SIGKILL,
)  # by someone else: nothing that a defect does


def copy_of_tree(folder: Path, commit: str) -> str:
    """Make a worktree of a commit at `folder`, or bring it up to date; return the commit's full
    name."""
    commit = git(ROOT, "rev-parse", commit)
    if folder.exists():
        git(folder, "checkout", "--quiet", "--force", "--detach", commit)
    else:
        git(ROOT, "worktree", "add", "--quiet", "--detach", str(folder), commit)
    return commit


def git(folder: Path, *words: str) -> str:
    """Return what git prints; its errors go on to stderr."""
    return subprocess.run(
        ["git", "-C", folder, *words], check=True, stdout=subprocess.PIPE, text=True
    ).stdout.strip()


@contextmanager
def planted(file: Path, text: str, replacement: str) -> Iterator[None]:
    """Replace `text`, which must stand once in `file`; afterwards the file and its time of change are as before."""
    whole, stamp = file.read_text(), file.stat()
    if whole.count(text) != 1:
        raise SystemExit(f"{file}: {text!r} stands there {whole.count(text)} times, must be once")
    try:
        file.write_text(whole.replace(text, replacement))
        yield
    finally:
        file.write_text(whole)
        os.utime(file, ns=(stamp.st_atime_ns, stamp.st_mtime_ns))


def lend_kernels(folder: Path) -> None:
    """Copy compiled kernels into the copy of the tree: they are found by what they are made of."""
    for kernels in ROOT.glob("*/__pycache__/kernels-*"):
        place = folder / kernels.relative_to(ROOT)
        if not place.exists():
            shutil.copytree(kernels, place)


def load_libraries() -> None:
    """Import what most tests need besides this project, once for all processes that are forked."""
    for name in LIBRARIES:
        with contextlib.suppress(ImportError):
            importlib.import_module(name)


def run_tests(folder: Path, words: Sequence[str], seconds: float) -> tuple[int | None, str]:
    """Run pytest in the copy of the tree: (its exit code, its output); None if it took longer than
    `seconds`. The process is a fork of this one, which has loaded the libraries."""
    room = folder.with_suffix(".tmp")  # where processes that compile lock each other out
    room.mkdir(exist_ok=True)
    options = ["-x", "-q", "-n", "0", "-p", "no:cacheprovider", *words]
    with tempfile.TemporaryFile() as output:
        child = os.fork()
        if child == 0:
            _be_pytest(folder, room, options, output.fileno())
        end = time.monotonic() + seconds
        try:
            while not (ended := os.waitpid(child, os.WNOHANG))[0]:
                if time.monotonic() > end:
                    return None, ""
                time.sleep(0.05)
        finally:
            if not ended[0]:  # with all that it has started
                os.killpg(child, signal.SIGKILL)
                os.waitpid(child, 0)
        output.seek(0)
        text = output.read().decode(errors="replace")
    code = os.waitstatus_to_exitcode(ended[1])
    if code == NO_SUCH_PATH or -code in STOPPED:
        raise SystemExit(text or f"pytest was stopped by signal {-code}")
    return code, text


def _be_pytest(folder: Path, room: Path, options: list[str], output: int) -> NoReturn:
    """Go on as pytest in the copy of the tree, and end."""
    os.setsid()
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    for stream in (1, 2):
        os.dup2(output, stream)
    os.chdir(folder)
    os.environ |= {"PYTHONPATH": str(folder), "TMPDIR": str(room)}
    tempfile.tempdir = None
    ours = {"", str(ROOT), str(ROOT / "tools")}
    sys.path[:] = [str(folder), *(path for path in sys.path if path not in ours)]
    sys.argv[:] = ["pytest"]
    code = 1
    try:
        code = int(pytest.main(options))
        sys.stdout.flush()
        sys.stderr.flush()
    finally:
        os._exit(code)


def outcome(
    folder: Path, paths: Sequence[str], marks: Sequence[str], seconds: float
) -> tuple[str, str, int]:
    """Run the tests of a mutant: ("killed", "survived" or "timeout", the test that failed, paths
    that were run)."""
    end, runs = time.monotonic() + seconds, [(mark, path) for mark in marks for path in paths]
    for count, (mark, path) in enumerate(runs, 1):
        before = [f"--ignore={known}" for _, known in runs[: (count - 1) % len(paths)]]
        code, output = run_tests(
            folder, ["-m", mark, path, *before], max(1.0, end - time.monotonic())
        )
        if code is None:
            return "timeout", path, count
        if code not in (0, NOTHING_COLLECTED):
            found = FAILED.search(output)
            return "killed", found[1] if found else f"{path}: exit code {code}", count
    return "survived", "", len(runs)


def main() -> None:
    """Run the command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--out", type=Path, required=True, help="CSV file to which lines are added")
    parser.add_argument("--only", nargs="+", metavar="ID", help="defects to plant; all without it")
    parser.add_argument(
        "--suite", action="store_true", help="run all tests, not those named with each defect"
    )
    parser.add_argument(
        "--slow", action="store_true", help="run the slow tests too, after the others"
    )
    parser.add_argument(
        "--check", action="store_true", help="run the tests that found the defects, without these"
    )
    parser.add_argument(
        "--least", type=float, default=0.0, help="share of the defects that has to be found"
    )
    parser.add_argument(
        "--minutes", type=float, default=10.0, help="wall time for one defect at most"
    )
    parser.add_argument(
        "--draw", type=int, default=0, help="plant so many drawn defects, not those of mutants.toml"
    )
    parser.add_argument("--seed", type=int, default=1, help="of the draw")
    parser.add_argument(
        "--of", nargs="+", metavar="FOLDER", default=draw_mutants.PACKAGES, help="drawn from these"
    )
    parser.add_argument("--commit", default="HEAD", help="of which the tree is tested")
    parser.add_argument(
        "--work", type=Path, default=Path(tempfile.gettempdir()) / "weavecell-mutants"
    )
    chosen = parser.parse_args()
    signal.signal(signal.SIGTERM, lambda *_: sys.exit("stopped"))  # by way of all `finally`
    folder = chosen.work.resolve()
    os.environ |= {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    commit = copy_of_tree(folder, chosen.commit)
    lend_kernels(folder)
    load_libraries()
    rows = list(csv.DictReader(chosen.out.open())) if chosen.out.exists() else []
    if chosen.check:
        tests = sorted({row["test"] for row in rows if row["outcome"] == "killed"})
        code, output = run_tests(
            folder, ["--maxfail=1000", *tests], 60 * chosen.minutes * len(tests)
        )
        print(output)
        sys.exit(code)
    if chosen.draw:
        mutants = draw_mutants.draw(chosen.draw, chosen.seed, chosen.of)
    else:
        mutants = tomllib.loads((ROOT / "tools" / "mutants.toml").read_text())["mutant"]
    for mutant in mutants:
        if mutant["id"] in {row["id"] for row in rows} or (
            chosen.only and mutant["id"] not in chosen.only
        ):
            continue
        paths = sorted(
            {path.split("/")[1] for path in git(ROOT, "ls-files", "tests/*test_*.py").splitlines()}
        )
        paths = [f"tests/{path}" for path in paths] if chosen.suite else mutant["tests"]
        marks = ("not slow", "slow and not printed") if chosen.slow else ("not slow",)
        begun, used = time.monotonic(), resource.getrusage(resource.RUSAGE_CHILDREN)
        with planted(folder / mutant["file"], mutant["text"], mutant["replacement"]):
            result, test, count = outcome(folder, paths, marks, 60 * chosen.minutes)
        now = resource.getrusage(resource.RUSAGE_CHILDREN)
        cpu = now.ru_utime + now.ru_stime - used.ru_utime - used.ru_stime
        values = (
            mutant["id"],
            mutant["file"],
            result,
            test,
            count,
            f"{cpu:.0f}",
            f"{time.monotonic() - begun:.0f}",
        )
        rows.append(dict(zip(COLUMNS, (*values, commit[:10]))))
        with chosen.out.open("a", newline="") as file:
            writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
            if file.tell() == 0:
                writer.writeheader()
            writer.writerow(rows[-1])
        print(*rows[-1].values(), flush=True)
    found = sum(row["outcome"] != "survived" for row in rows)
    print(f"{found} of {len(rows)} defects found")
    sys.exit(found < chosen.least * len(rows))


if __name__ == "__main__":
    main()
