"""The unit cell of a TexGen file as a plain weave: spacing, section and path of its two yarn families.

TexGen does not name warp and weft: the warp is the family nearer to the x axis of the file. Every yarn repeats along
and across itself; all yarns of a family are alike, so that the first one stands for them.
"""

from __future__ import annotations

import importlib.util
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from fabrics.checks import FilePath, FloatArray
from fabrics.errors import InputError
from fabrics.units import si

PLAIN = (
    "one unit cell of a plain weave: one layer of alike, equally spaced yarns in two directions at right angles, that "
    "pass over and under by turns and repeat along and across themselves"
)
_ALIKE = 0.02  # largest difference between yarns of a family, and between their spacings
_STRAIGHT = 0.01  # of a spacing, or of a unit vector
_SECONDS = 120


@dataclass(frozen=True)
class YarnGeometry:
    """One yarn of a plain weave.

    Parameters
    ----------
    spacing : [m] of the yarns of this family
    cell : [m] length of a crossover along the yarn, the spacing of the other family
    path : (n, 2) [m] place along the yarn from a crossover where it is on top, over two cells, and height about the
        middle of its lowest and highest point
    outline : (m, 2) [m] section there: across the yarn and in height, about its centre
    linear_density, fibre_density : [kg/m], [kg/m3], or None where the file gives none
    """

    spacing: float
    cell: float
    path: FloatArray
    outline: FloatArray
    linear_density: float | None
    fibre_density: float | None

    @property
    def amplitude(self) -> float:
        """[m] half of the height between the lowest and the highest point of the path."""
        return float(np.ptp(self.path[:, 1])) / 2

    @property
    def crimp(self) -> float:
        """[-] length of the path over that of the cells, minus one."""
        return float(np.hypot(*np.diff(self.path, axis=0).T).sum() / np.ptp(self.path[:, 0])) - 1

    @property
    def width(self) -> float:
        """[m] of the section."""
        return float(np.ptp(self.outline[:, 0]))

    @property
    def thickness(self) -> float:
        """[m] of the section."""
        return float(np.ptp(self.outline[:, 1]))

    @property
    def area(self) -> float:
        """[m2] of the section."""
        x, z = self.outline.T
        return float(abs(np.dot(x, np.roll(z, -1)) - np.dot(z, np.roll(x, -1)))) / 2


@dataclass(frozen=True)
class WeaveGeometry:
    """The plain weave of a TexGen file.

    Parameters
    ----------
    name : of the file
    yarns : (warp, weft) YarnGeometry
    thickness : [m] from the lowest to the highest point of all yarns
    """

    name: str
    yarns: tuple[YarnGeometry, YarnGeometry]
    thickness: float

    @classmethod
    def read(cls, path: FilePath) -> WeaveGeometry:
        """Read a TexGen file.

        Raises
        ------
        InputError : pytexgen is not installed, it cannot read the file, or what the file holds is no plain weave
        """
        lines = _Lines(Path(path))
        family = lines.families()
        spacing = [lines.spacing(family == f, f) for f in (0, 1)]
        lines.check_crossings(family, spacing)
        yarns = [lines.geometry(int(np.argmax(family == f)), family, f, spacing) for f in (0, 1)]
        for k, f in enumerate(family):
            other = lines.geometry(k, family, f, spacing)
            for what in ("width", "thickness", "area", "amplitude"):
                one, two = getattr(yarns[f], what), getattr(other, what)
                if abs(two / one - 1) > _ALIKE:
                    lines.refuse(f"two yarns of one direction differ in {what}, {1e3 * one:.4g} and {1e3 * two:.4g} mm")
        return cls(Path(path).name, (yarns[0], yarns[1]), lines.thickness())


