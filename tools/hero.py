"""The picture at the head of README: one ply of S-720 struck at 92.5 and 155 m/s. python tools/hero.py [FILE.png]

The deformed panel with its yarn tensions, the velocity of the projectile, and where the strike energy goes.
"""

import sys
from pathlib import Path

import numpy as np

import weavecell as wc
from fabrics.base.files import write_whole
from shellfabric.impact.run import run_impact
from shellfabric.loop import snapshots
from weavecell.report import pictures, pictures3d
from weavecell.report.pictures_figure import plots
from weavecell.report.pictures_style import FAINT, GREEN, INK, RED, tension_map
from weavecell.results import vtk
from weavecell.results.impact_shapes import Shape

HERO = Path(__file__).parents[1] / "docs" / "figures" / "impact.png"
STOPPED, PERFORATED = 92.5, 155.0  # [m/s] captions of thesis Figures 5-4 and 5-5
INSTANT = 100e-6  # [s] of the panel that is drawn
HALF_HEIGHT = 0.030  # [m] of the view
BAR = 20.0  # [mm] of the scale bar
US = 1e6


def shot(velocity, interval=None):
    """Fire one shot as a reader would, who gives fabric and velocity alone."""
    return run_impact(wc.setup("S-720", velocity, snapshot_interval=interval))


def image_of(result):
    """Draw the panel at INSTANT, its modelled part mirrored: (rows, columns, 3)."""
    shape = min((shapes[0] for shapes in result.snapshots), key=lambda one: abs(one.t - INSTANT))
    strength = np.array(result.panel.strengths)
    body = shape.projectile_position + result.setup.projectile.surface()
    grid = vtk.panel([Shape.from_snapshot(shape)], [snapshots.quads(result.panel)])
    foremost = body[..., 2] > body[..., 2].max() - 1e-4  # [m]
    centre = (*body[foremost].mean(axis=0)[:2], grid.bounds.z_max)
    return shape.t, pictures3d.panel(grid, strength, body, result.mirrored, HALF_HEIGHT, centre)


def draw(pyplot, perforated, stopped):
    """Draw the three panels of the picture."""
    figure = pyplot.figure(figsize=(13, 3.7))
    left, middle, right = figure.subplots(1, 3, width_ratios=(2.0, 1, 1))
    t, image = image_of(perforated)
    left.imshow(image, interpolation="lanczos")
    left.axis("off")
    left.set_title(f"S-720 at {PERFORATED:g} m/s, {US * t:.0f} µs after the strike")
    rows, columns = image.shape[:2]
    pixel = 2e3 * HALF_HEIGHT / rows  # [mm] across the view
    ends = np.array([0.04, 0.04]) * columns + [0, BAR / pixel]
    left.plot(ends, [0.94 * rows] * 2, color=INK, lw=3, solid_capstyle="butt")
    left.text(ends.mean(), 0.92 * rows, f"{BAR:g} mm", ha="center", va="bottom")
    scale = pyplot.cm.ScalarMappable(pyplot.Normalize(0, 1), tension_map())
    bar = figure.colorbar(
        scale, cax=left.inset_axes((0.15, -0.11, 0.7, 0.045)), orientation="horizontal"
    )
    bar.set_label("yarn tension / strength, the higher of warp and weft")
    bar.outline.set_visible(False)
    for result, colour, velocity in ((stopped, GREEN, STOPPED), (perforated, RED, PERFORATED)):
        middle.plot(US * result.step_history[:, 0], result.step_history[:, 2], color=colour)
        middle.plot([], [], color=colour, label=f"{velocity:g} m/s: {result.outcome}")
    middle.axhline(0, color=FAINT, lw=1)
    middle.set(
        title="projectile", xlabel="time after strike [µs]", ylabel="velocity [m/s]", xlim=(0, None)
    )
    middle.set_ylim(-4, 172)
    middle.legend(loc="upper right", fontsize=10)
    known = [
        (stopped.energies[name], label, colour)
        for name, label, colour in pictures.ENERGIES
        if np.any(stopped.energies.get(name, 0.0) > 0.005 * stopped.strike_energy)
    ]
    parts = [np.maximum(part, 0) for part, _, _ in known]
    right.stackplot(US * stopped.time, parts, colors=[colour for _, _, colour in known])
    below = np.zeros_like(parts[0])
    for part, (_, label, _) in zip(parts, known):
        place = 0.03 if label == known[0][1] else 0.93  # of the width
        k = int(place * part.size)
        if part[k] > 0.1 * stopped.strike_energy:  # the thinner ones have no room for their names
            white = label == "fabric, membrane"
            right.text(
                US * stopped.time[k],
                below[k] + 0.5 * part[k],
                label,
                ha="left" if place < 0.5 else "right",
                va="center",
                color="white" if white else INK,
                fontsize=10,
            )
        below = below + part
    right.axhline(stopped.strike_energy, color=INK, lw=1, ls=":")
    right.set(
        title=f"energy at {STOPPED:g} m/s", xlabel="time after strike [µs]", ylabel="energy [J]"
    )
    right.set(xlim=(0, US * stopped.time[-1]), ylim=(0, 1.04 * stopped.strike_energy))
    return figure


def main(path):
    """Fire the shots and write the picture."""
    with plots() as pyplot:
        figure = draw(pyplot, shot(PERFORATED, INSTANT / 4), shot(STOPPED))
        with write_whole(path, "wb") as file:
            figure.savefig(file, format="png", dpi=100)


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else HERO)
