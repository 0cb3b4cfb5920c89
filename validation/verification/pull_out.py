"""python -m validation.verification.pull_out [--out results/pull-out] [--page docs/reports/pull-out.md] [--further]

Solves the paths of the study, each kept in the folder as soon as it is done. With --page the page is written, and its
picture into figures/ beside it. --without leaves choices of the table of dependences out. With --further only the finer
mesh and the platens are computed, and put between their marks into the page.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from fabrics import catalogue, run_cache
from fabrics.friction.pull_out import FRICTION, FRICTION_RANGE, PullOutLaw
from meshing import crossover
from meshing.pictures_style import COLOURS, INK, WARP, WEFT
from unitcell3d.cases import pull_out
from unitcell3d.model.crossover import Numerics
from validation.marked_page import markdown
from validation.program import marks, program, publish, publish_all, save
from validation.verification.study import known
from weavecell.results import provenance


@dataclass(frozen=True)
class Case:
    """One run.

    Parameters
    ----------
    fabric : name
    pulled : 0 pulls the warp, 1 the weft
    friction : [-] Coulomb's coefficient
    size : hexahedra along, across and through a quarter of each yarn
    loads : of the largest end displacement of the crossing yarn
    rows : states along the pull
    slip : [m] over which friction sets in
    pressures : [Pa] of platens, in place of the end displacements; () for none
    """

    fabric: str = "S-720"
    pulled: int = 0
    friction: float = FRICTION
    size: tuple[int, int, int] = (8, 6, 2)
    loads: tuple[float, ...] = (1.0,)
    rows: int = pull_out.ROWS
    slip: float = Numerics.slip
    pressures: tuple[float, ...] = ()


BASE = Case()
LAW = replace(BASE, loads=pull_out.LOADS)
WEFT_PULLED = replace(LAW, pulled=1, loads=(0.5, 1.0))
PLATENS = replace(BASE, loads=(), pressures=(1e6, 2e6, 4e6))
FRICTIONLESS = replace(BASE, friction=0.0)
FINER = replace(BASE, size=(10, 8, 3))
VARIANTS: dict[str, Case] = {
    f"friction {FRICTION_RANGE[0]:g}": replace(BASE, friction=FRICTION_RANGE[0]),
    f"friction {FRICTION_RANGE[1]:g}": replace(BASE, friction=FRICTION_RANGE[1]),
    "coarser mesh, 6 x 4 x 2": replace(BASE, size=(6, 4, 2)),
    "half the load step": replace(BASE, rows=2 * BASE.rows),
    "half the regularisation slip": replace(BASE, slip=0.5 * BASE.slip),
}


FURTHER: dict[str, Case] = {"as it stands": BASE, "finer mesh, 10 x 8 x 3": FINER, "between platens": PLATENS}


def run(case: Case) -> dict[str, Any]:
    """One run: a dict of numbers and lists, for a file."""
    fabric = catalogue.load(case.fabric)
    largest = pull_out.displacements(fabric, case.pulled)[-1] / pull_out.LOADS[-1]
    built = crossover.build(fabric, domain="whole", size=case.size)
    numerics = Numerics(friction=case.friction, slip=case.slip)
    record = pull_out.pull_out(
        built, fabric, [share * largest for share in case.loads], pressures=case.pressures, pulled=case.pulled,
        numerics=numerics, rows=case.rows,
    )  # fmt: skip
    F_c, T_f = pull_out.thresholds(record)
    paths = [record["load"] == number for number in np.unique(record["load"])]
    return {
        "F_c": F_c.tolist(),
        "T_f": T_f.tolist(),
        "geometric": [float(np.abs(record["P_geometric"][of]).max()) for of in paths],
        "mobilised": [float(record["mobilised"][of].max()) for of in paths],
        "pull": [record["pull"][of].tolist() for of in paths],
        "P": [record["P"][of].tolist() for of in paths],
        "force": [record["F_c"][of].tolist() for of in paths],
        "iterations": int(record["iterations"].sum()),
        "states": len(record["path"]),
        "seconds": float(record["seconds"].sum()),
        "failed": record.failed,
    }


def law(case: Case, found: dict[str, Any]) -> PullOutLaw:
    """The law fitted to a run."""
    return PullOutLaw.fit(found["F_c"], found["T_f"], friction=case.friction)


def gather(runs: Callable[[Case], dict[str, Any]]) -> dict[str, Any]:
    """All results of the study."""
    whole = runs(LAW)
    last = {key: whole[key][-1:] for key in ("F_c", "T_f", "mobilised", "pull")}
    return {
        "law": whole,
        "weft": runs(WEFT_PULLED),
        "frictionless": runs(FRICTIONLESS),
        "variants": {"as it stands": whole | last} | {name: runs(case) for name, case in VARIANTS.items()},
    }


BEGIN, END = "<!-- further runs -->\n", "<!-- end of further runs -->"


def section(found: dict[str, dict[str, Any]], commit: str) -> str:
    """Finer mesh and platens: a row a transverse load, and the law of the platens; from {name: results} of FURTHER."""
    rows, first = [], None
    for name, of in found.items():
        for F_c, T_f, normal in zip(of["F_c"], of["T_f"], of["geometric"]):
            first = first or T_f / F_c
            change = f"{100 * (T_f / F_c / first - 1):+.2f} %"
            rows.append([name, f"{F_c:.2f}", f"{T_f:.3f}", f"{T_f / F_c:.4f}", change, f"{normal:.3f}"])
        if not of["F_c"] or of["failed"]:
            rows.append([name, "-", "-", "-", "-", of["failed"] or "does not slide"])
    text = (
        "The warp pulled, at the largest end displacement of the weft, and between platens with the weft's ends held\n"
        "(before the pull 1, 2 and 4 MPa on the area of the cell). Change: of T_f / F_c, against the first row.\n"
        f"Computed at commit {commit} by `python -m validation.verification.pull_out --further --page "
        "docs/reports/pull-out.md`.\n\n"
    )
    head = ["", "F_c, N", "T_f, N", "T_f / F_c", "change", "largest P of normal pressures, N"]
    text += markdown([head, *rows], numbers=True).rstrip("\n")
    of = found["between platens"]
    if len(of["F_c"]) > 1:
        fitted = law(PLATENS, of)
        text += f"\nBetween platens c0 = {fitted.c0:.3f} N and mu_eff = {fitted.mu_eff:.4f}.\n"
    seconds = sum(of["seconds"] for of in found.values())
    return text + f"\nThese runs took {seconds / 60:.1f} minutes of one core.\n"


def _laws(found):
    """(what is pulled, Case, results) of the runs that give a law."""
    cases = {"warp": (LAW, "law"), "weft": (WEFT_PULLED, "weft")}
    return [(name, case, found[key]) for name, (case, key) in cases.items()]


def thresholds(found: dict[str, Any]) -> str:
    """One row a transverse load."""
    rows = []
    for name, case, of in _laws(found):
        if len(of["F_c"]) < 2:
            rows.append([name, "-", "-", "-", "-", of["failed"] or "does not slide"])
            continue
        fitted = law(case, of)
        for F_c, T_f, normal in zip(of["F_c"], of["T_f"], of["geometric"]):
            off = T_f - float(fitted.threshold(F_c))
            rows.append([name, f"{F_c:.2f}", f"{T_f:.3f}", f"{T_f / F_c:.4f}", f"{normal:.3f}", f"{1e3 * off:+.1f}"])
    head = ["pulled", "F_c, N", "T_f, N", "T_f / F_c", "largest P of normal pressures, N", "T_f less the fit, mN"]
    return markdown([head, *rows], numbers=True)


def summary(found: dict[str, Any]) -> str:
    """The fitted laws, and the path without friction."""
    texts = []
    for name, case, of in _laws(found):
        if len(of["F_c"]) < 2:
            continue
        fitted = law(case, of)
        texts.append(
            f"- {name} pulled: c0 = {fitted.c0:.3f} N, mu_eff = {fitted.mu_eff:.4f} at a coefficient of "
            f"{case.friction:g}; rms of the fit {1e3 * (fitted.residual_rms or 0):.1f} mN."
        )
    free = found["frictionless"]
    largest = max(map(abs, free["P"][0]))
    texts.append(
        f"- without friction the axial force stays below {largest:.3f} N at a contact force of {free['F_c'][0]:.1f} N: "
        "the resistance of\n  the crimp alone, to which the c0 of the fits, the threshold without contact force, "
        "corresponds."
    )
    return "\n".join(texts)


def variants(found: dict[str, dict[str, Any]]) -> str:
    """One row a choice."""
    rows, first = [], None
    for name, of in found.items():
        if not of["F_c"]:
            rows.append([name, "-", "-", "-", "-", f"{of['mobilised'][0]:.3f}", f"{of['iterations']}"])
            continue
        ratio = of["T_f"][0] / of["F_c"][0]
        first = first or ratio
        rows.append([
            name, f"{of['F_c'][0]:.2f}", f"{of['T_f'][0]:.3f}", f"{ratio:.4f}", f"{100 * (ratio / first - 1):+.2f} %",
            f"{of['mobilised'][0]:.3f}", f"{of['iterations'] / of['states']:.1f}",
        ])  # fmt: skip
    head = ["", "F_c, N", "T_f, N", "T_f / F_c", "change", "largest share of Coulomb's limit", "tangents a state"]
    return markdown([head, *rows], numbers=True)


def cost(found: dict[str, Any]) -> str:
    """What the runs took."""
    others = list(found["variants"].values())[1:]  # the first is of the law
    all_runs = [*(found[key] for key in ("law", "weft", "frictionless")), *others]
    longest = max(max(of["seconds"] / len(of["pull"]) for of in all_runs), 0.0)
    ended = [of["failed"] for of in all_runs if of["failed"]]
    text = (
        f"All runs took {np.sum([of['seconds'] for of in all_runs]) / 60:.1f} minutes of one core, the longest path "
        f"{longest:.0f} s."
    )
    return text + (f" Ended early: {'; '.join(ended)}." if ended else " Newton's method converged at every state.")


def chart(pyplot: Any, found: dict[str, Any]) -> Any:
    """Axial force against the pull of the warp, and the thresholds of both yarns."""
    figure, (left, right) = pyplot.subplots(1, 2, figsize=(10.4, 4.4))
    of = found["law"]
    for number, (pull, P, force) in enumerate(zip(of["pull"], of["P"], of["force"])):
        colour, mark = COLOURS[number % len(COLOURS)], "os^Dvp"[number % 6]
        left.plot(1e6 * np.array(pull), P, f"{mark}-", color=colour, ms=4, lw=1.6, label=f"{force[-1]:.3g} N")
    left.set(xlabel="pull along the axis [µm]", ylabel="axial force P [N]", title="warp pulled")
    left.legend(title="contact force F$_c$", loc="upper left")
    for name, case, one, colour in (("warp", LAW, of, WARP), ("weft", WEFT_PULLED, found["weft"], WEFT)):
        right.plot(one["F_c"], one["T_f"], "o", color=colour, label=f"{name} pulled")
        if len(one["F_c"]) > 1:
            fine = np.array([0.0, max(one["F_c"])])
            right.plot(fine, law(case, one).threshold(fine), color=colour, lw=1.2)
    far = max(of["F_c"], default=1.0)
    right.plot([0, far], [0, LAW.friction * far], ls="--", color=INK, lw=1, label=f"{LAW.friction:g} F$_c$")
    right.set(xlabel="contact force F$_c$ [N]", ylabel="slip threshold T$_f$ [N]", title="threshold")
    right.legend()
    return figure


def main(
    *,
    out: Path = Path("results/pull-out"),
    page: Path | None = None,
    without: Sequence[str] = (),
    further: bool = False,
) -> None:
    for name in without:
        known("--without", name, tuple(VARIANTS))
        del VARIANTS[name]
    stamp, module = provenance.stamp(), "validation.verification.pull_out"

    def runs(case):
        [found] = run_cache.results(run, [(case,)], folder=out / "runs")
        print(case, found["T_f"], f"{found['seconds']:.0f} s", flush=True)
        return found

    if further:
        text = section({name: runs(case) for name, case in FURTHER.items()}, stamp["commit"])
        publish(text, page, marks("further runs", module))
        return
    found = gather(runs)
    save(chart, found, to=(page.parent / "figures" if page else out) / "pull-out.png", dpi=130)
    left_out = f"Not run: {', '.join(without)}.\n\n" if without else ""
    texts = {"law": f"{thresholds(found)}\n{summary(found)}\n",
             "sensitivity": f"{variants(found['variants'])}\n{left_out}{cost(found)}\n"}  # fmt: skip
    publish_all(texts, page, module, stamp)


if __name__ == "__main__":
    program(
        main, without="choices of the table of dependences to leave out", further="only the finer mesh and the platens"
    )
