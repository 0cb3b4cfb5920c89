"""Pictures of the ledger, where a reader would rather look than read; drawn from the runs that the checks have left."""

from __future__ import annotations

from types import ModuleType
from typing import TYPE_CHECKING, Any

import numpy as np

from fabrics import catalogue
from meshing.pictures_style import BLUE, COLOURS, FAINT, GREEN, INK, ORANGE, RED, WARP, WEFT
from validation.claims.checks import cell as cell_checks
from validation.claims.checks import coupling, impact, sensitivity, series, solids, waves
from validation.claims.checks.geometry import KEVLAR
from validation.claims.registry import Run

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_MODELS = {"incompressible": RED, "compressible": BLUE, "decoupled": ORANGE}


def _history(axes, run, **looks):
    """Velocity of a projectile to its stop."""
    axes.plot(1e6 * run["fine"][::5, 0], run["fine"][::5, 2], **looks)


def velocities(pyplot: ModuleType, runs: dict[str, Any]) -> Figure:
    """The six fabrics at 100 m/s."""
    figure, axes = pyplot.subplots(figsize=(6.4, 4.2))
    for name, colour in zip(KEVLAR, COLOURS):
        _history(axes, runs[name], color=colour, label=name)
    axes.set(xlabel="time [µs]", ylabel="projectile velocity [m/s]", ylim=(0, None), xlim=(0, None))
    axes.legend(ncols=2)
    return figure


def limits(pyplot: ModuleType, runs: dict[str, Any]) -> Figure:
    """Critical velocities inside the brackets of the thesis's captions."""
    brackets = {"S-720": (100, 155), "S-726": (100, 174), "S-727": (100, 158), "S-728": (100, 170), "S-731": (116, 132),
                "S-745": (110, 215)}  # fmt: skip
    figure, axes = pyplot.subplots(figsize=(6.4, 4.2))
    for k, name in enumerate(KEVLAR):
        axes.plot(brackets[name], [k, k], color=FAINT, lw=9, solid_capstyle="butt", alpha=0.55,
                  label="between a stop and a perforation of the thesis" if k == 0 else None)  # fmt: skip
        axes.plot(runs[name]["velocity"], k, "o", color=BLUE, ms=9, label="ours" if k == 0 else None)
    axes.set_yticks(range(6), KEVLAR)
    axes.set(xlabel="critical velocity [m/s]", ylim=(5.6, -1.6))
    axes.grid(axis="y", visible=False)
    axes.legend(loc="upper left", ncols=2)
    return figure


def bounds(pyplot: ModuleType, runs: dict[str, Any]) -> Figure:
    """Velocity between the bounds, on a balanced and an unbalanced fabric."""
    figure, row = pyplot.subplots(1, 2, figsize=(9.6, 3.9), sharey=True)
    for axes, name in zip(row, ("S-728", "S-731")):
        for model, colour in _MODELS.items():
            _history(axes, runs[f"{name} {model}"], color=colour, label=model)
        axes.set(title=name, xlabel="time [µs]", ylim=(0, None), xlim=(0, None))
    row[0].set_ylabel("projectile velocity [m/s]")
    row[0].legend()
    return figure


def cell_bounds(pyplot: ModuleType, runs: dict[str, Any]) -> Figure:
    """Tensions of the cell between the bounds, the weft held."""
    figure, row = pyplot.subplots(1, 2, figsize=(9.6, 3.9), sharey=True)
    for axes, (T, title) in zip(row, (("T1", "warp, stretched"), ("T2", "weft, held"))):
        for model, colour in _MODELS.items():
            strain, found = cell_checks.warp_pull(cell_checks.cell("S-728", model))
            axes.plot(100 * strain, found[T], color=colour, label=model)
        axes.set(title=title, xlabel="warp strain of the cloth [%]", xlim=(0, None), ylim=(0, None))
    row[0].set_ylabel("tension per yarn [N]")
    row[0].legend()
    return figure


def crossover(pyplot: ModuleType, runs: dict[str, Any]) -> Figure:
    """Cell and 3D crossover of S-726, the weft held."""
    from shellfabric.cell.model import CellModel

    path, given = runs["warp"], catalogue.load("S-726")
    law = solids.fitted(runs["warp"], runs["weft"], runs["equibiaxial"])
    figure, axes = pyplot.subplots(figsize=(6.4, 4.2))
    for laws, dash, name in (((law, law), "--", "cell, law fitted to the crossover"), (None, ":", "cell, printed law")):
        found = CellModel(given, laws).solve(1 + path["d1"] / given.weave.w1, 1.0)
        for T, colour in (("T1", WARP), ("T2", WEFT)):
            axes.plot(1e6 * path["d1"], found[T], dash, color=colour, label=name if T == "T1" else None)
    for T, colour, name in (("T1", WARP, "warp"), ("T2", WEFT, "weft, held")):
        axes.plot(1e6 * path["d1"], path[T], color=colour, label=f"3D crossover: {name}")
    axes.set(xlabel="displacement of the warp ends [µm]", ylabel="tension per yarn [N]", xlim=(0, None), ylim=(0, None))
    axes.legend()
    return figure


