"""Fabric files made from data-sheet values: `weavecell fabrics new`.

The values come from prompts, from a data sheet as its maker prints it (`weavecell.scenes.printed_draft`), or from
a CSV file with the columns key, warp, weft and, if wanted, source and status, which is read to the letter:

    key, warp, weft, source
    linear_density, 1100 dtex, 1100 dtex, data sheet of the yarn
    tenacity, 2350 mN/tex, 2350 mN/tex, data sheet of the yarn
    thickness, 0.30 mm, , data sheet of the fabric

Rows may have the names that makers use (`weavecell.scenes.sheet_names`). A value of the fabric as a
whole stands in the column warp. Crimp may be left out if the thickness is given, and the failure
strain where strength or tenacity is (`fabrics.data_sheet`). Curves of tests
(`weavecell.scenes.curves`) replace modulus, failure strain or the trellis law by fits.
"""

from __future__ import annotations

import json
import re
from collections.abc import Collection
from dataclasses import dataclass, field, replace
from math import degrees
from pathlib import Path

from fabrics import assumed, catalogue, plausible
from fabrics.base import tables
from fabrics.base.checks import FilePath
from fabrics.base.door import option
from fabrics.base.errors import InputError, nearest, together
from fabrics.base.files import read_text, replace_whole
from fabrics.base.units import refused, si
from fabrics.fabric import Fabric
from fabrics.fabric_tables import OF_FABRIC
from fabrics.families.trellis import LEAST_RISE
from fabrics.pattern import Pattern
from weavecell.scenes import curves, sheet_names
from weavecell.scenes.missing_values import BREAKING, Value, complete
from weavecell.scenes.sheet_names import ALL, WEAVE

# row of a CSV file, and key of the file that is made of it
IDEALISED = "idealised"
# of both yarns
REQUIRED = ("linear_density", "fibre_density", "modulus", "failure_strain", "crimp", "count")
# key of REQUIRED that may be left out: keys of which one then stands in for it
INSTEAD = {
    "failure_strain": ("strength", BREAKING, "tenacity"),
    "crimp": ("areal_density", "thickness"),
}
# which the tensile curve of a yarn gives
OF_YARN_CURVE = ("modulus", "failure_strain")
# of which a fibre family has a typical value
TYPICAL = ("fibre_density", "modulus", "failure_strain")
COLUMNS = {
    "key": tables.WORDS,
    "warp": tables.QUANTITIES,
    "weft": tables.QUANTITIES,
    "source": tables.WORDS,
    "status": tables.WORDS,
}


@dataclass(frozen=True)
class Draft:
    """A fabric file to be written.

    Parameters
    ----------
    name : of the fabric
    values : {key of ALL: Value}
    shear : {key: (value, source, status)} of [shear], or empty
    file : of the values, named in errors in place of the fabric file
    family : of `fabrics.families` that the file names, or None
    idealised : whether numbers beyond the plausible are meant
    remarks : comments on the sheet that the file is made of
    """

    name: str
    values: dict[str, Value]
    shear: dict[str, tuple[str, str, str]] = field(default_factory=dict)
    file: FilePath | None = None
    family: str | None = None
    idealised: bool = False
    remarks: tuple[str, ...] = ()
    shear_curve: FilePath | None = None

    def fabric(self) -> Fabric:
        """Build the Fabric of these values.

        Raises
        ------
        InputError : they are not those of a fabric; it names the row of a sheet or the curve that
            gives what is wrong
        """
        try:
            return catalogue.read(self.file or f"{self.name}.toml", self.text())
        except InputError as problem:
            parts = getattr(problem, "problems", (problem,))
            raise together([self._trace(part) for part in parts]) from None

    def _trace(self, problem):
        """The InputError of a key of the fabric file, with where its value comes from."""
        family, _, key = (problem.key or "").rpartition(".")
        value = self.values.get(key)
        if family == "shear" and self.shear_curve is not None:
            return problem.changed(file=self.shear_curve, made="fitted to this curve")
        if value is None:
            return problem
        text = getattr(value, family or "warp") or value.warp
        made = ""
        if value.stands_in or value.curve:
            made = f"{value.status}: {value.source}"
        file = value.curve or problem.file
        return problem.changed(file=file, value=text, line=value.row, made=made)

    def text(self) -> str:
        """Write the TOML file."""
        lines = [
            "# Made by `weavecell fabrics new`. Tables that are not given, [shear] and [solid], are assumed by fibre",
            "# family, with a range; [compression] comes from `weavecell calibrate`.",
            *(f"# {remark}" for remark in self.remarks),
            f"name = {_quote(self.name)}",
        ]
        lines += [] if self.family is None else [f"family = {_quote(self.family)}"]
        lines += ["idealised = true"] * self.idealised
        if WEAVE in self.values:
            lines.append(f"{WEAVE} = {_quote(self.values[WEAVE].warp)}")
        for key, value in self.values.items():
            if key in OF_FABRIC:
                lines.append(f"{key} = {_entry(value.warp, value.source, value.status)}")
        for family in ("warp", "weft"):
            lines += ["", f"[{family}]"]
            for key, value in self.values.items():
                if key not in OF_FABRIC and key != WEAVE:
                    ends = value.ranges.get(family)
                    entry = _entry(getattr(value, family), value.source, value.status, ends)
                    lines.append(f"{key} = {entry}")
        if self.shear:
            lines += [
                "",
                "[shear]",
                *(f"{key} = {_entry(*entry)}" for key, entry in self.shear.items()),
            ]
        return "\n".join(lines) + "\n"

    def write(self, path: FilePath) -> Fabric:
        """Write the file, never over one that is there; returns the Fabric that it holds.

        Raises
        ------
        InputError : the file exists, or its values are not those of a fabric; nothing has been
            written
        """
        path = Path(path)
        if path.exists():
            raise InputError("exists already", file=path)
        fabric = self.fabric()
        with replace_whole(path) as beside:
            beside.write_text(self.text(), encoding="utf-8")
        return fabric


