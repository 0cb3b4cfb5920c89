"""Pictures of the cases of `weavecell crossover`: a curve of each, and the deformed yarns.

pyvista draws bodies without scalar bars: VTK's crash a process that has loaded dolfinx.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fabrics.base.checks import FilePath
from fabrics.base.counted import counted
from fabrics.fabric import Fabric
from fabrics.pattern import PLAIN
from fabrics.plate_curve import PlateCurve
from weavecell.report.pictures_style import FAINT, FITTED, GREEN, INK, ORANGE, WARP, WEFT

if TYPE_CHECKING:
    from fabrics.base.record import Record
    from meshing.mesh import YarnMesh

UM = 1e6
MPA = 1e-6
WINDOW = (1500, 900)


def yarn(pyplot: Any, fabric: Fabric, record: Record) -> Any:
    """Draw tension against strain, with the closed form."""
    figure, axes = pyplot.subplots(figsize=(7.6, 4.8))
    strain = 100 * record["strain"]
    crimp = 100 * record.facts["crimp"]
    family = record.facts["yarn"]
    name = ("warp", "weft")[family]
    axes.plot(
        strain,
        record["T_taut"],
        color=FAINT,
        lw=1.6,
        ls="--",
        label="fibres without bending, eq. 4-7",
    )
    axes.plot(
        strain,
        record["T"],
        "o-",
        color=(WARP, WEFT)[family],
        ms=4,
        label=f"{name}, solid and bars",
    )
    axes.axvline(crimp, color=FAINT, lw=1, ls=":")
    beside = {"xytext": (4, -4), "textcoords": "offset points", "va": "top"}
    axes.annotate("crimp", (crimp, 1), xycoords=("data", "axes fraction"), color=FAINT, **beside)
    axes.set(xlabel="strain of the end distance [%]", ylabel="tension [N]")
    axes.set_title(f"{fabric.name}, one {name} pulled straight")
    axes.legend(loc="upper left", bbox_to_anchor=(0, 0.92))
    return figure


def stack(pyplot: Any, fabric: Fabric, record: Record) -> Any:
    """Draw pressure against the closure of a ply, with the pressure law if it knows the pack."""
    from unitcell3d.cases.stack import law_closure

    figure, axes = pyplot.subplots(figsize=(7.6, 4.8))
    plies = record.facts["plies"]
    pressed = record["pressure"] > 0
    axes.semilogy(
        UM * record["closure_ply"][pressed],
        MPA * record["pressure"][pressed],
        "o-",
        color=WARP,
        ms=4,
        label="3D yarns",
    )
    if fabric.areal_density_measured is not None and plies in (1, 4, 8, 16):
        pressure, _, closure = law_closure(fabric, record)
        if pressure.size:
            law = PlateCurve.pressure_law(fabric.areal_density_measured, int(plies))
            start = record["closure"][np.searchsorted(record["pressure"], pressure[0])] - closure[0]
            closed = UM * (law.closure + start) / plies
            label = "pressure law (eqs. 2-5, 2-6)"
            axes.semilogy(closed, MPA * law.pressure, color=ORANGE, ls="--", label=label)
    axes.set_ylim(bottom=1e-3)
    axes.set(xlabel="closure of the plates per ply [µm]", ylabel="mean pressure [MPa]")
    if plies == 1:
        plural = "one ply"
    else:
        plural = counted(plies, "ply")
    axes.set_title(f"{fabric.name}, {plural} between plates")
    axes.legend()
    return figure


def tensions(pyplot: Any, fabric: Fabric, record: Record) -> Any:
    """Draw tensions and contact force along the path."""
    figure, (upper, lower) = pyplot.subplots(
        2, 1, figsize=(7.6, 6.0), sharex=True, height_ratios=(2.2, 1)
    )
    share = 100 * record["path"]
    for key, colour, label in (
        ("T1", WARP, "warp tension"),
        ("T2", WEFT, "weft tension"),
        ("F_c", GREEN, "contact"),
    ):
        upper.plot(share, record[key], color=colour, label=label)
    lower.plot(share, UM * record["d1"], color=WARP, label="d$_1$")
    lower.plot(share, UM * record["d2"], color=WEFT, ls="--", label="d$_2$")
    upper.set(ylabel="force [N]", title=f"{fabric.name}, {record.facts['case']}")
    lower.set(xlabel="share of the path [%]", ylabel="end displacement [µm]")
    upper.legend()
    lower.legend()
    return figure


def shear(pyplot: Any, fabric: Fabric, record: Record) -> Any:
    """Shear stress against the angle, the fitted law and the fabric's own; forces below."""
    from fabrics.base.errors import InputError
    from unitcell3d.identify import shear_fit

    figure, (upper, lower) = pyplot.subplots(
        2, 1, figsize=(7.6, 7.0), sharex=True, height_ratios=(1.5, 1)
    )
    turned = np.arange(np.flatnonzero(record["gamma"] == 0)[-1], len(record["gamma"]))
    gamma = record["gamma"][turned]
    tau = record["tau"][turned]
    upper.plot(gamma, MPA * tau, "o", color=WARP, ms=4.5, mfc="white", label="3D yarns")
    fine = np.linspace(0, gamma[-1], 300)
    try:
        law = shear_fit.fit(gamma, tau).law
        label = f"fit of eq. 4-35: γ$_1$ {law.gamma1:.2f}, γ$_2$ {law.gamma2:.2f}"
        upper.plot(fine, MPA * law.stress(fine), color=INK, lw=1.8, label=label)
    except InputError:
        pass
    if fabric.shear is not None:
        label = f"fabric's data: γ$_1$ {fabric.shear.gamma1:g}, γ$_2$ {fabric.shear.gamma2:g}"
        upper.plot(
            fine, MPA * fabric.shear.stress(fine), color=ORANGE, ls="--", lw=1.8, label=label
        )
    upper.set(xlim=(0, 1.02 * gamma[-1]), ylim=(0, 1.15 * MPA * tau.max()))
    upper.set(ylabel="shear stress [MPa]", title=f"{fabric.name}, shear of the weave")
    upper.legend(loc="upper left", facecolor="w", framealpha=1, frameon=True, edgecolor="w")
    lower.plot(gamma, record["F_c"][turned], color=GREEN, label="at a crossing")
    for family, (name, colour) in enumerate((("warps", WARP), ("wefts", WEFT))):
        lower.plot(
            gamma,
            record["F_side"][turned, family],
            color=colour,
            ls="--",
            label=f"between parallel {name}",
        )
    lower.set(
        xlabel="shear angle γ [rad]",
        ylabel="contact force [N]",
        ylim=(0, 1.45 * record["F_c"].max()),
    )
    lower.legend(loc="upper left")
    return figure


