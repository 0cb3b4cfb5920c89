"""The unit cell of section 4.3, alone, between its bounds, and against the 3D crossover of chapter 3.

Equations are the thesis's: the equilibrium form.

Where the printed compression law is meant, it is used; else the regularised one (erratum E-05).
"""

from __future__ import annotations

import time
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.integrate import quad
from scipy.optimize import brentq

from fabrics import catalogue
from fabrics.base.checks import FloatArray
from fabrics.compression import CompressionLaw
from fabrics.weave import arc_length
from shellfabric.cell import crossover_kernels
from shellfabric.cell.model import CellModel
from shellfabric.coupon.model import Coupon, mesh_coupon
from validation.claims import changed_fabrics
from validation.claims.readers import KEVLAR, crimped, derivative
from validation.models.cell_equations import departure
from validation.values import Values, largest, rms
from weavecell.studies import biaxial_fit
from weavecell.studies.biaxial_path import CellPath
from weavecell.studies.biaxial_tests import BiaxialTest

if TYPE_CHECKING:
    from fabrics.yarn import Yarn

States = dict[
    str, FloatArray
]  # of a solved cell: tensions T1, T2, contact force F, heights h1, h2, energy W
BOUNDED = ("incompressible", "compressible", "decoupled")


def cell(name: str, model: str = "compressible", **changes: Any) -> CellModel:
    """Make the cell of a fabric."""
    return CellModel(
        changed_fabrics.load(name), cell_model=model, cell_formulation="equilibrium", **changes
    )


def printed(name: str, a: float | None = None) -> CellModel:
    """Make the cell with the law as printed, or with another `a` [m]."""
    given = changed_fabrics.load(name)
    laws = tuple(CompressionLaw(a or law.a, law.b, form="printed") for law in given.laws)
    return CellModel(given, laws, cell_formulation="equilibrium")  # type: ignore[arg-type]


def rectangle(name: str, half: Any, size: int, **options: Any) -> Coupon:
    """Make a coupon of a fabric, in the variational form; its half sides [m], one or two, and
    options of `mesh_coupon`."""
    table = CellModel(changed_fabrics.load(name), cell_formulation="variational").table(size)
    a, b = np.broadcast_to(half, 2)
    return mesh_coupon(table, lambda x, y: (abs(x) < a) & (abs(y) < b), max(a, b), **options)


def stretch_at_failure(yarn: Yarn) -> float:
    """Find the stretch of the cell at which a yarn alone is at its strength."""
    return (1 + yarn.crimp) * (1 + yarn.failure_strain)


def grid(model: CellModel, n: int = 61) -> list[FloatArray]:
    """Make pairs of stretches from rest to `stretch_at_failure` of each yarn."""
    axes = (np.linspace(1, stretch_at_failure(yarn), n) for yarn in model.fabric.weave.yarns)
    return np.meshgrid(*axes, indexing="ij")


def unfailed(model: CellModel, found: States) -> Any:
    """Mark the states in which no yarn is past its strength."""
    warp, weft = model.fabric.weave.yarns
    return (found["T1"] <= warp.strength) & (found["T2"] <= weft.strength)


def warp_pull(model: CellModel, n: int = 161) -> tuple[FloatArray, States]:
    """Solve warp extension with the weft held, to the failure of the first yarn: (strain,
    solution)."""
    strain = np.linspace(0, stretch_at_failure(model.fabric.weave.warp) - 1, n)
    found = model.solve(1 + strain, 1.0)
    safe = unfailed(model, found)
    last = n
    if not safe.all():
        last = int(np.argmin(safe))
    return strain[:last], {name: values[:last] for name, values in found.items()}


def random_states(name: str, n: int = 400, seed: int = 3) -> tuple[FloatArray, ...]:
    """Draw stretches between rest and failure at which the yarns touch."""
    rng = np.random.default_rng(seed)
    return tuple(
        1 + rng.uniform(0, 1, n) * (stretch_at_failure(y) - 1)
        for y in changed_fabrics.load(name).weave.yarns
    )


def alone(fabric: str, family: int) -> tuple[FloatArray, FloatArray]:
    """Pull a yarn without coupling from rest to its strength: (strains of the cell, tensions)."""
    stretch = np.linspace(
        1, stretch_at_failure(changed_fabrics.load(fabric).weave.yarns[family]), 400
    )
    return stretch - 1, pulled(cell(fabric, "decoupled"), family, stretch)


