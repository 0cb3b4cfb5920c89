"""The program `weavecell`, and `python -m weavecell`."""

from __future__ import annotations

import sys
from typing import NoReturn

from fabrics.base import extras
from fabrics.base.errors import WeavecellError, marked


def main() -> NoReturn:
    """Run the command line, or say what to install if its packages are not there."""
    try:
        with extras.explain_missing():
            from weavecell.cli import app
    except WeavecellError as problem:
        print(marked(problem), file=sys.stderr)
        sys.exit(problem.exit_code)
    app.main()


if __name__ == "__main__":
    main()
