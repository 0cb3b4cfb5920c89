"""What each command does with the keys of an input file: one `Support` for each, all in one place."""

from __future__ import annotations

from dataclasses import replace

from weavecell.scenes import build, target
from weavecell.scenes.coupon import CouponScene
from weavecell.scenes.impact import Scene
from weavecell.scenes.supported import Rule, Support, of

IMPACT = Support(Scene, rejected=build.NO_SLACK, rules=build.SHOT_RULES)
ACCURACY = replace(IMPACT, rejected=build.NO_SLACK | build.PINNED)
DRAWS = replace(
    IMPACT,
    ignored=("panel.symmetry", *target.UNWRITTEN, "history"),
    rejected=build.NO_SLACK | {"accuracy": "left out of draws, which run the mesh of the scene"},
)
LIMITS = target.support(
    ignored=("title", *target.UNWRITTEN, "projectile.strike_velocity", "run.end_time", "backing.after_stop")
)
SENSITIVITY = target.support()
SWEEP = target.support(
    rejected={"history": "left out: a sweep records nothing along yarns; `weavecell impact` does"},
)
COUPON = Support(
    CouponScene,
    rejected={"fabric.surface": "left out: the cell of a coupon is made from laws"},
    rules=(
        *build.CELL_RULES,
        Rule(
            "fabric.bending", lambda scene: scene.test != "pull_out",
            "left out: the yarns of a coupon have no bending stiffness, but in a pull-out",
        ),
        *(
            Rule(key, lambda scene: scene.test == "pull_out", "left out in a pull-out")
            for key in ("fabric.fibre_slack", *of("run", "steps elements_per_crossover tolerance max_iterations"))
        ),
    ),
)  # fmt: skip


def impact(scene: Scene) -> Support:
    """Of `weavecell impact`: a scene with [accuracy] has its own."""
    return IMPACT if scene.accuracy is None else ACCURACY
