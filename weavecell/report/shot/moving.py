"""The interactive view of a shot: its snapshots as compact arrays in a page, drawn there by
templates/view3d.js.

Places are 16-bit integers over the box of all snapshots, as differences from the snapshot before;
tensions are 8-bit shares of the strength. All arrays are compressed (zlib) in one text.
"""

from __future__ import annotations

import base64
import json
import zlib
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from weavecell.report import pictures3d
from weavecell.report.page import Report, Section
from weavecell.report.pictures_style import CLAY, ORANGE, RED, STEEL, tension_map
from weavecell.report.shot import chapters_shot
from weavecell.results import vtk
from weavecell.results.display import text

if TYPE_CHECKING:
    from weavecell.results.impact import ImpactRecord

# [bytes] limit of all snapshots before compression, which leaves about a third
_MOST_BYTES = 16_000_000
# 8-bit value of a yarn at its strength; larger tensions still fit
_PER_UNIT = 200
_AROUND = 36  # sectors of a projectile of metal, which the page turns about its axis
_OF_METAL = (
    " The projectile is grey where its metal has not flowed, and orange where it has flowed most, "
    "with a plastic strain of {}."
)
_CAPTION = (
    "The whole panel and the projectile. Drag to turn; + and − or Ctrl and the wheel come nearer. Front is the side "
    "that is struck. Tension in % of the strength; orange: one yarn failed; elements that have lost both are left out."
)


def section(record: ImpactRecord, instants: Sequence[tuple[Any, float]]) -> Section:
    """Build the chapter with the view.

    Parameters
    ----------
    instants : (grid of `results.vtk.panel`, time [s]) of each snapshot
    """
    caption = _CAPTION
    if record.metal is not None:
        most = max(_rings(record, t)[:, 2].max() for _, t in instants)
        caption += _OF_METAL.format(f"{most:.2g}")
    if record.ply_fabrics:
        caption += f" From the front: {record.which_fabric}."
    if record.backing is not None:
        caption += " Brown: half of the face of the block behind."
    return Section("motion", "The panel in motion", caption, moving=moving(record, instants))


def collect_instants(
    record: ImpactRecord, shapes: Sequence[Sequence[Any]]
) -> list[tuple[Any, float]]:
    """Make the instants of `section` from the shapes of the plies at each."""
    return [(vtk.panel(plies, record.quads), plies[0].time) for plies in shapes]


def page(record: ImpactRecord, instants: Sequence[tuple[Any, float]]) -> Report:
    """Build a page of the view alone, in the form of a report."""
    return Report(chapters_shot.find(record), "", (section(record, instants),))


