"""Every reader of a user's table takes what instruments and laboratories export, in ten forms."""

from unittest import mock

import numpy as np
import pytest

from fabrics.base.errors import InputError
from fabrics.base.tables import QUANTITIES, WORDS, read_table
from fabrics.plate_curve import PlateCurve
from unitcell3d.cases import load_path
from weavecell.runs import laboratory_tests
from weavecell.scenes import curves, fabric_file
from weavecell.studies import displacement_record, pull_out_tests
from weavecell.studies.compression_records import CompressionRecord

N = np.arange(1, 21)


def curve_of(read, path, *sizes):
    """The curve that a reader of curves fits, without the fit."""
    with mock.patch.object(
        curves, "_fit_shear", lambda path, *curve, **_: np.array(curve).tolist()
    ):
        return read(path, *sizes)


# reader, its columns {heading: (unit, cells)}; all numbers have a decimal point
READERS = {
    "record of a shot": (
        displacement_record.read,
        {"time": ("us", 0.25 + 2.5 * N), "displacement": ("mm", 0.125 + 0.3 * N - 0.001 * N**2)},
    ),
    "compression record": (
        lambda path: (
            CompressionRecord.read(path).load.tolist(),
            CompressionRecord.read(path).closed.tolist(),
        ),
        {"force": ("kN", 0.15 + 0.25 * N), "displacement": ("um", 90.5 - 80.5 / N)},
    ),
    "picture frame": (
        lambda path: curve_of(curves.picture_frame, path, 3e-4),
        {"shear angle": ("deg", 0.5 + 2.25 * N), "shear stress": ("kPa", 0.35 * N + 0.02 * N**3)},
    ),
    "bias strip": (
        lambda path: curve_of(curves.bias_extension, path, 3e-4, (0.05, 0.2)),
        {"displacement": ("mm", 0.5 + 1.25 * N), "force": ("N", 0.35 * N + 0.02 * N**3)},
    ),
    "tensile curve": (
        lambda path: repr(curves.yarn_tension(path)),
        {"strain": ("%", 0.125 * N), "force": ("N", 9.5 * N + 0.25)},
    ),
    "plate curve": (
        lambda path: (
            PlateCurve.read(path).pressure.tolist(),
            PlateCurve.read(path).closure.tolist(),
        ),
        {"pressure": ("MPa", 0.25 * N), "closure": ("um", 60.5 - 60.5 / N)},
    ),
    "corners of a path": (
        lambda path: load_path.read(path).tolist(),
        {"d1": ("um", 1.5 * N), "d2": ("um", 2.25 * N)},
    ),
    "pull-outs": (
        lambda path: [
            (one.group, one.peak)
            for one in pull_out_tests.read(path, {"warp": 1e-3, "weft": 1e-3}, pulled="weft")
        ],
        {
            "crossings": ("", 5 + N),
            "peak load": ("gf", 30.5 + 2.5 * N**2),
            "tension": ("N", 0.25 * N),
        },
    ),
    "tests of a laboratory": (
        lambda path: laboratory_tests.read(path).to_dict("list"),
        {
            "velocity": ("ft/s", 290.5 + 2.5 * N),
            "outcome": ("", np.where(N % 3, "PP", "CP")),
            "residual velocity": ("m/s", np.where(N % 3, 0.0, 10.5 + N)),
        },
    ),
}


def heading(name, unit, form):
    """A heading with its unit, by a form of {name} and {unit}; a column of words has its name."""
    if not unit:
        return name
    return form.format(name=name, unit=unit)


def table(columns, form="{name} [{unit}]", separator=",", *, mark=".", units=None, quote=""):
    """The text of a table; units : form of those in a row below the heading, which has none then."""
    rows = [[heading(name, unit, form) for name, (unit, _) in columns.items()]]
    if units:
        rows.append([heading("", unit, units) for unit, _ in columns.values()])
    rows += [
        [str(cell).replace(".", mark) for cell in cells]
        for cells in zip(*(cells for _, cells in columns.values()))
    ]
    return "".join(separator.join(f"{quote}{c}{quote}" for c in row) + "\n" for row in rows)


def with_others(columns):
    """A column before and one behind those that are asked for."""
    return {"shot no.": ("", N), **columns, "remark": ("", np.full(N.shape, "off, centre"))}


