"""Chapters of what an impact may also have: histories along yarns, an elastic projectile, a block behind the fabric."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from weavecell.report import pictures, pictures_body, pictures_histories
from weavecell.report.page import Figure, Section, Table

if TYPE_CHECKING:
    from shellfabric.output.histories import Histories
    from weavecell.results.impact import ImpactRecord


def measures(recorded: Histories, places: Sequence[float], ply: int | None = None) -> Section:
    """What was recorded along yarns and at the edges.

    Parameters
    ----------
    recorded : shellfabric.output.histories.Histories
    places : [m] along the yarns whose histories are drawn
    ply : number of the ply in a pack, the first is 1; None of a single panel
    """
    from shellfabric.output.wave_fronts import fronts

    t, waves = recorded.t, fronts(recorded)
    through = [yarn for yarn in (recorded.through("warp"), recorded.through("weft")) if yarn is not None]
    drawn: list[tuple[str, str, tuple[Any, ...]]] = []
    of_ply = f"-ply-{ply}" if ply else ""
    if recorded.yarns:
        within = [place for place in places if any(place <= yarn.X[-1] for yarn in recorded.yarns)]
        drawn = [
            ("tensions", "Tension and fibre strain of the yarns that were followed.", (recorded.yarns, within)),
            ("fronts", "Tension over place and time, with the longitudinal front (dark: tension arrives) and the "
             "transverse one (red: the foot of the pyramid); the lines are fitted.", (through, waves)),
            ("profiles", "Deflection along the yarns nearest the impact point.", (through,)),
        ]  # fmt: skip
    drawn.append(("edges", "Force of the fabric on the edges of the whole panel.", (recorded.edges,)))
    figures = tuple(
        Figure(pictures.render(getattr(pictures_histories, name), t, *arguments), "svg", caption, name + of_ply)
        for name, caption, arguments in drawn
    )
    title = f"Along the yarns and at the edges{f', ply {ply}' if ply else ''}"
    columns = ("front", "yarn", "speed in the fabric [m/s]", "95 % interval [m/s]", "speed along the yarn [m/s]")
    return Section(
        f"measures{of_ply}", title, "", figures,
        (Table(columns, tuple(_front_row(wave, recorded) for wave in waves), numeric=columns[2:]),) if waves else (),
    )  # fmt: skip


def body(record: ImpactRecord) -> list[Section]:
    """Sections of an elastic projectile, of a block behind the panel and of sliding crossovers, where there are any."""
    found = []
    if record.bar is not None:
        bar = record.bar
        lead = f"{record.rigid_check}. " if record.rigid_check else ""
        lead += f"Plastic strain has shortened it by {1e3 * bar.shortening:.3g} mm."
        swing = f" They swing in {1e6 * bar.swing:.3g} us." if np.isfinite(bar.swing) else ""
        caption = (
            f"Tip, tail and centre of mass of the projectile; the first mode has {1e6 * bar.period:.3g} us.{swing}"
        )
        picture = pictures.render(pictures_body.bar, bar)
        found.append(Section("bar", "The projectile as a bar", lead, (Figure(picture, "svg", caption, "bar"),)))
    if record.backing is not None:
        block = record.backing
        moving = 100 * record.energies["backing_kinetic"][-1] / record.strike_energy
        lead = (
            f"Back-face signature: {1e3 * block.back_face_signature:.1f} mm, volume of the dent "
            f"{1e6 * block.volume:.3g} cm³; the block still moves with {moving:.2g} % of the strike energy. "
            f"The crater is {1e3 * block.depth:.1f} mm deep and {2e3 * block.half_width:.1f} mm wide at half of that; "
            f"its wall stands at {np.degrees(block.steepness):.0f}° to the face. {int(block.gone.sum())} bricks of "
            f"{'the block' if block.share == 1 else 'its modelled part'} are eroded."
        )
        picture = pictures.render(pictures_body.crater, {record.title: block}, kind="png")
        caption = "The block cut along the warp through the impact point, at the end of the run, to scale."
        deep = pictures.render(pictures_body.depth_map, block, kind="png")
        seen = "Depth of the face of the block at the end of the run, seen along the flight; lines every fifth of it."
        figures = (Figure(picture, "png", caption, "crater"), Figure(deep, "png", seen, "depth-map"))
        found.append(Section("backing", "The block behind", lead, figures))
    if record.slips:
        found.append(_slips(record))
    return found


def _slips(record):
    """Section of sliding crossovers: a row a ply."""
    columns = (
        "ply", "segments that a yarn has left", "longest yarn through a crossover [mm]",
        "widest distance of neighbouring yarns [mm]", "work of friction [J]",
    )  # fmt: skip
    rows = tuple(
        (f"{ply}", f"{slip.pulled_out_segments}", f"{1e3 * slip.pulled_out_length:.3g}",
         f"{1e3 * slip.largest_window:.3g}", f"{slip.friction_work:.3g}")
        for ply, slip in enumerate(record.slips, 1)
    )  # fmt: skip
    share = 100 * sum(slip.friction_work for slip in record.slips) / record.strike_energy
    caption = f"Friction at the crossovers: {share:.3g} % of the strike energy."
    return Section("slip", "Sliding crossovers", "", (), (Table(columns, rows, caption, numeric=columns[1:]),))


def _front_row(wave, recorded):
    if not np.isfinite(wave.speed):
        return wave.kind, wave.family, "-", "-", "-"
    along = f"{wave.speed * (1 + recorded.through(wave.family).crimp):.0f}" if wave.kind == "longitudinal" else "-"
    low, high = wave.interval
    return wave.kind, wave.family, f"{wave.speed:.0f}", f"{low:.0f} to {high:.0f}", along
