"""Panels in motion as a ParaView series, by pyvista: one .vtu a snapshot, and a .pvd that lists
them with their times.

Pressures times areas add up to what histories.h5 has of each ply at that time, over the modelled
part of the panel.
"""

from __future__ import annotations

import errno
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fabrics.base.checks import FilePath, FloatArray, IntArray
from fabrics.base.errors import InputError
from fabrics.base.extras import explain_missing
from fabrics.base.files import check_size, find_inside, read_bytes, replace_whole, write

if TYPE_CHECKING:
    from weavecell.results.impact_shapes import Shape, TurnedBody

PRESSURES = ("projectile_pressure_Pa", "front_pressure_Pa", "rear_pressure_Pa")
COMPRESSION = 1  # level of zlib, of 1 to 9
AROUND = 24  # sectors of a body that is turned about its axis
_FAILED = "failed_segments_warp", "failed_segments_weft"


@explain_missing()
def grid(nodes: FloatArray, quads: IntArray) -> Any:
    """Make a pyvista.UnstructuredGrid of quadrilaterals (m, 4) of nodes (n, 3) [m]."""
    import pyvista

    return pyvista.UnstructuredGrid(
        {pyvista.CellType.QUAD: np.asarray(quads)}, np.asarray(nodes, float)
    )


@explain_missing()
def panel(plies: Sequence[Shape], quads: Sequence[IntArray]) -> Any:
    """Make the grid of a panel at one instant, with the arrays that docs/reference.md lists.

    Parameters
    ----------
    plies : the shape of each ply
    quads : of each ply (m, 4) node numbers, in order round the cell
    """
    parts = [_elements(shape, numbers) for shape, numbers in zip(plies, quads)]
    points = [shape.nodes for shape in plies]
    numbers_of_plies = list(range(1, len(plies) + 1))
    for number, shape in enumerate(plies, 1):
        if shape.resolved.size:
            parts.append(_yarns(shape))
            points.append(shape.yarn_surface.reshape(-1, 3))
            numbers_of_plies.append(number)
    # numbers of nodes of a part become those of the grid
    count = 0
    for part, number, own in zip(parts, numbers_of_plies, points):
        part["quads"] = part["quads"] + count
        part["ply"] = np.full(len(part["quads"]), number)
        count += len(own)
    cells = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
    together = grid(np.concatenate(points), cells["quads"])
    failed = cells["failed"]
    together.cell_data.update(
        {
            "tension_warp_N": cells["tension"][:, 0].astype(float),
            "tension_weft_N": cells["tension"][:, 1].astype(float),
            "failed_warp": failed[:, 0].astype(np.int8),
            "failed_weft": failed[:, 1].astype(np.int8),
            "failed_yarns": count_failed_yarns(failed),
            "ply": cells["ply"].astype(np.int8),
        }
    )
    if len(parts) > len(plies):
        together.cell_data["resolved_yarn"] = cells["yarn"].astype(np.int8)

    def of_points(arrays):
        """Values of the nodes, and none of the surfaces of yarns."""
        known = np.concatenate(arrays)
        return np.pad(known, [(0, count - len(known)), *[(0, 0)] * (known.ndim - 1)])

    together.point_data["area_m2"] = of_points([shape.area for shape in plies])
    for field, names in (("pressure", PRESSURES), ("failed_segments", _FAILED)):
        columns = of_points([getattr(shape, field) for shape in plies]).T
        together.point_data.update({name: column.copy() for name, column in zip(names, columns)})
    together.field_data["projectile_z_m"] = [float(plies[0].nose_position)]
    return together


def _elements(shape, quads):
    """{name: values} of the elements of a ply that no resolved yarns stand for."""
    left = np.ones(len(quads), bool)
    if shape.resolved.size:
        left = ~shape.resolved
    return {
        "quads": quads[left],
        "tension": shape.tension[left],
        "failed": shape.failed[left],
        "yarn": np.zeros(left.sum()),
    }


def _yarns(shape):
    """{name: values} of the surfaces of the resolved yarns of a ply: quadrilaterals from each section to
    the next one, marked as eroded where there is no yarn between them, so that all instants have the
    same ones."""
    count, around, _ = shape.yarn_surface.shape
    numbers = np.arange(count * around).reshape(count, around)
    beside = np.roll(numbers, -1, axis=1)
    corners = [numbers[:-1], numbers[1:], beside[1:], beside[:-1]]
    quads = np.stack(corners, axis=-1).reshape(-1, 4)
    tension = np.repeat(shape.yarn_tension[:-1], around)
    family = np.repeat(shape.yarn_family[:-1], around)
    gone = np.isnan(tension)
    tension = np.where(gone, 0.0, tension)
    failed = np.zeros((len(quads), 3), bool)
    failed[:, 2] = gone
    return {
        "quads": quads,
        "tension": np.column_stack([tension * (family == 0), tension * (family == 1)]),
        "failed": failed,
        "yarn": family + 1,
    }


def count_failed_yarns(broken: np.ndarray) -> np.ndarray:
    """Count how many yarns of each element have failed, (m,), 0 to 2; an eroded element has lost
    both.

    Parameters
    ----------
    broken : (m, 3) bool: warp failed, weft failed, element eroded
    """
    return np.where(broken[:, 2], 2, broken[:, :2].sum(axis=1)).astype(np.int8)


