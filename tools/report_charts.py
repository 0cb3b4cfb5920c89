"""Charts of the reports that a reader of the repository sees, each drawn from a CSV in docs/reports/data to a PNG
in docs/figures: `python tools/figures.py --only reports`. The file says of which content it was made
(`digest_of`), which a test compares with the CSV.

Cost against error: every method of a study is a point; those that none beats in cost and error are the front.
The default is marked; the error of the reference, below which none can be told, is a line.
Models: a row a model of one panel, its CPU time for one crossover and 1 us beside that of the thesis's model.
Scenes: a row a scene, a mark a model at what it leaves off the richest, with its CPU time over the richest's.
Maps: a mark a run over two parameters; colour and shape say whether it was stable, wrong without a message,
or ended with one. An open mark is flagged by a quality check.
"""

from __future__ import annotations

import hashlib
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter, SymmetricalLogLocator
from PIL import Image
from study_pages import DATA, STUDIES, read

from weavecell.report import pictures_figure
from weavecell.report.pictures_style import BLUE, FAINT, GREEN, INK, ORANGE, RED

FIGURES = Path(__file__).parents[1] / "docs" / "figures"
COST = "CPU [s]"
ERROR = "error of "
METHOD = "method"
DEFAULT = "default"
REFERENCE = "reference"
# what the study calls the default of the product; coupons and shots have a row of that name
DEFAULTS = {
    "crossover": "8 x 6 x 4",
    "crossover-order": "8 x 6 x 4",
    "law-or-surface": "calibrate, 8 x 6 x 4",
}
TITLES = {
    "cost-ply-stopped": "One ply of S-720, 92.5 m/s, stops the projectile",
    "cost-drawn-ply": "One ply of S-728, 5.5 mm sphere at 140 m/s, 12 drawn shots",
    "cost-drawn-pack": "Two plies of S-728, FSP of 1.1 g at 220 m/s, 10 drawn shots",
    "cost-pack": "Four plies of S-728, 91 m/s",
    "cost-pack-fragment": "Four plies of S-728, a fragment of 1.1 g at 276 to 324 m/s",
    "cost-pack-bullet": "Ten plies of S-728, a 9 mm bullet at 400 m/s",
    "cost-bullet": "9 mm bullet, twelve plies of S-745, 190 m/s",
    "crossover": "3D crossover of S-720",
    "crossover-order": "3D crossover of S-720: hexahedra of order 1 and 2",
    "law-or-surface": "A law or a surface in place of the 3D crossover, own aramid",
    "cost-bias-extension": "Coupon: bias extension of S-728",
    "cost-biaxial-coupon": "Coupon: biaxial tension",
    "cost-struck-yarn": "One struck yarn",
    "cost-peers": "One ply of S-720, 60 m/s, no failure: other models and another code",
    "solid-cost": "Four models of a ply of S-720: CPU time, here and in the thesis",
    "models-of-scenes": "Ten scenes: how far each model is off the richest",
    "stability-newton": "Newton iteration of the thesis on two heights",
    "stability-bracket": "The bracket of weavecell, same points",
    "stability-printed-law": "The compression law as printed",
    "stability-time-step": "Time step",
    "stability-nose-stiffness": "Contact with the nose",
    "stability-viscosity": "Viscosity of the yarns",
    "stability-edge-radius": "Edge radius of the nose against the mesh",
    "stability-plies": "Contact between plies",
    "stability-load-step": "Load step of the 3D crossover",
    "stability-bars": "Fibre bars in the solid yarn",
    "stability-bias": "Bias extension with a softer trellis",
}
# models of a panel, whose costs are set beside those of the thesis
MODELS = ("solid-cost",)
# models of several scenes, each held against the richest
SCENES = ("models-of-scenes",)
COSTS = tuple(
    name for name in TITLES if not name.startswith("stability-") and name not in MODELS + SCENES
)
MAPS = tuple(name for name in TITLES if name.startswith("stability-"))
# rows of the chart of models, by model and crossings of the study: name, elements of a crossover here and in the thesis
OF_MODELS = {
    ("cable", "158"): ("cable net, 203 mm", "2 bars", "3 cables"),
    ("shell", "158"): ("panel, 203 mm", "1 shell", "1 shell"),
    ("pinned", "20"): ("panel, 25.4 mm,\ndefault mesh", "16 shells", ""),
    ("yarns", "20"): ("resolved yarns, 25.4 mm", "2 segments", ""),
    ("solids", "20"): ("woven solids, 25.4 mm", "32 hexahedra", "400 hexahedra"),
}
# charts whose every method is named beside its point, since those off the front are what is compared
ALL_NAMED = (
    "cost-drawn-ply",
    "cost-drawn-pack",
    "cost-peers",
    "cost-bullet",
    "cost-pack-fragment",
    "cost-pack-bullet",
    "crossover-order",
    "law-or-surface",
)
# mark and colour of each outcome, and what it says
OUTCOMES = {
    "stable": ("o", GREEN, "stable: the answer is right"),
    "failed": ("s", ORANGE, "failed: ends with a message"),
    "wrong": ("X", RED, "wrong: ends with a wrong answer"),
}


