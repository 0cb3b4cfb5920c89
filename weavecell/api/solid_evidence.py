"""What the solid of a yarn is fitted to: a curve between platens, biaxial tests."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fabrics.base import run_cache
from fabrics.base.checks import FilePath
from fabrics.base.counted import counted
from fabrics.base.door import option
from fabrics.base.errors import InputError, UnstableError, placed
from fabrics.fabric import Fabric
from fabrics.plate_curve import PlateCurve
from weavecell.results import progress

if TYPE_CHECKING:
    from fabrics.surface import ResponseSurface
    from unitcell3d.identify.biaxial_states import PulledTest
    from unitcell3d.identify.solid_record import SolidFit

# a fit of the solid takes about so many trials; the progress bar needs a number
TRIALS = 20
# of the surface of a fitted solid: so few lines are closer to the crossover than the law of a finer mesh
SURFACE_LINES = 5


@dataclass(frozen=True, eq=False)
class Evidence:
    """What the solid is fitted to.

    Parameters
    ----------
    curve : PlateCurve, or None
    tests : of biaxial_states.PulledTest
    fitted : names of those that are fitted; all if empty
    free : constants that are fitted
    """

    curve: PlateCurve | None
    tests: tuple[PulledTest, ...] = ()
    fitted: tuple[str, ...] = ()
    free: tuple[str, ...] = ("E_c", "V_c", "K_r")


def read_evidence(
    fabric: Fabric,
    platen_curve: FilePath | None,
    biaxial: FilePath,
    fitted: Sequence[str] | None,
    constants: str | None,
) -> Evidence:
    """Return the Evidence of a file of biaxial tests, and of a platen curve if there is one."""
    from unitcell3d.identify.solid_record import NAMES as SOLID
    from weavecell.studies import biaxial_tests, solid_tests

    tests = biaxial_tests.read(biaxial, fabric.weave.yarn_spacing)
    chosen = tuple(fitted or ())
    known = [test.name for test in tests]
    for name in chosen:
        if name not in known:
            allowed = f"a test of {biaxial}: {', '.join(known)}"
            raise InputError(key="fitted", value=name, allowed=allowed)
    free: tuple[str, ...] = SOLID
    if constants is not None:
        free = tuple(dict.fromkeys(part.strip() for part in constants.split(",")))
    for name in free:
        if name not in SOLID:
            allowed = f"of {', '.join(SOLID)}, which are the solid's"
            raise InputError(key="constants", value=name, allowed=allowed)
    curve = None if platen_curve is None else PlateCurve.read(platen_curve)
    with placed(biaxial):
        return Evidence(curve, solid_tests.take_tests(tests, chosen), chosen, free)


def curve_of(fabric: Fabric, path: FilePath | None) -> PlateCurve:
    """Read the plate curve of a file, or without one take the pressure law at the fabric's measured
    areal density.

    Raises
    ------
    InputError : a bad file, or no measured areal density
    """
    if path is not None:
        return PlateCurve.read(path)
    if fabric.areal_density_measured is None:
        needs = f"has no areal_density_measured, which the pressure law needs: give {option('platen_curve', '')}"
        raise InputError(f"fabric {fabric.name} {needs}")
    return PlateCurve.pressure_law(fabric.areal_density_measured)


def fit_to_evidence(fabric: Fabric, evidence: Evidence, runs: Path) -> SolidFit:
    """Return the SolidFit of what was measured; an earlier run's if it is kept."""
    from unitcell3d.identify import solid_fit

    kept = run_cache.RunCache(runs)
    given: dict[str, Any] = {
        "tests": evidence.tests,
        "fitted": evidence.fitted,
        "free": evidence.free,
    }
    key = run_cache.key(("fit", fabric, evidence.curve, given), solid_fit.fit_solid.__module__)
    # the fit takes minutes: an interrupted calibration goes on behind it
    if key not in kept:
        with progress.bar(f"Solid of {fabric.name} from tests") as advance:
            kept[key] = solid_fit.fit_solid(
                fabric,
                evidence.curve,
                **given,
                on_progress=lambda trials: advance(
                    min(trials / TRIALS, 0.99), counted(trials, "trial")
                ),
            )
    return kept[key]


def sample_surface(fabric: Fabric, pool: Mapping[str, Any]) -> ResponseSurface | UnstableError:
    """Return the ResponseSurface of a fitted solid up to the failure of both yarns, on a coarse
    mesh; the exception of one that finds no equilibrium there."""
    from unitcell3d.cases.biaxial_and_platens import displacements_at_failure
    from unitcell3d.identify import response_surface

    d1, d2 = displacements_at_failure(fabric)
    try:
        with progress.bar(f"Response surface of {fabric.name}") as advance:
            return response_surface.sample(
                fabric,
                d1=(0.0, d1),
                d2=(0.0, d2),
                points=(SURFACE_LINES, SURFACE_LINES),
                size="coarse",
                **pool,
                on_progress=advance,
                provenance=f"3D crossover of {fabric.name}, its solid fitted to biaxial tests",
            ).surface
    except UnstableError as problem:
        return problem
