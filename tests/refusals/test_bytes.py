"""Files of any bytes, texts of any signs, terminals of any encoding: a line or a result, never a traceback."""

import fcntl
import io
import os
import re
import shutil
import signal
import subprocess
import sys
import textwrap
import time
from contextlib import suppress
from pathlib import Path

import numpy as np
import pint
import pytest

import weavecell as wc
from fabrics import catalogue
from fabrics.base import executors, files, read_formats
from fabrics.base.errors import InputError, WeavecellError
from tests.scene_text import impact_scene
from weavecell.answers.tables import format_for_terminal
from weavecell.results import termination

COUNT = int(os.environ.get("WEAVECELL_BYTES", "40"))
ROOT = Path(wc.__file__).parents[1]
TESTS = "velocity [m/s], outcome, residual velocity [m/s]\n80, PP, 0\n120, CP, 31\n95, CP, 12\n"
# what is damaged: the words that read it
READERS = {
    "scene.toml": "impact scene.toml --check",
    "fabric.toml": "show fabric.toml",
    "tests.csv": "reduce tests tests.csv",
    "peaks.csv": "reduce pull-out S-728 peaks.csv --check",
    "law.json": "impact with-law.toml --check",
    "values.csv": "fabrics new new.toml --from values.csv",
    "frame.csv": "fabrics new new.toml --from values.csv --picture-frame frame.csv",
}
PARTS = [
    b"\0",
    b"\x1b[31m",
    b"[[",
    b"]",
    b'"',
    b"'''",
    b"nan",
    b"1e999",
    b"-",
    b"\xff\xfe",
    b"\xed\xa0\x80",
    b"\x0b",
]
PARTS += [b"[" * 5000, b"9" * 5000, b"\n\n", b",", b";", b"{", b"\\u0000", b"\x85", b"= ", b"inf"]


@pytest.fixture
def whole(tmp_path):
    """{file: its bytes}, in this folder."""
    (tmp_path / "scene.toml").write_text(impact_scene())
    (tmp_path / "tests.csv").write_text(TESTS)
    (tmp_path / "peaks.csv").write_text("crossings, peak load [N]\n10, 1.3\n20, 6.4\n20, 6.1\n")
    shutil.copy(Path(catalogue.__file__).parent / "S-720.toml", tmp_path / "fabric.toml")
    catalogue.load("S-720").laws[0].to_json(tmp_path / "law.json")
    with_law = impact_scene().replace("[projectile]", 'law = "law.json"\n[projectile]', 1)
    (tmp_path / "with-law.toml").write_text(with_law)
    shutil.copy(ROOT / "examples/fabrics/mine.csv", tmp_path / "values.csv")
    rows = "".join(f"{angle}, {0.02 * angle**1.5}\n" for angle in range(0, 50, 3))
    (tmp_path / "frame.csv").write_text("shear angle [deg], shear stress [MPa]\n" + rows)
    return {name: (tmp_path / name).read_bytes() for name in READERS}


def damaged(content, random):
    """The bytes with a few of them cut, changed, doubled, or with others in between."""
    content = bytearray(content)
    for _ in range(random.integers(1, 4)):
        place = int(random.integers(len(content) + 1))
        length = int(random.integers(1, 9))
        match random.integers(5):
            case 0:
                content[place : place + length] = random.bytes(length)
            case 1:
                content[place:place] = PARTS[random.integers(len(PARTS))]
            case 2:
                del content[place : place + length]
            case 3:
                content[place:place] = content[place : place + 40 * length]
            case 4:
                del content[place:]
    return bytes(content)