class _Lines:
    """The yarns as read, in metres; what is no plain weave is refused with the name of the file."""

    def __init__(self, path):
        self.file = path
        self.yarns = _read(path)

    def refuse(self, what):
        raise InputError(what, file=self.file, key="weave", allowed=PLAIN)

    def families(self):
        """(n,) 0 for warp and 1 for weft; sets the axes (3, 3): along the warp, along the weft, normal."""
        runs = np.array([yarn["path"][-1] - yarn["path"][0] for yarn in self.yarns])
        self.length = np.linalg.norm(runs, axis=1)
        if not np.all(self.length > 0) or not all(np.isfinite(array).all() for y in self.yarns for array in y.values()):
            self.refuse("a yarn has no length, or points that are no numbers")
        along = runs / self.length[:, None]
        same = np.abs(along @ along[0]) > 1 - _STRAIGHT
        square = np.abs(along @ along[0]) < _STRAIGHT
        others = along[square]
        if not np.all(same | square) or not others.size or np.any(np.abs(others @ others[0]) < 1 - _STRAIGHT):
            self.refuse("the yarns do not run in two directions at right angles")
        nearest = int(np.argmax([abs(along[0, 0]), abs(others[0, 0])]))
        warp, weft = (along[0], others[0])[::-1] if nearest else (along[0], others[0])
        warp = warp * np.sign(warp[np.argmax(np.abs(warp))])
        normal = np.cross(warp, weft)
        normal *= np.sign(normal[np.argmax(np.abs(normal))]) / np.linalg.norm(normal)
        self.axes = np.array([warp, np.cross(normal, warp), normal])
        return np.where(same, nearest, 1 - nearest)

    def spacing(self, mine, f):
        """[m] between the yarns `mine` (n,) bool of family f, which repeat across themselves."""
        period, places = self._period(np.flatnonzero(mine), 1 - f), []
        for k in np.flatnonzero(mine):
            across = self.yarns[k]["path"] @ self.axes[1 - f]
            if np.ptp(across) > _STRAIGHT * period / mine.sum():
                self.refuse("a yarn is not straight in the plane of the fabric")
            places.append(across.mean())
            along = self._period([k], f)
            if abs(self.length[k] / along - round(self.length[k] / along)) > _STRAIGHT:
                self.refuse("a yarn does not end where it repeats")
        gaps = np.diff(np.sort(np.mod(places, period)), append=np.min(np.mod(places, period)) + period)
        if np.ptp(gaps) > _ALIKE * period / mine.sum():
            self.refuse("yarns of one direction are not equally spaced in one layer")
        return period / mine.sum()

    def _period(self, of, axis):
        """[m] with which the yarns repeat along an axis of the fabric."""
        found = []
        for k in of:
            repeats = self.yarns[k]["repeats"].reshape(-1, 3)
            own = repeats @ self.axes[axis]
            good = np.abs(own) > (1 - _STRAIGHT) * np.linalg.norm(repeats, axis=1)
            found.append(np.abs(own[good]).min() if good.any() else 0.0)
        if min(found) <= 0 or np.ptp(found) > _STRAIGHT * max(found):
            self.refuse("the yarns do not repeat together along and across themselves")
        return found[0]

    def _height(self, k, f, places):
        """[m] of a yarn at places along it, which may lie outside of its one repeat."""
        along, z = self.yarns[k]["path"] @ self.axes[f], self.yarns[k]["path"] @ self.axes[2]
        order = np.argsort(along)
        along, z = along[order], z[order]
        return np.interp(along[0] + np.mod(places - along[0], self.length[k]), along, z)

    def _across(self, k, f):
        """[m] place of a yarn of family f across itself."""
        return (self.yarns[k]["path"] @ self.axes[1 - f]).mean()

    def check_crossings(self, family, spacing):
        """Refuse a weave in which warp and weft do not pass over each other by turns."""
        ordered = []
        for f in (0, 1):
            of = np.flatnonzero(family == f)
            period = spacing[f] * len(of)
            ordered.append(of[np.argsort([np.mod(self._across(k, f) + 1e-6 * period, period) for k in of])])
        over = np.array([
            [np.sign(self._height(i, 0, self._across(j, 1)) - self._height(j, 1, self._across(i, 0)))
             for j in ordered[1]] for i in ordered[0]
        ])  # fmt: skip
        if np.any(over * np.roll(over, 1, axis=0) >= 0) or np.any(over * np.roll(over, 1, axis=1) >= 0):
            self.refuse("warp and weft do not pass over and under each other by turns")

    def geometry(self, k, family, f, spacing):
        """The YarnGeometry of yarn k of family f."""
        yarn, cell = self.yarns[k], spacing[1 - f]
        crossing = self._across(int(np.argmax(family != f)), 1 - f)
        tops = crossing + cell * np.arange(2)
        top = tops[np.argmax(self._height(k, f, tops))]
        along = yarn["path"] @ self.axes[f]
        period, n = self.length[k], round(2 * cell / self.length[k] * (len(along) - 1))
        places = np.linspace(-cell, cell, n + 1)
        z = self._height(k, f, top + places)
        path = np.column_stack([places, z - (z.max() + z.min()) / 2])
        away = np.abs(np.mod(along - top + period / 2, period) - period / 2)
        node = int(np.argmin(away))
        points = yarn["section"][node] @ np.array([yarn["side"][node], yarn["up"][node]])
        outline = points @ self.axes[[1 - f, 2]].T
        outline -= (outline.max(axis=0) + outline.min(axis=0)) / 2
        mass, density, area = yarn["fibres"]
        mass = mass or area * density
        return YarnGeometry(spacing[f], cell, path, outline, mass or None, density or None)

    def thickness(self):
        """[m] from the lowest to the highest point."""
        faces = []
        for yarn in self.yarns:
            rise = np.stack([yarn["side"] @ self.axes[2], yarn["up"] @ self.axes[2]], axis=1)
            faces.append((yarn["path"] @ self.axes[2])[:, None] + np.einsum("npc,nc->np", yarn["section"], rise))
        return float(np.ptp(np.concatenate([face.ravel() for face in faces])))


def _read(path):
    """[{name: array}] of the yarns of a file, in metres, as the worker writes them."""
    if importlib.util.find_spec("pytexgen") is None:
        raise InputError("needs the Python package pytexgen: pip install weavecell[texgen]", file=path)
    if not path.is_file():
        raise InputError("cannot be read", file=path, allowed="a TexGen file (.tg3)")
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder, "yarns.npz")
        command = [sys.executable, "-P", str(Path(__file__).with_name("worker.py")), str(path), str(out)]
        try:
            done = subprocess.run(command, capture_output=True, timeout=_SECONDS)
        except subprocess.TimeoutExpired:
            done = None
        if done is None or done.returncode or not out.exists():
            raise InputError("TexGen cannot read it", file=path, allowed="a TexGen file (.tg3) of one textile")
        with np.load(out) as content:
            unit = si(f"1 {content['unit']}", "m", file=path, key="GeometryScale")
            names = "path", "side", "up", "section", "repeats", "fibres"
            yarns = [{name: content[f"{name}{k}"] for name in names} for k in range(int(content["yarns"]))]
    if not yarns:
        raise InputError("holds no yarns", file=path, allowed="a TexGen file (.tg3) of one textile")
    for yarn in yarns:
        yarn |= {name: unit * yarn[name] for name in ("path", "section", "repeats")}
    return yarns
