"""The 3D crossover against the shell's cell and against what the thesis says of it (chapter 3, section 4.3.4)."""

from __future__ import annotations

import numpy as np

from fabrics import catalogue
from shellfabric.cell.model import CellModel
from validation.claims.checks.solids import fitted, paths
from validation.claims.registry import Found, Run, RunResult, check


@check(lambda fabric: {"path": Run.of("stretched", fabric=fabric, ratio=(1.0, 0.0))})
def monotone(path: RunResult, fabric: str) -> Found:
    drops = [float(np.max(np.maximum.accumulate(path[T]) - path[T]) / path[T].max()) for T in ("T1", "T2")]
    return {"largest drop over peak": max(drops), "note": path["failed"]}


def _laws(warp, weft, equibiaxial, law):
    """The compression laws of the cell: "published" ones of the fabric, or one "fitted" to the other two paths."""
    if law == "published":
        return None
    fit = fitted(weft, equibiaxial)  # the path that is compared is not among them
    return fit, fit


def _three(fabric, law):
    return paths(fabric)


@check(_three)
def tension_of_both(warp: RunResult, weft: RunResult, equibiaxial: RunResult, fabric: str, law: str) -> Found:
    """Tensions of the cell against the 3D crossover's, the weft held; largest difference over the peak."""
    given, laws = catalogue.load(fabric), _laws(warp, weft, equibiaxial, law)
    cell = CellModel(given, laws).solve(1 + warp["d1"] / given.weave.w1, 1.0)
    off = [float(np.abs(cell[T] - warp[T]).max() / warp[T].max()) for T in ("T1", "T2")]
    used = given.laws[0] if laws is None else laws[0]
    return {
        "warp": off[0],
        "weft": off[1],
        "note": f"a {1e3 * used.a:.4f} mm, b {1e5 * used.b:.2f} mm uN^(1/3)",
    }


@check(_three)
def energy_of_both(warp: RunResult, weft: RunResult, equibiaxial: RunResult, fabric: str, law: str) -> Found:
    """Work of the ends of the crossover, 2 T1 dd1, against what the cell stores."""
    given = catalogue.load(fabric)
    d, T = warp["d1"], warp["T1"]
    work = np.concatenate([[0], np.cumsum(np.diff(d) * (T[1:] + T[:-1]))])
    cell = CellModel(given, _laws(warp, weft, equibiaxial, law)).solve(1 + d / given.weave.w1, 1.0)
    off = np.abs(cell["W"] - work) / work.max()
    return {
        "largest difference over the end": off.max(),
        "note": f"at the end {1e3 * work[-1]:.3f} mJ in the crossover, {1e3 * float(cell['W'][-1]):.3f} mJ in the cell",
    }


@check(
    lambda fabric: {
        "woven": Run.of("stretched", fabric=fabric, ratio=(1.0, 0.0)),
        "alone": Run.of("lone", fabric=fabric, family=0),
    }
)
def warp_in_weave(woven: RunResult, alone: RunResult, fabric: str) -> Found:
    """Tension of the warp of the 3D crossover, weft held, less that of the lone 3D warp; and the weft's tension."""
    weave = catalogue.load(fabric).weave
    strain = woven["d1"] / weave.w1
    both = (strain > 0) & (strain <= alone["strain"][-1])
    lead = woven["T1"][both] - np.interp(strain[both], alone["strain"], alone["T"])
    before = (strain[both] > 0.1 * weave.warp.crimp) & (strain[both] < weave.warp.crimp)
    ratio = (woven["T2"] / np.maximum(woven["T1"], 1e-12))[both][before]
    return {
        "least lead of the woven yarn over the peak": float(lead.min() / woven["T1"].max()),
        "least lead before it is straight": float(lead[before].min()),
        "least growth of the weft": float(np.diff(woven["T2"]).min()),
        "least of weft over warp": float(ratio.min()),
        "greatest of weft over warp": float(ratio.max()),
        "note": f"{before.sum()} of {both.sum()} load steps before the warp is straight; failed: {woven['failed']}",
    }


@check(paths)
def tension_surface(warp: RunResult, weft: RunResult, equibiaxial: RunResult, fabric: str) -> Found:
    """Slope of the warp tension of the 3D crossover on the weft's displacement, between its three paths.

    Along weft extension with the warp held; and from warp extension with the weft held to extension of both, at the
    same displacement of the warp.
    """
    touching = weft["F_c"][1:] > 0
    along = (np.diff(weft["T1"]) / np.diff(weft["d2"]))[touching]
    d = np.linspace(0.1, 1.0, 40) * min(warp["d1"][-1], equibiaxial["d1"][-1])
    T = [np.interp(d, path["d1"], path["T1"]) for path in (warp, equibiaxial)]
    across = (T[1] - T[0]) / np.interp(d, equibiaxial["d1"], equibiaxial["d2"])
    return {
        "least slope, warp held": float(along.min()),
        "least slope, from weft held to both": float(across.min()),
    }


