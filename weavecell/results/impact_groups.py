"""Groups of histories.h5 that not every impact has: /measured, /bar, /backing and /slip."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from weavecell.results import keys
from weavecell.results.hdf5_file import PACKED, plain, put

if TYPE_CHECKING:
    from shellfabric.output.histories import Histories

_YARN = tuple(keys.units(keys.YARN_DATA))
# datasets whose attribute in the object that holds them has another name
_FIELDS = {"time": "t", "position": "place", "eroded": "gone"}


def write_group(group: Any, source: object, table: Iterable[keys.Key], scalars: Iterable[str]) -> None:
    """Scalars of an object by name, and arrays by the keys of a table."""
    for name in scalars:
        group.attrs[name] = getattr(source, name)
    for name, unit in keys.units(table).items():
        put(group, name, getattr(source, _FIELDS.get(name, name)), unit, **PACKED)


def read_group(file: Any, name: str) -> Any:
    """What `write_group` wrote of a bar, a backing or the sliding crossovers of a ply (slip/00, ...), or None."""
    from shellfabric.backing.coupling import BackingResult
    from shellfabric.projectile.dynamics import BarHistory
    from shellfabric.sliding.model import SlipSummary

    if name not in file:
        return None
    kinds: dict[str, tuple[Any, tuple[keys.Key, ...]]] = {
        "bar": (BarHistory, keys.BAR), "backing": (BackingResult, keys.BACKING), "slip": (SlipSummary, ()),
    }  # fmt: skip
    kind, table = kinds[name.partition("/")[0]]
    group = file[name]
    arrays = {_FIELDS.get(key.name, key.name): group[key.name][()] for key in table}
    return kind(**arrays, **{key: plain(value) for key, value in group.attrs.items()})


def write_measured(group: Any, measured: Histories) -> None:
    """Histories, and the fronts read off them, which are for the reader alone."""
    from shellfabric.output.wave_fronts import fronts

    put(group, "time", measured.t, "s")
    for number, yarn in enumerate(measured.yarns):
        inner = group.create_group(f"yarns/{number:03d}-{yarn.family}")
        for name in _YARN:
            inner.attrs[name] = getattr(yarn, name)
        for name, unit in keys.units(keys.YARN).items():
            put(inner, name, getattr(yarn, _FIELDS.get(name, name)), unit, **PACKED)
        put(inner, "strain", yarn.strain, "1", **PACKED)
    for name, forces in measured.edges.items():
        put(group, f"edges/{name}", forces, "N")
    for front in fronts(measured):
        inner = group.create_group(f"fronts/{front.family}-{front.kind}")
        inner.attrs["speed"], inner.attrs["interval"], inner.attrs["start"] = front.speed, front.interval, front.start
        put(inner, "time", front.time, "s")
        put(inner, "position", front.place, "m")


def read_measured(group: Any) -> Histories:
    from shellfabric.output.histories import EDGES, Histories, YarnHistory

    yarns = tuple(
        YarnHistory(
            **{name: plain(inner.attrs[name]) for name in _YARN},
            **{_FIELDS.get(name, name): inner[name][()] for name in keys.units(keys.YARN)},
        )
        for _, inner in sorted(group.get("yarns", {}).items())
    )
    return Histories(group["time"][()], yarns, {name: group[f"edges/{name}"][()] for name in EDGES})
