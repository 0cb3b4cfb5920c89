"""The biaxial response of a fabric's crossover, at ratios of strains, to the strength of a yarn."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import isfinite
from typing import TYPE_CHECKING, Any

from fabrics.base.checks import FilePath
from fabrics.base.errors import InputError
from fabrics.compression import CompressionLaw
from fabrics.fabric import Fabric
from fabrics.variants import with_linear_density
from weavecell.answers.biaxial_paths import NAMES, BiaxialResult, names_of
from weavecell.api import meshes
from weavecell.api.command import Plan, Running, command
from weavecell.api.run_size import WorkSize
from weavecell.api.target import resolve_fabric
from weavecell.results import progress
from weavecell.scenes import build

if TYPE_CHECKING:
    from shellfabric.cell.model import CellModel

STATES = 241
RATIOS = ("1:1", "1:0", "0:1")


@dataclass(frozen=True)
class BiaxialPlan(Plan[BiaxialResult]):
    """Paths of a crossover that are about to be followed.

    Parameters
    ----------
    model : CellModel, with its fabric
    ratios : {text: (warp, weft)} of each path
    source : of the compression law, in words
    mesh : of the 3D crossover as it was given; None without one
    size : the same as `meshing` takes it
    """

    runs = ""

    model: CellModel
    ratios: dict[str, tuple[float, float]]
    source: str
    mesh: Any
    size: Any

    @property
    def files(self) -> tuple[str, ...]:  # type: ignore[override]
        """The names of the files, also of the 3D crossover along the paths."""
        if self.mesh is None:
            return NAMES
        return names_of(self.ratios)

    def forecast(self) -> WorkSize:
        """Count paths and states, and hexahedra of the 3D crossover."""
        title = f"{self.model.fabric.name}, biaxial"
        amounts = {"path": len(self.ratios), "state": len(self.ratios) * STATES}
        if self.mesh is None:
            return WorkSize(title, amounts)
        from meshing import crossover

        return meshes.size_of_mesh(
            title, crossover.build(self.model.fabric, size=self.size), **amounts
        )

    def run(self, running: Running) -> BiaxialResult:
        """Follow the paths, in 3D too if it is asked for."""
        from weavecell.studies.biaxial_path import to_strength

        paths = {text: to_strength(self.model, pair, STATES) for text, pair in self.ratios.items()}
        solved = {}
        if self.mesh is not None:
            solved = _crossovers(self.model.fabric, paths, self.size)
        result = BiaxialResult(self.model, paths, solved, self.source, self.mesh, running.wall_time)
        return running.save(result)


@command(BiaxialPlan)
def biaxial(
    fabric: Fabric | FilePath,
    *,
    ratio: list[str] | None = None,
    compare_3d: str | float | tuple[int, int, int] | None = None,
    law: FilePath | CompressionLaw | None = None,
    check: bool = False,
    out: FilePath | None = None,
) -> BiaxialPlan:
    """Stretch a crossover at fixed ratios of strains to the strength of a yarn: 1:1, 1:0 and 0:1 if
    none is given.

    The folder then holds biaxial.csv, biaxial.json, pictures/ and report.html. A whole specimen:
    `weavecell coupon`.

    Parameters
    ----------
    fabric : name of the catalogue, or path of a fabric file; in Python also a Fabric. A named one
        has the linear densities of `weavecell.fabric`
    ratio : warp strain to weft strain, WARP:WEFT, may be given again; in Python a list. 0 holds a
        yarn
    compare_3d : also solve the 3D crossover on this mesh, such as coarse, and compare; needs
        dolfinx
    law : compression law of `weavecell calibrate` (law.json), in place of the fabric's; in Python
        also a CompressionLaw
    check : compute nothing and write nothing: count paths, states and hexahedra
    out : folder of the results; in Python None writes nothing

    Returns
    -------
    BiaxialResult

    Raises
    ------
    InputError : an option that is not allowed, or a fabric without a law

    Examples
    --------
    >>> stretched = wc.biaxial("S-720", ratio=["1:1"])
    >>> end = stretched.summary()["paths"]["1:1"]
    >>> end["failed"], [round(float(strain), 4) for strain in end["strain"]]  # [-]
    ('weft', [0.0375, 0.0375])
    """
    from shellfabric.cell.model import CellModel

    wanted = {text: _ratio(text) for text in ratio or RATIOS}
    named = not isinstance(fabric, Fabric)
    if compare_3d is None:
        fabric = resolve_fabric(fabric)
    else:
        fabric = meshes.resolve_fabric_for_3d(fabric)
    # the 3D crossover is compared at the linear density that shots have
    if named and compare_3d is not None:
        fabric = with_linear_density(fabric, "effective")
    source = "published"
    if isinstance(law, CompressionLaw):
        source = law.provenance
    elif law is not None:
        source = str(law)
    if law is not None:
        fabric = replace(fabric, laws=build.laws_of(fabric, law))
    elif fabric.laws is None:
        allowed = f"given, a law.json of `weavecell calibrate`: fabric {fabric.name} has no compression law"
        raise InputError(key="law", allowed=allowed)
    size = None
    if compare_3d is not None:
        size = meshes.size(compare_3d, "compare_3d")
    return BiaxialPlan(CellModel(fabric), wanted, source, compare_3d, size)


def _ratio(text):
    """(warp, weft) from "2:1"."""
    try:
        ratio = tuple(float(part) for part in text.split(":"))
    except ValueError:
        ratio = ()
    # a path with neither yarn stretched leads nowhere
    if len(ratio) != 2 or not all(map(isfinite, ratio)) or not min(ratio) >= 0 < max(ratio):
        allowed = 'two numbers of at least 0, one of them above, such as "2:1"'
        raise InputError(key="ratio", value=text, allowed=allowed)
    return ratio


def _crossovers(fabric, paths, size):
    """{ratio: Record} of the 3D crossover along the same paths."""
    from meshing import crossover
    from unitcell3d.cases import biaxial_and_platens

    built = crossover.build(fabric, size=size)
    w1, w2 = fabric.weave.w
    solved = {}
    with progress.bar(f"3D crossover of {fabric.name}") as advance:
        for number, (text, path) in enumerate(paths.items()):
            advance(number / len(paths), text)
            # the 3D crossover is moved by lengths, half a cell at each end
            strain1, strain2 = path.ratio
            solved[text] = biaxial_and_platens.biaxial(built, fabric, (strain1 * w1, strain2 * w2))
    return solved