def platens(pyplot: ModuleType, runs: dict[str, Any]) -> Figure:
    """The pressed crossover of S-720 and the one-ply law."""
    from fabrics.plate_curve import PlateCurve

    given, pressed = catalogue.load("S-720"), runs["pressed"]
    law = PlateCurve.pressure_law(given.areal_density_measured)
    pressure = pressed["F_plate"].mean(axis=1) / given.weave.cell_area
    closure = 2 * (pressed["plates"][0] - pressed["plates"])
    shift = np.interp(5e5, law.pressure, law.closure) - np.interp(5e5, pressure, closure)
    figure, axes = pyplot.subplots(figsize=(6.4, 4.2))
    on = pressure > 2e4
    axes.semilogy(1e6 * (closure[on] + shift), 1e-6 * pressure[on], color=BLUE, label="3D crossover")
    axes.semilogy(1e6 * law.closure, 1e-6 * law.pressure, color=INK, ls="--", label="pressure law of eq. 2-6")
    axes.set(xlabel="closure, laid together at 0.5 MPa [µm]", ylabel="pressure [MPa]")
    axes.legend()
    return figure


def fits(pyplot: ModuleType, runs: dict[str, Any]) -> Figure:
    """a and b fitted to our crossovers over the printed ones."""
    figure, axes = pyplot.subplots(figsize=(6.4, 4.2))
    for k, name in enumerate(KEVLAR):
        law = solids.fitted(*(runs[f"{name} {path}"] for path in ("warp", "weft", "equibiaxial")))
        given = catalogue.load(name).laws[0]
        for shift, value, colour, label in ((-0.18, law.a / given.a, BLUE, "a"), (0.18, law.b / given.b, ORANGE, "b")):
            axes.bar(k + shift, value, width=0.34, color=colour, label=label if k == 0 else None)
    axes.axhspan(0.7, 1.3, color=GREEN, alpha=0.15, lw=0, label="±30 %")
    axes.axhline(1, color=INK, lw=1)
    axes.set_xticks(range(6), KEVLAR)
    axes.set(ylabel="fitted over printed")
    axes.grid(axis="x", visible=False)
    axes.legend(ncols=3)
    return figure


def crimp_speed(pyplot: ModuleType, runs: dict[str, Any]) -> Figure:
    """Speeds of the fronts against crimp."""
    figure, axes = pyplot.subplots(figsize=(6.4, 4.2))
    for kind, colour in (("longitudinal", BLUE), ("transverse", RED)):
        points = []
        for name in KEVLAR:
            for family, yarn in zip(("warp", "weft"), catalogue.load(name).weave.yarns):
                points.append((100 * yarn.crimp, waves.front(runs[name], family, kind)))
        x, y = np.array([point for point in points if np.isfinite(point[1])]).T
        n, k = np.polyfit(np.log(x), np.log(y), 1)
        line = np.geomspace(x.min(), x.max(), 50)
        axes.loglog(x, y, "o", color=colour, label=f"{kind}: crimp to the power {n:.2f}")
        axes.loglog(line, np.exp(k) * line**n, color=colour, lw=1.2)
    axes.set(xlabel="crimp [%]", ylabel="speed of the front [m/s]")
    axes.set_xticks([0.5, 1, 2, 5, 10], ["0.5", "1", "2", "5", "10"])
    axes.minorticks_off()
    axes.legend()
    return figure


def sensitivities(pyplot: ModuleType, runs: dict[str, Any]) -> Figure:
    """Change of velocity for 20 % less and more of each parameter."""
    figure, row = pyplot.subplots(1, 3, figsize=(11.5, 3.7), sharey=True)
    for axes, (parameter, name) in zip(row, sensitivity.NAMES.items()):
        same = runs[f"{parameter}_same"]
        for which, colour in (("less", ORANGE), ("more", BLUE)):
            run = runs[f"{parameter}_{which}"]
            t = np.linspace(0, min(run["fine"][-1, 0], same["fine"][-1, 0]), 300)
            label = "20 % less" if which == "less" else "20 % more"
            axes.plot(1e6 * t, series.velocity(run, t) - series.velocity(same, t), color=colour, label=label)
        axes.axhline(0, color=INK, lw=0.8)
        axes.set(title=name, xlabel="time [µs]", xlim=(0, None))
    row[0].set_ylabel("change of velocity [m/s]")
    row[0].legend()
    return figure