def pulled(model: CellModel, family: int, stretch: Any, other: float = 1.0) -> FloatArray:
    """Compute the tension [N] of a yarn whose cell is stretched along it, and across it by
    `other`."""
    return model.solve(*((stretch, other) if family == 0 else (other, stretch)))[f"T{family + 1}"]


def stretch_to_strength(model: CellModel, family: int, other: float = 1.0) -> float:
    """Find the stretch of the cell along a yarn at which the yarn is at its strength; across it is
    `other`."""
    strength = model.fabric.weave.yarns[family].strength

    def excess(stretch):
        return float(pulled(model, family, stretch, other)) - strength

    return brentq(excess, 1.0, 1.5, xtol=1e-12)


def equilibrium() -> Values:
    """Check F against 2 T sin(alpha) of both yarns; heights and compressions against the heights at
    rest; random states."""
    force = closing = 0.0
    for name in catalogue.list_names():
        model = cell(name)
        s1, s2 = random_states(name)
        found = model.solve(s1, s2)
        weave = model.fabric.weave
        contact = found["F"] > 0
        for T, h, w, s in zip(("T1", "T2"), ("h1", "h2"), weave.w, (s1, s2)):
            k = np.pi * found[h] / (2 * w * s)
            F = 2 * found[T] * k / np.sqrt(1 + k * k)
            force = max(force, abs(F / found["F"] - 1)[contact].max())
        sum_h = found["h1"] + found["h2"]
        d = model.fabric.laws[0].d(found["F"])
        closing = max(closing, abs((sum_h + 2 * d - sum(weave.h0)) / sum_h)[contact].max())
    return {"equilibrium": force, "compatibility": closing}


def jacobian_ratio() -> float:
    """Compare dS/dh by differences of the arc length with eq. 4-24 as printed; return the ratio
    that is furthest from 2."""
    ratios = []
    for w, h, *_ in crimped():
        rise = derivative(partial(arc_length, w), h, 1e-4 * h)
        k = np.pi / (2 * w)

        def written(x, k=k, h=h):
            return np.sin(k * x) ** 2 / np.sqrt(1 + (k * h * np.sin(k * x)) ** 2)

        ratios.append(rise / (k * k * h * quad(written, 0, w, epsabs=0, epsrel=1e-12)[0]))
        assert abs(crossover_kernels.arc(w, h)[1] / rise - 1) < 1e-6
    return max(ratios, key=lambda ratio: abs(ratio - 2))


def sine_slope_error() -> float:
    """Compute the error of d sin(alpha)/dh that the contact force of the cell's equilibrium form
    has, over eq. 4-21.

    F = 2 T sin(alpha), so that dF/dh = 2 (dT/dh sin(alpha) + T dsin(alpha)/dh), with dT/dh = EA/S0 dS/dh.
    """
    worst = 0.0
    cells = [cell(name) for name in KEVLAR]
    for model, yarn in ((one, yarn) for one in cells for yarn in one.yarns):
        h = yarn.h0
        stretched = 1.02 * yarn.w
        F, dF, T = crossover_kernels.contact_force(stretched, h, yarn, model.crossover)
        dT = yarn.EA / yarn.S0 * crossover_kernels.arc(stretched, h)[1]
        found = (0.5 * dF - dT * 0.5 * F / T) / T
        written = 4 * np.pi * stretched**2 / np.hypot(2 * stretched, np.pi * h) ** 3
        worst = max(worst, abs(found / written - 1))
    return worst


def off_lone_yarns(name: str, **changes: Any) -> float:
    """Compute the tensions of the cell less those of lone yarns, over EA; of random states at which
    the yarns would touch."""
    stretches = random_states(name)
    found = cell(name, **changes).solve(*stretches)
    worst = 0.0
    for T, s, (w, _, S0, yarn) in zip(("T1", "T2"), stretches, crimped([name])):
        lone = yarn.EA * np.maximum(2 * w * s / S0 - 1, 0)
        worst = max(worst, largest(found[T] - lone) / yarn.EA)
    return worst