@dataclass(frozen=True)
class Run:
    """A run of one ply of S-720 in Table 4-3 of the thesis.

    Parameters
    ----------
    seconds : [s] of execution
    processors : number
    crossovers : of the part that is meshed
    microseconds : [us] simulated
    """

    seconds: float
    processors: int
    crossovers: int
    microseconds: float

    @property
    def cost(self) -> float:
        """[s] of CPU time a crossover and us, over all processors."""
        return self.seconds * self.processors / (self.crossovers * self.microseconds)


# models of the study that the thesis has too; 79 x 79 crossovers of a quarter of its panel, and 20 x 20 of solids
TABLE_4_3 = {
    "cable": Run(1243.0, 1, 79 * 79, 250.0),
    "shell": Run(1932.0, 1, 79 * 79, 250.0),
    "solids": Run(157424.0, 3, 20 * 20, 42.0),
}
PER_LINE = 46  # characters of a name beside a chart
# lengths of an axis are shown in micrometres if all of them are below a millimetre
SMALL = 1e-3


@dataclass(frozen=True)
class Point:
    """One method: its cost [s], its error [%], its name."""

    cost: float
    error: float
    name: str


def digest_of(name: str) -> str:
    """Compute the digest of a CSV, without its first line, which says how it was made."""
    content = (DATA / f"{name}.csv").read_bytes().split(b"\n", 1)[1]
    return hashlib.sha256(content).hexdigest()[:16]


def digest_in(path: Path) -> str:
    """Read the digest of the CSV that a picture was made of."""
    with Image.open(path) as image:
        return str(image.info.get("Source", ""))


def write(folder: Path = FIGURES) -> None:
    """Draw all charts to a folder, each a PNG."""
    for name in (*COSTS, *MODELS, *SCENES, *MAPS):
        figure = draw(name)
        figure.savefig(
            folder / f"{name}.png", dpi=110, metadata={"Source": digest_of(name), "Software": None}
        )


def draw(name: str) -> Any:
    """Draw the chart of a study."""
    with pictures_figure.plots():
        if name in COSTS:
            return _draw_cost(name)
        if name in MODELS:
            return _draw_models(name)
        if name in SCENES:
            return _draw_scenes(name)
        return _draw_map(name)


def front(points: list[Point]) -> list[Point]:
    """Select the methods that none beats: no other is both cheaper and closer. From cheap to dear."""
    found: list[Point] = []
    for point in sorted(points, key=lambda point: (point.cost, point.error)):
        if not found or point.error < found[-1].error:
            found.append(point)
    return found


def errors_of(name: str) -> list[str]:
    """List the columns of errors of a study of cost."""
    rows = read(name)[1]
    return [column for column in rows[0] if column.startswith(ERROR)]


def points_of(name: str, column: str) -> tuple[list[Point], float | None]:
    """Read the methods of a study that have a cost and this error, and the error of the reference itself."""
    points = []
    reference = None
    for row in read(name)[1]:
        if not row[column]:
            continue
        if row[METHOD] == REFERENCE:
            reference = float(row[column])
        # a method that others are held against has no error of its own
        elif row[COST] and float(row[column]) > 0:
            points.append(Point(float(row[COST]), float(row[column]), row[METHOD]))
    return points, reference


