"""Programs that hold the models against the thesis, against tests and against themselves.

    python -m validation claims          the ledger of the thesis's claims
    python -m validation cost-accuracy   CPU time against error of every method
    python -m validation crossover       the same of the 3D crossover, by all its choices
    python -m validation stability       maps of where each method fails
    python -m validation calibration     the compression laws of the catalogue, or its whole calibration chain
    python -m validation scatter         a study of scatter put into a page
    python -m validation measured        what was measured against what is computed: bias, scatter, u_val

Each has --help. Others are modules of their own: python -m validation.published.one_ply, ...
"""

from __future__ import annotations

import sys

from validation.commands import calibration, claims, cost_accuracy, crossover, scatter, stability
from validation.measured import command as measured
from validation.program import program
from weavecell.results import out_folder

PROGRAMS = {
    "claims": claims, "cost-accuracy": cost_accuracy, "crossover": crossover, "stability": stability,
    "calibration": calibration, "scatter": scatter, "measured": measured,
}  # fmt: skip


def main(arguments: list[str]) -> None:
    """Run the program that the first argument names."""
    if not arguments or arguments[0] not in PROGRAMS:
        sys.exit(__doc__)
    module = PROGRAMS[arguments[0]]
    try:
        program(module.main, arguments, **getattr(module, "NOTES", {}))
    finally:
        out_folder.release()


if __name__ == "__main__":
    main(sys.argv[1:])
