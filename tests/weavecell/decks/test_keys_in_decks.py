"""Each key of an input file changes a deck, is refused for decks, or is told as left out (`NoPlace`)."""

import pytest

from fabrics.base.errors import InputError
from fabrics.base.schema import unread, with_tables, without_place
from tests.scene_text import merged
from tests.weavecell.scenes.test_keys_of_models import OTHERWISE, SHOT, digest_of
from tests.weavecell.scenes.test_keys_reach import ENTRIES, ROOT, row, with_value
from weavecell.decks import folder, model
from weavecell.scenes import build
from weavecell.scenes.impact import Scene, check

PACK = {
    "panel": {"plies": 2, "opening": "15 mm", "impact_point": None},
    "run": {"elements_per_crossover": 1},
}
# values unlike those of the pack
UNLIKE = {"panel.plies": ({}, 3), "run.end_time": ({}, "1 us")}
# the heading is an argument of the writer; a set of other keys; where numbers come from
OF_NO_NUMBER = (
    "title",
    "panel.preset",
    "fabric.weaving_damage.source",
    "fabric.weaving_damage.status",
)
# a body from a file costs half a minute
OF_FILES = ("projectile.stl", "projectile.density")
KEYS = [key for key in ENTRIES if key not in OF_NO_NUMBER and not key.startswith(OF_FILES)]
# a card of its own takes half a second
WALK = [
    pytest.param(key, marks=pytest.mark.slow if key.startswith(("fabric.", "panel.ply.")) else ())
    for key in KEYS
]


@pytest.fixture(scope="module")
def write():
    """The text of the deck of a scene for OpenRadioss, or the error of one that is refused; cells that
    are alike share a card."""
    code = folder.CODES["radioss"]
    laws, misfits = {}, {}
    fit, measure = code.LAW.fit, model.Mismatch.measure

    def fit_once(fabric, match):
        name = digest_of(fabric.model)
        if name not in laws:
            laws[name] = fit(fabric, match)
        return laws[name]

    def measure_once(fabric, law):
        if id(law) not in misfits:
            misfits[id(law)] = measure(fabric, law)
        return misfits[id(law)]

    texts = {}

    def write_text(scene):
        try:
            case = build.build(check(scene, None, "export"), None, "s")
            deck = model.build(
                build.setup(case, None), code, "kg-m-s", "uniaxial", title="", source=""
            )
        except InputError as problem:
            return problem
        return str(code.write(deck, "panel"))

    def remembered(scene):
        if repr(scene) not in texts:
            texts[repr(scene)] = write_text(scene)
        return texts[repr(scene)]

    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(ROOT)
        patch.setattr(code.LAW, "fit", fit_once)
        patch.setattr(model.Mismatch, "measure", measure_once)
        yield remembered


def is_a_shot(scene):
    """Whether a shot takes the scene."""
    try:
        build.setup(build.build(check(scene, None, "shot"), None, "s"), None).target()
    except InputError:
        return False
    return True


@pytest.mark.parametrize("key", WALK)
def test_a_key_changes_a_deck_is_refused_or_told(write, key):
    """A scene that is refused for what else it says tells nothing of the key. What acts by its default
    too is told in the deck itself, which changes with it."""
    context, value = UNLIKE.get(key) or OTHERWISE.get(key) or row(key)[:2]
    base = merged(merged(SHOT, PACK), context)
    scene = with_value(base, key, value)
    without = write(base)
    found = write(scene)
    if isinstance(without, InputError):
        return
    places = with_tables(key)
    told = any(name in without_place(Scene, "export") for name in places)
    if isinstance(found, InputError):
        refused = any(name in unread(Scene, "export") for name in places)
        assert refused or not is_a_shot(scene), found
    elif told:
        assert found == without or key in model.ACT_BY_DEFAULT
    else:
        assert found != without
