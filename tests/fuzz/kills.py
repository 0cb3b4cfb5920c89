"""Random ends of commands: kill, SIGTERM, Ctrl-C, a full disk, at a random instant or at a random file.

    python -m tests.fuzz.kills --seed 1 --count 200

Each command runs in a process of its own, which ends as drawn. Afterwards nothing of the user is changed, no folder
that is not whole says that it is, and the same command (with --resume where it has that) makes the folder that an
undisturbed run leaves, its tables to the byte. Exit code 1 and a line for each end after which that is not so.
"""

from __future__ import annotations

import argparse
import hashlib
import os
import random
import resource
import shlex
import shutil
import signal
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

from fabrics.base import files
from tests.scene_text import FRAME, impact_scene, is_whole
from weavecell.results import file_list

SHORT = {"opening": "20 mm", "end_time": "5 us"}
SMALL = {"opening": "30.6 mm", "end_time": "60 us", "run": "elements_per_crossover = 1"}
OUTPUTS = 'elements_per_crossover = 1\noutputs = ["paraview", "report"]'
PULL = '[fabric]\nname = "S-726"\n[pull_out]\ncrossings = 10\ndisplacement = "1 mm"\ncrossover_cohesion = "0.5 N"\n'
FLIGHT = "time [us], displacement [mm]\n" + "".join(
    f"{t}, {0.15 * t - 2e-4 * t**2}\n" for t in range(0, 300, 5)
)
INPUTS = {
    "scene.toml": impact_scene(**SHORT, run=OUTPUTS),
    "bare.toml": impact_scene(**SHORT, run="elements_per_crossover = 1\noutputs = []"),
    "study.toml": impact_scene(**SMALL),
    "other.toml": impact_scene(**SMALL, fabric="S-728"),
    "frame.toml": FRAME,
    "pull.toml": PULL,
    "tests.csv": "velocity [m/s], outcome, residual velocity [m/s]\n80, PP, 0\n120, CP, 31\n95, CP, 12\n",
    "flight.csv": FLIGHT,
}
# words of each command, to which --out is added, and whether it has --resume
COMMANDS = {
    "impact scene.toml --no-assumed-range": True,
    "impact bare.toml --no-assumed-range": True,
    "coupon frame.toml": True,
    "coupon pull.toml": True,
    "sweep bare.toml --over panel.plies=1,2 --jobs 1": True,
    "v50 study.toml --shots 8 --jobs 1": True,
    "critical-velocity study.toml --tolerance '20 m/s' --residual-shots 0 --no-scan --jobs 1 --no-assumed-range": True,
    "compare study.toml other.toml --shots 8 --jobs 1": True,
    "mesh S-720 --format k,rad": False,
    "reduce tests tests.csv": True,
    "reduce shot flight.csv --mass '3 g'": False,
    "biaxial S-720 --ratio 1:1": False,
    "export bare.toml --to lsdyna": False,
    "export bare.toml --to radioss": False,
}
ENDS = {
    "kill": signal.SIGKILL,
    "SIGTERM": signal.SIGTERM,
    "Ctrl-C": signal.SIGINT,
    "full disk": None,
}
CODES = {"kill": {-9, 0}, "SIGTERM": {130, 0}, "Ctrl-C": {130, 0}, "full disk": {2, 0}}
# tables that do not depend on when or where a run is made
TABLES = ("*.csv", "*.k", "*.rad")
# [s] a command is given up after this: the first compiles kernels
PATIENCE = 900.0


@dataclass(frozen=True)
class Ending:
    """How a command ends.

    Parameters
    ----------
    command : of COMMANDS
    kind : of ENDS
    share : [-] of the time or of the files of an undisturbed run
    at_file : whether it ends when a file is about to appear, and not at an instant
    """

    command: str
    kind: str
    share: float
    at_file: bool


@dataclass(frozen=True)
class Run:
    """What an ended process left.

    Parameters
    ----------
    code : exit code; negative of a signal
    said : its standard error
    seconds : that it took
    """

    code: int
    said: str
    seconds: float


def draw(count, seed, beginnings=("",)):
    """Draw endings, each command with one of these beginnings in turn."""
    drawn = random.Random(seed)
    names = [command for command in COMMANDS if command.startswith(tuple(beginnings))]
    for number in range(count):
        yield Ending(
            names[number % len(names)],
            drawn.choice([*ENDS]),
            drawn.random(),
            drawn.random() < 0.6,
        )


def run(words, folder, before=lambda: None, signalled=None):
    """Run a command line in a child of this process, in a folder.

    Parameters
    ----------
    before : called in the child
    signalled : (signal, [s] after which it is sent), or None
    """
    with tempfile.TemporaryFile("w+") as err:
        sys.stdout.flush()
        sys.stderr.flush()
        began = time.perf_counter()
        child = os.fork()
        if child == 0:
            _be_the_command(words, folder, before, err)
        while True:
            ended, status = os.waitpid(child, os.WNOHANG)
            passed = time.perf_counter() - began
            if ended:
                break
            if signalled is not None and passed >= signalled[1]:
                os.kill(child, signalled[0])
                signalled = None
            if passed > PATIENCE:
                os.kill(child, signal.SIGKILL)
            time.sleep(0.001)
        err.seek(0)
        return Run(os.waitstatus_to_exitcode(status), err.read(), passed)


