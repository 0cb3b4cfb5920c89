"""The 3D crossover against the shell's cell and against what the source says of it (chapter 3, section 4.3.4)."""

from __future__ import annotations

import numpy as np

from fabrics import catalogue
from shellfabric.cell.model import CellModel
from validation.claims.checks.solids import fitted, paths
from validation.claims.registry import check
from validation.claims.run import Run


@check(lambda fabric: {"path": Run.of("stretched", fabric=fabric, ratio=(1.0, 0.0))})
def monotone(path, fabric):
    drops = [float(np.max(np.maximum.accumulate(path[T]) - path[T]) / path[T].max()) for T in ("T1", "T2")]
    return {"largest drop over peak": max(drops), "note": path["failed"]}


@check(paths)
def tension_of_both(warp, weft, equibiaxial, fabric):
    """Tensions of the cell with the law fitted to the crossover's paths, against the crossover's; weft held."""
    law = fitted(warp, weft, equibiaxial)
    off = {}
    for name, laws in (("fitted", (law, law)), ("published", None)):
        cell = CellModel(catalogue.load(fabric), laws).solve(1 + warp["d1"] / catalogue.load(fabric).weave.w1, 1.0)
        off[name] = [float(np.abs(cell[T] - warp[T]).max() / warp[T].max()) for T in ("T1", "T2")]
    return {
        "warp": off["fitted"][0],
        "weft": off["fitted"][1],
        "note": "largest differences over the peak; with the "
        f"published law {100 * off['published'][0]:.0f} and {100 * off['published'][1]:.0f} %",
    }


@check(paths)
def energy_of_both(warp, weft, equibiaxial, fabric):
    """Work of the ends of the crossover, 2 T1 dd1, against what the cell stores."""
    law = fitted(warp, weft, equibiaxial)
    d, T = warp["d1"], warp["T1"]
    work = np.concatenate([[0], np.cumsum(np.diff(d) * (T[1:] + T[:-1]))])
    cell = CellModel(catalogue.load(fabric), (law, law)).solve(1 + d / catalogue.load(fabric).weave.w1, 1.0)
    off = np.abs(cell["W"] - work) / work.max()
    return {
        "largest difference over the end": off.max(),
        "note": f"at the end {1e3 * work[-1]:.3f} mJ in the crossover, {1e3 * float(cell['W'][-1]):.3f} mJ in the cell",
    }


def _part(fabric, reach):
    return {"path": Run.of("stretched", fabric=fabric, ratio=(1.0, 0.0), reach=reach)}


@check(_part)
def section_change(path, fabric, reach):
    change = path["thickness_end"] / path["thickness"] - 1
    return {
        "largest change": np.abs(change).max(),
        "note": f"thickness at the crossing: warp {100 * change[0]:+.0f} %, weft {100 * change[1]:+.0f} %",
    }


@check(_part)
def profiles(path, fabric, reach):
    """RMS distance of the deformed centrelines from the cosine of their height and length, over the height."""
    off = []
    for x, z in path["lines"]:
        h = z[0] - z[-1]
        off.append(float(np.sqrt(np.mean((z - z[-1] - h * np.cos(0.5 * np.pi * x / x[-1])) ** 2)) / h))
    return {"warp": off[0], "weft": off[1], "weft over warp": off[1] / off[0]}


@check(lambda fabric: {"brick": Run.of("brick", fabric=fabric, stretch=[1.02, 0.9, 0.85])})
def axial_modulus(brick, fabric):
    """E_1 of the solids' code over E_a V_f (eq. 3-2)."""
    return {"over the rule": brick["stress"] / brick["strain"] / (brick["E_a"] * brick["V_f"])}


@check(lambda fabric: {name: Run.of("lone", fabric=fabric, family=k) for k, name in enumerate(("warp", "weft"))})
def lone_yarns(warp, weft, fabric):
    """Lone yarns in 3D: where the taut line meets no load, and its slope on the strain of the yarn's own length."""
    found = {}
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
def hourglass(loose, barred, fabric):
    """Drops of the pull on a lone yarn: one-point solids without bars, and full integration with bars."""
    drops = [float(np.max(np.maximum.accumulate(run["T"]) - run["T"]) / run["T"].max()) for run in (loose, barred)]
    return {
        "drop without bars": drops[0],
        "drop with bars": drops[1],
        "note": f"nodes alternate by up to {1e6 * loose['astray'].max():.2f} and {1e6 * barred['astray'].max():.2f} um",
    }
