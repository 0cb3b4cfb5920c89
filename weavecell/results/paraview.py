"""A panel in motion as a ParaView series: one .vtu a snapshot, and a .pvd that lists them with their times.

Pressures times areas, and failed segments, add up to what histories.h5 has of each ply at that time, over the part of
the panel that is modelled.
"""

from __future__ import annotations

import zlib
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from fabrics.checks import FilePath
from fabrics.errors import InputError
from fabrics.files import write_whole

if TYPE_CHECKING:
    from weavecell.results.impact_shapes import Shape


QUAD = 9  # VTK's number of a quadrilateral
_KINDS = {"f8": "Float64", "f4": "Float32", "i8": "Int64", "i1": "Int8", "u1": "UInt8"}
PRESSURES = ("projectile_pressure_Pa", "front_pressure_Pa", "rear_pressure_Pa", "torn_pressure_Pa")
_OF_NODES = ("nodes", "pressure", "area", "failed_segments", "slip")


def write_panel(out: Path, instants: Iterable[Sequence[Shape]], quads: Sequence[np.ndarray]) -> None:
    """Write a panel's shapes as panel.pvd and panel/*.vtu in the folder `out`; the cells of a ply have its number.

    Parameters
    ----------
    instants : of each instant the plies' `results.impact_shapes.Shape`
    quads : of each ply (m, 4) node numbers, in order round the cell
    """
    times: dict[str, float] = {}
    plies = np.concatenate([np.full(len(each), ply, np.int8) for ply, each in enumerate(quads, 1)])
    for number, shapes in enumerate(instants):
        if not times:
            first = np.cumsum([0, *(len(shape.nodes) for shape in shapes)])
            cells = topology(np.concatenate([each + start for each, start in zip(quads, first)]))
        nodes, pressure, area, segments, slip, tension, failed = (
            np.concatenate([getattr(shape, name) for shape in shapes]) for name in (*_OF_NODES, "tension", "failed")
        )
        name = f"panel/panel-{number:04d}.vtu"
        values = cell_values(tension, failed) | {"ply": plies}
        at_nodes = node_values(pressure, area, segments, slip)
        write_grid(out / name, nodes, cells, values, at_nodes, shapes[0].nose_position)
        times[name] = shapes[0].t
    write_series(out / "panel.pvd", times)


def cell_values(tension: np.ndarray, failed: np.ndarray) -> dict[str, np.ndarray]:
    """Cell data of a panel from its tensions (m, 2) [N] and its flags (m, 3) bool of `results.impact_shapes.Shape`."""
    return {
        "tension_warp_N": tension[:, 0].astype(float),
        "tension_weft_N": tension[:, 1].astype(float),
        "failed_warp": failed[:, 0].astype(np.int8),
        "failed_weft": failed[:, 1].astype(np.int8),
        "failed_yarns": failed_yarns(failed),
    }


def node_values(
    pressure: np.ndarray, area: np.ndarray, segments: np.ndarray, slip: np.ndarray
) -> dict[str, np.ndarray]:
    """Point data of a panel from the arrays (k, ...) of `results.impact_shapes.Shape`."""
    return (
        dict(zip(PRESSURES, pressure.T))
        | {"area_m2": area}
        | dict(zip(("failed_segments_warp", "failed_segments_weft"), segments.T))
        | dict(zip(("slip_warp_m", "slip_weft_m"), slip.T))
    )


def topology(quads: np.ndarray) -> dict[str, tuple[str, bytes]]:
    """The cells of quadrilaterals (m, 4) as `write_grid` takes them; grids of the same cells share it."""
    quads = np.asarray(quads, np.int64)
    return {
        "connectivity": _block(quads),
        "offsets": _block(np.arange(4, 4 * len(quads) + 1, 4, dtype=np.int64)),
        "types": _block(np.full(len(quads), QUAD, np.uint8)),
    }