def cones(pyplot: ModuleType, runs: dict[str, Any]) -> Figure:
    """Deflection over the panel with a soft and a locked trellis."""
    figure, row = pyplot.subplots(1, 2, figsize=(9.6, 4.4))
    for axes, (name, title) in zip(
        row, (("soft", "trellis that never locks"), ("hard", "trellis locked from the start"))
    ):
        run = runs[name]
        taken = next((s for s in run["snapshots"] if coupling.base_ratio(s)[1] > 50e-3), run["snapshots"][-1])
        x, y, z = 1e3 * taken["x"], 1e3 * taken["y"], 1e3 * taken["z"].T
        z = np.maximum(z, 0)
        full = np.block([[z[:0:-1, :0:-1], z[:0:-1]], [z[:, :0:-1], z]])
        X, Y = np.concatenate([-x[:0:-1], x]), np.concatenate([-y[:0:-1], y])
        drawn = axes.contourf(X, Y, full, levels=14, cmap="Blues")
        axes.contour(X, Y, full, levels=[0.05 * full.max()], colors=[RED], linewidths=1.6)
        axes.set(title=title, aspect="equal", xlabel=f"mm along the warp, after {1e6 * taken['t']:.0f} µs")
        axes.grid(visible=False)
        figure.colorbar(drawn, ax=axes, label="deflection [mm]", shrink=0.85)
    row[0].set_ylabel("mm along the weft")
    return figure


def pulled_in(pyplot: ModuleType, runs: dict[str, Any]) -> Figure:
    """Velocity with weft edges that slip."""
    figure, axes = pyplot.subplots(figsize=(6.4, 4.2))
    for (name, run), colour in zip(runs.items(), (INK, GREEN, BLUE, RED)):
        label = "clamped" if name == "held" else f"{name[2:]} mm of pull-in"
        _history(axes, run, color=colour, label=label)
    axes.axvline(60, color=FAINT, lw=1, ls="--")
    axes.set(xlabel="time [µs]", ylabel="projectile velocity [m/s]", ylim=(0, None), xlim=(0, None))
    axes.legend()
    return figure


def angles(pyplot: ModuleType, runs: dict[str, Any]) -> Figure:
    """Mean angles of the zones of the bias coupon."""
    figure, row = pyplot.subplots(1, 2, figsize=(9.6, 3.9), sharey=True)
    for axes, (name, title) in zip(
        row, (("locking", "published trellis"), ("straight", "straight yarns, soft trellis"))
    ):
        run = runs[name]
        for k, (zone, colour) in enumerate(zip("ABC", (BLUE, GREEN, RED))):
            axes.plot(1e3 * run["moved"], np.degrees(run["angles"][:, k]), color=colour, label=f"zone {zone}")
        axes.plot(
            1e3 * run["moved"], np.degrees(run["inextensible"]), ":", color=INK, label="C, yarns that do not stretch"
        )
        axes.set(title=title, xlabel="elongation of the coupon [mm]", xlim=(0, None))
    row[0].set_ylabel("angle between the yarns [°]")
    row[0].legend()
    return figure


def _between(*names):
    return {f"{name} {model}": impact.shot(name, **({} if model == "compressible" else {"cell_model": model}))
            for name in names for model in _MODELS}  # fmt: skip


def _all_six():
    return {name: waves.shot(name, snapshots=25e-6) for name in KEVLAR}


_SHEARED: dict[str, Any] = {"fabric": "S-728", "G_soft": 8.66e6, "G_hard": 8.66e9, "gamma": [0.036, 0.21]}
_PULLED: dict[str, Any] = {"fabric": "S-728", "lengths": [0.001, 0.002, 0.003], "start": 1e-9, "end": 200e-6}
# topic: (drawing, its runs, caption, wide)
PICTURES = {
    "compr": (
        (fits, lambda: {f"{n} {k}": run for n in KEVLAR for k, run in solids.paths(n).items()},
         "Compression law fitted to our 3D crossovers, over the one that the thesis fitted to its own.", False),
        (platens, lambda: {"pressed": Run.of("plates", fabric="S-720")},
         "One ply of S-720 between plates.", False),
    ),
    "cell": (
        (cell_bounds, dict, "The cell of S-728 between its bounds: warp stretched, weft held.", True),
        (crossover, lambda: solids.paths("S-726"),
         "S-726, weft held: tensions of the 3D crossover and of the cell.", False),
    ),
    "shear": ((cones, lambda: coupling.sheared(**_SHEARED),
               "S-728 struck at 100 m/s; in red the base of the cone, at 5 % of the height.", True),),
    "bias": ((angles, lambda: {name: Run.of("bias", cloth=name) for name in ("locking", "straight")},
              "Angles between warp and weft in the three zones of the bias coupon.", True),),
    "wave": ((crimp_speed, _all_six, "Fronts along warp and weft of the six fabrics, struck at 100 m/s.", False),),
    "impact1": (
        (velocities, _all_six, "One ply of each fabric struck at 100 m/s.", False),
        (limits, lambda: {name: Run.of("limit", fabric=name) for name in KEVLAR},
         "Critical velocities and what the thesis's captions say of them.", False),
        (bounds, lambda: _between("S-728", "S-731"),
         "100 m/s on a balanced and an unbalanced fabric, between the bounds.", True),
    ),
    "sens": ((sensitivities, lambda: sensitivity.all_three("S-728"),
              "S-728 struck at 100 m/s, with 20 % less and more of one parameter.", True),),
    "slip": ((pulled_in, lambda: sensitivity.pulled(**_PULLED),
              "S-728 struck at 100 m/s, the weft edges drawn in over the first 200 µs.", False),),
}  # fmt: skip
