"""Fabric files made from data-sheet values: `weavecell fabrics new`.

The values come from prompts or from a CSV file with the columns key, warp, weft and, if wanted, source and status:

    key, warp, weft, source
    linear_density, 1100 dtex, 1100 dtex, data sheet of the yarn
    crimp, 1.2 %, 0.8 %, measured on the fabric

Curves of tests (`weavecell.scenes.curves`) replace modulus, failure strain or the trellis law by fits.
"""

from __future__ import annotations

import csv
from dataclasses import dataclass, field, replace
from pathlib import Path

from fabrics import assumed, catalogue
from fabrics.checks import FilePath
from fabrics.errors import InputError
from fabrics.fabric import Fabric
from fabrics.files import replace_whole
from fabrics.units import si
from weavecell.scenes import curves

# key: SI unit, example, meaning
KEYS = {
    "linear_density": ("kg/m", "1100 dtex", "mass per length of the yarn"),
    "fibre_density": ("kg/m^3", "1.44 g/cm^3", "density of the fibre"),
    "modulus": ("Pa", "90 GPa", "axial modulus of the fibre"),
    "failure_strain": ("", "3.3 %", "failure strain of the fibre"),
    "crimp": ("", "1.2 %", "yarn length over length of fabric, minus one"),
    "count": ("1/m", "8.5 / cm", "yarns per width of fabric"),
}
OPTIONAL = {"width": ("m", "1.1 mm", "width of the yarn in the fabric, across its family")}
COLUMNS = ("key", "warp", "weft", "source", "status")


@dataclass(frozen=True)
class Value:
    """One value of both families, as written, with where it comes from."""

    warp: str
    weft: str
    source: str
    status: str = "user"


@dataclass(frozen=True)
class Draft:
    """A fabric file to be written.

    Parameters
    ----------
    name : of the fabric
    values : {key of KEYS or OPTIONAL: Value}
    shear : {key: (value, source, status)} of [shear], or empty
    """

    name: str
    values: dict[str, Value]
    shear: dict[str, tuple[str, str, str]] = field(default_factory=dict)

    def text(self) -> str:
        """The TOML file."""
        lines = [
            "# Made by `weavecell fabrics new`. Tables that are not given, [shear] and [solid], are assumed by fibre",
            "# family, with a range; [compression] comes from `weavecell calibrate`.",
            f"name = {_quoted(self.name)}",
        ]
        for family in ("warp", "weft"):
            lines += ["", f"[{family}]"]
            lines += [
                f"{key} = {_entry(getattr(value, family), value.source, value.status)}"
                for key, value in self.values.items()
            ]
        if self.shear:
            lines += ["", "[shear]", *(f"{key} = {_entry(*entry)}" for key, entry in self.shear.items())]
        return "\n".join(lines) + "\n"

    def write(self, path: FilePath) -> Fabric:
        """Write the file, never over one that is there; returns the Fabric that it holds.

        Raises
        ------
        InputError : the file exists, or its values are not those of a fabric; nothing has been written
        """
        path = Path(path)
        if path.exists():
            raise InputError("exists already", file=path)
        with replace_whole(path) as beside:
            beside.write_text(self.text(), encoding="utf-8")
            try:
                return catalogue.read(beside)
            except InputError as problem:
                raise InputError(file=path, key=problem.key, value=problem.value, allowed=problem.allowed) from None


def check(key: str, text: str) -> str:
    """The text of one value; InputError where it is no quantity of the key's unit."""
    si(text if (KEYS | OPTIONAL)[key][0] or "%" in text else _plain(text), (KEYS | OPTIONAL)[key][0], key=key)
    return text.strip()