def check(key: str, text: str, idealised: bool = False) -> str:
    """Check the text of one value; InputError if it is not a quantity of a unit that the key may
    have, or out of bounds that an `idealised` fabric has too."""
    try:
        ALL[key].read(text, key=key, idealised=idealised)
    except InputError as problem:
        others = [name for name in ALL if name != key and ALL[name].takes(text)]
        if ALL[key].takes(text) or not others:
            raise
        allowed = f"{problem.allowed}; this is a unit of {' or '.join(others)}"
        raise problem.changed(allowed=allowed) from None
    return text.strip()


def read_values(
    path: FilePath, family: str | None = None, fitted: Collection[str] = ()
) -> tuple[dict[str, Value], bool]:
    """Read the values of a CSV file, and complete them by the fibre family (`missing_values`); with
    whether the file says that its fabric is idealised.

    Parameters
    ----------
    family : that the user names, or None
    fitted : keys that a curve gives, which the file may lack

    Raises
    ------
    InputError : all that is wrong, a line each naming the file, the key, the value and what is
        allowed
    """
    table = tables.read_table(
        path,
        COLUMNS,
        what="a CSV file of key, warp, weft",
        example="key, warp, weft",
        optional=("weft", "source", "status"),
    )
    values: dict[str, Value] = {}
    problems: list[InputError] = []
    tried: set[str] = set()
    lines: dict[str, str] = {}
    rows = list(sheet_names.named(table.rows(), (*ALL, IDEALISED), path))
    idealised = _is_idealised(rows, path, problems)
    for line, cells in rows:
        key = cells["key"]
        tried |= {key, nearest(key, ALL) or key}
        if lines.setdefault(key, line) != line:
            message = f"{key} is given in {lines[key]} already"
            problems.append(InputError(message, file=path, key=line, allowed="given once"))
        elif key == IDEALISED:
            continue
        elif key == WEAVE:
            values[key] = _weave(cells, line, path)
        elif (value := _row(cells, line, path, problems, idealised)) is not None:
            values[key] = value
    values = complete(values, family)
    tried |= set(values)
    for key in (key for key in REQUIRED if key not in fitted):
        others = INSTEAD.get(key, ())
        if not tried & {key, *others}:
            more = ""
            if key in TYPICAL:
                named = option("family", "...")
                more = f"; or {named} with its fibre family, whose typical value is then assumed"
            if others:
                more = f", or {' or '.join(others)} in its place{more}"
            allowed = f'such as "{ALL[key].example}"{more}'
            problems.append(InputError("is missing", file=path, key=key, allowed=allowed))
    if problems:
        raise together(problems)
    return values, idealised


def read_draft(path: FilePath, name: str, family: str | None, fitted: Collection[str]) -> Draft:
    """Return the draft of a CSV file, whose arguments are those of `read_values`."""
    values, idealised = read_values(path, family, fitted)
    return Draft(name, values, file=path, family=family, idealised=idealised)


