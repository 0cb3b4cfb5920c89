"""Files of our packages, which a wheel has to hold."""

import subprocess
import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[2]
SETTINGS = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))
PACKAGES = [
    pattern.rstrip("*") for pattern in SETTINGS["tool"]["setuptools"]["packages"]["find"]["include"]
]


def files():
    """Those that git tracks, or all but caches where this is no checkout."""
    options = ["ls-files", "--cached", "--others", "--exclude-standard", "--"]
    command = ["git", "-C", str(ROOT), *options, *PACKAGES]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode == 0 and done.stdout:
        return sorted(Path(line) for line in done.stdout.splitlines() if (ROOT / line).is_file())
    found = [path for package in PACKAGES for path in (ROOT / package).rglob("*") if path.is_file()]
    return sorted(path.relative_to(ROOT) for path in found if "__pycache__" not in path.parts)


FILES = files()
