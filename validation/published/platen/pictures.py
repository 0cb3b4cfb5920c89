"""Misfit and closures of the crossover between platens: the published constants, and one factor changed at a time."""

from __future__ import annotations

from collections.abc import Sequence

from fabrics.checks import FilePath
from fabrics.files import write_whole
from meshing import pictures_style
from meshing.pictures_style import BLUE, FAINT, GREEN, INK, ORANGE, RED
from validation.published.platen.study import Outcome

COLOURS = {"section": BLUE, "crimp": BLUE, "Vf0": BLUE, "contact": GREEN, "mesh": GREEN, "constants": RED}
LABELS = {BLUE: "geometry", GREEN: "contact and mesh", RED: "solid constants"}


def draw(outcomes: Sequence[Outcome], loose: float, packed: float, path: FilePath) -> None:
    """Misfit of the pressure, and closures below and above 1 MPa, a row for each variant, as PNG.

    Parameters
    ----------
    outcomes : the published constants first; `closure_rms`, `pressure_rms`, `loose` and `packed` are drawn
    loose, packed : [m] closures of the platen law below and above 1 MPa
    """
    with pictures_style.plots() as plt:
        figure, (left, right) = plt.subplots(1, 2, figsize=(11.4, 7.2), sharey=True)
        for row, each in enumerate(outcomes):
            colour = COLOURS.get(each.variant.group, INK)
            left.plot(100 * each.pressure_rms, row, "o", ms=8, color=colour)
            for value, filled in ((each.loose, True), (each.packed, False)):
                right.plot(1e6 * value, row, "o", ms=8, color=colour, mfc=colour if filled else "white", mew=1.8)
        left.axvline(100 * outcomes[0].pressure_rms, color=FAINT, lw=1.2, ls="--")
        left.axvline(15, color=ORANGE, lw=2)
        right.axvline(1e6 * loose, color=ORANGE, lw=2)
        right.axvline(1e6 * packed, color=ORANGE, lw=2, ls="--")
        names = [each.variant.name for each in outcomes]
        left.set_yticks(range(len(names)), ["published constants (Table 3-2)", *names[1:]])
        left.invert_yaxis()
        left.set(title="misfit of the pressure", xlabel="rms of the relative misfit [%]", xlim=(0, 80))
        right.set(title="closure", xlabel="closure [µm]", xlim=(0, None))
        line = plt.Line2D
        marks = [line([], [], marker="o", ls="", color=colour, label=text) for colour, text in LABELS.items()]
        marks += [
            line([], [], color=ORANGE, label="left: target 15 %; right: platen law, below 1 MPa"),
            line([], [], color=ORANGE, ls="--", label="platen law, above 1 MPa"),
            line([], [], marker="o", ls="", color=INK, label="right, filled: closure below 1 MPa"),
            line([], [], marker="o", ls="", color=INK, mfc="white", mew=1.8, label="open: above 1 MPa"),
        ]
        figure.legend(handles=marks, loc="outside lower center", ncols=3, fontsize=10)
        with write_whole(path, "wb") as file:
            figure.savefig(file, format="png", dpi=90)
        plt.close(figure)