def stress_resultant_error() -> float:
    """Compare the forces at the edge of a stretched coupon with the force of the stresses of two
    half layers (eqs. 4-46 to 4-48).

    Each yarn acts in one half of the thickness, over the width of its cell; the mean over the whole thickness, times
    thickness and width, is to be what the nodes of the coupon are pulled with.
    """
    worst = 0.0
    for name in ("S-720", "S-726", "S-731"):
        weave = changed_fabrics.load(name).weave
        coupon = rectangle(name, 8.000001 * np.array(weave.w), 801)
        stretch = [1 + 0.6 * (stretch_at_failure(yarn) - 1) for yarn in weave.yarns]
        forces = -coupon.forces(coupon.points * stretch)[0]
        state = coupon.table.model.solve(*stretch)
        width = 2 * np.array(weave.w[::-1])
        for axis in (0, 1):
            rim = coupon.points[:, axis] > coupon.points[:, axis].max() - 0.1 * weave.w[axis]
            across = np.ptp(coupon.points[rim, 1 - axis])
            pulled = abs(forces[rim, axis].sum())
            layer = float(state[f"N{axis + 1}"]) / (0.5 * weave.thickness * width[axis])
            worst = max(worst, abs(0.5 * layer * weave.thickness * across / pulled - 1))
    return worst


def lone_yarn() -> Values:
    """Check a yarn whose partner is gone, in a coupon of warp alone; and the slack of steps 11 and
    25 as printed."""
    worst = 0.0
    for name in ("S-720", "S-731"):
        weave = changed_fabrics.load(name).weave
        # the weft has been drawn out of the right half, as it has to be somewhere in a coupon
        coupon = rectangle(name, 0.01, 51, woven=lambda x, y: (np.ones(x.shape, bool), x < 0))
        lone = coupon.points[coupon.edges[0]][:, :, 0].min(axis=1) > 2 * weave.w1
        for stretch in (1.01, stretch_at_failure(weave.warp) - 0.005):
            T = coupon.tensions(coupon.points * [stretch, 1.0])[0][lone]
            alone = weave.warp.EA * max(2 * weave.w1 * stretch - weave.S01, 0) / weave.S01
            worst = max(worst, largest(T - alone) / weave.warp.strength)
        # the printed w for 2w leaves it slack whatever the stretch
        as_printed = max(weave.w1 * stretch_at_failure(weave.warp) - weave.S01, 0)
    return {"difference over strength": worst, "as printed, at failure": as_printed}


def surfaces(fabric: str) -> Values:
    """Compare the stored energies of the bounds and of the cell between, over all pairs of strains
    at which no yarn fails."""
    models = [cell(fabric, model) for model in BOUNDED]
    pairs = grid(models[0], 41)
    found = [model.solve(*pairs) for model in models]
    sound = unfailed(models[0], found[0])
    high, middle, low = (part["W"][sound] for part in found)
    least = min(float((high - middle).min()), float((middle - low).min()))
    return {
        "least distance over the highest": least / high.max(),
        "mean share of the way": float(np.mean(middle - low) / np.mean(high - low)),
        "off the equations": max(departure(model, *pairs) for model in models),
    }


def survived(name: str, n: int = 61) -> tuple[FloatArray, FloatArray]:
    """Compute (warp strains (n,), stored energy [J] of the coupled cell (n, n)), nan where a yarn
    is past its strength."""
    model = cell(name)
    pairs = grid(model, n)
    found = model.solve(*pairs)
    return pairs[0][:, 0] - 1, np.where(unfailed(model, found), found["W"], np.nan)


def displacement_at_strength(model: CellModel, family: int, away: float) -> float:
    """Find the end displacement [m] at which a yarn reaches its strength, the crossing yarn being
    shortened by `away` [m]."""
    w = model.fabric.weave.w
    return w[family] * (stretch_to_strength(model, family, 1 - away / w[1 - family]) - 1)


def curve_change(curve: CellPath, family: int, shift: float) -> float:
    """Compute the RMS by which tensions move when the strain origin moves by `shift` [-], over the
    RMS of the curve itself."""
    strain = curve.strain[:, family]
    tension = curve.tension[:, family]
    common = strain > shift
    off = rms(tension[common] - np.interp(strain[common] - shift, strain, tension))
    return off / rms(tension[common])


