"""The mesh of a crossover or a woven patch, with its quality.

The folder of `weavecell mesh`
    crossover.msh, crossover.vtu    or patch.*; the formats requested (OpenRadioss:
                                    crossover_0000.rad)
    crossover.png, quality.png      the mesh, and the scaled Jacobian of its elements
    mesh.json                       size, quality, overlap, provenance
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fabrics.base.checks import FilePath
from fabrics.base.frozen import explain_frozen
from fabrics.fabric import Fabric
from weavecell.answers.result import WrittenResult, plain
from weavecell.results import out_folder, progress

if TYPE_CHECKING:
    from shellfabric.membrane.indicator import Indicator


def names_of(stem: str, formats: Sequence[str]) -> list[str]:
    """Return the names of the files of a mesh: its own, pictures of it and of its quality."""
    files = [_file(stem, suffix) for suffix in formats]
    return [*files, f"{stem}.png", "quality.png", "mesh.json"]


def _file(stem, suffix):
    # the name that OpenRadioss's starter takes
    if suffix == "rad":
        return f"{stem}_0000.rad"
    return f"{stem}.{suffix}"


@explain_frozen
@dataclass(frozen=True, repr=False)
class MeshResult(WrittenResult):
    """The mesh of a crossover or a woven patch.

    Parameters
    ----------
    fabric : Fabric that is meshed
    mesh : `meshing.crossover.Crossover` or `meshing.patch.Patch`
    formats : suffixes of the files that `save` writes

    Examples
    --------
    >>> wc.mesh("S-720", mesh="coarse").mesh.points.shape
    (378, 3)
    """

    kind = "mesh"
    uses = ("mesh",)

    fabric: Fabric
    mesh: Any
    formats: tuple[str, ...] = ("msh", "vtu")

    @cached_property
    def checks(self) -> tuple[Indicator, ...]:
        """Quality checks: distortion of hexahedra, overlap of yarns."""
        from weavecell.studies import crossover_checks

        return crossover_checks.of_mesh(self.mesh, self.fabric.weave.thickness)

    @property
    def stem(self) -> str:
        """Name of the files without suffix: "crossover" or "patch"."""
        if hasattr(self.mesh, "count"):
            return "patch"
        return "crossover"

    @property
    def domain(self) -> str:
        """ "quarter", "whole" or "periodic", or the yarns of a patch."""
        if self.stem == "patch":
            return "{} warp x {} weft yarns".format(*self.mesh.count)
        return self.mesh.domain

    @property
    def fibre_bars(self) -> tuple[int, int]:
        """Numbers of fibre bars of warp and weft."""
        bars = [0, 0]
        for lines, family in zip(self.mesh.bars, self.mesh.families):
            bars[family] += len(lines)
        return bars[0], bars[1]

    @property
    def sections(self) -> str:
        """Shape of the yarns' sections, and how they were fitted."""
        return f"{self.mesh.sections[0].kind}: {self.mesh.section_fit.report}"

    def _what(self):
        return f"{self.fabric.name}, mesh"

    def _columns(self):
        return {name: [value] for name, value in self.summary().items() if plain(value)}

    def words(self) -> dict[str, str]:
        """Return the main figures of the mesh, as texts."""
        gap = 1e6 * self.mesh.least_gap
        distance = f"apart by at least {gap:.2f} um"
        if gap < 0:
            distance = f"overlap by up to {-gap:.2f} um"
        return {
            "fabric": self.mesh.fabric,
            "domain": self.domain,
            "hexahedra": f"{len(self.mesh.hexes)}",
            "nodes": f"{len(self.mesh.points)}",
            "fibre bars": "{} / {} (warp / weft)".format(*self.fibre_bars),
            "worst scaled Jacobian": f"{self.mesh.min_scaled_jacobian:.3f}",
            "sections": self.sections,
            "facets of the mesh": distance,
        }

    def to_vtk(self, folder: FilePath) -> Path:
        """Write the mesh for ParaView, crossover.vtu or patch.vtu; returns its path."""
        return self._export(Path(folder), "vtu")

    def _export(self, folder, suffix):
        from weavecell.decks import mesh_files

        path = folder / _file(self.stem, suffix)
        with out_folder.hold(folder, [path.name]):
            mesh_files.write(self.mesh, self.fabric, path)
        return path

    @property
    def _written(self):
        return names_of(self.stem, self.formats)

    def _write(self, folder):
        from weavecell.report import pictures_mesh, pictures_patch, pictures_quality
        from weavecell.results import json_file, provenance

        with progress.bar(f"Mesh of {self.mesh.fabric}") as advance:
            advance(0.2, "writing")
            for suffix in self.formats:
                self._export(folder, suffix)
            advance(0.6, "drawing")
            if self.stem == "patch":
                pictures_patch.picture(self.mesh, folder / "patch.png")
            else:
                pictures_mesh.picture(self.mesh, folder / "crossover.png")
            pictures_quality.picture(self.mesh, folder / "quality.png")
            stamp = provenance.stamp("", self.fabric)
            json_file.write(folder / "mesh.json", self.summary() | {"provenance": stamp})

    def lines(self) -> list[str]:
        """Write the lines that are printed, without what is doubtful."""
        return [f"{key:<24}{value}" for key, value in self.words().items()]
