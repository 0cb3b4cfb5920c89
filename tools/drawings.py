"""Draw the figures of the theory pages: python tools/drawings.py [FOLDER]  (default: docs/figures).

Geometry only, no results. Labels are the symbols of docs/theory-cell.md. The files are the same in every run.
"""

import sys
from pathlib import Path

import numpy as np
from matplotlib.patches import Ellipse, Polygon, Rectangle

from fabrics.pattern import PLAIN, Pattern
from weavecell.report.pictures_figure import plots
from weavecell.report.pictures_style import FAINT, INK, STEEL, WARP, WEFT

FIGURES = Path(__file__).parents[1] / "docs" / "figures"


def main(folder=FIGURES):
    """Draw all drawings and write them to a folder."""
    for name, draw in DRAWINGS.items():
        with plots() as pyplot:
            figure = draw(pyplot)
            figure.savefig(Path(folder) / f"theory-{name}.svg", metadata={"Date": None})


def bare(pyplot, count, size, **widths):
    """Make a figure with axes without frame and with equal scales."""
    figure, axes = pyplot.subplots(1, count, figsize=size, **widths)
    for ax in np.atleast_1d(axes):
        ax.set_aspect("equal")
        ax.axis("off")
    return figure, axes


def arrow(ax, start, end, text="", at=(0, 0), colour=INK, style="-|>"):
    """Draw an arrow from start to end; its label stands `at` from the middle."""
    ax.annotate(
        "",
        end,
        start,
        arrowprops={"arrowstyle": style, "color": colour, "lw": 1.5, "shrinkA": 0, "shrinkB": 0},
    )
    middle = 0.5 * (np.array(start) + np.array(end)) + at
    ax.text(*middle, text, color=colour, ha="center", va="center")


def measure(ax, start, end, text, at):
    """Draw a double arrow with its label."""
    arrow(ax, start, end, text, at, style="<|-|>")


def band(ax, x, z, half, colour):
    """Draw a yarn along its centreline: a band of the half thickness, and the line."""
    slope = np.gradient(z, x)
    n = np.array([-slope, np.ones_like(slope)]) / np.hypot(1, slope)
    upper, lower = np.array([x, z]) + half * n, np.array([x, z]) - half * n
    ax.add_patch(
        Polygon(np.concatenate([upper, lower[:, ::-1]], axis=1).T, color=colour, alpha=0.2, lw=0)
    )
    ax.plot(x, z, color=colour)


def lay_yarns(plan, pattern, count):
    """Draw `count` warp yarns along x and weft yarns along y, which lie over each other by a pattern."""
    width = 0.74
    for k in range(count):
        at = k - 0.5 * width
        plan.add_patch(Rectangle((-0.7, at), count + 0.4, width, color=WARP, alpha=0.85, lw=0))
    for k in range(count):
        at = k - 0.5 * width
        plan.add_patch(Rectangle((at, -0.7), width, count + 0.4, color=WEFT, lw=0))
    for i in range(count):
        for j in range(count):
            if pattern.is_warp_up(j, i):
                over = (i - 0.5, j - 0.5 * width), 1, width
                plan.add_patch(Rectangle(*over, color="white", lw=0))
                plan.add_patch(Rectangle(*over, color=WARP, alpha=0.85, lw=0))


def weaves(pyplot):
    """Draw weaves from above, each from its pattern."""
    names = ("plain", "basket 2x2", "twill 2/2", "twill 3/1", "crowfoot", "satin 5")
    figure, axes = bare(pyplot, len(names), (11, 2.3))
    for ax, name in zip(axes, names):
        count = 8
        lay_yarns(ax, Pattern.read(name), count)
        ax.set(xlim=(-0.8, count - 0.2), ylim=(-0.8, count - 0.2))
        ax.set_title(name, color=INK, fontsize=10)
    return figure


def weave(pyplot):
    """Draw a plain weave from above and in section, with its dimensions."""
    figure, (plan, section) = bare(pyplot, 2, (11, 4.0), width_ratios=(1, 1.35))
    lay_yarns(plan, PLAIN, 4)
    plan.add_patch(Rectangle((0.5, 1.5), 1, 1, fill=False, ls="--", color=INK, lw=2))
    measure(plan, (0.5, -0.85), (1.5, -0.85), "$2w_1$", (0, -0.28))
    measure(plan, (-0.85, 1.5), (-0.85, 2.5), "$2w_2$", (-0.38, 0))
    plan.text(4.0, 3.0, "warp", color=WARP, va="center")
    plan.text(3.0, 3.95, "weft", color=WEFT, ha="center")
    plan.set(xlim=(-1.6, 4.9), ylim=(-1.5, 4.3))
    w, h = 2.0, 0.62
    x = np.linspace(-1.35 * w, 1.35 * w, 200)
    band(section, x, h * np.cos(0.5 * np.pi * x / w), 0.3, WARP)
    section.add_patch(Ellipse((0, -0.33), 2.3, 0.62, color=WEFT, alpha=0.6, lw=0))
    section.axhline(0, color=FAINT, lw=1, ls=":")
    measure(section, (0, 0), (0, h), "$h_i$", (0.22, 0.02))
    for side in (-1, 1):
        section.plot([side * w] * 2, [-0.95, 0.1], color=FAINT, lw=1)
    measure(section, (-w, -0.9), (w, -0.9), "$2w_i$", (0, -0.2))
    slope = 0.5 * np.pi * h / w
    section.plot([w, w - 1.1], [0, 1.1 * slope], color=INK, lw=1, ls="--")
    section.text(w - 0.66, 0.12, r"$\alpha_i$")
    section.text(-1.6, 0.68, "length $S_i$", color=WARP)
    section.text(0, -0.36, "crossing yarn $j$", color=INK, ha="center", va="center", fontsize=10)
    section.set(xlim=(-2.8, 2.8), ylim=(-1.4, 1.3))
    return figure