def _block(array):
    """(name of VTK for the type, bytes) of an array: compressed, as one block behind its header."""
    array = np.ascontiguousarray(array)
    packed = zlib.compress(array.tobytes(), 1)
    header = np.array([1, array.nbytes, 0, len(packed)], "<u8")
    return _KINDS[array.dtype.str[1:]], header.tobytes() + packed


def write_grid(
    path: FilePath,
    nodes: np.ndarray,
    cells: Mapping[str, tuple[str, bytes]],
    values: Mapping[str, np.ndarray],
    at_nodes: Mapping[str, np.ndarray] | None = None,
    projectile_z: float | None = None,
) -> None:
    """Write an unstructured grid as .vtu, its arrays behind the XML (format of VTK 1.0, appended, zlib).

    Parameters
    ----------
    nodes : (n, 3) [m]
    cells : of `topology`
    values : {name: (m,)} cell data
    at_nodes : {name: (n,)} point data, or None
    projectile_z : [m], field data; None for none
    """
    count = len(next(iter(values.values())))
    blocks: list[bytes] = []
    offset = 0

    def entry(name, block, attributes=""):
        nonlocal offset
        kind, content = block
        blocks.append(content)
        line = f'<DataArray type="{kind}" Name="{name}"{attributes} format="appended" offset="{offset}"/>'
        offset += len(content)
        return line

    field = ""
    if projectile_z is not None:
        place = entry("projectile_z_m", _block(np.array([float(projectile_z)])), ' NumberOfTuples="1"')
        field = f"<FieldData>{place}</FieldData>\n"
    points = entry("Points", _block(np.asarray(nodes, float)), ' NumberOfComponents="3"')
    elements = "".join(entry(name, block) for name, block in cells.items())
    data, point_data = (
        "".join(entry(name, _block(array)) for name, array in arrays.items()) for arrays in (values, at_nodes or {})
    )
    text = (
        '<?xml version="1.0"?>\n<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" '
        'header_type="UInt64" compressor="vtkZLibDataCompressor">\n<UnstructuredGrid>\n'
        f"{field}"
        f'<Piece NumberOfPoints="{len(nodes)}" NumberOfCells="{count}">\n'
        f"<PointData>{point_data}</PointData>\n<CellData>{data}</CellData>\n"
        f"<Points>{points}</Points>\n<Cells>{elements}</Cells>\n"
        '</Piece>\n</UnstructuredGrid>\n<AppendedData encoding="raw">_'
    )
    with write_whole(path, "wb") as file:
        file.write(text.encode())
        file.writelines(blocks)
        file.write(b"</AppendedData>\n</VTKFile>\n")


def failed_yarns(broken: np.ndarray) -> np.ndarray:
    """(m,) how many yarns of each element have failed, 0 to 2; an eroded element has lost both.

    Parameters
    ----------
    broken : (m, 3) bool: warp failed, weft failed, element eroded
    """
    return np.where(broken[:, 2], 2, broken[:, :2].sum(axis=1)).astype(np.int8)


def write_series(path: FilePath, times: Mapping[str, float]) -> None:
    """Write the .pvd.

    Parameters
    ----------
    times : {name of a file beside the .pvd: time [s]}
    """
    sets = "\n".join(f'    <DataSet timestep="{time:.9e}" file="{name}"/>' for name, time in times.items())
    with write_whole(path) as file:
        file.write(
            '<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1" byte_order="LittleEndian">\n'
            f"  <Collection>\n{sets}\n  </Collection>\n</VTKFile>\n"
        )


def read_series(path: FilePath) -> list[tuple[Path, float]]:
    """The files of a .pvd with their times, as [(path, time [s])].

    Raises
    ------
    InputError : no such file, or not a series
    """
    from xml.etree import ElementTree

    path = Path(path)
    try:
        return [
            (path.parent / entry.attrib["file"], float(entry.attrib["timestep"]))
            for entry in ElementTree.parse(path).iter("DataSet")
        ]
    except (OSError, ElementTree.ParseError, KeyError, ValueError) as problem:
        raise InputError(f"is not a readable ParaView series ({problem})", file=path) from None
