"""Picture of the study."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

from fabrics.files import replace_whole
from meshing.pictures_style import INK, WARP, WEFT
from validation.verification.pull_out.study import LAW, law
from validation.verification.pull_out.study import WEFT as OF_WEFT


def chart(found: dict[str, Any], path: Path) -> None:
    """Axial force against the pull of the warp, and the thresholds of both yarns."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(10.4, 4.4), layout="constrained")
    of = found["law"]
    for pull, P, force in zip(of["pull"], of["P"], of["force"]):
        left.plot(1e6 * np.array(pull), P, "o-", ms=3, label=f"F$_c$ {force[-1]:.3g} N")
    left.set(xlabel="pull along the axis [µm]", ylabel="axial force P [N]", title="warp pulled")
    left.legend(frameon=False)
    for name, case, one, colour in (("warp", LAW, of, WARP), ("weft", OF_WEFT, found["weft"], WEFT)):
        right.plot(one["F_c"], one["T_f"], "o", color=colour, label=f"{name} pulled")
        if len(one["F_c"]) > 1:
            fine = np.array([0.0, max(one["F_c"])])
            right.plot(fine, law(case, one).threshold(fine), color=colour, lw=1.2)
    far = max(of["F_c"], default=1.0)
    right.plot([0, far], [0, LAW.friction * far], ls="--", color=INK, lw=1, label=f"{LAW.friction:g} F$_c$")
    right.set(xlabel="contact force F$_c$ [N]", ylabel="slip threshold T$_f$ [N]")
    right.legend(frameon=False)
    with replace_whole(path) as beside:
        figure.savefig(beside, format="png", dpi=130)
    plt.close(figure)
