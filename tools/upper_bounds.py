"""Print the packages that pyproject.toml bounds from above, on one line: tools/package.sh tries the newest of each.

python tools/upper_bounds.py
"""

import re
import tomllib
from pathlib import Path

SETTINGS = Path(__file__).parents[1] / "pyproject.toml"


def bounded() -> list[str]:
    """Return the names of the dependencies with an upper bound."""
    project = tomllib.loads(SETTINGS.read_text("utf-8"))["project"]
    found = []
    for entry in project["dependencies"]:
        name = re.match(r"[\w-]+", entry)
        if name is not None and "<" in entry:
            found.append(name[0])
    return found


if __name__ == "__main__":
    print(" ".join(bounded()))
