"""A bullet of metal in a shot: against a rigid nose, its energies, threads, checkpoints, and before a block."""

from dataclasses import fields

import numpy as np
import pytest

from fabrics import metals
from fabrics.base.errors import InputError, UnstableError
from fabrics.metals import Metal
from shellfabric.block.block import Backing
from shellfabric.impact.run import run_impact
from shellfabric.impact.setup import ImpactSetup
from shellfabric.loop import checkpoint
from shellfabric.loop.hooks import Every
from shellfabric.loop.pack_solver import PackSolver
from shellfabric.membrane.numerics import Numerics
from shellfabric.projectile.projectile import Projectile
from shellfabric.projectile.turned import Turned

QUICK = {"opening": 0.0508, "table_size": 61, "end_time": 40e-6}
DRAWN = {"shape": "ogive", "radius": 2.75e-3, "length": 12e-3, "nose_length": 5e-3}
SPEED = 300.0
JACKET = {"jacket": "gilding metal", "jacket_thickness": 0.3e-3}


def bullet(core="lead", **changes):
    """A bullet of the drawing above, of the mass that it has."""
    given = DRAWN | {"edge_radius": 0.2e-3} | changes
    load = lambda metal: metals.load(metal) if isinstance(metal, str) else metal  # noqa: E731
    jacket = given.get("jacket")
    drawing = Turned(
        given["radius"],
        given["length"],
        load(core),
        nose_length=given["nose_length"],
        jacket=jacket and load(jacket),
        jacket_thickness=given.get("jacket_thickness", 0.0),
        element_size=given.get("element_size", 0.2 * given["radius"]),
    )
    return Projectile(body="metal", core=core, mass=drawing.drawn_mass, **given)


def shoot(fabric, shot, velocity=150.0, **changes):
    return run_impact(ImpactSetup(fabric, velocity, projectile=shot, **QUICK | changes))


@pytest.fixture(scope="module")
def struck(fabric):
    return shoot(fabric, bullet(**JACKET), velocity=SPEED, end_time=15e-6)


def test_a_bullet_widens_and_its_energy_balances(struck):
    end = struck.metal
    assert struck.energy_error_max < 5e-4
    assert end.width_at_rest == pytest.approx(2 * DRAWN["radius"], rel=1e-12)
    assert end.length_at_rest == pytest.approx(DRAWN["length"], rel=1e-12)
    assert end.width > end.width_at_rest
    assert end.length < 0.999 * end.length_at_rest
    assert end.plastic_energy > 0.01
    assert end.core_strain > end.jacket_strain > 0
    assert struck.energies["plastic_projectile"][-1] >= end.plastic_energy
    lost = struck.setup.projectile.mass * (SPEED - end.centre_velocity[-1])
    step = struck.step_history[0, 0]
    assert lost == pytest.approx(-np.sum(struck.step_history[:-1, 3]) * step, rel=1e-9)
    assert struck.velocity[-1] == pytest.approx(end.centre_velocity[-1], rel=1e-12)
    # its tip is slowed first
    assert end.tip[-1] < end.centre[-1] < end.tail[-1]
    checks = {one.name: one for one in struck.checks}
    assert 0 < checks["jacket strain"].value < 1
    assert checks["projectile hourglass"].ok


def test_a_stiff_body_is_the_rigid_nose(fabric):
    stiff = Metal(8000.0, 2e12, 0.3)
    flying = {"element_size": 0.3e-3}
    shots = []
    for shot in (bullet(stiff, **flying), None):
        if shot is None:
            shot = Projectile(mass=shots[0].setup.projectile.mass, edge_radius=0.2e-3, **DRAWN)
        shots.append(shoot(fabric, shot))
    metal, rigid = shots
    assert metal.velocity[-1] == pytest.approx(rigid.velocity[-1], rel=1e-3)
    assert metal.nose_position[-1] == pytest.approx(rigid.nose_position[-1], rel=1e-3)
    assert 150 - rigid.velocity[-1] > 3


