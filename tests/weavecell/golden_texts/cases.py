"""What users read of each command: lines of the terminal, the folder, the page, and results as Python shows them.

Numbers of files stand with three digits, which all processors give; dates, times, versions and places are masked.
"""

import contextlib
import csv
import io
import json
import os
import re
import shlex
import tempfile
import tomllib
from html import unescape
from math import sin
from pathlib import Path
from unittest import mock

import numpy as np

import weavecell as wc
from tests.scene_text import toml
from tests.weavecell.session_runs import small_calibration

HERE = Path(__file__).parent
_TABLES = tomllib.loads((HERE / "cases.toml").read_text("utf-8"))
CASES = _TABLES["case"]
TESTS = """velocity [m/s], outcome, residual velocity [m/s]
90, PP, 0
120, CP, 31
105, CP, 12
112, PP, 0
150, CP, 101
"""
SHEET = """key, warp, weft, source, status
linear_density, 1100 dtex, , data sheet of the yarn, measured
fibre_density, 1.44 g/cm^3, , data sheet of the yarn, measured
modulus, 90 GPa, 84 GPa, data sheet of the yarn, measured
tenacity, 2060 mN/tex, , data sheet of the yarn, measured
failure_strain, 3.3 %, , data sheet of the yarn, measured
count, 8.5 / cm, 9 / cm, data sheet of the fabric, measured
thickness, 0.30 mm, , data sheet of the fabric, measured
"""
# values that differ from run to run, by the names of their keys
CHANGING = re.compile(
    r"processor|step_time|wall|cpu|second|date|commit|version|python|platform|provenance|seconds_of|sha|\bsystem\b"
)
TIMED = re.compile("cpu|wall")  # columns of tables
MASKED = [
    (re.compile(r"\d[\d.]*(e-?\d+)? s(econds)?(?= |$|,|;|\))(?! of CPU)"), "? s"),
    (re.compile(r"\b20\d\d-\d\d-\d\d([T ]\d\d:\d\d(:\d\d)?)?\S*"), "DATE"),
    (re.compile(r"\b[0-9a-f]{7,64}\b(?<![0-9]{7})"), "DIGEST"),
    (re.compile(r"(?<=weavecell )\d+\.\d+\.\d+\S*"), "VERSION"),
    (re.compile(r'(Version |version = \{|"weavecell": ")[\d.]+\w*'), r"\1VERSION"),
    # what is nothing but the rounding of the processor
    (re.compile(r"-?\b\d(\.\d+)?e-(1[4-9]|[2-9]\d)\b"), "0.0"),
]
PROGRESS = re.compile(r"\d %, \d\d:\d\d|compiling the kernels of")
# a version has two points
FLOAT = re.compile(r"(?<![\d.])-?\d+\.\d+(?:e[+-]?\d+)?(?!\d|\.\d)")
FITTED = 1e-5  # [m/s]


@contextlib.contextmanager
def invented():
    """Shots of studies are invented: a limit that is a little blurred."""
    from weavecell.studies import ballistic_limit

    def fire(_, velocity, __, stops_below=0.0):
        limit = 104.0 + 3.0 * sin(17.0 * velocity)
        residual = max(velocity**2 - limit**2, 0.0) ** 0.5
        outcome = "stopped"
        if residual:
            outcome = "perforated"
        tension = 90.0 + velocity, 70.0 - 0.1 * velocity
        return ballistic_limit.Shot(
            velocity, residual, outcome, 1e-2 / velocity, 3.0, tension, 1e-5 * velocity, 0.5
        )

    with (
        mock.patch.object(ballistic_limit, "_fire", fire),
    ):
        yield


def write(names):
    """Write the texts of some cases to texts/."""
    (HERE / "texts").mkdir(exist_ok=True)
    for name in names:
        with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
            (HERE / "texts" / f"{name}.txt").write_text(text_of(name), "utf-8")


def write_records():
    """Write records of a laboratory to this folder: shots, a ply between platens, a flight, a data sheet."""
    Path("tests.csv").write_text(TESTS)
    Path("sheet.csv").write_text(SHEET)
    force = np.geomspace(10, 7000, 40)
    # neither record is exactly what it is read with: the noise of a perfect fit is that of the processor
    closed = 0.33 * (10 ** (-1 / 3) - force ** (-1 / 3)) + 2e-4 * np.sin(3 * np.arange(40))
    _write_columns("ply.csv", "force [N], displacement [mm]", force, closed)
    crossings = np.repeat([10, 20], 3)
    peaks = 0.28 * np.sinh(0.155 * crossings) * (1 + 0.06 * np.sin(3 * np.arange(6)))
    _write_columns("peaks.csv", "crossings, peak load [N]", crossings, peaks)
    time = np.arange(0, 200, 2.0)
    flown = 0.1 * time - 1e-4 * time**2 + 3e-3 * np.sin(3 * time)
    _write_columns("flight.csv", "time [us], displacement [mm]", time, flown)


def _write_columns(name, heading, *columns):
    rows = (", ".join(f"{value}" for value in row) for row in zip(*columns))
    Path(name).write_text("\n".join([heading, *rows]))


