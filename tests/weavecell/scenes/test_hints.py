"""A hint is a slip of the letters, or the only key with a word in common, in the table where it stands: forty slips."""

import re

import pytest

from fabrics.base.errors import InputError, nearest, share_word
from tests.scene_text import merged
from weavecell.scenes.impact import check

SHOT = {
    "fabric": {"name": "S-720"},
    "projectile": {"name": "FSP 1.10 g", "strike_velocity": "100 m/s"},
    "panel": {"opening": "100 mm"},
    "backing": {"material": "Roma Plastilina No. 1"},
}
# what is written = what the line says: a key that is meant, tables that have it, or "" of no hint
SLIPS = {
    "fabric.nmae": "name",
    "fabric.flie": "file",
    "fabric.cell_modle": "cell_model",
    "fabric.crosover_gap": "crossover_gap",
    "fabric.linear_densty": "linear_density",
    "fabric.failure": "",
    "fabric.frame": "",
    "fabric.width": "",
    "fabric.mass": "[projectile]",
    "fabric.friction": "[projectile]",
    "fabric.opening": "[panel]",
    "projectile.diamter": "diameter",
    "projectile.strike_speed": "strike_velocity",
    "projectile.shpae": "shape",
    "projectile.obliquty": "obliquity",
    "projectile.velocty": "strike_velocity",
    "projectile.weight": "mass",
    "projectile.calibre": "diameter",
    "projectile.radius": "",
    "projectile.frame": "",
    "projectile.law": "[fabric]",
    "projectile.threads": "[numerics]",
    "panel.boundry": "boundary",
    "panel.opennig": "opening",
    "panel.symetry": "symmetry",
    "panel.layers": "plies",
    "panel.failure": "yarn_failure",
    "panel.friction": "[projectile]; here ply_friction, crossover_friction",
    "panel.angle": "[panel.ply]; here weave_angle",
    "panel.thread": "",
    "panel.tip": "",
    "run.endtime": "end_time",
    "run.end_tiem": "end_time",
    "run.output": "outputs",
    "run.snapshots": "snapshot_interval",
    "run.friction": "[projectile]",
    "history.warps": "warp",
    "numerics.dampng": "",
    "numerics.viscosity": "stretch_viscosity",
    "backing.name": "material",
    "backing.position": "",
    "backing.standof": "standoff",
    "backing.erosion": "erosion_strain",
}


@pytest.mark.parametrize("key", SLIPS)
def test_a_slip_gets_the_hint_that_is_right_or_none(key):
    table, _, name = key.partition(".")
    with pytest.raises(InputError) as caught:
        check(merged(SHOT, {table: {name: "1 mm"}}), None, "shot")
    line = next(line for line in str(caught.value).splitlines() if line.startswith(f"{key}:"))
    meant = re.search(r'did you mean "(\w+)"', line)
    homes = re.search(r"it is a key of (.*)", line)
    wanted = SLIPS[key]
    if wanted.startswith("["):
        assert homes
        assert homes[1].startswith(wanted)
    else:
        assert (meant[1] if meant else "") == wanted
        assert not homes


def test_letters_count_in_their_places():
    for slip, name in (("velocty", "velocity"), ("poission", "poisson"), ("simetry", "symmetry")):
        assert nearest(slip, [name]) == name
    # alike by letters in any order: the hints of these were wrong
    for slip, name in (
        ("position", "poisson"),
        ("failure", "file"),
        ("frame", "name"),
        ("seed", "speed_of_x"),
    ):
        assert nearest(slip, [name]) is None
    assert share_word("friction", ["ply_friction", "crossover_friction", "angle"]) == [
        "ply_friction",
        "crossover_friction",
    ]
    assert nearest("friction", ["ply_friction", "crossover_friction"]) is None
