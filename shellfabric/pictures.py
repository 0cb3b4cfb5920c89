"""Pictures of an impact: histories and energies, maps of tension and of failed yarns, the deformed panel."""

from __future__ import annotations

import numpy as np

from fabrics.files import replace_whole
from shellfabric.measures import deflection_profile
from shellfabric.panel import SYMMETRIES

_SHOWN = {
    "kinetic_projectile": "projectile, kinetic",
    "kinetic_fabric": "cloth, kinetic",
    "stored": "yarns, stored",
    "shear": "trellis shear",
    "viscous": "viscous",
    "contact": "contact",
    "friction": "friction",
    "grip": "slip in the clamps",
    "external": "work on edges led in",
    "failed": "lost with failed yarns",
}
_COLOURS = (
    "#7c8794", "#0072B2", "#009E73", "#56B4E9", "#E69F00", "#CC79A7", "#1d2733", "#b5651d", "#8c8c3f", "#4d6b3c",
    "#D55E00",
)  # fmt: skip
_BAR = {
    "vertical": True, "position_x": 0.91, "position_y": 0.25, "height": 0.5, "width": 0.05,
    "color": "black", "title_font_size": 24, "label_font_size": 22, "fmt": "%.0f", "n_labels": 4,
}  # fmt: skip
_WARP, _WEFT = "#0072B2", "#D55E00"


def histories(result, path):
    """Velocity, energies with their balance, reactions, and deflection along both yarns at the snapshots."""
    from matplotlib import rc_context
    from matplotlib.figure import Figure

    with rc_context({"axes.spines.top": False, "axes.spines.right": False, "axes.titlelocation": "left"}):
        figure = Figure(figsize=(12, 8.4), layout="constrained")
        velocity, energy, reaction, shape = figure.subplots(2, 2).ravel()
    t = 1e6 * result.t
    velocity.plot(t, result.v, color=_WARP, lw=2)
    velocity.set(title=f"Projectile: {result.outcome}", xlabel="time, µs", ylabel="velocity, m/s")
    velocity.axhline(0, color="#9aa3ad", lw=0.8)
    shown = [(*pair, colour) for pair, colour in zip(_SHOWN.items(), _COLOURS) if np.any(result.energies[pair[0]])]
    names, labels, colours = zip(*shown)
    energy.stackplot(t, [result.energies[name] for name in names], labels=labels, colors=colours, lw=0)
    energy.set(
        title=f"Energy; the balance holds to {100 * result.worst_balance:.2g} % of the strike energy",
        xlabel="time, µs",
        ylabel="J",
        ylim=(0, 1.02 * result.strike_energy),
        xlim=(0, t[-1]),
    )
    handles, labels = energy.get_legend_handles_labels()
    energy.legend(handles[::-1], labels[::-1], fontsize=8, loc="center left", framealpha=0.9)
    for name, colour in (("warp", _WARP), ("weft", _WEFT)):
        reaction.plot(t, result.reactions[name], color=colour, lw=1.5, label=name)
    reaction.set(title="Tension at the edge, yarn through the impact", xlabel="time, µs", ylabel="N")
    reaction.legend(frameon=False)
    for number, shot in enumerate(result.snapshots):
        shade = 0.25 + 0.75 * (number + 1) / len(result.snapshots)
        for (x, z), colour in zip(deflection_profile(result.panel, shot), (_WARP, _WEFT)):
            shape.plot(1e3 * x, 1e3 * z, color=colour, alpha=shade, lw=1.2)
    every = 1e6 * result.snapshots[0].t if result.snapshots else 0.0
    title = f"Deflection every {every:.3g} µs (warp blue, weft red)" if result.snapshots else "No snapshots were taken"
    shape.set(title=title, xlabel="from the impact point, mm", ylabel="mm")
    _save(figure, path)


def maps(result, path, reach=None):
    """Tension of warp and weft on the undeformed panel, failed yarns marked; `reach` [m] shows the middle alone."""
    from matplotlib.figure import Figure

    panel = result.panel
    ni, nj = panel.counts
    X, Y = panel.coordinates()
    mirror_x, mirror_y = SYMMETRIES[panel.symmetry]
    figure = Figure(figsize=(12, 5.4), layout="constrained")
    top = float(result.tension.max())
    for c, (axes, name) in enumerate(zip(figure.subplots(1, 2), ("warp", "weft"))):
        tension = result.tension[:, c].reshape(ni, nj)
        broken = result.broken[:, c].reshape(ni, nj)
        for sx in (1, -1) if mirror_x else (1,):
            for sy in (1, -1) if mirror_y else (1,):
                x, y = sx * 1e3 * X, sy * 1e3 * Y
                colours = axes.pcolormesh(x, y, tension, cmap="viridis", vmin=0, vmax=top, rasterized=True)
                hole = np.ma.masked_where(~broken, np.ones_like(tension))
                axes.pcolormesh(x, y, hole, cmap="Reds", vmin=0, vmax=1.3, rasterized=True)
        axes.set(title=f"{name}: {100 * broken.mean():.2g} % failed (red)", xlabel="along warp, mm", aspect="equal")
        if reach is not None:
            axes.set(xlim=(-1e3 * reach, 1e3 * reach), ylim=(-1e3 * reach, 1e3 * reach))
    figure.axes[0].set_ylabel("along weft, mm")
    figure.colorbar(colours, ax=figure.axes, label="tension, N", shrink=0.8)
    _save(figure, path)


def deformed(result, path):
    """The deformed panel seen from behind, completed by symmetry, coloured by the greater yarn tension."""
    import pyvista

    panel = result.panel
    mirror_x, mirror_y = SYMMETRIES[panel.symmetry]
    keep = ~result.broken[:, 2]
    faces = np.column_stack([np.full(keep.sum(), 4), result.quads[keep]]).ravel()
    plotter = pyvista.Plotter(off_screen=True, window_size=(1500, 900))
    plotter.set_background("white")
    for sx in (1, -1) if mirror_x else (1,):
        for sy in (1, -1) if mirror_y else (1,):
            cloth = pyvista.PolyData(1e3 * result.nodes * [sx, sy, 1], faces)
            cloth.cell_data["tension, N"] = result.tension[keep].max(axis=1)
            plotter.add_mesh(
                cloth,
                scalars="tension, N",
                cmap="viridis",
                clim=(0, float(result.tension.max())),
                lighting=True,
                scalar_bar_args=_BAR,
            )
    # set back by half its edge radius: flat elements cut across the rounding
    shot = result.setup.projectile
    body = 1e3 * np.moveaxis(result.nose + shot.surface(shot.edge_radius / 2), -1, 0)
    plotter.add_mesh(pyvista.StructuredGrid(*body), color="#7c8794", smooth_shading=True)
    size = 1e3 * max(np.ptp(result.nodes[:, 0]) * (2 if mirror_x else 1), np.ptp(result.nodes[:, 1]))
    plotter.camera_position = [(0.9 * size, -1.35 * size, 0.75 * size), (0.05 * size, 0, -0.03 * size), (0, 0, 1)]
    plotter.camera.zoom(0.95)
    with replace_whole(path) as beside:
        plotter.screenshot(str(beside))
    plotter.close()


def _save(figure, path):
    with replace_whole(path) as beside:
        figure.savefig(beside, dpi=110)