def cell(pyplot):
    """Draw the unit cell at rest and stretched, with its lengths."""
    figure, axes = bare(pyplot, 2, (11, 3.6), width_ratios=(1, 1.15))
    states = (
        (2.0, 0.75, 0.35, 0.52, 0.58, 1.7, "0"),
        (2.25, 0.42, 0.52, 0.44, 0.5, 2.1, ""),
    )  # w, h1, h2, half thicknesses, width
    for ax, (w, h1, h2, half1, half2, width, rest) in zip(axes, states):
        x = np.linspace(-w, w, 200)
        band(ax, x, h1 * np.cos(0.5 * np.pi * x / w), half1, WARP)
        ax.add_patch(Ellipse((0, -h2), width, 2 * half2, color=WEFT, alpha=0.5, lw=0))
        ax.plot([0], [-h2], "o", color=WEFT, ms=5)
        ax.plot([-w - 0.3, w + 0.3], [0, 0], color=FAINT, lw=1, ls=":")
        measure(ax, (0, 0), (0, h1), f"$h_{{{rest}1}}$", (0.28, 0.0))
        measure(ax, (0, -h2), (0, 0), f"$h_{{{rest}2}}$", (0.28, 0.0))
        measure(ax, (0, -1.3), (w, -1.3), f"$w_{{{rest}1}}$", (0, -0.2))
        ax.plot([w, w], [-1.4, 0.1], color=FAINT, lw=1)
        ax.set(xlim=(-3.5, 3.6), ylim=(-1.75, 1.6))
    axes[0].text(0, 1.42, "touching, no force", ha="center", va="center", fontsize=11)
    axes[0].set_title("at rest", loc="center", fontsize=12)
    axes[1].set_title("stretched", loc="center", fontsize=12)
    w, h1 = states[1][:2]
    slope = 0.5 * np.pi * h1 / w
    for side in (-1, 1):
        arrow(
            axes[1],
            (side * w, 0),
            (side * (w + 0.95), -0.95 * slope),
            "$T_1$",
            (side * 0.1, 0.24),
            WARP,
        )
        arrow(axes[1], (-0.5, -0.05), (-0.5, -0.05 + 0.42 * side), "$F_c$", (-0.27, 0.06 * side))
    closure = "$h_1+h_2=h_{01}+h_{02}-d_{c1}-d_{c2}-g$"
    axes[1].text(0, 1.42, closure, ha="center", va="center", fontsize=11)
    return figure


def mesh(pyplot):
    """Draw the membrane's elements on the yarns, and the points of an element."""
    figure, (net, points) = bare(pyplot, 2, (11, 4.6))
    for k in range(4):
        net.plot([-0.4, 3.4], [k, k], color=WARP, lw=1.2, alpha=0.5)
        net.plot([k, k], [-0.4, 3.4], color=WEFT, lw=1.2, alpha=0.5)
    net.plot([1, 2], [1, 1], color=WARP, lw=6)
    for i in (1, 2):
        for j in (0, 1):
            net.plot([i, i], [j + 0.06, j + 0.94], color=WEFT, lw=4)
    net.plot(*np.meshgrid(range(4), range(4)), "o", color=INK, ms=5)
    net.text(1.5, 1.17, r"$\Lambda_1$", color=WARP, ha="center", fontsize=14)
    for i, j in ((1, 0), (2, 0), (1, 1), (2, 1)):
        net.text(i + 0.22, j + 0.55, r"$\Lambda_2$", color=WEFT, ha="center", fontsize=14)
    net.set(xlim=(-0.6, 3.7), ylim=(-0.6, 3.6))
    nodes, weights = np.array([-1, 0, 1]), np.array([0.5 * 0.25**2, 0.75 - 0.25**2, 0.5 * 0.75**2])
    for k in range(-1, 3):
        points.plot([-1.4, 2.4], [k, k], color=WARP, lw=1.2, alpha=0.5)
        points.plot([k, k], [-1.4, 2.4], color=WEFT, lw=1.2, alpha=0.5)
    points.add_patch(Rectangle((0, 0), 1, 1, color=FAINT, alpha=0.25, lw=0))
    for i, a in zip(nodes, weights):
        for j, b in zip(nodes, weights):
            points.plot([i], [j], "o", color=INK, ms=4 + 30 * a * b, mfc="white", mew=1.6)
    for s in (0.25, 0.75):
        for q in (0.25, 0.75):
            points.plot([s], [q], "s", color=INK if (s, q) == (0.25, 0.25) else STEEL, ms=8)
    points.text(0.36, 0.34, "$x$", fontsize=14)
    points.text(0.5, 1.13, "element, 2 x 2 points", ha="center", fontsize=10)
    points.text(
        -0.05, -1.32, "size of the circles: weights $B_aB_b$ of the nodes", ha="center", fontsize=10
    )
    points.set(xlim=(-1.9, 2.6), ylim=(-1.6, 2.5))
    return figure


