"""Print the lowest versions that pyproject.toml allows, a line a package, as pip takes them for constraints.

python tools/lower_bounds.py > lowest.txt && pip install -c lowest.txt ".[app]"
"""

import re
import tomllib
from pathlib import Path

GROUPS = ("app",)
# PyPI has no wheel of the 3.7 of Debian 12 for Python 3.11
LOWEST_AT_PYPI = {"h5py": "3.8"}
SETTINGS = Path(__file__).parents[1] / "pyproject.toml"


def lines() -> list[str]:
    """Return the lines of what a user installs: the dependencies, and the groups in GROUPS.

    Raises
    ------
    ValueError : an entry without a lower bound
    """
    project = tomllib.loads(SETTINGS.read_text("utf-8"))["project"]
    needed = [*project["dependencies"]]
    for group in GROUPS:
        needed += project["optional-dependencies"][group]
    found = []
    for entry in needed:
        bound = re.fullmatch(r"([\w-]+)>=([\d.]+)(?:,<[\d.]+)?", entry)
        if bound is None:
            raise ValueError(f"{entry} has no lower bound of the form name>=version")
        found.append(f"{bound[1]}=={LOWEST_AT_PYPI.get(bound[1], bound[2])}")
    return found


if __name__ == "__main__":
    print("\n".join(lines()))
