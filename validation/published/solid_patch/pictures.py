"""Pictures of the solid patch: the deformed weave, its histories beside the shell's; the last state for ParaView."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
import pyvista

from fabrics.files import replace_whole
from meshing.pictures import save
from meshing.pictures_style import BLUE, GREEN, ORANGE, PURPLE, RED, SKY, WARP, WEFT
from validation.published.solid_patch.study import clock, node_strains, profile

SHELL = "#555555"
PARTS = (
    ("kinetic_fabric", "kinetic, fabric", BLUE), ("fibres", "fibres", RED), ("solids", "solids", GREEN),
    ("viscous", "viscous", PURPLE), ("hourglass", "hourglass", ORANGE), ("contact", "contact", SKY),
)  # fmt: skip


def histories(march: Any, beside: Any, path: Path) -> None:
    """Velocity, tension under the nose, energies, and the profile at the end; dashed lines are the shell's.

    Time counts from where the nose reaches the middle plane.
    """
    figure, ((speed, pull), (energy, shape)) = plt.subplots(2, 2, figsize=(11, 7.6))
    t = 1e6 * (march.sample("t") - clock(march))
    speed.plot(t, march.sample("v"), color=WARP, label="solid patch")
    speed.plot(1e6 * beside.t, beside.v, "--", color=SHELL, label="shell")
    speed.set(title="Projectile", xlabel="time from the middle plane on [us]", ylabel="velocity [m/s]")
    for name, colour, k in (("warp", WARP, 0), ("weft", WEFT, 1)):
        pull.plot(t, march.sample(f"{name}_nose"), color=colour, label=f"{name}, solid patch")
        pull.plot(1e6 * beside.t, beside.nose[:, k], "--", color=colour, label=f"{name}, shell")
    pull.set(
        title="Mean tension of the two middle yarns under the nose",
        xlabel="time from the middle plane on [us]",
        ylabel="tension [N]",
    )
    for name, label, colour in PARTS:
        energy.plot(t, 1e3 * march.sample(name), color=colour, label=label)
    energy.plot(t, 1e3 * march.sample("error"), ":", color="black", label="energy error")
    energy.set(title="Energies of the solid patch", xlabel="time from the middle plane on [us]", ylabel="energy [mJ]")
    own = 1e3 * profile(march)
    shape.plot(own[:, 0], own[:, 1], color=WARP, label="solid patch, between the middle warps")
    then = np.argmin(np.abs(beside.shots - (march.sample("t")[-1] - clock(march))))
    half = 1e3 * beside.profiles[then]
    shape.plot(np.concatenate([-half[::-1, 0], half[:, 0]]), np.concatenate([half[::-1, 1], half[:, 1]]), "--",
               color=SHELL, label="shell, through the impact point")  # fmt: skip
    shape.set(title="Profile along the warp at the end", xlabel="place [mm]", ylabel="height [mm]")
    for axes in (speed, pull, energy, shape):
        axes.legend(frameon=False, fontsize=9, loc="lower center" if axes is shape else "best")
        axes.grid(alpha=0.3)
        for side in ("top", "right"):
            axes.spines[side].set_visible(False)
    figure.tight_layout()
    with replace_whole(path) as beside_path:
        figure.savefig(beside_path, dpi=130)
    plt.close(figure)


def scene(march: Any, path: Path) -> None:
    """The deformed yarns, coloured by the strain of their fibres, over the projectile; seen from behind the fabric."""
    mesh = march.patch.mesh
    quads = np.concatenate(list(mesh.faces.values()))
    skin = pyvista.PolyData(1e3 * march.state.x, faces=np.insert(quads, 0, 4, axis=1).ravel())
    skin.point_data["fibre strain [%]"] = 100 * node_strains(march)
    skin = skin.clean()
    view = pyvista.Plotter(off_screen=True, window_size=(1600, 1000), lighting="none")  # type: ignore[arg-type]
    view.set_background("white")  # type: ignore[arg-type]
    for place, strength in (((-3.0, 1.0, 3.0), 0.8), ((2.0, -4.0, 2.0), 0.6), ((0.0, 0.0, 5.0), 0.3)):
        view.add_light(pyvista.Light(position=place, focal_point=(0, 0, 0), color="white", intensity=strength))
    view.add_mesh(
        skin, scalars="fibre strain [%]", cmap="viridis", clim=(0, max(0.1, float(skin["fibre strain [%]"].max()))),
        smooth_shading=True, split_sharp_edges=True, feature_angle=40, ambient=0.3, diffuse=0.8, specular=0.15,
        scalar_bar_args={"title": "fibre strain [%]\n", "color": "black", "vertical": True, "position_x": 0.9,
                         "position_y": 0.2, "height": 0.6, "width": 0.05, "fmt": "%.2f"},
    )  # fmt: skip
    shot = march.patch.projectile
    short = replace(shot, length=min(shot.length or np.inf, 3 * shot.radius)) if shot.shape != "sphere" else shot
    body = short.surface() + march.state.projectile_position
    view.add_mesh(pyvista.StructuredGrid(*np.moveaxis(1e3 * body, -1, 0)), color="#9aa3ad", smooth_shading=True)
    middle = 1e3 * np.array([0.0, 0.0, 0.5 * march.state.x[:, 2].max()])
    view.enable_parallel_projection()  # type: ignore[call-arg]
    view.camera_position = [tuple(middle + np.array([-40, -60, 48.0])), tuple(middle), (0, 0, 1)]
    view.camera.parallel_scale = 0.4e3 * np.hypot(*march.patch.mesh.extent)
    view.reset_camera_clipping_range()
    save(view, path)


def paraview(march: Any, path: Path) -> None:
    """The last state as a .vtu: bricks, displacement, velocity, fibre strain, torn bricks."""
    mesh = march.patch.mesh
    grid = pyvista.UnstructuredGrid({pyvista.CellType.HEXAHEDRON: mesh.hexes}, march.state.x)
    grid.point_data["displacement"] = march.state.x - mesh.points
    grid.point_data["velocity"] = march.state.v
    grid.point_data["fibre_strain"] = node_strains(march)
    grid.cell_data["yarn"] = mesh.yarn
    with replace_whole(path) as beside:
        grid.save(beside)
