"""docs/reports/pull-out.md: the method, the law, and what it depends on."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from fabrics.friction.pull_out import FRICTION, FRICTION_RANGE, FRICTION_SOURCE, FRICTION_STATUS
from unitcell3d.cases.pull_out import SLIDING
from validation.verification.pull_out.study import LAW, PLATENS, WEFT, law
from weavecell.report.marked_page import markdown

BEGIN, END = "<!-- further runs -->\n", "<!-- end of further runs -->"


def page(found: dict[str, Any], without: Sequence[str] = (), further: str = "", run: str = "") -> str:
    """The page in Markdown, from the results of `study.gather`.

    Parameters
    ----------
    found : of `study.gather`
    without : choices that were left out
    further : text between the marks of the section that `--further` makes
    run : line of `validation.commits.computed`
    """
    left_out = f"\nNot run: {', '.join(without)}.\n" if without else ""
    dependences = variants(found["variants"]) + left_out
    return "\n".join([
        _TITLE, run, _HEAD, thresholds(found), summary(found), _FIGURE, _VARIANTS, dependences, cost(found),
        f"\n## Finer mesh, and platens\n\n{BEGIN}{further}{END}", _LIMITS,
    ])  # fmt: skip


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
    cases = {"warp": (LAW, "law"), "weft": (WEFT, "weft")}
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


_TITLE = """# Pull-out through the 3D crossover

*At which axial force does a yarn slip through a crossover, and what does this force depend on?*
"""
_HEAD = f"""
Not to be edited by hand. One path on the command line:

```
weavecell crossover S-720 --case pull-out --mu 0.2 --mesh coarse --law results/calibrate-S-720/law.json
```

**Model.** A whole crossover. The crossing yarn is stretched by its end displacement, which presses the yarns together;
it is held by the fabric at its ends, along its width too. With `--pressure "1 MPa,2 MPa"` two platens without friction
press the yarns together instead, which compresses their cross-sections; they are then held at their distance. The other
yarn is then moved along its axis, from sticking into full sliding, at that end displacement or distance. Its ends
follow the glide plane of the plain weave, which one yarn pulled through all others keeps: the crimp can travel along it
(`unitcell3d/model/pull_out.py`).

**Threshold.** P is the axial force that the yarn takes from the crossing yarn, the difference of the tensions at its
ends. The threshold T_f is P where {100 * SLIDING:g} % of Coulomb's limit is mobilised over the contact; F_c is the
vertical contact force at that state. Fitted is T_f = c0 + mu_eff F_c. With `--law` the fit is written to the law.json
of a calibration as its group `pull_out`, which `fabrics.friction.pull_out.PullOutLaw` reads.

**Coefficient.** {FRICTION:g} if none is given; range {FRICTION_RANGE[0]:g} to {FRICTION_RANGE[1]:g}, status
{FRICTION_STATUS} ({FRICTION_SOURCE}).

**Regularisation.** Friction sets in over a slip of 0.5 µm; where a point stuck is taken over from one state to the
next.

## The law

S-720, coefficient {FRICTION:g}, coarse mesh (8 x 6 x 2 hexahedra a quarter yarn).
"""

_FIGURE = """
![Axial force against the pull, and the thresholds against the contact force](figures/pull-out.png)
"""

_VARIANTS = """
## Sensitivity

The warp pulled at the largest transverse load, one choice changed at a time. Change: of T_f / F_c.
"""

_LIMITS = """
## Limitations

- The end displacement of the crossing yarn or the distance of the platens is held, not the force: F_c changes during
  the pull, and is taken at the threshold itself.
- Neighbouring crossings of the pulled yarn slide together, as on the plateau of a pull-out test. Its front, where some
  crossings stick, is computed by the panel.
- Coulomb's coefficient does not depend on pressure, velocity or finish.
"""
