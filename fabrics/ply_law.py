"""Contact law of two neighbouring plies: pressure against closure, per area, the same on every mesh.

Closure is the thickness that two half plies lose under a pressure from outside, from their thickness at rest on; of two
plies of one fabric it is what one ply loses between platens. The weave gives way first (127 to 240 um up to 19.4 MPa in
the 3D crossovers of six Kevlar 129 fabrics), then fibre is pressed on fibre:

    p(d)  from samples, linear between them,        dp/dd = E_c rho_f / A_d  beyond the last one

with E_c the transverse modulus of packed yarn, rho_f the density of the fibre and A_d the areal density of a ply, so
that A_d / rho_f is the thickness of a solid sheet of its fibre.

Sources, of which `PlyLaw.of` takes the first that there is:

1. the fabric's own law ([ply_contact] of its file), such as the platen curve of its 3D crossover, "computed";
2. solid fibre alone, "assumed".

The pressure law of packs of the thesis (`of_packs`, "fitted") is used where it is named.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from fabrics.assumed import family_of, transverse_moduli, with_solid_laws
from fabrics.checks import FilePath, FloatArray, positive
from fabrics.errors import InputError
from fabrics.fabric import Fabric
from fabrics.fabric_tables import STATUSES
from fabrics.files import read_columns
from fabrics.plate_curve import PlateCurve
from fabrics.units import si

TESTED = 4  # plies of the packs that the thesis takes the contact of plies from (section 5.2.2)
_TABLE = ("closure", "pressure", "source", "status")
UNITS = {"closure": "m", "pressure": "Pa"}

SOLID_TRAVEL = (
    1e-6  # [m] to the one sample of a law without travel, which is a straight line anyway
)


@dataclass(frozen=True, eq=False)
class PlyLaw:
    """Pressure against closure of two neighbouring plies.

    Parameters
    ----------
    closure : (n,) [m] rising from 0, n at least 2
    pressure : (n,) [Pa] rising from 0
    stiffness : [Pa/m] beyond the last sample
    source : where it comes from
    status : of `STATUSES`

    Raises
    ------
    InputError : samples that do not begin at 0 or do not rise, or a stiffness that is not positive
    """

    closure: np.ndarray
    pressure: np.ndarray
    stiffness: float
    source: str = ""
    status: str = "assumed"

    def __post_init__(self):
        positive(self, "stiffness")
        for key in ("closure", "pressure"):
            column = np.asarray(getattr(self, key), float)
            object.__setattr__(self, key, column)
            if column.ndim != 1 or column.size < 2 or column.size != len(self.closure):
                raise InputError(
                    key=key, value=f"{column.size} values", allowed="at least 2, as many of both"
                )
            if not np.all(np.isfinite(column)) or column[0] != 0 or not np.all(np.diff(column) > 0):
                row = 1 if column[0] != 0 else int(np.argmin(np.diff(column) > 0)) + 2
                raise InputError(
                    key=key,
                    value=f"row {row}",
                    allowed="finite, 0 in the first row and rising from row to row",
                )

    def __eq__(self, other: object) -> bool:
        return (
            isinstance(other, PlyLaw)
            and self.table() == other.table()
            and self.stiffness == other.stiffness
        )

    __hash__ = None  # type: ignore[assignment]

    @classmethod
    def of(cls, fabric: Fabric) -> PlyLaw:
        """The law of a fabric: the first source of the list above that it has.

        Raises
        ------
        InputError : as `solid`
        """
        return cls.solid(fabric) if fabric.ply_contact is None else fabric.ply_contact

    @classmethod
    def chosen(cls, choice: PlyLaw | FilePath, fabric: Fabric) -> PlyLaw:
        """The law that a user names: "solid", "pressure_law", or a file as of `read`; a PlyLaw as it is.

        Raises
        ------
        InputError : as `solid`, `of_packs` and `read`
        """
        if isinstance(choice, PlyLaw):
            return choice
        named = {"solid": cls.solid, "pressure_law": cls.of_packs}
        return named[str(choice)](fabric) if choice in named else cls.read(choice, fabric)

    @classmethod
    def of_packs(cls, fabric: Fabric) -> PlyLaw:
        """The pressure law of packs (thesis eqs. 5-1 to 5-4), "fitted" to tests of Kevlar 129 plain weaves.

        Its closure counts from the 10 N on the platen at which the records begin (erratum E-02), and so does its
        pressure here: 28 kPa less than that of the test, 0.1 % at its end.

        Raises
        ------
        InputError : other than para-aramid yarns, no measured areal density, or one too low for the law
        """
        family = family_of(fabric)
        if family is None or family.of_others or family.name != "para-aramid":
            raise InputError(
                key="ply_contact",
                value="pressure_law",
                allowed="of para-aramid yarns, which were tested",
            )
        if fabric.areal_density_measured is None:
            raise InputError(
                f"fabric {fabric.name} has no areal_density_measured, which the pressure law needs"
            )
        pressure, closure = between_plies(fabric.areal_density_measured)
        source = f"pressure law of packs, thesis eqs. 5-1 to 5-4, at {1e3 * fabric.areal_density_measured:.1f} g/m2"
        return cls(closure, pressure - pressure[0], cls.solid(fabric).stiffness, source, "fitted")

    @classmethod
    def read(cls, path: FilePath, fabric: Fabric) -> PlyLaw:
        """The law of a file, which goes on as solid fibre of the fabric.

        Parameters
        ----------
        path : law.json of `weavecell calibrate`, or a CSV file of two columns whose first line names them with their
            units, such as closure [um], pressure [MPa], and whose first row is 0, 0

        Raises
        ------
        InputError : one line naming the file, the key, the value and what is allowed
        """
        path = Path(path)
        if path.suffix == ".csv":
            columns = read_columns(
                path,
                UNITS,
                what="a contact law of plies",
                content="a contact law of plies: closure and pressure",
                heading="closure or pressure with its unit, such as closure [um]",
                accepts=lambda names: sorted(names) == ["closure", "pressure"],
                columns="closure, pressure",
            )
            return cls._checked(columns, path.name, "user", fabric, path, "")
        content = _content(path)
        table, stated = content.get("ply_contact"), content.get("fabric", "")
        if table is None:
            raise InputError(
                "has no ply_contact", file=path, allowed="a law of `weavecell calibrate`"
            )
        if stated not in ("", fabric.name):
            raise InputError(
                file=path,
                key="fabric",
                value=stated,
                allowed=f"{fabric.name}, or a CSV file of its curve",
            )
        return cls.from_table(table, fabric, path)

    @staticmethod
    def held_by(path: FilePath) -> bool:
        """Whether a law.json holds the contact law of plies too; False as well where it cannot be read."""
        try:
            return _content(Path(path)).get("ply_contact") is not None
        except InputError:
            return False

    @classmethod
    def from_table(cls, table: Any, fabric: Fabric, file: FilePath) -> PlyLaw:
        """The law of a table `ply_contact`: closure and pressure as lists of texts with units, source and status.

        A table { file = "curve.csv" } names a file beside it (`read`).

        Raises
        ------
        InputError : as `read`
        """
        if not isinstance(table, Mapping) or not (
            set(table) <= set(_TABLE) or set(table) == {"file"}
        ):
            wrong = ", ".join(table) if isinstance(table, Mapping) else table
            raise InputError(
                file=file, key="ply_contact", value=wrong, allowed=f"file, or {', '.join(_TABLE)}"
            )
        if set(table) == {"file"}:
            return cls.read(Path(file).parent / str(table["file"]), fabric)
        columns = {}
        for key, unit in UNITS.items():
            texts = table.get(key)
            name = f"ply_contact.{key}"
            if not isinstance(texts, list):
                raise InputError(
                    file=file, key=name, value=texts, allowed=f'a list of texts such as "1 {unit}"'
                )
            columns[key] = np.array([si(text, unit, file=file, key=name) for text in texts])
        return cls._checked(
            columns, table.get("source", Path(file).name), table.get("status", "user"), fabric, file
        )

    @classmethod
    def _checked(cls, columns, source, status, fabric, file, where="ply_contact."):
        """A law whose errors name the file."""
        if status not in STATUSES:
            raise InputError(
                file=file,
                key=f"{where}status",
                value=status,
                allowed=f"one of {', '.join(STATUSES)}",
            )
        stiffness = cls.solid(fabric).stiffness
        try:
            return cls(columns["closure"], columns["pressure"], stiffness, source, status)
        except InputError as problem:
            key = f"{where}{problem.key}"
            raise InputError(
                file=file, key=key, value=problem.value, allowed=problem.allowed
            ) from None

    def words(self) -> str:
        """Travel, pressure at its end, and stiffness beyond, for the reader."""
        beyond = f"{self.stiffness:.3g} Pa/m beyond"
        return f"{1e6 * self.travel:.1f} um up to {1e-6 * self.pressure[-1]:.3g} MPa, {beyond} ({self.status})"

    def table(self) -> dict[str, Any]:
        """The law as `from_table` reads it."""
        return {
            "closure": [f"{1e6 * value:.6g} um" for value in self.closure],
            "pressure": [f"{1e-6 * value:.6g} MPa" for value in self.pressure],
            "source": self.source,
            "status": self.status,
        }

    @classmethod
    def solid(cls, fabric: Fabric) -> PlyLaw:
        """Solid fibre from the first touch on: the law of a fabric of which no travel is known, "assumed".

        Between the two faces of a ply lie its warp and its weft, each as a solid sheet of its mass, in series:

            1 / K = sum over both of A / (rho_f E_c)

        with A = areal density of one yarn family.

        Raises
        ------
        InputError : no transverse modulus, given or of a known family of fibres (`fabrics.assumed`)
        """
        weave, laws = fabric.weave, with_solid_laws(fabric).solid_laws
        assert laws is not None
        give = sum(
            length * yarn.linear_density / weave.cell_area / (yarn.fibre_density * law.E_c)
            for length, yarn, law in zip(weave.S0, weave.yarns, laws)
        )
        samples = np.array([0.0, SOLID_TRAVEL])
        return cls(
            samples, samples / give, 1 / give, "solid fibre, E_c rho_f / areal density", "assumed"
        )

    def between(self, other: PlyLaw) -> PlyLaw:
        """The law of a ply of this fabric on one of another: half of the closure of each at every pressure."""
        if other is self or other == self:
            return self
        pressure = np.union1d(self.pressure, other.pressure)
        closure = 0.5 * (self.closure_at(pressure) + other.closure_at(pressure))
        stiffness = 2 / (1 / self.stiffness + 1 / other.stiffness)
        source = (
            self.source
            if self.source == other.source
            else f"half each: {self.source}; {other.source}"
        )
        status = self.status if self.status == other.status else f"{self.status}, {other.status}"
        return PlyLaw(closure, pressure, stiffness, source, status)

    def scaled(self, factor: float) -> PlyLaw:
        """The law with `factor` times the pressure at every closure."""
        return replace(self, pressure=factor * self.pressure, stiffness=factor * self.stiffness)

    @property
    def steepest(self) -> float:
        """[Pa/m] highest slope of the law, which bounds the time step of explicit springs."""
        return max(self.stiffness, float(np.max(np.diff(self.pressure) / np.diff(self.closure))))

    @property
    def travel(self) -> float:
        """[m] closure at the last sample, from which on the law is that of solid fibre."""
        return float(self.closure[-1])

    def pressure_at(self, closure: ArrayLike) -> FloatArray:
        """Pressure [Pa] at a closure [m]; zero where plies are apart."""
        d = np.asarray(closure, float)
        beyond = np.maximum(d - self.travel, 0.0)
        return np.interp(d, self.closure, self.pressure) + self.stiffness * beyond

    def closure_at(self, pressure: ArrayLike) -> FloatArray:
        """Closure [m] at a pressure [Pa]; the inverse of `pressure_at`."""
        p = np.asarray(pressure, float)
        beyond = np.maximum(p - self.pressure[-1], 0.0)
        return np.interp(p, self.pressure, self.closure) + beyond / self.stiffness

    def energy_at(self, closure: ArrayLike) -> FloatArray:
        """Energy per area [J/m2] stored at a closure [m]: the integral of the pressure."""
        d = np.maximum(np.asarray(closure, float), 0.0)
        steps = 0.5 * np.diff(self.closure) * (self.pressure[1:] + self.pressure[:-1])
        stored = np.concatenate([[0.0], np.cumsum(steps)])
        k = np.clip(np.searchsorted(self.closure, d, side="right") - 1, 0, len(self.closure) - 1)
        rest, start = d - self.closure[k], self.pressure[k]
        slope = np.append(np.diff(self.pressure) / np.diff(self.closure), self.stiffness)[k]
        return stored[k] + start * rest + 0.5 * slope * rest * rest


def packing_stiffness(fabric: Fabric) -> float:
    """[N/m] stiffness of a ply, in its plane, as solid fibre: the sum over both yarns of E_c A / rho_f

    with A = areal density of one yarn family, rho_f the density of its fibre and E_c its transverse modulus.
    """
    weave = fabric.weave
    return sum(
        E_c * length * yarn.linear_density / (weave.cell_area * yarn.fibre_density)
        for E_c, length, yarn in zip(transverse_moduli(fabric), weave.S0, weave.yarns)
    )


def _content(path):
    """The content of a law.json."""
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as problem:
        raise InputError(
            "cannot be read", file=path, allowed=f"a law of `weavecell calibrate` ({problem})"
        ) from None
    return content if isinstance(content, dict) else {}


def between_plies(areal_density: float, plies: int = TESTED) -> tuple[FloatArray, FloatArray]:
    """Pressure [Pa] and what two neighbouring plies of a pack close (thesis eqs. 5-1 to 5-4, erratum E-02) [m].

    A pack of N plies closes d_N = 2 d_m + (N - 1) d_f between platens, one ply d_1 = 2 d_m, with d_m between a middle
    surface and a platen and d_f between two middle surfaces: d_f = (d_N - d_1) / (N - 1).

    Parameters
    ----------
    areal_density : [kg/m2] of one ply, measured
    plies : of the pack that was pressed: 4, 8 or 16

    Raises
    ------
    InputError : as PlateCurve.pressure_law
    """
    pack, one = (PlateCurve.pressure_law(areal_density, count) for count in (plies, 1))
    return one.pressure, (pack.closure - one.closure) / (plies - 1)
