"""Whether a figure shows its data, by property: what stands on an axis are the numbers of one field of the
data, in the unit of the axis, and the words beside them are the names of that field."""

import re
from collections.abc import Mapping
from dataclasses import is_dataclass
from itertools import product
from types import SimpleNamespace

import numpy as np
import pandas as pd
from matplotlib.collections import PolyCollection
from matplotlib.colors import same_color
from matplotlib.lines import Line2D

# what one unit of SI is in the unit of a label
UNITS = {
    "": 1.0,
    "-": 1.0,
    "rad": 1.0,
    "N": 1.0,
    "J": 1.0,
    "m/s": 1.0,
    "%": 1e2,
    "mm": 1e3,
    "mm N^(1/3)": 1e3,
    "µm": 1e6,
    "µs": 1e6,
    "kN": 1e-3,
    "kHz": 1e-3,
    "MPa": 1e-6,
    "kJ/m²": 1e-3,
    "°": 180 / np.pi,
}
IN_TEXT = "|".join(sorted(map(re.escape, UNITS.keys() - {"", "-"}), key=len, reverse=True))
NUMBER = re.compile(rf"(-?\d+(?:\.(\d+))?)\s*({IN_TEXT})(?![\w/])")


class Field:
    """Numbers of the data with the words that name them.

    Parameters
    ----------
    words : set of the words
    values : array in SI units, or a function of what stands on the x axis, in SI units
    """

    def __init__(self, words, values):
        self.words = words
        self.values = values

    def holds(self, drawn):
        """Whether all numbers (n,) that are drawn, in SI units, are of this field."""
        if callable(self.values):
            return False
        drawn = drawn[~np.isnan(drawn)]
        held = np.ravel(self.values)
        near = np.isclose(drawn[:, None], held[None, :], rtol=1e-9, atol=1e-15)
        return bool(near.any(axis=1).all())

    def runs_through(self, points):
        """Whether points {axis: (n,)} in SI units are on the curve of this field."""
        if not callable(self.values) or len(points) < 2:
            return False
        return np.allclose(self.values(points["x"]), points["y"], rtol=1e-9, atol=1e-15)


def words_of(text):
    """Return the words of a text or of a name; a subscript of mathematics is a word of its own."""
    apart = re.sub(r"(?<=\w)\$_", " ", text)
    return set(re.findall(r"[a-z]+|\d+|γ", apart.lower()))


def fields_of(data, said=None, words=frozenset()):
    """List the fields of nested data: what a name or a key leads to has its words.

    Parameters
    ----------
    said : {name: the words that a figure has for it, "" for none}
    words : of the names that lead to the data
    """
    said = said or {}
    named = _by_name(data)
    found = []
    if named is not None:
        for name, value in named.items():
            own = words_of(said.get(name, str(name).replace("_", " ")))
            found += fields_of(value, said, words | own)
    elif isinstance(data, (list, tuple)) and not all(np.isscalar(each) for each in data):
        for each in data:
            found += fields_of(each, said, words)
    elif callable(data):
        found.append(Field(words, data))
    elif not isinstance(data, (str, bool)):
        values = np.asarray(data)
        if values.dtype.kind in "iuf":
            found.append(Field(words, values))
    return found


def _by_name(data):
    """{name: what it has} of data with names, or None."""
    if isinstance(data, pd.DataFrame):
        return {re.sub(r"_m_s$", "", name): column.to_numpy() for name, column in data.items()}
    if isinstance(data, SimpleNamespace):
        return vars(data)
    if hasattr(data, "_asdict"):
        return data._asdict()
    if is_dataclass(data):
        return {name: getattr(data, name) for name in data.__dataclass_fields__}
    if isinstance(data, Mapping):
        return data
    return None


def axis_label(axes, name):
    """Return the label of an axis, or of the one that shares it."""
    shared = {"x": axes.get_shared_x_axes(), "y": axes.get_shared_y_axes()}[name]
    for each in (axes, *shared.get_siblings(axes)):
        if label := getattr(each, f"get_{name}label")():
            return label
    return ""


def unit_of(label):
    """Return the unit in brackets of a label, "" if it has none; of "% of the largest" the unit alone."""
    found = re.search(r"\[([^\]]*)\]", label)
    if found is None:
        return ""
    return found[1].split(" of ")[0]


