"""Constants of a fabric's cell fitted to measured biaxial tests: `weavecell calibrate --biaxial`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from fabrics.base.checks import FilePath
from fabrics.base.errors import InputError
from fabrics.fabric import Fabric
from fabrics.variants import data_digest
from weavecell.answers.biaxial_fit import NAMES, YARNS, BiaxialFitResult
from weavecell.api.command import Plan, Running
from weavecell.api.run_size import WorkSize
from weavecell.api.target import resolve_fabric
from weavecell.scenes import curves, result_keys

if TYPE_CHECKING:
    from shellfabric.cell.model import CellModel
    from weavecell.studies.biaxial_tests import BiaxialTest
FIRST = "a, b"


@dataclass(frozen=True)
class BiaxialFitPlan(Plan[BiaxialFitResult]):
    """A fit that is about to be made.

    Parameters
    ----------
    model : CellModel, whose constants are free
    tests : all that the file has
    fitted : names of those that are fitted; all if empty
    constants : that are free
    source : name of the file
    """

    files = NAMES
    runs = ""

    model: CellModel
    tests: tuple[BiaxialTest, ...]
    fitted: tuple[str, ...]
    constants: tuple[str, ...]
    source: str

    def forecast(self) -> WorkSize:
        """Count tests, states and constants: a fit takes a second."""
        title = f"{self.model.fabric.name}, biaxial tests of {self.source}"
        states = sum(len(test.load) for test in self.tests)
        fitted = len(self.fitted) or len(self.tests)
        amounts = {"test": len(self.tests), "fitted test": fitted, "state": states}
        return WorkSize(title, amounts | {"constant": len(self.constants)})

    def run(self, running: Running) -> BiaxialFitResult:
        """Fit the constants."""
        from weavecell.studies import biaxial_fit as study

        fabric = self.model.fabric
        provenance = f"fitted to the biaxial tests of {self.source}"
        found = study.fit(self.model, self.tests, self.fitted, self.constants, provenance)
        law = replace(found.law, fitted_data=data_digest(fabric))
        found = replace(found, law=law)
        kept = self._find_wrongly_kept(found)
        result = BiaxialFitResult(fabric, found, self.source, running.wall_time, kept)
        result_keys.check_fabric(result.fabric, fabric, self.source)
        result.fabric_keys()
        return running.save(result)

    def _find_wrongly_kept(self, found):
        """Say which of a and b was kept though the tests, with both free, exclude its value."""
        from weavecell.studies import biaxial_fit as study

        kept = [name for name in ("a", "b") if name not in self.constants]
        if len(kept) != 1:
            return ()
        both = (*self.constants, *kept)
        free = study.fit(self.model, self.tests, self.fitted, both, with_profiles=False)
        constant = free.values[kept[0]]
        if constant.low <= getattr(found.law, kept[0]) <= constant.high:
            return ()
        return tuple(kept)


def plan_fit(
    fabric: Fabric | FilePath,
    path: FilePath,
    fitted: Sequence[str] | None,
    constants: str | None,
    centreline: str | None,
    yarn_curve: Sequence[str] | None,
) -> BiaxialFitPlan:
    """Plan the fit to the tests of a file; the arguments are those of `calibrate`."""
    from shellfabric.cell.model import CellModel
    from weavecell.studies import biaxial_fit as study
    from weavecell.studies import biaxial_tests

    known = resolve_fabric(fabric)
    tests = tuple(biaxial_tests.read(path, known.weave.yarn_spacing))
    names = [test.name for test in tests]
    for name in fitted or ():
        if name not in names:
            raise InputError(
                key="fitted", value=name, allowed=f"a test of {path}: {', '.join(names)}"
            )
    free = [part.strip() for part in (constants or FIRST).split(",")]
    for name in free:
        if name not in study.CONSTANTS:
            raise InputError(key="constants", value=name, allowed=", ".join(study.CONSTANTS))
    slack = [0.0, 0.0]
    for text in yarn_curve or ():
        known = _with_yarn_curve(known, text, slack)
    laws = None
    if known.laws is None:
        laws = study.first_laws(known, free)
    if centreline == "cosine" and not known.weave.pattern.is_plain:
        allowed = f"left out: yarns of a {known.weave.pattern.name} are straight from crossing to crossing"
        raise InputError(key="centreline", value=centreline, allowed=allowed)
    model = CellModel(known, laws, centreline=centreline or "cosine", slack=(slack[0], slack[1]))
    return BiaxialFitPlan(
        model, tests, tuple(fitted or ()), tuple(dict.fromkeys(free)), curves.name_of(path)
    )


def _with_yarn_curve(fabric, text, slack):
    """The fabric with the stiffness and failure strain of FAMILY=FILE; its slack [-] is set in
    `slack` (warp, weft)."""
    family, separator, path = str(text).partition("=")
    family = family.strip()
    if not separator or family not in (*YARNS, "both"):
        allowed = "warp, weft or both, and a file, such as warp=yarn.csv"
        raise InputError(key="yarn_curve", value=text, allowed=allowed)
    path = path.strip()
    fitted = curves.yarn_with_foot(path)
    pairs = {"E": [], "failure_strain": []}
    for m, (name, yarn) in enumerate(zip(YARNS, fabric.weave.yarns)):
        E = yarn.E
        strain = yarn.failure_strain
        if family in (name, "both"):
            E = fitted.EA / yarn.A_s
            strain = fitted.failure_strain
            slack[m] = fitted.slack
            of = f"a {name} yarn of {1e7 * yarn.linear_density:.4g} dtex: check force and strain"
            result_keys.checked("modulus", f"{1e-9 * E:.5g} GPa", path, of)
            result_keys.checked("failure_strain", f"{100 * strain:.5g} %", path, of)
        pairs["E"].append(E)
        pairs["failure_strain"].append(strain)
    return fabric.with_yarns(**pairs)
