"""Programs that hold the models against the thesis, against tests and against themselves.

    python -m validation study      studies of validation/studies: what they vary and read off (`validation.study`)
    python -m validation claims     the ledger of the thesis's claims
    python -m validation stale      which CSVs of studies the code no longer computes (`validation.stale`)
    python -m validation patch      whether crossovers may be pinned for a nose, by woven solid yarns
    python -m validation measured   what was measured against what is computed: bias, scatter, u_val
    python -m validation scored     each test of a ply or pack against drawn shots: rank, CRPS, Brier

Each has --help.
"""

from __future__ import annotations

import sys

from validation import patch, runner, stale
from validation.claims import command as claims
from validation.measured import command as measured
from validation.measured import scored
from validation.program import program
from weavecell.results import out_folder, termination

PROGRAMS = {
    "study": runner,
    "stale": stale,
    "claims": claims,
    "measured": measured,
    "scored": scored,
    "patch": patch,
}


def main(arguments: list[str]) -> None:
    """Run the program that the first argument names."""
    if not arguments or arguments[0] not in PROGRAMS:
        sys.exit(__doc__)
    module = PROGRAMS[arguments[0]]
    try:
        with termination.interrupt_on_sigterm():
            program(module.main, arguments, **getattr(module, "NOTES", {}))
    finally:
        out_folder.release()


if __name__ == "__main__":
    main(sys.argv[1:])