def contact(pyplot):
    """Draw the contact of nose and fabric, of two plies, and the law of a point."""
    figure, (nose, plies, law) = bare(pyplot, 3, (12, 3.5), width_ratios=(1, 1.05, 0.95))
    angle = np.linspace(0, 0.5 * np.pi, 40)
    outline = np.array(
        [
            [-1.6, 0.0],
            *zip(0.9 + 0.6 * np.sin(angle), 0.6 - 0.6 * np.cos(angle)),
            [1.5, 2.1],
            [-1.6, 2.1],
        ]
    )
    nose.add_patch(Polygon(outline, color=STEEL, alpha=0.35, lw=0))
    x = np.linspace(-1.6, 3.2, 200)
    nose.plot(x, 0.07 + 1.5 / (1 + np.exp(-(x - 1.9) / 0.42)), color=WARP)
    n = np.array([np.sin(0.25 * np.pi), -np.cos(0.25 * np.pi)])
    point, foot = np.array([0.9, 0.6]) + 0.34 * n, np.array([0.9, 0.6]) + 0.6 * n
    point[1] = 0.07 + 1.5 / (1 + np.exp(-(point[0] - 1.9) / 0.42))
    nose.plot(*point, "o", color=INK, ms=6)
    arrow(nose, foot, foot + 0.8 * n, "$n$", (0.16, 0.12))
    nose.plot(*zip([0.9, 0.6], foot), color=FAINT, lw=1, ls="--")
    nose.annotate(
        "point, $d<0$", point, (-1.3, 0.55), arrowprops={"arrowstyle": "-", "color": FAINT}
    )
    nose.text(0.98, 0.72, r"$\rho_e$")
    nose.text(-0.3, 1.5, "projectile", ha="center")
    nose.text(2.6, 1.62, "ply", color=WARP, ha="center")
    nose.set(xlim=(-1.8, 3.3), ylim=(-1.3, 2.3))
    x = np.linspace(-2, 2, 200)
    front, rear = 0.16 * x**2, -0.82 + 0.1 * x**2
    for z, colour in ((front, WARP), (rear, WEFT)):
        band(plies, x, z, 0.5, colour)
    plies.plot([0.5], [0.04], "o", color=INK, ms=6)
    plies.plot([0.44], [-0.80], "o", color=INK, ms=6)
    plies.text(0.62, 0.12, "$x$")
    plies.text(0.56, -0.98, "$y$")
    arrow(plies, (0.44, -0.80), (0.4, -1.55), "$n$", (0.2, -0.1))
    measure(plies, (-1.35, 0.29 - 0.48), (-1.35, 0.29 + 0.54), "$t$", (0.16, 0.0))
    plies.annotate(
        "depth",
        (-0.3, -0.41),
        (-0.3, 0.95),
        ha="center",
        arrowprops={"arrowstyle": "-|>", "color": INK},
    )
    plies.text(0.9, 0.95, "front ply", color=WARP)
    plies.text(0.9, -1.5, "rear ply", color=WEFT)
    plies.set(xlim=(-2.2, 2.2), ylim=(-1.9, 1.5))
    law.set_aspect("auto")
    d = np.linspace(0, 1, 100)
    law.plot(d, 0.42 * d**3 / (1.25 - d) ** 0.5, color=WARP)
    end = 0.42 / 0.25**0.5
    law.plot([1, 1.28], [end, end + 0.28 * 3.6], color=WARP, ls="--")
    law.plot([0, 0.5], [0, 0.5 * 3.6], color=WEFT, ls="--")
    law.text(0.5, 1.85, "solid fibre,\nslope $K$", color=WEFT, ha="center", fontsize=10)
    law.text(1.0, 0.25, "computed,\nthen slope $K$", color=WARP, fontsize=10)
    arrow(law, (0, 0), (1.45, 0))
    arrow(law, (0, 0), (0, 2.1))
    law.text(1.42, -0.14, "$d$", ha="center")
    law.text(-0.08, 2.0, "$p$", ha="center")
    law.set(xlim=(-0.25, 1.5), ylim=(-0.3, 2.25))
    return figure


DRAWINGS = {"weave": weave, "weaves": weaves, "cell": cell, "mesh": mesh, "contact": contact}

if __name__ == "__main__":
    main(*sys.argv[1:])