def read_values(path: FilePath) -> dict[str, Value]:
    """Values of a CSV file.

    Raises
    ------
    InputError : one line naming the file, the line, the value and what is allowed
    """
    try:
        with open(path, encoding="utf-8", newline="") as file:
            rows = [[cell.strip() for cell in row] for row in csv.reader(file) if row and not row[0].startswith("#")]
    except (OSError, UnicodeDecodeError) as problem:
        raise InputError("cannot be read", file=path, allowed="a CSV file of key, warp, weft") from problem
    if not rows or rows[0][:3] != list(COLUMNS[:3]) or not set(rows[0]) <= set(COLUMNS):
        raise InputError(file=path, key="columns", value=", ".join(rows[0] if rows else ()), allowed=", ".join(COLUMNS))
    found = {}
    for row in rows[1:]:
        entry = dict(zip(rows[0], row))
        key = entry["key"]
        if key not in KEYS | OPTIONAL or len(row) > len(rows[0]) or len(row) < 3:
            raise InputError(file=path, key="key", value=key, allowed=f"one of {', '.join(KEYS | OPTIONAL)}")
        try:
            warp, weft = check(key, entry["warp"]), check(key, entry["weft"] or entry["warp"])
        except InputError as problem:
            raise InputError(file=path, key=key, value=problem.value, allowed=problem.allowed) from None
        source = entry.get("source") or Path(path).name
        found[key] = Value(warp, weft, source, entry.get("status") or "user")
    missing = [key for key in KEYS if key not in found]
    if missing:
        raise InputError("is missing", file=path, key=missing[0], allowed=f'such as "{KEYS[missing[0]][1]}"')
    return found


def with_curves(
    draft: Draft, *, yarn: FilePath | None = None, frame: FilePath | None = None, side: float | None = None
) -> tuple[Draft, list[str]]:
    """The draft with values that are fitted to curves, and a line about each fit.

    Parameters
    ----------
    yarn : CSV file of a yarn's strain and force, of both families
    frame : CSV file of a picture-frame test
    side : [m] of the frame, where the file gives the force

    Raises
    ------
    InputError : a bad file, or a draft that is no fabric
    """
    fitted = []
    if yarn is not None:
        fit = curves.yarn_tension(yarn)
        values = dict(draft.values)
        of_fibres = [
            si(getattr(values["fibre_density"], family), "kg/m^3")
            / si(getattr(values["linear_density"], family), "kg/m")
            for family in ("warp", "weft")
        ]
        source = f"tensile curve of the yarn, {curves.name_of(yarn)}"
        moduli = [f"{1e-9 * fit.EA * per_area:.5g} GPa" for per_area in of_fibres]
        strain = f"{100 * fit.failure_strain:.5g} %"
        values["modulus"] = Value(moduli[0], moduli[1], source, "fitted")
        values["failure_strain"] = Value(strain, strain, source, "fitted")
        draft = replace(draft, values=values)
        fitted.append(
            f"fitted: modulus {moduli[0]}, failure strain {strain} (rms {fit.rms:.3g} N, slack {100 * fit.slack:.3g} %)"
        )
    if frame is not None:
        found = curves.picture_frame(frame, _thickness(draft), side)
        law, source = found.law, f"picture-frame curve, {curves.name_of(frame)}"
        if not found.locked:
            source += "; ends before the yarns lock: G2 and gamma2 are not determined"
        texts = {"G1": f"{1e-6 * law.G1:.6g} MPa", "G2": f"{1e-6 * law.G2:.6g} MPa"}
        texts |= {"gamma1": f"{law.gamma1:.6g}", "gamma2": f"{law.gamma2:.6g}"}
        draft = replace(draft, shear={key: (value, source, "fitted") for key, value in texts.items()})
        fitted.append(f"fitted: trellis law, rms {1e-6 * found.rms:.3g} MPa" + ("" if found.locked else ", not locked"))
    return draft, fitted


def left_open(fabric: Fabric) -> list[str]:
    """A line about each table that will be assumed, or has to be given."""
    try:
        return assumed.lines(assumed.with_solid_laws(assumed.with_shear(fabric)))
    except InputError as problem:
        return [str(problem)]


def _thickness(draft):
    """[m] of the fabric as a shell."""
    from fabrics.weave import Weave
    from fabrics.yarn import Yarn

    def of(family, key):
        return si(_plain(getattr(draft.values[key], family)), KEYS[key][0], key=key)

    yarns = [
        Yarn(*(of(family, key) for key in ("linear_density", "fibre_density", "modulus", "failure_strain", "crimp")))
        for family in ("warp", "weft")
    ]
    return Weave(*yarns, of("warp", "count"), of("weft", "count")).thickness


def _plain(text):
    """A number where the text is one: ratios carry no unit."""
    try:
        return float(text)
    except ValueError:
        return text


def _entry(value, source, status):
    return f"{{ value = {_quoted(value)}, source = {_quoted(source)}, status = {_quoted(status)} }}"


def _quoted(text):
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'