def _draw_cost(name):
    columns = errors_of(name)
    figure = Figure(figsize=(9, 4.6 * len(columns) + 0.3), layout="constrained")
    for axes, column in zip(np.atleast_1d(figure.subplots(len(columns), 1)), columns):
        points, reference = points_of(name, column)
        best = front(points)
        axes.set(xscale="log", yscale="log", xlabel="CPU time [s]", ylabel=column)
        axes.plot(
            [point.cost for point in points],
            [point.error for point in points],
            "o",
            ms=5,
            color="#b9c0c8",
            label="other methods",
        )
        axes.step(
            [point.cost for point in best],
            [point.error for point in best],
            "o-",
            where="post",
            lw=1.6,
            color=BLUE,
            label="front: none is cheaper and closer",
        )
        # a method can be its own reference, and then has no error
        if reference is not None and reference > 0:
            axes.axhline(
                reference, color=INK, ls=":", lw=1.6, label=f"reference itself: {reference:.2g} %"
            )
            low, high = axes.get_ylim()
            low = min(low, 0.7 * reference)
            axes.axhspan(low, reference, color="#eef0f3", zorder=0)
            axes.set_ylim(low, high)
        for point in points:
            if point.name == DEFAULTS.get(name, DEFAULT):
                label = "default"
                if name in DEFAULTS:
                    label = f"default, {point.name}"
                axes.plot(point.cost, point.error, "*", ms=17, color=RED, mec="white", label=label)
        named = best
        if name in ALL_NAMED:
            named = sorted(points, key=lambda point: point.cost)
        lines = []
        for number, point in enumerate(named, 1):
            # neighbours on both sides of the line, so that their numbers do not meet
            offset = (5, 6) if number % 2 else (-11, -15)
            axes.annotate(
                f"{number}",
                (point.cost, point.error),
                offset,
                textcoords="offset points",
                color=BLUE,
            )
            error = float(f"{point.error:.2g}")
            lines.append(f"{number}  {_short(point.name)}: {point.cost:.3g} s, {error:g} %")
        axes.text(
            1.02,
            0.0,
            "\n".join(lines),
            transform=axes.transAxes,
            va="bottom",
            fontsize=9,
            color=BLUE,
        )
        axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1.0), fontsize=9, borderaxespad=0.0)
        _plain_decades(axes)
    figure.suptitle(TITLES[name], x=0.01, ha="left", fontweight="bold", fontsize=13)
    return figure


def _short(name):
    """A name cut to its line."""
    if len(name) <= PER_LINE:
        return name
    return f"{name[: PER_LINE - 1]}…"


def _plain_decades(axes):
    """Write 0.1, 0.2, 0.5, 1 ... on logarithmic axes."""
    for axis in (axes.xaxis, axes.yaxis):
        low, high = axis.get_view_interval()
        steps = (1.0, 2.0, 5.0)
        if high / low > 300:
            steps = (1.0,)
        axis.set_major_locator(LogLocator(subs=steps))
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axis.set_minor_formatter(NullFormatter())


def costs_of_models(name: str) -> dict[tuple[str, str], tuple[float, float | None]]:
    """Read the CPU times [s] a crossover and us of a study: {key of OF_MODELS: (here, in the thesis)}, None where the
    thesis has no such model."""
    found = {}
    for row in read(name)[1]:
        found[row["model"], row["crossings"]] = 1e-9 * float(
            row["CPU time [ns per crossover and us]"]
        )
    return {
        key: (found[key], TABLE_4_3[key[0]].cost if key[0] in TABLE_4_3 else None)
        for key in OF_MODELS
    }


def _draw_models(name):
    costs = costs_of_models(name)
    figure = Figure(figsize=(9, 5.0), layout="constrained")
    axes = figure.subplots()
    places = np.arange(len(costs))[::-1]
    here = [own for own, _ in costs.values()]
    axes.plot(here, places, "o", ms=10, color=BLUE, label="here, one core", zorder=3)
    theirs = [(cost, place) for (_, cost), place in zip(costs.values(), places) if cost]
    axes.plot(*zip(*theirs), "s", ms=10, color=ORANGE, label="thesis, Table 4-3", zorder=3)
    for own, (cost, place) in zip((own for own, cost in costs.values() if cost), theirs):
        axes.plot([own, cost], [place, place], color="#d5dade", lw=2, zorder=1)
    for (model, pair), place in zip(costs.items(), places):
        for value, elements in zip(pair, OF_MODELS[model][1:]):
            if value is not None:
                _label(axes, _seconds(value), value, place, 9, INK)
                _label(axes, elements, value, place, -19, "#5b6670")
    axes.set_yticks(places, [OF_MODELS[model][0] for model in costs])
    axes.set(
        xscale="log",
        xlim=(5e-8, 300),
        ylim=(-0.55, len(costs) - 0.45),
        xlabel="CPU time of one crossover for 1 µs, over all processors",
    )
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: _seconds(value)))
    axes.grid(axis="x", color="#e6e9ed")
    axes.set_axisbelow(True)
    figure.suptitle(TITLES[name], x=0.01, ha="left", fontweight="bold", fontsize=13)
    figure.legend(loc="outside lower left", ncols=2, fontsize=9)
    return figure


