"""A crossover that was meshed elsewhere: a .msh file in place of a mesh size.

The file holds the physical volumes "warp" and "weft" and the surfaces that `YarnMesh.groups` names,
each yarn a transfinite box of hexahedra, as gmsh makes it of the script that `weavecell mesh
--format geo` writes. The section may be any. Its area follows from the nodes (a cubic spline of the
thickness across the yarn), the fibre volume fraction from that area,

    Vf0 = A_s (1 + crimp) / A

and counts and crimp stay those of the fabric, whose cell the law is for.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import CubicSpline

from fabrics.base import files
from fabrics.base.checks import FilePath, FloatArray
from fabrics.base.errors import InputError
from meshing.generate import Groups, of_file

KIND = "read"
# of the half cell length, and of the height of the centreline: what a mesh may differ from the
# fabric
LENGTH_TOLERANCE = 1e-6
HEIGHT_TOLERANCE = 5e-3


@dataclass(frozen=True)
class MeshFile:
    """A .msh file, read whole, so that every process and every key of a result has the same.

    Parameters
    ----------
    name : of the file
    content : its bytes
    """

    name: str
    content: bytes

    @classmethod
    def load(cls, path: FilePath) -> MeshFile:
        """Read a file.

        Raises
        ------
        InputError : it cannot be read
        """
        try:
            return cls(Path(path).name, files.read_bytes(path, "mesh file"))
        except OSError as problem:
            line = f"a mesh file that can be read ({problem.strerror})"
            raise InputError(key="mesh", value=str(path), allowed=line) from None

    def __str__(self) -> str:
        return self.name

    def groups(self) -> Groups:
        """Read the physical groups.

        Raises
        ------
        InputError : gmsh cannot read it
        """
        with TemporaryDirectory() as folder:
            path = Path(folder) / "read.msh"
            path.write_bytes(self.content)
            try:
                return of_file(path)
            except InputError as problem:
                raise InputError(f"{self.name}: {problem}") from None


@dataclass(frozen=True)
class ReadSection:
    """A section as the nodes of one yarn give it.

    Parameters
    ----------
    y : (ny+1,) [m] distances of the mesh lines from the middle, the first 0
    thick : (ny+1,) [m] thickness at each
    """

    y: tuple[float, ...]
    thick: tuple[float, ...]

    kind = KIND

    @property
    def thickness(self) -> float:
        """[m] in the middle."""
        return self.thick[0]

    @property
    def half_width(self) -> float:
        """[m] from the middle to the cut."""
        return self.y[-1]

    @property
    def area(self) -> float:
        """[m2] of both halves."""
        return 2 * float(self._spline().integrate(0, self.half_width))

    def half_thickness(self, y: ArrayLike) -> FloatArray:
        """Compute the half thickness q(y) [m] at the distances `y` [m] from the middle."""
        return self._spline()(abs(np.asarray(y, float))) / 2

    def _spline(self):
        """Thickness over |y|, level in the middle by symmetry."""
        return CubicSpline(self.y, self.thick, bc_type=((1, 0.0), "not-a-knot"))


@dataclass(frozen=True)
class ReadSections:
    """The sections of a mesh that was read: what `section_fit.SectionFit` is of one that was made.

    Parameters
    ----------
    sections : (ReadSection, ReadSection) of warp and weft
    shift : [m] of warp against weft in z, positive apart
    Vf0 : (warp, weft) [-] fibre volume fractions
    """

    sections: tuple[ReadSection, ReadSection]
    shift: float
    Vf0: tuple[float, float]

    @property
    def report(self) -> str:
        """Say in one line what the sections are."""
        warp, weft = self.Vf0
        return f"sections of the mesh file (Vf0 {warp:.3f} / {weft:.3f})"