def _equal_strains(balanced, loose):
    given = {"balanced_path": balanced, "loose_path": loose}
    return {
        name: Run.of(
            "stretched",
            fabric=fabric,
            ratio=[round(w / catalogue.load(fabric).weave.w1, 9) for w in catalogue.load(fabric).weave.w],
        )
        for name, fabric in given.items()
    }


@check(_equal_strains)
def loose_weave(balanced_path: RunResult, loose_path: RunResult, balanced: str, loose: str) -> Found:
    """Differences of the cell with cosine and with straight yarns from the 3D crossover, both yarns strained alike.

    RMS of both tensions over the strengths, along the path of the 3D crossover up to the cell's first failure.
    """
    off = {}
    for name, path in ((balanced, balanced_path), (loose, loose_path)):
        weave = catalogue.load(name).weave
        stretches = [1 + path[d] / w for d, w in zip(("d1", "d2"), weave.w)]
        for profile in ("cosine", "straight"):
            cell = CellModel(catalogue.load(name), form="equilibrium", profile=profile).solve(*stretches)
            parts = [(cell[T] - path[T]) / y.strength for T, y in zip(("T1", "T2"), weave.yarns)]
            sound = np.all([cell[T] <= y.strength for T, y in zip(("T1", "T2"), weave.yarns)], axis=0)
            off[name, profile] = float(np.sqrt(np.mean(np.square(parts)[:, sound])))
    return {
        "loose over balanced": off[loose, "cosine"] / off[balanced, "cosine"],
        "straight over cosine, loose": off[loose, "straight"] / off[loose, "cosine"],
        "note": "; ".join(f"{name}, {profile}: {100 * value:.1f} %" for (name, profile), value in off.items()),
    }


def _part(fabric, reach):
    return {"path": Run.of("stretched", fabric=fabric, ratio=(1.0, 0.0), reach=reach)}


@check(_part)
def section_change(path: RunResult, fabric: str, reach: float) -> Found:
    change = path["thickness_end"] / path["thickness"] - 1
    return {
        "largest change": np.abs(change).max(),
        "note": f"thickness at the crossing: warp {100 * change[0]:+.0f} %, weft {100 * change[1]:+.0f} %",
    }


@check(_part)
def profiles(path: RunResult, fabric: str, reach: float) -> Found:
    """RMS distance of the deformed centrelines from the cosine of their height and length, over the height."""
    off = []
    for x, z in path["lines"]:
        h = z[0] - z[-1]
        off.append(float(np.sqrt(np.mean((z - z[-1] - h * np.cos(0.5 * np.pi * x / x[-1])) ** 2)) / h))
    return {"warp": off[0], "weft": off[1], "weft over warp": off[1] / off[0]}


@check(lambda fabric: {"brick": Run.of("brick", fabric=fabric, stretch=[1.02, 0.9, 0.85])})
def axial_modulus(brick: RunResult, fabric: str) -> Found:
    """E_1 of the solids' code over E_a V_f (eq. 3-2)."""
    return {"over the rule": brick["stress"] / brick["strain"] / (brick["E_a"] * brick["V_f"])}


@check(lambda fabric: {name: Run.of("lone", fabric=fabric, family=k) for k, name in enumerate(("warp", "weft"))})
def lone_yarns(warp: RunResult, weft: RunResult, fabric: str) -> Found:
    """Lone yarns in 3D: where the taut line meets no load, and its slope on the strain of the yarn's own length."""
    found: Found = {}
    for (name, run), yarn in zip((("warp", warp), ("weft", weft)), catalogue.load(fabric).weave.yarns):
        taut = run["T"] > 0.2 * run["T"][-1]
        slope, start = np.polyfit(run["strain"][taut], run["T"][taut], 1)
        slack = run["strain"] < 0.8 * yarn.crimp
        found |= {
            f"knee {name}": -start / slope,
            f"stiffness {name}": slope * (1 + yarn.crimp),
            f"slack load {name}, over strength": run["T"][slack].max() / yarn.strength,
        }
    return found | {"order": sorted(("warp", "weft"), key=lambda name: found[f"knee {name}"])}


@check(
    lambda fabric: {
        "loose": Run.of("lone", fabric=fabric, family=0, bars=0, one_point=True),
        "barred": Run.of("lone", fabric=fabric, family=0),
    }
)
def hourglass(loose: RunResult, barred: RunResult, fabric: str) -> Found:
    """Drops of the pull on a lone yarn: one-point solids without bars, and full integration with bars."""
    drops = [float(np.max(np.maximum.accumulate(run["T"]) - run["T"]) / run["T"].max()) for run in (loose, barred)]
    return {
        "drop without bars": drops[0],
        "drop with bars": drops[1],
        "note": f"nodes alternate by up to {1e6 * loose['astray'].max():.2f} and {1e6 * barred['astray'].max():.2f} um",
    }