def write_panel(out: Path, instants: Iterable[Sequence[Shape]], quads: Sequence[IntArray]) -> None:
    """Write a panel as panel.pvd and panel/panel-NNNN.vtu in the folder `out`; parameters as of
    `panel`."""
    times: dict[str, float] = {}
    for number, plies in enumerate(instants):
        name = f"panel/panel-{number:04d}.vtu"
        write_grid(out / name, panel(plies, quads))
        times[name] = plies[0].time
    write_series(out / "panel.pvd", times)


@explain_missing()
def body(found: TurnedBody) -> Any:
    """Make the grid of a projectile of metal, turned about its axis, with the arrays that
    docs/reference.md lists."""
    import pyvista

    turn = np.linspace(0, 2 * np.pi, AROUND, endpoint=False)
    r, z = found.nodes.T[..., None]
    places = np.stack([r * np.cos(turn), r * np.sin(turn), z + 0 * turn], axis=-1) + found.place
    corners = np.asarray(found.drawn.corners)
    # two neighbouring copies of an element's quadrilateral are a hexahedron
    first = corners[:, None] * AROUND + np.arange(AROUND)[None, :, None]
    second = corners[:, None] * AROUND + np.roll(np.arange(AROUND), -1)[None, :, None]
    cells = np.concatenate([second, first], axis=-1).reshape(-1, 8)
    made = pyvista.UnstructuredGrid({pyvista.CellType.HEXAHEDRON: cells}, places.reshape(-1, 3))
    of_elements = {
        "plastic_strain": found.plastic,
        "strain": found.strain,
        "jacket": found.drawn.jacketed.astype(np.int8),
    }
    made.cell_data.update({name: np.repeat(values, AROUND) for name, values in of_elements.items()})
    return made


def write_body(out: Path, bodies: Iterable[tuple[TurnedBody, float]]) -> None:
    """Write a projectile of metal as body.pvd and body/body-NNNN.vtu in the folder `out`.

    Parameters
    ----------
    bodies : (body, time [s]) of each instant
    """
    times: dict[str, float] = {}
    for number, (found, time) in enumerate(bodies):
        name = f"body/body-{number:04d}.vtu"
        write_grid(out / name, body(found))
        times[name] = time
    write_series(out / "body.pvd", times)


@explain_missing()
def write_faces(out: Path, faces: Iterable[tuple[FloatArray, float]]) -> None:
    """Write the face of a block as block.pvd and block/block-NNNN.vtu in the folder `out`; nothing of
    no faces.

    Parameters
    ----------
    faces : (nodes (nx, ny, 3) [m], time [s]) of each instant
    """
    import pyvista

    times: dict[str, float] = {}
    for number, (face, time) in enumerate(faces):
        name = f"block/block-{number:04d}.vtu"
        made = pyvista.StructuredGrid(*np.moveaxis(face, -1, 0))
        write_grid(out / name, made.cast_to_unstructured_grid())
        times[name] = time
    if times:
        write_series(out / "block.pvd", times)


def write_grid(path: FilePath, content: Any) -> None:
    """Write a grid of pyvista as .vtu, whole or not at all.

    Numbers are compressed a little and stand as bytes: to compress them well took most of the time.

    Raises
    ------
    OSError : the file cannot be written, as on a full disk
    """
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridWriter

    writer = vtkXMLUnstructuredGridWriter()
    writer.SetInputData(content)
    writer.SetDataModeToAppended()
    writer.EncodeAppendedDataOff()
    writer.SetCompressionLevel(COMPRESSION)
    with replace_whole(path) as beside:
        writer.SetFileName(str(beside))
        if not writer.Write():
            raise OSError(errno.EIO, "the grid could not be written", str(path))


def write_series(path: FilePath, times: Mapping[str, float]) -> None:
    """Write the .pvd.

    Parameters
    ----------
    times : {name of a file beside the .pvd: time [s]}
    """
    sets = "\n".join(
        f'    <DataSet timestep="{time:.9e}" file="{name}"/>' for name, time in times.items()
    )
    write(
        path,
        '<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1" byte_order="LittleEndian">\n'
        f"  <Collection>\n{sets}\n  </Collection>\n</VTKFile>\n",
    )


def read_grid(path: FilePath) -> Any:
    """Read a .vtu, or another file of elements that pyvista reads.

    Raises
    ------
    InputError : it is too large
    """
    import pyvista

    check_size(path, Path(path).stat().st_size, "mesh file")
    return pyvista.read(Path(path))


def read_series(path: FilePath) -> list[tuple[Path, float]]:
    """Read the files of a .pvd with their times, as [(path, time [s])].

    Raises
    ------
    InputError : no such file, or not a series
    """
    from xml.etree import ElementTree

    path = Path(path)
    try:
        found = []
        for entry in ElementTree.fromstring(read_bytes(path)).iter("DataSet"):
            file = find_inside(path.parent, entry.attrib["file"])
            if file is None:
                raise ValueError(f"it names {entry.attrib['file']!r}, which is not beside it")
            found.append((file, float(entry.attrib["timestep"])))
        return found
    except (OSError, ElementTree.ParseError, KeyError, ValueError) as problem:
        raise InputError(f"is not a readable ParaView series ({problem})", file=path) from None
