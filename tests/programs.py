"""Code that a test runs in a Python process of its own."""

import subprocess
import sys
from pathlib import Path


def printed(code, *words):
    """What the code prints, which has to come to its end."""
    command = [sys.executable, "-c", code, *map(str, words)]
    root = Path(__file__).parents[1]
    done = subprocess.run(command, cwd=root, capture_output=True, text=True, timeout=3000)
    assert done.returncode == 0, done.stderr[-2000:]
    return done.stdout.strip()
