"""The HTML report: chapters, pictures, tables, printed pages."""

import logging
import os
from contextlib import suppress

# pictures are drawn without a window: a backend that is none, with which matplotlib cannot be
# loaded, decides nothing here
if "MPLBACKEND" in os.environ:
    with suppress(ImportError):
        try:
            import matplotlib  # noqa: F401
        except ValueError:
            _name = os.environ.pop("MPLBACKEND")
            _line = f"MPLBACKEND = {_name!r} is no backend of matplotlib: left out"
            logging.getLogger("weavecell").warning(_line)