PREAMBLE = "Model,X-3024\nSample interval,4e-09\nComment,,\n\n"
FORMS = {
    "brackets and capitals": lambda c: table(
        {name.upper(): column for name, column in c.items()}, "{name} ({unit})"
    ),
    "semicolons and decimal commas": lambda c: table(c, separator=";", mark=","),
    "tabs, units below": lambda c: table(c, "{name}", "\t", mark=",", units="{unit}"),
    "quotes, units below in brackets": lambda c: table(c, "{name}", units="({unit})", quote='"'),
    "a preamble": lambda c: PREAMBLE + table(c),
    "a preamble, semicolons": lambda c: "Prüfer;M. M.\nDatum;2.3.2026\n" + table(c, separator=";"),
    "a heading that begins with #": lambda c: "# made up\n# " + table(c),
    "other columns": lambda c: table(with_others(c), separator=";"),
    "a solidus": lambda c: table(c, "{name} / {unit}"),
    "underlines": lambda c: table(
        {name.replace(" ", "_"): column for name, column in c.items()}, "{name}_{unit}"
    ),
    "a word between": lambda c: table(c, "{name} in {unit}", "\t"),
    "other ends of lines": lambda c: "\ufeff" + table(c).replace("\n", "\r\n") + ",,\r\n",
}


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("reader", READERS)
def test_a_table_says_the_same_in_each_form(tmp_path, reader, form):
    read, columns = READERS[reader]
    (tmp_path / "plain.csv").write_text(table(columns), "utf-8")
    (tmp_path / "form.csv").write_text(FORMS[form](columns), "utf-8")
    wanted = read(tmp_path / "plain.csv")
    assert str(read(tmp_path / "form.csv")) == str(wanted)


def test_values_of_a_data_sheet_in_other_forms(tmp_path):
    plain = (
        "key,warp,weft,source\nthickness,0.35 mm,,\nlinear_density,1100 dtex,930.5 dtex,a list\n"
    )
    others = (
        "Key;Warp;Weft;Source\nthickness;0,35 mm;;\nlinear_density;1100 dtex;930,5 dtex;a list\n",
        "Sheet 12,,\n# rev. 3\n" + plain,
        plain.replace("warp,weft", "ends,fill"),
        "key,warp,weft,source,page\nthickness,0.35 mm,,,1\n"
        "linear_density,1100 dtex,930.5 dtex,a list,2\n",
    )
    columns = {"key": WORDS, "warp": QUANTITIES, "weft": QUANTITIES, "source": WORDS}
    assert fabric_file.COLUMNS.items() >= columns.items()
    found = []
    for number, text in enumerate((plain, *others)):
        path = tmp_path / f"{number}.csv"
        path.write_text(text)
        rows = read_table(path, columns, what="a sheet", example="key", optional=("source",)).rows()
        found.append([cells for _, cells in rows])
    assert found[1:] == [found[0]] * 4
    assert found[0][1] == {
        "key": "linear_density",
        "warp": "1100 dtex",
        "weft": "930.5 dtex",
        "source": "a list",
    }


def test_what_machines_call_a_column_is_told(tmp_path, caplog):
    path = tmp_path / "machine.csv"
    path.write_text("Time (sec),Extension (mm),Load (kN),Position (mm)\n0.5,1.5,0.02,7\n")
    with caplog.at_level("INFO", "weavecell"):
        kinds = {"displacement": "m", "force": "N"}
        found = read_table(path, kinds, what="a curve", example="force [N]")
    assert found.cells == {"displacement": ["1.5"], "force": ["0.02"]}
    assert found.scales == {"displacement": 1e-3, "force": 1e3}
    told = [record.getMessage().partition(": ")[2] for record in caplog.records]
    assert told == [
        "Extension (mm) is taken for displacement",
        "Load (kN) is taken for force",
        "left out, columns that are not known: Time (sec), Position (mm)",
    ]


@pytest.mark.parametrize(
    "text, message",
    [
        ("time [us],Time [s],displacement [mm]\n1,2,3\n", "a column time that is there once"),
        ("time,displacement [mm]\n1,2\n", "heading = 'time': has no unit"),
        ("time [us],displacement [mm]\n(s),(mm)\n1,2\n", "must be one unit: the row below says s"),
        ("time [us],displacement [kg]\n1,2\n", "displacement = '1 kg': must be a text with a unit"),
        ("time [us]\n1\n", "columns = 'time [us]': must be time and displacement"),
        ("time [us],displacement [mm],x\n1\n", "line 2 = '1': must be 3 cells"),
        ("", "is empty; must be a record of a shot: time and displacement"),
    ],
)
def test_what_is_wrong_with_a_heading_is_named(tmp_path, text, message):
    path = tmp_path / "record.csv"
    path.write_text(text)
    with pytest.raises(InputError) as refused:
        displacement_record.read(path)
    assert message in str(refused.value)
