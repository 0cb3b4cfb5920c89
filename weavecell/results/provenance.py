"""Where a result comes from: versions, commit, machine, threads, date and the scene's text."""

from __future__ import annotations

import os
import platform
import subprocess
import sys
from contextlib import suppress
from datetime import UTC, datetime
from functools import cache
from importlib import metadata
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fabrics import __version__, assumed
from weavecell.results import sources

if TYPE_CHECKING:
    from fabrics.compression import CompressionLaw
    from fabrics.fabric import Fabric
    from shellfabric.impact.setup import ImpactSetup

# modules whose versions results depend on
PACKAGES = (
    "numpy",
    "scipy",
    "numba",
    "dolfinx",
    "petsc4py",
    "gmsh",
    "meshio",
    "h5py",
    "pyvista",
    "vtk",
    "matplotlib",
    "pydantic",
    "typer",
)


def stamp(
    scene_text: str = "", *fabrics: Fabric, setup: ImpactSetup | None = None
) -> dict[str, Any]:
    """Collect what a reader needs to repeat a run, as a flat dict of texts; of fabrics, also those
    of a set-up, which of their tables were assumed, and of a set-up its notes and what a projectile
    from an STL file was.

    Beside the texts stands "sources", a list of (number, status, source) for `weavecell cite`.
    """
    laws: list[CompressionLaw] = []
    if setup is not None:
        fabrics = (*fabrics, *setup.fabrics)
        for ply in setup.lay_up or (setup,):
            laws += ply.laws or ()
    lines = []
    for fabric in fabrics:
        if fabric.assumed or fabric.idealised:
            lines += assumed.lines(fabric)
    known = {}
    if lines:
        known["assumed"] = "; ".join(lines)
    if setup is not None and setup.notes:
        known["notes"] = "; ".join(setup.notes)
    if setup is not None and setup.projectile.solid is not None:
        known["projectile_stl"] = setup.projectile.solid.digest
    return known | {
        "weavecell": __version__,
        "commit": commit(),
        "date": datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC"),
        "python": platform.python_version(),
        "packages": ", ".join(f"{name} {version}" for name, version in versions().items()),
        "system": platform.platform(),
        "processor": f"{processor()}, {os.cpu_count()} cores",
        "threads": threads(),
        "scene": scene_text,
        "sources": sources.list_sources(fabrics, laws, scene_text),
    }


def versions() -> dict[str, str]:
    """List the versions of the installed packages that results can depend on.

    Debian names some distributions otherwise than their makers do, so the version of the module
    that is loaded, where it states one, goes before that of the distribution.
    """
    installed = {}
    for name in PACKAGES:
        distribution = name
        if name == "dolfinx":
            distribution = "fenics-dolfinx"
        version = getattr(sys.modules.get(name), "__version__", None)
        with suppress(metadata.PackageNotFoundError):
            installed[name] = version or metadata.version(distribution)
    return installed


@cache
def commit() -> str:
    """Return the git commit this package was run from, "+ changes" if the tree had been edited;
    "not a checkout" otherwise. It is asked for once a process, which keeps the code that it has
    loaded."""
    # installed from a wheel, the folder may lie inside the checkout of another project
    home = Path(__file__).resolve().parents[1]
    if not (home.parent / ".git").exists():
        return "not a checkout"
    try:
        head = _git(home, "rev-parse", "--short=12", "HEAD")
        changed = _git(home, "status", "--porcelain", "--untracked-files=no")
    except (OSError, subprocess.CalledProcessError, subprocess.TimeoutExpired):
        return "not a checkout"
    if changed:
        head += " + changes"
    return head


def threads() -> str:
    """Say how many threads the numerical libraries may use."""
    text = f"OMP_NUM_THREADS {os.environ.get('OMP_NUM_THREADS', 'unset')}"
    if "numba" in sys.modules:
        text += f", numba {sys.modules['numba'].get_num_threads()}"
    return text


def _git(folder, *words):
    return subprocess.run(
        ["git", "-C", str(folder), *words], check=True, capture_output=True, text=True, timeout=5
    ).stdout.strip()


def processor() -> str:
    """Return the processor's name."""
    # only Linux needs the file: there `platform.processor` knows the architecture at best
    with suppress(OSError):
        for line in Path("/proc/cpuinfo").read_text().splitlines():
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    return platform.processor() or platform.machine()
