"""Constraints, periodic images, sparsity patterns and linear solver; the differences between versions of dolfinx.

dolfinx 0.5 is loaded here, so that its symbols stay its own. By itself it has the loader show the symbols of its
libraries, and of all that are loaded later, to every library of the process (RTLD_GLOBAL). Parts of the C++ library
that were compiled into it then stand in for those of VTK, whose wheels have the strings of an older compiler: its
regular expressions wrote beyond their strings, and its scale of colours aborted the process.
"""

import sys
from contextlib import suppress

_set_flags = getattr(sys, "setdlopenflags", None)
if _set_flags is not None:
    sys.setdlopenflags = lambda flags: None
    try:
        with suppress(ModuleNotFoundError):
            import dolfinx  # noqa: F401
    finally:
        sys.setdlopenflags = _set_flags