def _be_the_command(words, folder, before, err):
    """The child: never returns."""
    from weavecell.cli import app

    code = 1
    try:
        null = os.open(os.devnull, os.O_RDWR)
        os.dup2(null, 0)
        os.dup2(null, 1)
        os.dup2(err.fileno(), 2)
        os.chdir(folder)
        signal.signal(signal.SIGINT, signal.default_int_handler)
        before()
        app.main(shlex.split(words))
    except SystemExit as leaving:
        code = leaving.code or 0
    except BaseException:
        import traceback

        traceback.print_exc()
    finally:
        sys.stderr.flush()
        os._exit(code)


def _end_at_file(number, sent):
    """End this process when the file with a number, from 0, is about to appear."""
    written = []

    def watcher(path, _):
        written.append(path)
        if len(written) == number + 1:
            os.kill(os.getpid(), sent)

    files.watchers.append(watcher)


def _limit_files(size):
    """Let no file grow beyond a size [bytes], as a full disk does."""
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))


def write_inputs(folder):
    """Write the inputs of all commands, and what else a user has there."""
    for name, text in INPUTS.items():
        (folder / name).write_text(text)
    (folder / "o").mkdir()
    (folder / "o" / "notes.txt").write_text("mine")


def digests(folder):
    """{name: SHA-256} of the files in a folder but hidden ones."""
    found = {}
    for path in sorted(folder.rglob("*")):
        name = path.relative_to(folder).as_posix()
        if path.is_file() and not any(part.startswith(".") for part in name.split("/")):
            found[name] = hashlib.sha256(path.read_bytes()).hexdigest()
    return found


def tables(folder):
    """Digests of the tables among the results in a folder."""
    return {
        name: known for name, known in digests(folder).items() if file_list.matches(name, TABLES)
    }


def undisturbed(command, base):
    """Run a command to its end: (its folder, seconds, number of files)."""
    folder = Path(tempfile.mkdtemp(dir=base))
    write_inputs(folder)
    done = run(f"{command} --out o", folder)
    assert done.code == 0, done.said
    assert is_whole(folder / "o")
    return folder, done.seconds, len(file_list.FileList.read(folder / "o").digests)


def faults(ending, base, model):
    """What is wrong after an ending and a second run, in words.

    Parameters
    ----------
    model : of `undisturbed`
    """
    whole, seconds, count = model
    folder = Path(tempfile.mkdtemp(dir=base))
    write_inputs(folder)
    before = digests(folder)
    sent = ENDS[ending.kind]
    options = {}
    if sent is None:
        largest = max(path.stat().st_size for path in (whole / "o").rglob("*") if path.is_file())
        # from less than any file has to more than any
        size = int(200 * (1.5 * largest / 200) ** ending.share)
        options["before"] = lambda: _limit_files(size)
    elif ending.at_file:
        options["before"] = lambda: _end_at_file(int(ending.share * count), sent)
    else:
        options["signalled"] = (sent, ending.share * seconds)
    found = []
    first = run(f"{ending.command} --out o", folder, **options)
    if first.code not in CODES[ending.kind]:
        found.append(f"exit code {first.code}: {first.said[-300:]}")
    if "Traceback" in first.said:
        found.append(f"traceback: {first.said[-300:]}")
    # one that ends behind its mark is whole
    names = set(digests(folder))
    if is_whole(folder / "o") and names != set(digests(whole)):
        found.append("says that it is whole")
    again = f"{ending.command} --out o"
    if COMMANDS[ending.command]:
        again += " --resume"
    second = run(again, folder)
    if second.code != 0:
        found.append(f"the second run ends with {second.code}: {second.said[-300:]}")
    elif not is_whole(folder / "o"):
        found.append("is not whole after the second run")
    after = digests(folder)
    if any(after.get(name) != known for name, known in before.items()):
        found.append("a file of the user is changed")
    if set(after) != set(digests(whole)):
        found.append(f"other files: {sorted(set(after) ^ set(digests(whole)))}")
    left = [path.name for path in folder.rglob(f"{files.UNFINISHED}*-????????*")]
    if left:
        found.append(f"left unfinished: {left}")
    if tables(folder / "o") != tables(whole / "o"):
        found.append("other numbers")
    shutil.rmtree(folder)
    return found


def main(arguments=None):
    """Draw, run and tell; returns the exit code."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--only", nargs="+", default=[""], help="beginnings of commands")
    chosen = parser.parse_args(arguments)
    # children have all modules, and the compiled kernels that they find in the cache
    from weavecell import api
    from weavecell.cli import app  # noqa: F401

    assert api.impact
    models = {}
    wrong = 0
    tally = dict.fromkeys(ENDS, 0)
    with tempfile.TemporaryDirectory() as base:
        for ending in draw(chosen.count, chosen.seed, chosen.only):
            if ending.command not in models:
                models[ending.command] = undisturbed(ending.command, base)
            tally[ending.kind] += 1
            for fault in faults(ending, base, models[ending.command]):
                wrong += 1
                print(f"{ending}: {fault}", flush=True)
    told = ", ".join(f"{count} {kind}" for kind, count in tally.items())
    print(f"seed {chosen.seed}: {chosen.count} ends ({told}), {wrong} faults")
    return int(wrong > 0)


if __name__ == "__main__":
    sys.exit(main())