def pull_out(pyplot: Any, fabric: Fabric, record: Record) -> Any:
    """Draw the axial force against the pull at each transverse load, and the thresholds against the
    contact force."""
    from unitcell3d.cases import pull_out as case

    figure, (left, right) = pyplot.subplots(1, 2, figsize=(10.4, 4.6))
    F_c, T_f = case.thresholds(record)
    for number in np.unique(record["load"]):
        of = (record["load"] == number) & ((record["pull"] > 0) | (np.roll(record["pull"], -1) > 0))
        left.plot(
            UM * record["pull"][of],
            record["P"][of],
            "o-",
            ms=3,
            label=f"F$_c$ {record['F_c'][of][-1]:.3g} N",
        )
    left.set(xlabel="pull along the axis [µm]", ylabel="axial force [N]")
    name = ("warp", "weft")[int(record.facts["pulled"])]
    left.set_title(f"{fabric.name}, {name} pulled, friction {record.facts['friction']:g}")
    left.legend()
    right.plot(F_c, T_f, "o", color=WARP, label="3D yarns in full sliding")
    if F_c.size > 1:
        law = case.fit(record)
        fine = np.array([0.0, 1.05 * F_c.max()])
        label = f"T$_f$ = {law.c0:.2g} N + {law.mu_eff:.3f} F$_c$"
        right.plot(fine, law.threshold(fine), color=INK, lw=1.6, label=label)
    right.set(xlim=(0, None), ylim=(0, None))
    right.set(xlabel="contact force F$_c$ [N]", ylabel="slip threshold T$_f$ [N]")
    right.legend()
    return figure


