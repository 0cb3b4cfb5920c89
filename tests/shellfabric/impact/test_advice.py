"""What a quality check advises changes what it finds: each check that a cheap shot raises, before and after."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fabrics import catalogue
from shellfabric.impact import proposals
from shellfabric.impact.run import run_impact
from shellfabric.impact.setup import ImpactSetup
from shellfabric.membrane import quality
from shellfabric.membrane.numerics import Numerics
from shellfabric.projectile.projectile import Projectile
from validation.cases.impact import Unchecked
from validation.models.variants import with_law_form

ROOT = Path(__file__).parents[3]
FABRIC = catalogue.load("S-720").with_effective_density()
SHOT = ImpactSetup(
    FABRIC,
    140.0,
    opening=0.06,
    table_size=51,
    end_time=40e-6,
    elements_per_crossover=1,
    symmetry="quarter",
    numerics=Numerics(threads=1),
)
PRINTED = with_law_form(FABRIC, "printed")
SHORT_FIT = tuple(replace(law, F_range=(0.0, 1e-3)) for law in FABRIC.laws)
NARROW = replace(SHOT, projectile=Projectile(mass=0.44e-3, radius=1.06e-3))
OBLIQUE = replace(
    SHOT,
    strike_velocity=300.0,
    end_time=100e-6,
    projectile=Projectile(obliquity=0.9),
    symmetry="whole",
    elements_per_crossover=None,
)
FINER = {"elements_per_crossover": 2}


def numerics(**numbers):
    """Numerics that nobody checks."""
    return {"numerics": Unchecked(threads=1, **numbers)}


USUAL = {"numerics": SHOT.numerics}
# check: (shot that raises it, what its advice changes)
SCENES = {
    "time step": (replace(SHOT, **numerics(cfl=1.2)), USUAL),
    "tension oscillation": (
        replace(SHOT, yarn_failure=False, **numerics(stretch_viscosity=0.0)),
        USUAL,
    ),
    "nose penetration": (replace(SHOT, **numerics(nose_stiffness=0.01)), USUAL),
    "contact point spacing": (replace(SHOT, **numerics(contact_points=2)), USUAL),
    "element side": (NARROW, FINER),
    "element over failure length": (replace(NARROW, strike_velocity=400.0), FINER),
    "yarns an element": (
        replace(SHOT, elements_per_crossover=None, grading=((np.inf, 2),)),
        {"grading": ((16, 1), (np.inf, 2))},
    ),
    "path over fine mesh": (
        replace(OBLIQUE, grading=((8, 1), (np.inf, 2))),
        {"grading": ((40, 1), (np.inf, 2))},
    ),
    "swelling under contact": (
        replace(SHOT, fabric=PRINTED, laws=PRINTED.laws),
        {"laws": FABRIC.laws},
    ),
    "contact force over fitted range": (
        replace(SHOT, laws=SHORT_FIT),
        {"cell_model": "incompressible", "laws": None},
    ),
}


def find(setup, name):
    """The indicator of a run, None where there is none."""
    return {one.name: one for one in run_impact(setup).checks}.get(name)


@pytest.mark.slow
@pytest.mark.parametrize("name", SCENES)
def test_advice_that_is_followed_changes_what_the_check_finds(name):
    setup, changes = SCENES[name]
    before = find(setup, name)
    assert before.doubtful
    assert before.remedy == proposals.fill(quality.CHECKS[name].advice, setup) != ""
    after = find(replace(setup, **changes), name)
    assert after is None or not after.doubtful
    assert after is None or after.value < before.value


def test_every_check_is_declared_with_its_advice_and_stands_on_the_pages(tool):
    """Whoever adds a check declares it as a Check: nothing else makes an Indicator of numbers."""
    pages = tool("pages")
    declared = set()
    for folder in ("shellfabric", "weavecell", "unitcell3d", "meshing"):
        for path in (ROOT / folder).rglob("*.py"):
            text = path.read_text("utf-8")
            declared |= set(re.findall(r"\bCheck\(\s*\"([^\"]+)\"", text))
            made = re.findall(r"(?<![\w.\"])Indicator\(", text)
            assert not made or path.name in ("indicator.py", "impact.py"), path
    assert declared == {check.name for check in pages.CHECKS}
    for check in pages.CHECKS:
        assert check.advice
        assert check.meaning
    rows = pages.doubtful_results()
    assert all(check.name in rows for check in pages.CHECKS)
