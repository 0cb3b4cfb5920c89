"""STL files of projectiles: what is read of them, what is refused in one line, and runs that go on bit for bit."""

import json
from dataclasses import replace
from itertools import pairwise
from math import pi
from pathlib import Path

import numpy as np
import pytest
import pyvista

from fabrics.errors import InputError
from shellfabric.projectile.projectile import Projectile
from shellfabric.projectile.solid import volume
from validation.verification.stl_noses import NOSES, errors, triangles, write
from weavecell.scenes import impact, stl_file

CUBE = Path(__file__).parents[3] / "examples" / "cube.stl"
EDGE = 0.4e-3
SCENE = """
[fabric]
name = "S-720"

[projectile]
shape = "stl"
stl = "body.stl"
stl_unit = "mm"
mass = "1.1 g"
edge_radius = "0.4 mm"
strike_velocity = "150 m/s"
{projectile}
[panel]
opening = "50 mm"
{panel}
[run]
end_time = "40 us"
checkpoint_interval = "10 us"
outputs = []
"""


def facets():
    """(12, 3, 3) [mm] corners of the cube's triangles."""
    mesh = pyvista.read(CUBE)
    return np.asarray(mesh.points)[mesh.regular_faces]


def ascii_file(path, corners):
    """Write triangles as a text, as they are."""
    rows = ["solid"]
    for one in corners:
        rows += ["facet normal 0 0 0", "outer loop", *(f"vertex {x} {y} {z}" for x, y, z in one), "endloop", "endfacet"]
    path.write_text("\n".join([*rows, "endsolid"]))
    return path


def changed(corners, **what):
    """The cube with a change of its corners."""
    return {
        "open": corners[1:],
        "turned inside out": corners[:, ::-1],
        "one turned over": np.concatenate([corners[:1, ::-1], corners[1:]]),
        "a sheet inside": np.concatenate([corners, corners[:1], corners[:1, ::-1]]),
        "beside its axis": np.add(corners, [5, 0, 0]),
        "in inches": corners / 25.4,
        "nothing": corners[:0],
        "not a number": np.where(corners == corners.max(), np.nan, corners),
    }[what["by"]]


REFUSED = {
    "open": "is not closed: 3 edges have one triangle",
    "turned inside out": "its triangles face inwards",
    "one turned over": "has normals that point both ways: 3 edges between such triangles",
    "a sheet inside": "is not the surface of a body: 3 edges have more than two triangles",
    "beside its axis": "its z axis, x = y = 0, must lie in the body",
    "in inches": "is 0.2895 mm wide and 0.2047 mm long in mm; must be a body of 0.5 to 100 mm: see projectile.stl_unit",
    "nothing": "holds no triangles; must be an STL file, ASCII or binary",
    "not a number": "holds no triangles",
}


@pytest.mark.parametrize("what", REFUSED)
def test_a_bad_file_is_refused_in_one_line(command, tmp_path, what):
    path = ascii_file(tmp_path / "body.stl", changed(facets(), by=what))
    (tmp_path / "scene.toml").write_text(SCENE.format(projectile="", panel=""))
    code, _, err = command("impact", "scene.toml", "--out", "out")
    assert code == 2
    assert err.startswith(f"error: {path.name}: {REFUSED[what]}")
    assert err.count("\n") == 1
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("content", [b"", b"no STL file", b"solid x\n", bytes(84), bytes(range(256)) * 9])
def test_what_is_no_stl_file(tmp_path, content, capfd, caplog):
    path = tmp_path / "body.stl"
    path.write_bytes(content)
    with pytest.raises(InputError, match=r"body.stl: (holds no triangles|is )"):
        stl_file.surface(path, "mm")
    assert (caplog.text, *capfd.readouterr()) == ("", "", ""), "VTK has reported it too"


def test_no_file(tmp_path):
    with pytest.raises(InputError, match="cannot be read; must be an STL file"):
        stl_file.surface(tmp_path / "nowhere.stl", "mm")


def test_text_and_binary_hold_the_same_body(tmp_path):
    points, faces = triangles(replace(NOSES["chisel"], length=6e-3), 61, 37)
    both = [stl_file.surface(write(tmp_path / f"{kind}.stl", np.add(points, [0, 0, 0.2e-3]), faces, kind), "mm")
            for kind in (True, False)]  # fmt: skip
    for one, other in pairwise(both):
        assert one.volume == pytest.approx(other.volume, rel=1e-6)
        assert one.volume == pytest.approx(volume(points, faces), rel=1e-4)
        assert (one.width, one.length) == pytest.approx((other.width, other.length), rel=1e-6)
        assert one.points[:, 2].max() == 0
        assert one.length == pytest.approx(6e-3, rel=1e-4)


def test_a_name_gives_mass_and_edge_radius():
    """The rest of a fragment simulator is in the file."""
    told = {"name": "FSP 1.10 g", "shape": "stl", "stl": str(CUBE), "stl_unit": "mm", "strike_velocity": "90 m/s"}
    made = impact.check({"fabric": {"name": "S-720"}, "projectile": told, "panel": {"opening": "50 mm"},
                         "run": {"end_time": "60 us"}}, None)  # fmt: skip
    assert made.projectile.mass == pytest.approx(1.10e-3)
    assert made.projectile.edge_radius == pytest.approx(0.3e-3)
    assert made.projectile.diameter == pytest.approx(5.2e-3 * 2**0.5)
    assert made.projectile.flat_width is None
    assert made.panel.symmetry == "whole"