def text_of(name):
    """The text of a case, which is run in this folder."""
    case = CASES[name]
    for scene in case.get("scenes", ()):
        Path(f"{scene}.toml").write_text(toml(_TABLES["scene"][scene]))
    write_records()
    parts = []
    smaller = contextlib.nullcontext()
    if name == "calibrate":
        smaller = small_calibration()
    # of the terminal, by which tables are folded
    wide = mock.patch.dict(os.environ, COLUMNS="80")
    with invented(), smaller, wide:
        for line in case["lines"]:
            parts += [f"$ weavecell {line}", *_printed(line)]
        if "out" in case:
            # states of the 3D crossover have the noise of its solver
            parts += _folder(Path(case["out"]), rows=1 if case.get("solid") else 4)
        for expression in case.get("python", ()):
            parts += [f">>> {expression}", *_shown(expression)]
    return "\n".join(_mask(line).rstrip() for part in parts for line in part.splitlines()) + "\n"


def _printed(line):
    """What a command prints, errors behind the rest, and its exit code."""
    from weavecell.cli import app

    out = io.StringIO()
    err = io.StringIO()
    code = None
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            app.main(shlex.split(line))
        except SystemExit as leaving:
            code = leaving.code
    # a long run says how far it is, the first one of a kind that it compiles
    shown = [line for line in err.getvalue().splitlines() if not PROGRESS.search(line)]
    errors = [f"! {line}" for line in shown]
    return [out.getvalue().rstrip("\n"), *errors, f"[exit code {code}]"]


def _shown(expression):
    """A result as Python and a notebook show it."""
    out = io.StringIO()
    # what is assumed is logged, and tested with the lines of commands
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(io.StringIO()):
        result = eval(expression, {"wc": wc})
        table = result.to_dataframe()
        # the picture has its own tests
        drawn = mock.Mock()
        drawn._repr_png_ = lambda: b""
        with mock.patch.object(type(result), "plot", return_value=drawn, create=True):
            notebook = result._repr_html_()
    summary = json.dumps(_rounded(result.summary()), indent=1, ensure_ascii=False, default=str)
    yield f"repr: {result!r}"
    yield f"str: {result}"
    yield f"summary: {summary}"
    yield f"table: {len(table)} rows of {', '.join(map(str, table))}"
    yield "notebook, beside the above:"
    yield "\n".join(line for line in _sentences(notebook) if line not in str(result))


def _folder(folder, rows):
    """The files of a folder, and what is in those of text: so many lines of a table."""
    files = [p.relative_to(folder) for p in sorted(folder.rglob("*")) if p.is_file()]
    named = [re.sub(r"[0-9a-f]{16,}", "DIGEST", path.as_posix()) for path in files]
    yield "files: " + " ".join(dict.fromkeys(named))
    for path in files:
        text = ""
        if path.suffix in (".json", ".csv", ".html", ".svg") and path.parts[0] != "runs":
            text = (folder / path).read_text("utf-8")
        if path.suffix == ".json":
            content = json.dumps(_rounded(json.loads(text)), indent=1, sort_keys=True)
            yield f"== {path}\n{content}"
        elif path.suffix == ".csv":
            yield f"== {path}"
            lines = list(csv.reader(text.splitlines()[:rows]))
            timed = [number for number, key in enumerate(lines[0]) if TIMED.search(key)]
            for row in lines[1:]:
                for number in timed:
                    row[number] = "?"
            for row in lines:
                yield ", ".join(FLOAT.sub(_three_digits, value) for value in row)
            yield f"{len(text.splitlines())} lines"
        elif path.suffix == ".toml" and path.name != "scene.toml" and path.parts[0] != "inputs":
            yield f"== {path}\n" + (folder / path).read_text("utf-8")
        elif path.suffix == ".html":
            yield f"== {path}\n" + "\n".join(_sentences(text))
        elif path.suffix == ".svg":
            yield f"== {path}: " + " | ".join(sorted(_drawn(text)))


def _drawn(svg):
    """The words in a picture: texts, or comments beside the outlines of letters; numbers of axes are left out."""
    texts = re.findall(r"<!-- (.*?) -->", svg) + re.findall(r"<text[^>]*>(.*?)</text>", svg, re.S)
    words = {" ".join(unescape(re.sub(r"<[^>]*>", "", text)).split()) for text in texts}
    return {text for text in words if re.search(r"[A-Za-z]", text)}


def _sentences(page):
    """What a page says, a line each, without the cells of its tables."""
    page = re.sub(r"<(script|style|svg|td|th)\b.*?</\1>", "", page, flags=re.S)
    page = re.sub(r"</?(abbr|b|i|em|sub|sup|a|span|code)\b[^>]*>", "", page)
    parts = [" ".join(unescape(part).split()) for part in re.split(r"<[^>]*>", page)]
    lines = [FLOAT.sub(_three_digits, part) for part in parts if part.count(" ") > 2]
    return list(dict.fromkeys(lines))


def _rounded(value):
    """JSON with three digits, and without what differs from run to run."""
    if isinstance(value, dict):
        return {
            str(key): "?" if CHANGING.search(str(key)) else _rounded(_settle(str(key), one))
            for key, one in value.items()
        }
    if isinstance(value, (list, tuple)):
        return [_rounded(one) for one in value]
    if isinstance(value, float):
        return float(f"{value:.3g}")
    if isinstance(value, np.ndarray):
        return _rounded(value.tolist())
    return value


def _settle(key, value):
    """A velocity [m/s] below what a fit ends at is 0: the difference of two equal limits, say."""
    if key.endswith("_m_s") and isinstance(value, float) and abs(value) < FITTED:
        return 0.0
    return value


def _three_digits(found):
    return f"{float(found[0]):.3g}"


def _mask(line):
    for pattern, word in MASKED:
        line = pattern.sub(word, line)
    return line
