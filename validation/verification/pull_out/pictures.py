"""Picture of the study."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from fabrics.files import replace_whole
from meshing.pictures_style import COLOURS, INK, WARP, WEFT, plots
from validation.verification.pull_out.study import LAW, law
from validation.verification.pull_out.study import WEFT as OF_WEFT


def chart(found: dict[str, Any], path: Path) -> None:
    """Axial force against the pull of the warp, and the thresholds of both yarns."""
    with plots() as pyplot:
        figure = compose(pyplot, found)
        with replace_whole(path) as beside:
            figure.savefig(beside, format="png", dpi=130)


def compose(pyplot: Any, found: dict[str, Any]) -> Any:
    """The figure of `chart`."""
    figure, (left, right) = pyplot.subplots(1, 2, figsize=(10.4, 4.4))
    of = found["law"]
    for number, (pull, P, force) in enumerate(zip(of["pull"], of["P"], of["force"])):
        colour, mark = COLOURS[number % len(COLOURS)], "os^Dvp"[number % 6]
        left.plot(1e6 * np.array(pull), P, f"{mark}-", color=colour, ms=4, lw=1.6, label=f"{force[-1]:.3g} N")
    left.set(xlabel="pull along the axis [µm]", ylabel="axial force P [N]", title="warp pulled")
    left.legend(title="contact force F$_c$", loc="upper left")
    for name, case, one, colour in (("warp", LAW, of, WARP), ("weft", OF_WEFT, found["weft"], WEFT)):
        right.plot(one["F_c"], one["T_f"], "o", color=colour, label=f"{name} pulled")
        if len(one["F_c"]) > 1:
            fine = np.array([0.0, max(one["F_c"])])
            right.plot(fine, law(case, one).threshold(fine), color=colour, lw=1.2)
    far = max(of["F_c"], default=1.0)
    right.plot([0, far], [0, LAW.friction * far], ls="--", color=INK, lw=1, label=f"{LAW.friction:g} F$_c$")
    right.set(xlabel="contact force F$_c$ [N]", ylabel="slip threshold T$_f$ [N]", title="threshold")
    right.legend()
    return figure