@pytest.mark.parametrize("name", READERS)
def test_a_file_of_damaged_bytes_is_read_or_refused_in_words(command, tmp_path, whole, name):
    random = np.random.default_rng(list(name.encode()))
    for number in range(COUNT // len(READERS) + 1):
        (tmp_path / "new.toml").unlink(missing_ok=True)
        content = damaged(whole[name], random)
        (tmp_path / name).write_bytes(content)
        code, _, err = command(READERS[name])
        assert code in (0, 2, 3), (number, content)
        if code == 2:
            assert err.startswith("error: ") or "\nerror: " in err, (number, content)


DEEP = "x = " + "[" * 20_000 + "]" * 20_000


@pytest.mark.parametrize(
    "text, words",
    [
        ("# nothing yet", "scene.toml: is empty"),
        (DEEP, "not valid TOML (lists or tables are nested too deeply)"),
        (f"[panel]\nplies = {'9' * 5000}", "not valid TOML (Exceeds the limit"),
        (
            "a.b.c = 1",
            "scene.toml: is neither; must be an input file, with tables [fabric], [panel]",
        ),
        (
            f"[panel]\nopening = [{'1, ' * 5000}1]",
            "panel.opening = [1, 1, 1, 1, 1,",
        ),
        ('title = "a\\u0000b"', "scene.toml: title: has the control character U+0000"),
        ('title = "\\u001B[2J"', "title: has the control character U+001B"),
        ('[fabric]\n"na\\u007Fme" = 1', "fabric: has the control character U+007F"),
    ],
)
def test_toml_that_no_table_can_be_made_of(command, tmp_path, text, words):
    (tmp_path / "scene.toml").write_text(text)
    code, _, err = command("impact scene.toml --check")
    assert code == 2
    assert words in err
    assert max(map(len, err.splitlines())) < 500


def test_json_and_hdf5_that_cannot_be_read(tmp_path):
    (tmp_path / "law.json").write_text("[" * 100_000)
    with pytest.raises(InputError, match="is not JSON"):
        read_formats.read_json(tmp_path / "law.json", "any", what="a law")
    path = tmp_path / "a.h5"
    with files.write_hdf5(path, "kind 1") as file:
        file["x"] = np.arange(2000.0)
        file.attrs["text"] = "a"
    content = path.read_bytes()
    random = np.random.default_rng(3)
    for _ in range(COUNT):
        path.write_bytes(damaged(content, random))
        # whatever else h5py raises
        with suppress(InputError), read_formats.read_hdf5(path, "kind 1") as file:
            assert file["x"][()].size


def test_a_page_break_in_a_source_is_a_blank(command, tmp_path, whole):
    text = whole["values.csv"].decode().replace("data sheet", "data\vsheet")
    assert "\v" in text
    (tmp_path / "values.csv").write_text(text)
    assert command("fabrics new new.toml --from values.csv")[0] == 0
    assert "data sheet" in (tmp_path / "new.toml").read_text()
    assert command("show new.toml")[0] == 0


@pytest.mark.parametrize(
    "source", ["A. Smith [private], [red]", "see [/data]", "\\[x", "[", "[bold"]
)
def test_brackets_of_a_text_are_printed_as_they_are(source):
    from pandas import DataFrame

    for table, title in (
        (DataFrame({"source": ["a"]}, index=[source]), ""),
        (DataFrame({"source": [source]}), ""),
        (DataFrame({source: ["a"]}), ""),
        (DataFrame({"source": ["a"]}), source),
    ):
        assert " ".join(format_for_terminal(table, title).split()).count(source) == 1


@pytest.mark.parametrize("encoding", ["ascii", "latin-1", "cp437", "cp1252", "utf-8"])
def test_what_a_terminal_cannot_print_is_replaced(command, monkeypatch, encoding):
    for words in (
        "show S-720",
        "fabrics list",
        "projectiles list",
        "metals list",
        "backings list",
        "v50 --help",
    ):
        written = io.BytesIO()
        with monkeypatch.context() as other:
            stream = io.TextIOWrapper(written, encoding=encoding)
            other.setattr(sys, "stdout", stream)
            assert command(words)[0] == 0
            stream.flush()
        assert len(written.getvalue()) > 500


def test_a_quantity_of_pint_is_taken():
    u = pint.UnitRegistry()
    small = {"opening": 20 * u.mm, "end_time": "10 us"}
    size = wc.impact("S-720", 92.5 * u.m / u.s, check=True, **small)
    assert "92.5 m/s" in str(size)
    assert str(size) == str(wc.impact("S-720", "92.5 m/s", check=True, **small))
    with pytest.raises(InputError, match="velocity"):
        wc.impact("S-720", 92.5 * u.kg, check=True, **small)
    with pytest.raises(InputError, match="velocity"):
        wc.impact("S-720", [92.5, 93] * u.m / u.s, check=True, **small)


def test_a_script_without_the_main_guard_is_told_of_it(tmp_path):
    script = textwrap.dedent(
        """
        from fabrics.base import executors
        with executors.open_executor("local", 2) as pool:
            print(list(executors.as_done(pool, abs, [(-1,), (-2,)])))
        """
    )
    (tmp_path / "script.py").write_text(script)
    run = subprocess.run(
        [sys.executable, "script.py"],
        cwd=tmp_path,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 1
    last = run.stderr.splitlines()[-1]
    assert 'if __name__ == "__main__":' in last
    assert "bootstrapping" not in run.stderr


def test_a_process_that_dies_is_told():
    with (
        pytest.raises(WeavecellError, match="want of memory"),
        executors.open_executor("local", 2) as pool,
    ):
        list(executors.as_done(pool, os._exit, [(3,)]))


def test_the_end_of_standard_input_is_no_interrupt(tmp_path):
    run = subprocess.run(
        [sys.executable, "-m", "weavecell", "fabrics", "new", "mine.toml"],
        cwd=tmp_path,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 2
    assert "standard input ended" in run.stderr


def test_a_notebook_shows_the_line_of_the_cell_and_the_message():
    with pytest.raises(InputError) as caught:
        wc.impact("S-720", "92.5 m/s", plys=2)
    place, message = caught.value._render_traceback_()
    assert place.endswith('wc.impact("S-720", "92.5 m/s", plys=2)')
    assert message == f"InputError: {caught.value}"


def test_an_interrupt_inside_a_kernel_is_an_interrupt():
    from fabrics.base.errors import interrupts

    with pytest.raises(KeyboardInterrupt), interrupts():
        try:
            raise KeyboardInterrupt
        except KeyboardInterrupt as problem:
            raise SystemError("returned a result with an exception set") from problem
    with pytest.raises(SystemError), interrupts():
        raise SystemError("of another cause")


@pytest.fixture
def heeds_interrupts():
    """A process that was started in the background ignores SIGINT until it is told otherwise."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.mark.usefixtures("heeds_interrupts")
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_an_interrupt_that_a_library_makes_another_error_of_is_an_interrupt(number):
    def load():
        try:
            os.kill(os.getpid(), number)
        except KeyboardInterrupt:
            raise ImportError("no module named vtkViewsCore") from None

    with pytest.raises(KeyboardInterrupt), termination.interrupt_on_sigterm():
        load()
    # a full disk, or a refusal, while what was computed is written, is told as it is
    for kind in (OSError, InputError):
        with pytest.raises(kind), termination.interrupt_on_sigterm():
            try:
                load()
            except ImportError:
                raise kind("no space") from None
    with pytest.raises(ImportError), termination.interrupt_on_sigterm():
        raise ImportError("that is so")


def test_a_file_is_read_although_another_holds_its_lock(tmp_path):
    """As from a drive without locks, where each lock fails."""
    import h5py

    path = tmp_path / "a.h5"
    with files.write_hdf5(path, "kind 1") as file:
        file["x"] = np.arange(3.0)
    with open(path, "rb") as held:
        fcntl.flock(held, fcntl.LOCK_EX)
        with pytest.raises(OSError, match="unable to lock file"):
            h5py.File(path, "r")
        with read_formats.read_hdf5(path, "kind 1") as file:
            assert list(file["x"]) == [0.0, 1.0, 2.0]


def test_no_file_is_opened_with_a_lock():
    opened = []
    for folder in ("fabrics", "meshing", "unitcell3d", "shellfabric", "weavecell"):
        for path in (ROOT / folder).rglob("*.py"):
            opened += re.findall(r"h5py\.File\(.*", path.read_text())
    assert len(opened) > 1
    # in memory, or for reading without a lock
    assert [line for line in opened if "content" not in line and "locking=False" not in line] == []


def test_a_coupon_that_is_terminated_is_interrupted(tmp_path):
    """A real SIGTERM at a process that relaxes a strip."""
    (tmp_path / "bias.toml").write_text(
        '[fabric]\nname = "S-720"\n[bias_extension]\nlength = "100 mm"\nwidth = "40 mm"\n'
        'elongation = "5 mm"\n[run]\nsteps = 200\noutputs = []\n'
    )
    process = subprocess.Popen(
        [sys.executable, "-m", "weavecell", "coupon", "bias.toml", "--out", "bias"],
        cwd=tmp_path,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
    )
    while not (tmp_path / "bias" / "checkpoint.h5").exists() and process.poll() is None:
        time.sleep(0.01)
    process.terminate()
    said = process.communicate()[1]
    assert process.returncode == 130
    assert "Traceback" not in said
    assert said.endswith("error: interrupted; --resume goes on from its last step\n")