def is_own_table(path: FilePath) -> bool:
    """Tell whether a file has the heading of this project, key, warp, weft, and is read to the letter."""
    try:
        lines = [line for line in read_text(path).splitlines() if line.strip(' ,;\t"')]
    except OSError:
        return True
    for line in lines:
        first, *others = re.split(r"[,;\t]", line)
        if first.strip('# "').lower() == "key" and others:
            return sheet_names.column(others[0]) != "value"
    return not lines


def _is_idealised(rows, path, problems):
    """Whether a row says that numbers beyond the plausible are meant."""
    for line, cells in rows:
        if cells["key"] != IDEALISED:
            continue
        text = cells["warp"]
        if text.lower() not in ("true", "false") or cells.get("weft"):
            allowed = "true or false, in the column warp"
            value = ", ".join(filter(None, (text, cells.get("weft"))))
            where = f"{line}, {IDEALISED}"
            problems.append(InputError(file=path, key=where, value=value, allowed=allowed))
        return text.lower() == "true"
    return False


def _weave(entry, line, path):
    """The Value of the row that names the weave."""
    for column in ("weft", "status"):
        if entry.get(column):
            where = f"{line}, {WEAVE}, {column}"
            allowed = "left out: the weave is one of both families, in the column warp"
            raise InputError(file=path, key=where, value=entry[column], allowed=allowed)
    try:
        pattern = Pattern.read(entry["warp"])
    except InputError as problem:
        raise problem.changed(file=path, key=f"{line}, {WEAVE}") from None
    return Value(pattern.name, "", entry.get("source") or Path(path).name)


def _row(entry, line, path, problems, idealised):
    """The Value of one row, or None with what is wrong with it added to `problems`."""
    key = entry["key"]
    if key not in ALL:
        near = nearest(key, (*ALL, IDEALISED))
        hint = None
        if near:
            hint = f'is not a known key, did you mean "{near}"?'
        if hint:
            allowed = None
        else:
            allowed = f"one of {', '.join((*ALL, IDEALISED))}"
        problems.append(InputError(hint, file=path, key="key", value=key, allowed=allowed))
        return None
    texts = []
    wrong = len(problems)
    if key in OF_FABRIC and entry.get("weft"):
        allowed = (
            f"left out in the column weft: {key} is one value of the fabric, in the column warp"
        )
        where = f"{line}, {key}"
        problems.append(InputError(file=path, key=where, value=entry["weft"], allowed=allowed))
    weft = ""
    if key not in OF_FABRIC:
        weft = entry.get("weft") or entry["warp"]
    for family, text in (("warp", entry["warp"]), ("weft", weft)):
        try:
            texts.append(check(key, text, idealised) if text or family == "warp" else "")
        except InputError as problem:
            if not (family == "weft" and text == entry["warp"]):
                wrong_one = refused(problem.value, problem.allowed, file=path, key=key)
                problems.append(wrong_one.changed(line=_number_of(line)))
    status = entry.get("status") or "user"
    if status not in catalogue.STATUSES:
        allowed = f"one of {', '.join(catalogue.STATUSES)}"
        problems.append(InputError(file=path, key=f"{key}, status", value=status, allowed=allowed))
    if len(problems) > wrong:
        return None
    source = entry.get("source") or Path(path).name
    return Value(*texts, source, status, row=_number_of(line))


def _number_of(line):
    """The number of a line that is named, such as "line 4"."""
    return int(line.rpartition(" ")[2])