# mark and colour of each model of a scene, and how far above it its number stands [pt]; and where models are alike
OF_SCENES = {
    "1 element": ("o", BLUE, 8),
    "3 elements": ("s", GREEN, -18),
    "resolved yarns": ("D", ORANGE, 8),
    "rigid nose": ("v", RED, 8),
    "bar": ("^", INK, -18),
}
ALIKE = 5.0  # [%]


def offs_of_scenes(name: str) -> list[tuple[str, str, float, float]]:
    """List (scene, model, what it leaves off the richest [%], CPU time over that of the richest) of a study."""
    found = []
    for row in read(name)[1]:
        richest = float(row[f"CPU, {row['richest']} [s]"])
        for model in OF_SCENES:
            off = row[f"off, {model} [%]"]
            if off and model != row["richest"]:
                found.append(
                    (row["scene"], model, float(off), float(row[f"CPU, {model} [s]"]) / richest)
                )
    return found


def _draw_scenes(name):
    offs = offs_of_scenes(name)
    scenes = list(dict.fromkeys(scene for scene, *_ in offs))
    figure = Figure(figsize=(9, 0.55 * len(scenes) + 1.6), layout="constrained")
    axes = figure.subplots()
    axes.axvspan(1e-3, ALIKE, color="#eef0f3", zorder=0)
    for model, (mark, colour, above) in OF_SCENES.items():
        own = [
            (off, len(scenes) - 1 - scenes.index(scene), cost)
            for scene, of, off, cost in offs
            if of == model
        ]
        if not own:
            continue
        x, y, cost = zip(*own)
        axes.plot(x, y, mark, ms=8, color=colour, label=model, zorder=3)
        for place in zip(x, y, cost):
            _label(axes, f"{place[2]:.2g}", place[0], place[1], above, "#5b6670")
    axes.set_yticks(range(len(scenes)), scenes[::-1], fontsize=8)
    low = min(off for _, _, off, _ in offs)
    axes.set(
        xscale="log",
        xlim=(0.6 * low, None),
        ylim=(-0.6, len(scenes) - 0.4),
    )
    axes.set_xlabel("off the richest [%], grey: within 5 %; numbers: CPU time over its", fontsize=9)
    axes.xaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.grid(axis="x", color="#e6e9ed")
    axes.set_axisbelow(True)
    figure.suptitle(TITLES[name], x=0.01, ha="left", fontweight="bold", fontsize=11)
    figure.legend(loc="outside lower left", ncols=5, fontsize=9)
    return figure


def _label(axes, text, x, y, above, colour):
    """Write over a mark, or under it, by points."""
    axes.annotate(
        text, (x, y), (0, above), textcoords="offset points", ha="center", fontsize=10, color=colour
    )


def _seconds(value):
    """A time [s] in two digits: "27 µs"."""
    units = {"ns": 1e-9, "µs": 1e-6, "ms": 1e-3, "s": 1.0}
    unit = [name for name, size in units.items() if value >= 0.9995 * size or name == "ns"][-1]
    return f"{float(f'{value / units[unit]:.2g}'):g} {unit}"


def map_of(name: str) -> tuple[str, str, list[Any] | None]:
    """Read the columns that a map is of, and the default, from the study's [map]."""
    content = tomllib.loads((STUDIES / f"{name}.toml").read_text("utf-8"))
    asked = content["map"]
    headings = content.get("columns", {})
    x, y = (headings.get(asked[key], asked[key].replace("_", " ")) for key in ("x", "y"))
    return x, y, asked.get("default")