def test_any_number_of_threads_gives_the_same_bits(fabric):
    found = [
        shoot(fabric, bullet(), plies=3, end_time=12e-6, numerics=Numerics(threads=threads))
        for threads in (1, 2)
    ]
    assert np.array_equal(found[0].step_history, found[1].step_history)
    assert np.array_equal(found[0].metal.places, found[1].metal.places)
    assert found[0].metal.core_strain > 0


def solver_of(fabric, **changes):
    setup = ImpactSetup(fabric, 150.0, projectile=bullet(), **QUICK | changes)
    return PackSolver(setup.target(), 150.0, setup.end_time)


def test_a_resumed_run_goes_on_bit_for_bit(fabric, tmp_path):
    path = tmp_path / "half.h5"

    class Half(Every):
        def __call__(self, solver):
            if self.due(solver) and not path.exists():
                checkpoint.write(solver, path)

    whole = solver_of(fabric, end_time=24e-6).run([Half(10e-6)])
    again = solver_of(fabric, end_time=24e-6)
    checkpoint.read(again, path)
    assert 0 < again.steps < whole.steps
    again.run()
    for name in ("v", "z", "error", "plastic_projectile"):
        assert np.array_equal(whole.sample(name), again.sample(name))
    one, other = (run.part("metal").row for run in (whole, again))
    assert np.array_equal(one.x, other.x)
    assert one.plastic_work == other.plastic_work > 0
    # another bullet's checkpoint is refused
    changed = ImpactSetup(fabric, 150.0, projectile=bullet("lead-antimony"), **QUICK)
    with pytest.raises(InputError, match="checkpoint"):
        checkpoint.read(PackSolver(changed.target(), 150.0, 24e-6), path)


def test_a_bullet_meets_the_block_in_the_shape_that_it_has(fabric):
    """A soft ply that it breaks at once: energy balances, and the dent takes its momentum."""
    block = Backing(size=(0.06, 0.06, 0.03), min_size=3e-3, refined_depth=6e-3, standoff=0.3e-3)
    shot = bullet()
    found = shoot(fabric, shot, velocity=250.0, backing=block, end_time=20e-6)
    assert found.energy_error_max < 2e-3
    assert found.metal.length < 0.95 * found.metal.length_at_rest
    assert found.backing.depth > 1e-3
    # a row of the history has the block's force of a step ago beside that of the ply
    lost = shot.mass * (250.0 - found.metal.centre_velocity[-1])
    step = found.step_history[0, 0]
    assert lost == pytest.approx(-np.sum(found.step_history[:-1, 3]) * step, rel=5e-3)


REFUSED = {
    "obliquity": {"obliquity": 0.1},
    "yaw": {"yaw": 0.1},
    "shape": {"shape": "cone", "half_angle": 0.6, "tip_radius": 1e-3, "nose_length": None},
    "length": {"length": None},
    "mass": {"mass": 1e-3},
    "edge_radius": {"edge_radius": 0.6e-3},
    "core": {"core": "leed"},
    "cavity_depth": {"cavity_diameter": 1e-3},
    "bore_diameter": {"bore_diameter": 1e-3},
}


@pytest.mark.parametrize("key", REFUSED)
def test_what_a_body_of_metal_cannot_do_is_refused(key):
    good = bullet()
    given = {entry.name: getattr(good, entry.name) for entry in fields(good)}
    with pytest.raises(InputError, match=key):
        Projectile(**given | REFUSED[key])


def test_keys_of_metal_are_refused_of_another_body():
    with pytest.raises(InputError, match=r"core .*body metal"):
        Projectile(core="lead")


def test_a_body_that_fails_ends_the_run_and_says_where(fabric):
    solver = solver_of(fabric)
    row = solver.part("metal").row
    row.x[row.outline[2], 1] -= 2.5e-3  # the tip is turned inside out
    with pytest.raises(UnstableError, match=r"projectile.*element at r = .* mm"):
        solver.run()