def plates(pyplot: Any, fit: Any) -> Any:
    """Draw pressure against closure.

    Parameters
    ----------
    fit : unitcell3d.identify.solid_record.PlatenClosures
    """
    figure, axes = pyplot.subplots(figsize=(8.6, 4.6))
    pressure = MPA * fit.pressure
    axes.plot(
        1e6 * fit.measured, pressure, "o", ms=6, mfc="white", mec=INK, mew=1.4, label="measured"
    )
    axes.plot(1e6 * fit.before, pressure, "--", color=FAINT, lw=2, label="before the fit")
    axes.plot(1e6 * fit.computed, pressure, color=FITTED, lw=2.4, label="fitted")
    axes.set(xlabel="closed by the plates [µm]", ylabel="pressure [MPa]", yscale="log")
    axes.legend(loc="upper left")
    return figure


def draw_deformed(mesh: YarnMesh, record: Record, path: FilePath) -> None:
    """Draw the last state as a PNG: warps blue, wefts vermilion; mirrored or repeated where that is
    what the domain is.

    Parameters
    ----------
    mesh : meshing.mesh.YarnMesh of the domain
    record : fabrics.base.record.Record
    path : of the .png file
    """
    import pyvista

    from unitcell3d.model import submeshes
    from weavecell.report.pictures_mesh import COLOURS, plotter, save

    bodies, images = _bodies(mesh, record, submeshes)
    scene = plotter(WINDOW)
    looks = {"edge_color": INK, "line_width": 0.7, "ambient": 0.4, "diffuse": 0.7}
    for family, grid, x in bodies:
        colour = COLOURS[("warp", "weft")[family]]
        for image in images(x, grid):
            for sheet in _sheets(grid):
                nodes = 1e3 * image[sheet]
                surface = pyvista.StructuredGrid(*(nodes[..., c] for c in range(3)))
                scene.add_mesh(surface, color=colour, show_edges=True, **looks)
    scene.enable_parallel_projection()
    scene.view_vector((-5, -7, 6))
    scene.camera.zoom(1.3)
    save(scene, path)


def _bodies(mesh, record, yarns):
    """((family, grid, points), ...) of the yarns, and a function that yields the images of a yarn's
    points."""
    if len(record.last["u"]) == len(mesh.points):
        of = mesh
    elif record.facts["case"].startswith("yarn"):
        of = yarns.single_yarn_mesh(mesh, int(record.facts["yarn"]))
    else:
        plies = int(record.facts["plies"])
        of = yarns.stacked(mesh, plies, record["distance"][0] / plies)
    x = of.points + record.last["u"]
    bodies = [(family, grid, x) for family, grid in zip(of.families, of.grids)]
    quarter = getattr(mesh, "domain", "") == "quarter"
    if quarter:
        return bodies, lambda points, grid: (
            points * np.array([a, b, 1]) for a in (1, -1) for b in (1, -1)
        )
    if "crossings" not in record.facts or hasattr(mesh, "count"):
        return bodies, lambda points, grid: (points,)
    return bodies, _glides(mesh, x)


def _glides(mesh, x):
    """Images of a whole crossover's yarns at the next crossings, upside down at every other one."""
    steps = []
    for grid in mesh.grids:
        step = x[grid[-1]].mean(axis=(0, 1)) - x[grid[0]].mean(axis=(0, 1))
        steps.append(step * [1, 1, 0])
    levels = {id(grid): x[grid[-1], 2].mean() for grid in mesh.grids}

    def images(points, grid):
        for m in (0, 1):
            for n in (0, 1):
                moved = points + m * steps[0] + n * steps[1]
                if not PLAIN.is_warp_up(m, n):
                    moved[:, 2] = 2 * levels[id(grid)] - moved[:, 2]
                yield moved

    return images


def _sheets(grid):
    """The six faces of a yarn as structured sheets of nodes."""
    return grid[:, :, 0], grid[:, :, -1], grid[:, 0], grid[:, -1], grid[0], grid[-1]