def _draw_map(name):
    x, y, default = map_of(name)
    rows = [row for row in read(name)[1] if row["outcome"] in OUTCOMES]
    across = _Axis.of(x, [row[x] for row in rows])
    up = _Axis.of(y, [row[y] for row in rows])
    height = 4.6
    if up.names:
        height = 1.9 + 0.36 * len(up.names)
    elif len(rows) > 200:
        height = 6.6
    figure = Figure(figsize=(9, height), layout="constrained")
    axes = figure.subplots()
    size = 70 if len(rows) < 200 else 34
    for outcome, (marker, colour, label) in OUTCOMES.items():
        for flagged, chosen in _by_flag(rows, outcome):
            face = colour
            text = f"{label} ({len(chosen)})"
            if flagged:
                face = "white"
                text = f"{label}, flagged by a check ({len(chosen)})"
            axes.scatter(
                [across.place(row[x]) for row in chosen],
                [up.place(row[y]) for row in chosen],
                marker=marker,
                s=size,
                color=face,
                edgecolors=colour,
                linewidths=1.3,
                label=text,
                zorder=3,
            )
    if default is not None:
        place = across.place(str(default[0])), up.place(str(default[1]))
        axes.scatter(
            *place,
            marker="o",
            s=5 * size,
            color="none",
            edgecolors=INK,
            linewidths=1.6,
            label="default",
        )
    for axis, given in ((axes.xaxis, across), (axes.yaxis, up)):
        given.dress(axis)
    figure.suptitle(TITLES[name], x=0.01, ha="left", fontweight="bold", fontsize=13)
    figure.legend(loc="outside lower left", ncols=2, fontsize=9, labelspacing=0.9)
    return figure


def _by_flag(rows, outcome) -> Iterator[tuple[bool, list[dict[str, str]]]]:
    """(flagged or not, rows) of an outcome, where there are any."""
    for flagged in (False, True):
        chosen = [
            row for row in rows if row["outcome"] == outcome and bool(row.get("flags")) == flagged
        ]
        if chosen:
            yield flagged, chosen


@dataclass(frozen=True)
class _Axis:
    """An axis of a map: numbers, linear or logarithmic, or names in the order of the file."""

    label: str
    names: tuple[str, ...]
    factor: float
    logarithmic: bool
    least: float = 1.0

    @classmethod
    def of(cls, label: str, texts: list[str]) -> _Axis:
        """Choose the axis for the values of a column."""
        try:
            values = np.array(texts, float)
        except ValueError:
            # the first name on top
            return cls(label, tuple(dict.fromkeys(texts))[::-1], 1.0, False)
        positive = values[values > 0]
        least = positive.min(initial=1.0)
        wide = positive.max(initial=0.0) > 20 * least and values.min() >= 0
        if label.endswith("[m]") and abs(values).max() < 2 * SMALL:
            return cls(label.replace("[m]", "[µm]"), (), 1e6, wide, 1e6 * least)
        return cls(label, (), 1.0, wide, least)

    def place(self, text: str) -> float:
        """Return where a value stands."""
        if self.names:
            return float(self.names.index(text))
        return self.factor * float(text)

    def _named(self, value, _):
        """Text of a tick; none between zero and the least value, where there is no room."""
        if 0 < value < self.least:
            return ""
        return f"{value:g}"

    def dress(self, axis: Any) -> None:
        """Set scale, ticks and label of a matplotlib axis."""
        axis.set_label_text(self.label)
        if self.names:
            axis.set_ticks(range(len(self.names)), self.names)
            axis.axes.set_ylim(-0.6, len(self.names) - 0.4)
        elif self.logarithmic:
            # zero has its own place at the end of a symmetric logarithmic scale
            least = self.least
            axis._set_axes_scale("symlog", linthresh=least)
            high = axis.get_data_interval()[1]
            steps = (1, 2, 5) if high < 1000 * least else (1,)
            axis.set_major_locator(SymmetricalLogLocator(base=10, linthresh=least, subs=steps))
            axis.set_major_formatter(FuncFormatter(self._named))
        axis.axes.grid(color="#e6e9ed")


__all__ = [
    "COSTS",
    "FAINT",
    "MAPS",
    "MODELS",
    "SCENES",
    "costs_of_models",
    "digest_in",
    "digest_of",
    "draw",
    "front",
    "offs_of_scenes",
    "points_of",
    "write",
]