def moving(record: ImpactRecord, instants: Sequence[tuple[Any, float]]) -> str:
    """Write the arrays of the view as JSON; so many snapshots, evenly chosen, that they stay
    small."""
    from matplotlib.colors import to_rgb

    first = instants[0][0]
    each = 6 * first.n_points + 3 * first.n_cells
    count = min(len(instants), max(2, _MOST_BYTES // each))
    chosen = [instants[k] for k in np.linspace(0, len(instants) - 1, count).round().astype(int)]
    places = np.array([grid.points for grid, _ in chosen])
    low = places.min(axis=(0, 1))
    high = places.max(axis=(0, 1))
    step = np.maximum(high - low, 1e-9) / 65535
    whole = np.round((places - low) / step).astype(np.int64)
    # differences compress better; they are taken modulo 2^16
    differences = np.diff(whole, axis=0, prepend=0).astype("<u2")
    ply = np.asarray(first["ply"]) - 1
    tension = []
    for grid, _ in chosen:
        tension.append(np.column_stack([grid["tension_warp_N"], grid["tension_weft_N"]]))
    shares = np.array(tension) / record.strength[ply]
    body = _bodies(record, [t for _, t in chosen])
    mirrors = (bool(record.mirror_x), bool(record.mirror_y))
    width = pictures3d.width(places[0], record.mirror_x)
    faces = pictures3d.open_faces([record.face_at(t) for _, t in chosen], mirrors, 0.55 * width)
    rows, columns = faces[0].shape[:2]
    parts = (
        body.astype("<f4"),
        np.array(faces).astype("<f4"),
        first.cells.reshape(-1, 5)[:, 1:].astype("<u4"),
        differences,
        np.clip(np.round(_PER_UNIT * shares), 0, 255).astype(np.uint8),
        np.array([grid["failed_yarns"] for grid, _ in chosen]).astype(np.uint8),
        ply.astype(np.uint8),
    )
    packed = zlib.compress(b"".join(part.tobytes() for part in parts), 6)
    noses = []
    for grid, t in chosen:
        noses.append([*record.nose_place(t), float(grid.field_data["projectile_z_m"][0])])
    deepest = max(float(np.ptp(places[..., 2])), 1e-6)
    # one scale with the pictures beside it
    of_tension = {"value": 1.0, "text": "100 % of the strength"}
    ends = dict.fromkeys(("tension", "warp", "weft"), of_tension)
    ends["deflection"] = {"value": deepest, "text": text(deepest, "m", form=".1f")}
    elevation = 0.6
    if record.seen_from_front:
        elevation = -0.6
    palette = np.round(255 * tension_map()(np.linspace(0, 1, 256))[:, :3]).astype(int)
    head = {
        "nodes": first.n_points,
        "elements": first.n_cells,
        "instants": count,
        "rings": body.shape[1] if body.ndim == 3 else 0,
        "around": _AROUND,
        "bodyVertices": body.shape[-2] if body.ndim == 2 else 6 * (body.shape[1] - 1) * _AROUND,
        "flowed": [round(255 * part) for part in to_rgb(ORANGE)],
        "mostPlastic": max(float(body[..., 2].max()), 1e-3) if body.ndim == 3 else 0.0,
        "faceRows": rows,
        "faceColumns": columns,
        "perUnit": _PER_UNIT,
        "origin": low.tolist(),
        "step": step.tolist(),
        "rest": record.z_rest.tolist(),
        "mirrors": list(mirrors),
        "width": width,
        "depth": deepest,
        "elevation": elevation,
        "projectile": noses,
        "times": [t for _, t in chosen],
        "captions": [chapters_shot.instant(record, t) for _, t in chosen],
        "ends": ends,
        "palette": palette.tolist(),
        "failed": [round(255 * part) for part in to_rgb(RED)],
        "steel": [round(255 * part) for part in to_rgb(STEEL)],
        "clay": [round(255 * part) for part in to_rgb(CLAY)],
        "data": base64.b64encode(packed).decode("ascii"),
    }
    return json.dumps(head)


def _bodies(record, times):
    """The projectile in the page: of metal (instants, rings, 3) r, z [m] and effective plastic strain of
    its surface; of another the vertices (n, 3) [m] of its triangles, which stay. z is 0 at the foremost
    point."""
    if record.metal is not None:
        return np.array([_rings(record, t) for t in times])
    body = record.projectile - np.append(np.zeros(2), record.projectile[..., 2].max())
    corner = body[:-1, :-1]
    across = body[1:, 1:]
    # two triangles for each quadrilateral
    corners = [corner, body[1:, :-1], across, corner, across, body[:-1, 1:]]
    return np.stack(corners, axis=2).reshape(-1, 3)


def _rings(record, t):
    """(rings, 3) r, z [m] and plastic strain of the surface at the cut nearest to a time."""
    cut = min(record.cuts, key=lambda cut: abs(cut.time - t))
    # a node has the mean of the elements about it
    corners = record.metal.corners
    count = np.bincount(corners.ravel(), minlength=len(cut.body))
    total = np.bincount(corners.ravel(), np.repeat(cut.plastic, 4), len(cut.body))
    surface = record.metal.outline
    return np.column_stack([cut.body[surface], (total / count)[surface]])
