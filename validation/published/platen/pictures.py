"""Platen pressure over closure: the law, the published constants, and one factor changed at a time."""

from __future__ import annotations

from collections.abc import Sequence

from fabrics.checks import FilePath, FloatArray
from fabrics.files import write_whole
from meshing import pictures_style
from meshing.pictures_style import COLOURS, FAINT, INK
from validation.published.platen.study import Outcome

GROUPS = {"geometry": ("section", "crimp", "Vf0"), "contact and mesh": ("contact", "mesh"), "constants": ("constants",)}


def draw(pressure: FloatArray, law: FloatArray, outcomes: Sequence[Outcome], path: FilePath) -> None:
    """One panel for each group of factors; closures [m] against pressure [Pa] as PNG."""
    with pictures_style.plots() as plt:
        figure, panels = plt.subplots(1, 3, figsize=(17, 6.6), sharey=True)
        for panel, (title, groups) in zip(panels, GROUPS.items()):
            panel.semilogy(1e6 * law, 1e-6 * pressure, color=INK, lw=3.2, label="platen law, eq. 2-6")
            first = outcomes[0]
            panel.semilogy(1e6 * first.closure, 1e-6 * first.pressure, color=FAINT, lw=3.2, label="Table 3-2")
            shown = [each for each in outcomes[1:] if each.variant.group in groups]
            for n, each in enumerate(shown):
                colour, dash = COLOURS[n % len(COLOURS)], ("-", "--")[n // len(COLOURS)]
                panel.semilogy(
                    1e6 * each.closure, 1e-6 * each.pressure, color=colour, ls=dash, lw=1.6, label=each.variant.name
                )
            panel.set(title=title, xlabel="closure [um], offset free")
            panel.legend(fontsize=9, loc="upper left")
        panels[0].set_ylabel("platen pressure [MPa]")
        with write_whole(path, "wb") as file:
            figure.savefig(file, format="png", dpi=80)
        plt.close(figure)
