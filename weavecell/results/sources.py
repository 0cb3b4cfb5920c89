"""The source of every number that a run used: those of its fabrics, of what is assumed of them, of
projectile, metals, block and resolved yarns."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from typing import TYPE_CHECKING, Any, NamedTuple

from fabrics import assumed, backings, data_sheet, metals, projectiles
from fabrics.base.errors import InputError
from fabrics.base.files import parse_toml
from fabrics.materials import read_table

if TYPE_CHECKING:
    from fabrics.compression import CompressionLaw
    from fabrics.fabric import Fabric

# what a fabric file gives and no run uses
_UNUSED = ("micrograph.", "areal_density_measured")


class Source(NamedTuple):
    """Where a number comes from.

    Parameters
    ----------
    of : what it belongs to, such as "S-720"
    number : its name there, such as "warp.modulus"
    status : such as "measured"
    text : the source
    """

    of: str
    number: str
    status: str
    text: str


def list_sources(
    fabrics: Iterable[Fabric], laws: Iterable[CompressionLaw] = (), scene_text: str = ""
) -> list[Source]:
    """List the sources of the numbers of a run, each once.

    Parameters
    ----------
    fabrics : of the run, with what was assumed of them
    laws : compression laws of their plies
    scene_text : of the input file, which names projectile, block and metals; of a program, or "",
        it says nothing
    """
    found: list[Source] = []
    for fabric in {fabric.name: fabric for fabric in fabrics}.values():
        found += _of_fabric(fabric)
    for law in laws:
        if law.fabric:
            found.append(Source(law.fabric, "compression law", "fitted", law.provenance))
    # a program that computed a result is no input file
    with suppress(ValueError):
        scene = parse_toml(scene_text)
        found += _of_scene(scene)
        found += _of_friction(scene, fabrics)
    return list(dict.fromkeys(found))


def _of_fabric(fabric: Fabric) -> Iterator[Source]:
    """Sources of a fabric's data, then those of data_sheet.toml that stand in for some."""
    for key, entry in fabric.sources.items():
        if not key.startswith(_UNUSED):
            yield Source(fabric.name, key, entry["status"], entry["source"])
    if fabric.idealised:
        yield Source(fabric.name, "idealised", "assumed", assumed.describe_idealised(fabric))
    standing_in = assumed.shot_entries(fabric)
    names = [name for name in fabric.assumed if name in standing_in]
    if "crimp" in fabric.assumed:
        names += assumed.entries_of_crimp(fabric)
    for name in names:
        entry = standing_in.get(name) or data_sheet.entries()[name]
        yield Source(fabric.name, name, entry.status, entry.source)


def _of_scene(scene: Mapping[str, Any]) -> Iterator[Source]:
    """Sources of what an input file names."""
    shot = scene.get("projectile", {})
    named: Mapping[str, Any] = {}
    if "name" in shot:
        # a file of the user's own may be gone by now
        with suppress(InputError):
            _, named = projectiles.entry(shot["name"])
        yield from _of_rows(f"projectile {shot['name']}", named)
    for part in ("core", "jacket"):
        metal = shot.get(part, named.get(part, {}).get("value"))
        if metal in metals.TABLES.list_names():
            yield from _of_rows(metal, metals.TABLES.entry(metal))
    if "backing" in scene:
        material = scene["backing"].get("material")
        if material in backings.list_names():
            yield from _of_rows(material, backings.entry(material))
        else:
            yield from _of_rows("block of the thesis", read_table("backing"))
    panel = scene.get("panel", {})
    if panel.get("crossovers", "pinned") != "pinned":
        from shellfabric.yarns.model import DATA

        yield from _of_rows("resolved yarns", DATA)
    if "plies" in panel or "ply" in panel:
        gap = data_sheet.entries()["ply_gap"]
        yield Source("pack", "ply_gap", gap.status, gap.source)


def _of_friction(scene: Mapping[str, Any], fabrics: Iterable[Fabric]) -> Iterator[Source]:
    """Source of the friction between resolved yarns, if the input file does not give it."""
    panel = scene.get("panel", {})
    if panel.get("crossovers", "pinned") != "pinned" and "crossover_friction" not in panel:
        entry = assumed.friction_between_yarns(*fabrics)
        name = data_sheet.FRICTION_BETWEEN_YARNS
        yield Source("resolved yarns", name, entry.status, entry.source)


def _of_rows(name: str, rows: Mapping[str, Any]) -> Iterator[Source]:
    for key, row in rows.items():
        if isinstance(row, Mapping) and "source" in row:
            yield Source(name, key, row["status"], row["source"])
