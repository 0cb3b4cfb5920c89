"""Files of users and of the program: encodings, separators and numbers."""

import numpy as np
import pytest

from fabrics.base import files, read_formats, tables
from fabrics.base.errors import InputError
from fabrics.base.schema import read_toml

CURVE = "strain [%], force [N]\n0.5, 10.25\n1, 20\n"
ENCODINGS = ("utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be")
BYTE_ORDER_MARK = "\ufeff"


def read(path):
    units = {"strain": "", "force": "N"}
    return tables.read_columns(path, units, what="a curve", example="strain [%]")


def written(folder, text, encoding="utf-8"):
    path = folder / "curve.csv"
    path.write_bytes(text.encode(encoding))
    return path


def assert_is_the_curve(found):
    assert found["strain"] == pytest.approx([0.005, 0.01])
    assert found["force"] == pytest.approx([10.25, 20])


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize("encoding", ENCODINGS)
def test_a_file_is_read_in_every_encoding_of_excel_and_notepad(tmp_path, encoding, end):
    """A table of numbers, and an input file."""

    def saved(text):
        mark = BYTE_ORDER_MARK if encoding.endswith("e") else ""
        return written(tmp_path, mark + text.replace("\n", end), encoding)

    assert_is_the_curve(read(saved("# Prüfung an µm\n" + CURVE)))
    content = read_toml(saved('a = "20 µm"\n# Maße\n[b]\nc = 1\n'), what="scene")[1]
    assert content == {"a": "20 µm", "b": {"c": 1}}


@pytest.mark.parametrize("encoding", ["cp1252", "cp1250", "mac-roman", "utf-32", "cp932", "gbk"])
def test_another_encoding_is_named_with_advice(tmp_path, encoding):
    word = "織物" if encoding in ("cp932", "gbk") else "Maß"
    path = written(tmp_path, CURVE + f"# {word}\n", encoding)
    line = 1 if encoding == "utf-32" else 4
    for reader in (read, lambda path: read_toml(path, what="scene")):
        with pytest.raises(InputError) as refused:
            reader(path)
        assert f"curve.csv: line {line} is not UTF-8 text; save it as" in str(refused.value)


@pytest.mark.parametrize(
    "text",
    [
        "strain [%]; force [N]\n0,5; 10,25\n1; 20\n",
        "strain [%];force [N]\r\n0,5;1,025E+01\r\n1,0;20,0\r\n;\r\n",
        "sep=;\nstrain [%];force [N]\n0,5;10,25\n1;20\n",
        "sep=,\nstrain [%],force [N]\n0.5,10.25\n1,20\n",
        "strain [%]\tforce [N]\n0,5\t10,25\n1\t20\n",
        "strain [%]\tforce [N]\n0.5\t10.25\n1\t20\n",
        '"strain [%]";"force [N]"\n"0,500";"10,250"\n"1,000";"20,000"\n',
        '"force [N]","strain [%]"\n"10.25","0.5"\n"20","1"\n',
    ],
)
def test_separators_and_decimal_commas_of_any_country(tmp_path, text):
    assert_is_the_curve(read(written(tmp_path, text)))


@pytest.mark.parametrize(
    "text, line",
    [
        ("strain [%]; force [N]\n0.5; 10\n1,5; 20\n", "line 3 = '1,5': must be written without"),
        ("strain [%]; force [N]\n1; 1,025\n2; 2,050\n", "line 2 = '1,025': must be written with"),
        ("strain [%]; force [N]\n0,5; 1.025,5\n", "line 2 = '0,5': must be written without"),
        ("strain [%]; force [N]\n0,5; 1,025,500\n", "line 2 = '1,025,500': must be written"),
        ("strain [%], force [N]\n0,5, 10,25\n", "line 2 = '0, 5, 10, 25': if these are decimal"),
        ('strain [%], force [N]\n"0,5", 10\n', "line 2, strain = '0,5': write a decimal point"),
        ('strain [%], force [N]\n0.5, "10\n1, 20\n', "line 2: has a quotation mark that is not"),
        ("strain [%], force [N]\n0.5 10\n", "line 2 = '0.5 10': must be two numbers"),
    ],
)
def test_what_may_be_read_in_two_ways_is_refused(tmp_path, text, line):
    with pytest.raises(InputError) as refused:
        read(written(tmp_path, text))
    assert f"curve.csv: {line}" in str(refused.value)


@pytest.mark.parametrize("bad", ["nan", "NaN", "inf", "-inf", "Infinity", "1e999", "1_0", "", "x"])
@pytest.mark.parametrize("column", ["strain", "force"])
def test_what_is_no_finite_number_is_named_with_its_line(tmp_path, column, bad):
    cells = {"strain": "0.7", "force": "15"} | {column: bad}
    path = written(tmp_path, CURVE + "{strain}, {force}\n".format(**cells))
    with pytest.raises(InputError) as refused:
        read(path)
    expected = f"curve.csv: line 4, {column} = {bad!r}: must be a finite number"
    assert str(refused.value).endswith(expected)


def test_an_hdf5_file_in_memory_is_the_file_on_disk(tmp_path):
    with files.write_hdf5(tmp_path / "a.h5", "test 1", note="µ") as file:
        file["group/a"] = np.arange(5.0)
    with read_formats.read_hdf5(tmp_path / "a.h5", "test 1") as file:
        assert file.attrs["note"] == "µ"
        assert list(file["group/a"]) == [0, 1, 2, 3, 4]