def test_a_cube():
    found = stl_file.surface(CUBE, "mm")
    assert found.volume == pytest.approx(5.2e-3**3)
    assert found.width == pytest.approx(5.2e-3 * 2**0.5)
    assert found.sharp
    solid = stl_file.solid(CUBE, "mm", EDGE)
    body = Projectile(1e-3, solid.radius, EDGE, "stl", length=solid.length, solid=solid)
    assert (body.mirrored(0), body.mirrored(1)) == (True, True)
    # in the frame of a turned ply it lies as the chisel does
    np.testing.assert_allclose(body.seen_from(0.3).frame, NOSES["chisel"].seen_from(0.3).frame)
    assert not np.allclose(body.seen_from(0.3).frame, body.frame)
    assert body.distance([0, 0, -1e-3])[0] == pytest.approx(-1e-3, abs=1e-6)
    # along the diagonal of an edge a ball of the edge radius is touched, (sqrt(2) - 1) of it inside of the sharp edge
    corner = np.array([2.6e-3, 0, 0])
    out = np.array([1, 0, 1]) / 2**0.5
    assert body.distance(corner)[0] == pytest.approx((2**0.5 - 1) * EDGE, abs=0.25 * EDGE)
    assert body.distance(corner)[1] @ out > 0.99


def test_sharp_edges_are_rounded_and_round_ones_kept(tmp_path):
    """A sharp cylinder becomes the analytic one with the edge radius, but for a quarter of that at the edge."""
    path = tmp_path / "cylinder.stl"
    mesh = pyvista.Cylinder(radius=2.7, height=5, direction=(0, 0, 1), resolution=96).triangulate().clean()
    mesh.save(path)
    assert stl_file.surface(path, "mm").volume == pytest.approx(pi * 2.7e-3**2 * 5e-3, rel=2e-3)
    solid = stl_file.solid(path, "mm", 0.3e-3)
    body = Projectile(1e-3, solid.radius, 0.3e-3, "stl", length=solid.length, solid=solid)
    distance, _ = errors(replace(NOSES["flat"], length=5e-3), body, count=1500)
    assert np.abs(distance).max() < 0.25
    assert np.sqrt(np.mean(distance**2)) < 0.05
    round_ = stl_file.surface(write(tmp_path / "round.stl", *triangles(NOSES["flat"], 121, 97)), "mm")
    assert not round_.sharp


def test_an_interrupted_run_goes_on_bit_for_bit(command, tmp_path, monkeypatch):
    """And the folder holds what is needed to repeat it."""
    from tests.weavecell.commands.test_impact import datasets, interrupt_at

    (tmp_path / "body.stl").write_bytes(CUBE.read_bytes())
    (tmp_path / "scene.toml").write_text(SCENE.format(projectile='yaw = "20 deg"', panel=""))
    code, out, _ = command("impact", "scene.toml", "--out", "whole")
    assert code == 0
    assert "projectile: a body from an STL file of 1.1 g and 7.354 mm" in out
    told = json.loads((tmp_path / "whole" / "summary.json").read_text())
    assert told["energy_error_max"] < 0.0025
    assert not told["mirror_x"]
    assert told["provenance"]["projectile_stl"].endswith(" mm 0.0004")
    assert (tmp_path / "whole" / "projectile.stl").read_bytes() == CUBE.read_bytes()
    with monkeypatch.context() as interrupted:
        interrupt_at(interrupted, 0.5)
        assert command("impact", "scene.toml", "--out", "part")[0] == 130
    stl_file._solid.cache_clear()
    stl_file._surface.cache_clear()
    assert command("impact", "scene.toml", "--out", "part", "--resume")[0] == 0
    one, other = (datasets(tmp_path / name / "histories.h5") for name in ("whole", "part"))
    assert one == other


def test_another_file_is_another_run(command, tmp_path, monkeypatch):
    from tests.weavecell.commands.test_impact import interrupt_at

    (tmp_path / "body.stl").write_bytes(CUBE.read_bytes())
    (tmp_path / "scene.toml").write_text(SCENE.format(projectile="", panel='symmetry = "quarter"'))
    with monkeypatch.context() as interrupted:
        interrupt_at(interrupted, 0.5)
        assert command("impact", "scene.toml", "--out", "out")[0] == 130
    ascii_file(tmp_path / "body.stl", facets() * [1, 1, 1.01])
    code, _, err = command("impact", "scene.toml", "--out", "out", "--resume")
    assert code == 2
    assert "checkpoint" in err


def test_a_symmetry_that_the_body_has_not_is_refused(command, tmp_path):
    ascii_file(tmp_path / "body.stl", facets() + np.where(facets()[..., :1] > 0, [0.5, 0, 0], [0, 0, 0]))
    (tmp_path / "scene.toml").write_text(SCENE.format(projectile="", panel='symmetry = "quarter"'))
    code, _, err = command("impact", "scene.toml", "--out", "out")
    assert code == 2
    assert "panel.symmetry = 'quarter': must be whole for this shot" in err