def with_curves(
    draft: Draft,
    *,
    yarn: FilePath | None = None,
    frame: FilePath | None = None,
    side: float | None = None,
    bias: FilePath | None = None,
    strip: tuple[float, float] | None = None,
) -> tuple[Draft, list[str]]:
    """Return the draft with values that are fitted to curves, and a line about each fit.

    Parameters
    ----------
    yarn : CSV file of a yarn's strain and force, of both families
    frame : CSV file of a picture-frame test
    side : [m] of the frame, if the file gives the force
    bias : CSV file of a bias strip
    strip : (width, length) [m] of it

    Raises
    ------
    InputError : a bad file, or a draft that does not make a fabric
    """
    fitted = []
    if yarn is not None:
        fit = curves.yarn_tension(yarn)
        values = dict(draft.values)
        for key in ("linear_density", "fibre_density"):
            if key not in values:
                raise InputError(
                    "is missing, which the curve of a yarn needs", file=draft.file, key=key
                )
        of_fibres = []
        for family in ("warp", "weft"):
            fibre_density = si(getattr(values["fibre_density"], family), "kg/m^3")
            linear_density = si(getattr(values["linear_density"], family), "kg/m")
            of_fibres.append(fibre_density / linear_density)
        source = f"tensile curve of the yarn, {curves.name_of(yarn)}"
        moduli = [f"{1e-9 * fit.EA * per_area:.5g} GPa" for per_area in of_fibres]
        strain = f"{100 * fit.failure_strain:.5g} %"
        curve = str(yarn)
        values["modulus"] = Value(moduli[0], moduli[1], source, "fitted", curve=curve)
        values["failure_strain"] = Value(strain, strain, source, "fitted", curve=curve)
        for key in INSTEAD["failure_strain"]:
            values.pop(key, None)
        draft = replace(draft, values=values)
        fitted.append(
            f"fitted: modulus {moduli[0]}, failure strain {strain} (rms {fit.rms:.3g} N, slack {100 * fit.slack:.3g} %)"
        )
    if frame is not None and bias is not None:
        ways = f"{option('picture_frame', '')} or {option('bias_extension', '')}"
        raise InputError(f"give one curve of shear: {ways}")
    fitted += [f"note: {note}" for note in plausible.judge(_of_specimen(side, strip))]
    if frame is not None:
        fabric = draft.fabric()
        shear = curves.picture_frame(frame, fabric.weave.thickness, side)
        # what is wrong with the law is wrong with this curve, not with the values of the draft
        plausible.judge(plausible.of_shear(shear.law, fabric), curve=frame)
        return _with_shear(
            draft, shear, f"picture-frame curve, {curves.name_of(frame)}", fitted, frame
        )
    if bias is not None:
        fabric = draft.fabric()
        shear = curves.bias_extension(bias, fabric.weave.thickness, strip)
        plausible.judge(plausible.of_shear(shear.law, fabric), curve=bias)
        return _with_shear(draft, shear, f"bias strip, {curves.name_of(bias)}", fitted, bias)
    return draft, fitted


def _of_specimen(side, strip):
    """The sizes of a frame and of a strip, each None if there is none, that are compared with
    plausible ranges."""
    if side is not None:
        yield plausible.Number("frame_side", "frame_side", side)
    if strip is not None:
        yield plausible.Number("strip", "strip_width", strip[0])
        yield plausible.Number("strip", "strip_length", strip[1])


def _with_shear(draft, fit, source, fitted, curve):
    """(The draft with a fitted trellis law, the lines about the fits)."""
    law = fit.law
    remarks = []
    if not fit.stiffens:
        remarks.append("does not stiffen: G2 is G1, gamma1 and gamma2 are not determined")
    elif not fit.locked:
        remarks.append("ends before the yarns lock: G2 and gamma2 are not determined")
    if fit.offset > 0:
        remarks.append(f"the law leaves out {1e-6 * fit.offset:.3g} MPa at the angle zero")
    source = "; ".join([source, *remarks])
    texts = {"G1": f"{1e-6 * law.G1:.6g} MPa", "G2": f"{1e-6 * law.G2:.6g} MPa"}
    # a curve of two lines has both at one angle
    gamma2 = max(law.gamma2, law.gamma1 + LEAST_RISE)
    texts |= {"gamma1": f"{law.gamma1:.6g}", "gamma2": f"{gamma2:.6g}"}
    shear = {key: (value, source, "fitted") for key, value in texts.items()}
    constants = f"G1 {1e-6 * law.G1:.4g} MPa, G2 {1e-6 * law.G2:.4g} MPa"
    constants += f", gamma1 {degrees(law.gamma1):.3g} deg, gamma2 {degrees(law.gamma2):.3g} deg"
    fitted_law = f"fitted: trellis law {constants}, rms {1e-6 * fit.rms:.3g} MPa"
    line = "; ".join([fitted_law, *remarks])
    draft = replace(draft, shear=shear, shear_curve=curve)
    draft.fabric()
    return draft, [*fitted, line]


def left_open(fabric: Fabric, path: FilePath) -> list[str]:
    """Write a line about each number that disagrees with another, each table that will be assumed,
    and at the end what is missing in the file at `path`."""
    missing = [f"missing: the compression law, which `weavecell calibrate {path}` computes"]
    try:
        fabric = assumed.with_solid_laws(assumed.with_shear(fabric))
    except InputError as problem:
        missing.insert(0, f"missing: {problem}")
    return [*fabric.notes, *assumed.lines(fabric), f"written to {path}", *missing]


def _entry(value, source, status, ends=None):
    span = ""
    if ends is not None:
        low, high = map(_quote, ends)
        span = f" low = {low}, high = {high},"
    return (
        f"{{ value = {_quote(value)},{span} source = {_quote(source)}, status = {_quote(status)} }}"
    )


def _quote(text):
    # as JSON has it, but TOML escapes DEL too
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")