def look_up(fabric: str, n: int, samples: int) -> Values:
    """Compare the bilinear table of tensions with the cell itself, over all states up to failure;
    and their speed."""
    model = cell(fabric)
    table = model.table(n)
    rng = np.random.default_rng(4)
    s1, s2 = (rng.uniform(axis[0], axis[-1], samples) for axis in (table.stretch1, table.stretch2))
    begun = time.perf_counter()
    exact = model.solve(s1, s2)
    solved = time.perf_counter()
    x, y = (
        (s - axis[0]) / d
        for s, axis, d in zip((s1, s2), (table.stretch1, table.stretch2), table.steps)
    )
    i = np.minimum(x.astype(int), n - 2)
    j = np.minimum(y.astype(int), n - 2)
    x = x - i
    y = y - j
    read = lambda c: c[:, 0] + c[:, 1] * x + c[:, 2] * y + c[:, 3] * x * y  # noqa: E731
    T1 = read(table.tension1[i, j])
    reading = time.perf_counter() - solved
    safe = unfailed(model, exact)
    pairs = zip(
        (T1, read(table.tension2[i, j])), (exact["T1"], exact["T2"]), model.fabric.weave.yarns
    )
    error = max(abs(T - given)[safe].max() / yarn.strength for T, given, yarn in pairs)
    return {"largest error over strength": error, "speed-up": (solved - begun) / reading}


def cell_along(path: Any, fabric: str, law: CompressionLaw | None = None) -> Values:
    """Follow a warp extension of the crossover with the cell and its published law, or another:
    largest differences of the tensions over their peaks, and of the energy from the work of the
    ends, 2 T1 dd1, over that at the end."""
    given = changed_fabrics.load(fabric)
    d = path["d1"]
    T = path["T1"]
    laws = None
    if law is not None:
        laws = (law, law)
    cell = CellModel(given, laws).solve(1 + d / given.weave.w1, 1.0)
    work = np.concatenate([[0], np.cumsum(np.diff(d) * (T[1:] + T[:-1]))])
    return {
        "warp": largest(cell["T1"] - T) / T.max(),
        "weft": largest(cell["T2"] - path["T2"]) / path["T2"].max(),
        "energy": largest(cell["W"] - work) / work.max(),
    }


def centreline_error(path: Any, fabric: str, centreline: str, own_law: bool) -> float:
    """Compute the RMS of both tensions of a cell less those of the 3D crossover, over the strengths,
    along a path of the crossover up to its strength; with the published law, or a and b fitted to
    the path (`own_law`)."""
    given = changed_fabrics.load(fabric)
    model = CellModel(given, cell_formulation="equilibrium", centreline=centreline)
    strength = np.array([yarn.strength for yarn in given.weave.yarns])
    load = np.stack([path["T1"], path["T2"]], axis=1)
    strain = np.stack([path[key] / w for key, w in zip(("d1", "d2"), given.weave.w)], axis=1)
    sound = (load <= strength).all(axis=1)
    test = BiaxialTest("3D crossover", strain[sound], load[sound])
    if own_law:
        model = biaxial_fit.fit(model, [test], with_profiles=False).model
    return rms((biaxial_fit.loads_of(model, test) - test.load) / strength)


def cell_error(path: Any, fabric: str) -> float:
    """Compute the RMS of both tensions of the cell less those of the 3D crossover, over the
    strengths, along a path of the crossover up to the cell's first failure."""
    given = changed_fabrics.load(fabric)
    cell = CellModel(given, cell_formulation="equilibrium")
    stretches = [1 + path[key] / w for key, w in zip(("d1", "d2"), given.weave.w)]
    found = cell.solve(*stretches)
    errors = []
    sound = True
    for key, yarn in zip(("T1", "T2"), given.weave.yarns):
        sound = sound & (found[key] <= yarn.strength)
        errors.append((found[key] - path[key]) / yarn.strength)
    return rms(np.array(errors)[:, sound])


def off_cosine(line: Any) -> float:
    """Compute the RMS distance of a deformed centreline from the cosine of its height and length,
    over the height."""
    x, z = line
    h = z[0] - z[-1]
    return rms(z - z[-1] - h * np.cos(0.5 * np.pi * x / x[-1])) / h
