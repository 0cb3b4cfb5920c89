"""The response surface of a fabric's crossover."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Unpack

from fabrics.base.checks import FilePath
from fabrics.base.errors import InputError
from fabrics.base.run_cache import RunCache
from fabrics.fabric import Fabric
from weavecell.answers.surface import NAMES, SurfaceResult
from weavecell.api import meshes, quantities
from weavecell.api.command import Plan, Running, command
from weavecell.api.execution import Execution, ResumableKeywords
from weavecell.api.keywords import explain_keywords
from weavecell.api.run_size import WorkSize
from weavecell.results import progress, provenance


@dataclass(frozen=True)
class SurfacePlan(Plan[SurfaceResult]):
    """A response surface that is about to be sampled.

    Parameters
    ----------
    fabric : Fabric, with what a 3D crossover needs
    mesh, size : as it was given, and as `meshing` takes it
    d1, d2 : (lowest, highest) [m] end displacements
    points, tolerance, friction : of `surface`
    """

    files = NAMES

    fabric: Fabric
    mesh: Any
    size: Any
    d1: tuple[float, float]
    d2: tuple[float, float]
    points: int
    tolerance: float | None
    friction: float

    @property
    def inputs(self) -> Sequence[object]:
        """All of it, but how the mesh was given."""
        spans = [self.d1, self.d2]
        return [(self.fabric, spans, self.points, self.tolerance, self.size, self.friction)]

    def forecast(self) -> WorkSize:
        """Count hexahedra, nodes and the first lines."""
        built = meshes.build(self.fabric, "quarter", size=self.size)
        lines = 2 * self.points
        return meshes.size_of_mesh(f"{self.fabric.name}, response surface", built, line=lines)

    def run(self, running: Running) -> SurfaceResult:
        """Sample it; the finished lines are kept until it is written."""
        from unitcell3d.identify import response_surface

        stamp = provenance.stamp("")
        with progress.bar(f"Response surface of {self.fabric.name}") as advance:
            sampled = response_surface.sample(
                self.fabric,
                d1=self.d1,
                d2=self.d2,
                points=(self.points, self.points),
                tolerance=self.tolerance,
                size=self.size,
                friction=self.friction,
                folder=running.kept,
                resume=running.how.resume,
                **running.how.solver_pool,
                on_progress=advance,
                provenance=f"weavecell {stamp['weavecell']}, commit {stamp['commit']}, {stamp['date']}",
            )
        settings = {
            "fabric": self.fabric.name,
            "mesh": self.mesh,
            "friction": self.friction,
            "d1_m": self.d1,
            "d2_m": self.d2,
            "lines": sampled.surface.T1.shape,
            "tolerance": self.tolerance,
        }
        cell = _cell(self.fabric, sampled.surface)
        result = running.save(SurfaceResult(self.fabric, sampled, settings, cell))
        RunCache(running.runs).clear()
        return result


@command(SurfacePlan)
@explain_keywords(ResumableKeywords)
def surface(
    fabric: Fabric | FilePath,
    *,
    mesh: str | float | tuple[int, int, int] = meshes.SOLVED,
    d1: str | tuple[float, float] = "0 mm .. 0.03 mm",
    d2: str | tuple[float, float] = "0 mm .. 0.03 mm",
    points: int = 21,
    tolerance: float | None = None,
    friction: float = 0.0,
    check: bool = False,
    **options: Unpack[ResumableKeywords],
) -> SurfacePlan:
    """Sample the response surface of the 3D crossover: tensions, contact force and heights over
    (d1, d2).

    The folder then holds surface.h5, surface.json, pictures/ and report.html; while the run goes
    on, runs/. With friction the response depends on the path: the surface is that of stretching the
    weft first and the warp then. The fabric has the linear density of its data sheet. Needs dolfinx
    and PETSc.

    Parameters
    ----------
    fabric : name of the catalogue, or path of a fabric file; in Python also a Fabric
    mesh : auto, coarse, medium or fine, the numbers of hexahedra along, across and through a
        quarter yarn, such as 8,6,2, or an edge length
    d1 : end displacements of the warp [m], per end, LOW .. HIGH
    d2 : end displacements of the weft [m], per end, LOW .. HIGH
    points : initial number of lines in each direction
    tolerance : refine until every line is interpolated from the others within this share of the
        largest force
    friction : Coulomb's coefficient between the yarns
    check : solve nothing and write nothing: count lines and hexahedra
    **options : jobs, executor, out and resume

    Returns
    -------
    SurfaceResult

    Raises
    ------
    InputError : a range, number of points or tolerance that is not allowed, or a fabric that cannot
        be meshed
    UnstableError : a line found no equilibrium

    Examples
    --------
    >>> sampled = wc.surface("S-720", mesh="coarse", points=5)  # doctest: +SKIP
    >>> wc.impact("S-720", "90 m/s", surface=sampled.surface)  # doctest: +SKIP
    """
    from unitcell3d.identify import response_surface

    Execution.refuse_others("surface", options)
    fabric = meshes.resolve_fabric_for_3d(fabric)
    spans = _span(d1, "d1"), _span(d2, "d2")
    response_surface.check(*spans, (points, points), tolerance, friction)
    return SurfacePlan(fabric, mesh, meshes.size(mesh), *spans, points, tolerance, friction)


def _span(value, key):
    """(low, high) [m] of a text such as "0 mm .. 0.03 mm", or of two values."""
    ends = value
    if isinstance(value, str):
        ends = [part.strip() for part in value.split("..")]
    if len(ends) != 2:
        raise InputError(key=key, value=value, allowed='two lengths, such as "0 mm .. 0.03 mm"')
    return quantities.number(ends[0], "m", key), quantities.number(ends[1], "m", key)


def _cell(fabric, surface):
    """The shell's cell at the samples, {"T1", "T2", "F_c"}; {} for a fabric without a law."""
    from shellfabric.cell.model import CellModel

    if fabric.laws is None:
        return {}
    w1, w2 = fabric.weave.w
    state = CellModel(fabric).solve(1 + surface.d1[:, None] / w1, 1 + surface.d2[None, :] / w2)
    return {"T1": state["N1"], "T2": state["N2"], "F_c": state["F"]}