def refuse_untold(figure, fields, not_drawn=()):
    """Refuse a figure of which a line or an area is not of one field each way, in the unit of its axis
    and under its words, or a number in a text is not of the data.

    Parameters
    ----------
    fields : of the data; numbers that a figure computes are fields that the test computes
    not_drawn : words of fields that need not be seen
    """
    seen = set()
    for axes in figure.axes:
        title = axes.get_title(loc="left") + axes.get_title() + figure.get_suptitle()
        labels = {name: axis_label(axes, name) for name in "xy"}
        for artist, points in _drawn(axes):
            told = [f"{title} {name}" for name in _names(axes, artist)]
            place = title, labels["y"], artist.get_label()
            seen |= _refuse_untold_points(points, labels, told, fields, place)
        _refuse_unnamed(axes)
        for text in _texts(axes):
            _refuse_foreign_numbers(text, fields)
    left = [f.words for k, f in enumerate(fields) if k not in seen and np.ndim(f.values) > 0]
    left = [words for words in left if not any(words_of(name) <= words for name in not_drawn)]
    assert not left, f"not drawn: {left}"


def _drawn(axes):
    """Yield the lines and areas of an axes, each with its points {axis: (n,)}, None across the picture."""
    for line in axes.lines:
        yield line, _in_data(axes, line, np.array(line.get_data(orig=False), float).T)
    for patch in axes.patches:
        corners = patch.get_patch_transform().transform_path(patch.get_path()).vertices
        yield patch, _in_data(axes, patch, corners)
    for area in axes.collections:
        if isinstance(area, PolyCollection) and area.get_array() is None:
            yield area, _in_data(axes, area, np.concatenate([p.vertices for p in area.get_paths()]))


def _in_data(axes, artist, points):
    """{axis: coordinates of points (n, 2)}, None of what is placed by the picture or is the line of zero."""
    placed = artist.get_transform().contains_branch_seperately(axes.transData)
    given = zip("xy", points.T, placed, strict=True)
    return {axis: values if known and np.any(values) else None for axis, values, known in given}


def _names(axes, artist):
    """The names of what is drawn: its own, or those of the lines of its colour."""
    if artist.get_label() and not artist.get_label().startswith("_"):
        return [artist.get_label()]
    if isinstance(artist, Line2D):
        colour = artist.get_color()
    else:
        colour = artist.get_facecolor()[:3]
    names = [line.get_label() for line in axes.lines if same_color(line.get_color(), colour)]
    return [name for name in names if not name.startswith("_")] or [""]


def _refuse_untold_points(points, labels, told, fields, place):
    """Return the numbers of the fields that points are of; refuse those that are of none."""
    si = {
        axis: values / UNITS[unit_of(labels[axis])]
        for axis, values in points.items()
        if values is not None and values.size
    }
    curves = {k for k, field in enumerate(fields) if field.runs_through(si)}
    seen = set()
    for axis, values in si.items():
        held = {k for k, field in enumerate(fields) if field.holds(values)}
        if axis == "y":
            held |= curves
        elif curves and not held:
            continue  # at places that the figure chooses
        assert held, f"{place}: {axis} is no field of the data: {values}"
        words = [words_of(f"{labels[axis]} {name}") for name in told]
        right = {k for k, known in product(held, words) if fields[k].words <= known}
        assert right, f"{place}: {axis} is {[fields[k].words for k in held]}, told {words}"
        seen |= right
    return seen


def _refuse_unnamed(axes):
    """Refuse a legend that does not name what is drawn, and nothing else."""
    if axes.get_legend() is None:
        return
    named = {
        artist.get_label()
        for artist in (*axes.lines, *axes.patches, *axes.collections, *axes.containers)
        if not str(artist.get_label()).startswith("_")
    }
    assert {text.get_text() for text in axes.get_legend().get_texts()} == named - {""}


def _texts(axes):
    """All texts of an axes."""
    legend = axes.get_legend()
    named = [text.get_text() for text in legend.get_texts()] if legend else []
    return [axes.get_title(loc="left"), axes.get_title(), *named]


def _refuse_foreign_numbers(text, fields):
    """Refuse a text of which a number with a unit is no number of the data, to the digits it has."""
    for whole, digits, unit in NUMBER.findall(text):
        step = 10.0 ** -len(digits)
        at = [
            UNITS[unit] * np.ravel(field.values) for field in fields if not callable(field.values)
        ]
        near = np.abs(np.concatenate(at) - float(whole)) <= 0.5001 * step
        assert near.any(), f"{text!r}: {whole} {unit} is no number of the data"
