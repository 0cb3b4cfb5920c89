"""STL files of projectiles: what is read of them, what is refused in one line, and runs that go on bit for bit."""

import json
import tomllib
from dataclasses import replace
from itertools import pairwise
from math import pi
from pathlib import Path

import numpy as np
import pytest
import pyvista
from numpy.testing import assert_allclose

from fabrics.base.errors import InputError
from shellfabric.projectile.projectile import Projectile
from shellfabric.projectile.solid import volume
from tests.scene_text import datasets, merged, toml
from tests.stl_noses import NOSES, errors, triangles, write
from weavecell.scenes import impact, stl_file

CUBE = Path(__file__).parents[3] / "examples" / "cube.stl"
EDGE = 0.4e-3
SHOT = tomllib.loads("""
fabric.name = "S-720"
panel.opening = "50 mm"
run = { end_time = "40 us", checkpoint_interval = "10 us", outputs = [] }
[projectile]
shape = "stl"
stl = "body.stl"
stl_unit = "mm"
mass = "1.1 g"
edge_radius = "0.4 mm"
strike_velocity = "150 m/s"
""")


def facets():
    """(12, 3, 3) [mm] corners of the cube's triangles."""
    mesh = pyvista.read(CUBE)
    return np.asarray(mesh.points)[mesh.regular_faces]


def centred(corners):
    """Triangles about the middle of the cube, from which they can be made smaller."""
    middle = corners.reshape(-1, 3).mean(axis=0)
    return corners - middle + middle / 0.8


def ascii_file(path, corners):
    """Write triangles as a text, as they are."""
    rows = ["solid"]
    for one in corners:
        rows += [
            "facet normal 0 0 0",
            "outer loop",
            *(f"vertex {x} {y} {z}" for x, y, z in one),
            "endloop",
            "endfacet",
        ]
    path.write_text("\n".join([*rows, "endsolid"]))
    return path


@pytest.mark.parametrize(
    "change, said",
    [
        (lambda c: c[1:], "is not closed: 3 edges have one triangle"),
        (lambda c: c[:, ::-1], "its triangles face inwards"),
        (
            lambda c: np.concatenate([c[:1, ::-1], c[1:]]),
            "has normals that point both ways: 3 edges between such",
        ),
        (
            lambda c: np.concatenate([c, c[:1], c[:1, ::-1]]),
            "is not the surface of a body: 3 edges have more than two",
        ),
        (lambda c: np.add(c, [5, 0, 0]), "its z axis, x = y = 0, must lie in the body"),
        (
            lambda c: c / 25.4,
            "is 0.2895 mm wide and 0.2047 mm long in mm; must be a body of 0.5 to 100 mm: see ",
        ),
        (
            lambda c: np.add(c, [60, 61, 0]),
            "its z axis, x = y = 0, must lie in the body: it is the projectile's axis; the body lies from x = 57.4 "
            "to 62.6 and y = 58.4 to 63.6 mm: shift it by -60 and -61 mm",
        ),
        (
            lambda c: np.concatenate([c, 0.5 * c + [0, 0, 10]]),
            "holds 2 separate bodies, of 140.6 and 17.58 mm^3; must be one body",
        ),
        (
            lambda c: np.concatenate([c, np.add(c, [0, 0, 10])[:, ::-1]]),
            "its triangles face inwards",
        ),
        (
            lambda c: np.concatenate([c, 0.8 * centred(c)[:, ::-1], 0.2 * centred(c)]),
            "holds 2 separate bodies, of 140.6 and 1.125 mm^3",
        ),
        (lambda c: c[:0], "holds no triangles; must be an STL file, ASCII or binary"),
        (lambda c: np.where(c == c.max(), np.nan, c), "has corners that are no finite numbers"),
    ],
)
def test_a_bad_file_is_refused_in_one_line(tmp_path, change, said):
    path = ascii_file(tmp_path / "body.stl", change(facets()))
    with pytest.raises(InputError) as problem:
        stl_file.solid(path, "mm", EDGE)
    assert str(problem.value).startswith(f"{path}: {said}")
    assert "\n" not in str(problem.value)


@pytest.mark.parametrize(
    "content", [b"", b"no STL file", b"solid x\n", bytes(84), bytes(range(256)) * 9]
)
def test_what_is_no_stl_file(tmp_path, content, capfd, caplog):
    path = tmp_path / "body.stl"
    path.write_bytes(content)
    with pytest.raises(InputError, match=r"body.stl: (holds no triangles|is )"):
        stl_file.surface(path, "mm")
    assert (caplog.text, *capfd.readouterr()) == ("", "", ""), "VTK has reported it too"
    with pytest.raises(InputError, match="cannot be read; must be an STL file"):
        stl_file.surface(tmp_path / "nowhere.stl", "mm")


def assert_cube(path):
    """The file holds the cube."""
    assert stl_file.surface(path, "mm").volume == pytest.approx(5.2e-3**3, rel=1e-6)


def test_a_cavity_is_allowed(tmp_path):
    corners = facets()
    middle = corners.reshape(-1, 3).mean(axis=0)
    hole = 0.5 * (corners - middle) + middle
    path = ascii_file(tmp_path / "body.stl", np.concatenate([corners, hole[:, ::-1]]))
    assert stl_file.surface(path, "mm").volume == pytest.approx(7 / 8 * 5.2e-3**3, rel=1e-6)


@pytest.mark.parametrize(
    "change",
    [
        lambda text: text.replace(b"endsolid", b"end solid"),
        bytes.upper,
        lambda text: b"\xef\xbb\xbf" + text,
        lambda text: text.replace(b"\n", b"\r\n"),
        lambda text: text + b"\n\n",
        lambda text: text.replace(b"endsolid", b"END SOLID cube"),
        lambda text: text.replace(b"solid\n", b"solid K\xf6rper\n", 1),
    ],
)
def test_a_text_as_other_programs_write_it(tmp_path, change):
    path = ascii_file(tmp_path / "body.stl", facets())
    path.write_bytes(change(path.read_bytes()))
    assert_cube(path)


@pytest.mark.parametrize("tail", [b"", b"\0" * 7, b"solid of nothing", b"x" * 501])
@pytest.mark.parametrize("head", [b"solid of a program", b"head"])
def test_a_binary_file_with_more_behind_its_triangles(tmp_path, head, tail):
    records = np.zeros(12, np.dtype([("numbers", "<f4", 12), ("attribute", "<u2")]))
    records["numbers"][:, 3:] = facets().reshape(12, 9)
    path = tmp_path / "body.stl"
    path.write_bytes(head.ljust(80) + np.uint32(12).tobytes() + records.tobytes() + tail)
    assert_cube(path)


def test_text_and_binary_hold_the_same_body(tmp_path):
    points, faces = triangles(replace(NOSES["chisel"], length=6e-3), 61, 37)
    both = [
        stl_file.surface(
            write(tmp_path / f"{kind}.stl", np.add(points, [0, 0, 0.2e-3]), faces, kind), "mm"
        )
        for kind in (True, False)
    ]
    for one, other in pairwise(both):
        assert one.volume == pytest.approx(other.volume, rel=1e-6)
        assert one.volume == pytest.approx(volume(points, faces), rel=1e-4)
        assert (one.width, one.length) == pytest.approx((other.width, other.length), rel=1e-6)
        assert one.points[:, 2].max() == 0
        assert one.length == pytest.approx(6e-3, rel=1e-4)


def test_a_name_gives_mass_and_edge_radius():
    """The rest of a fragment simulator is in the file."""
    changes = {"name": "FSP 1.10 g", "stl": str(CUBE), "mass": None, "edge_radius": None}
    made = impact.check(merged(SHOT, {"projectile": changes}), None)
    assert made.projectile.mass == pytest.approx(1.10e-3)
    assert made.projectile.edge_radius == pytest.approx(0.3e-3)
    assert made.projectile.diameter == pytest.approx(5.2e-3 * 2**0.5)
    assert made.projectile.flat_width is None
    assert made.panel.symmetry == "whole"


def test_a_cube_has_volume_width_and_sharp_edges():
    found = stl_file.surface(CUBE, "mm")
    assert found.volume == pytest.approx(5.2e-3**3)
    assert found.width == pytest.approx(5.2e-3 * 2**0.5)
    assert found.sharp


@pytest.fixture
def cube():
    """Return the cube as a projectile with rounded edges."""
    solid = stl_file.solid(CUBE, "mm", EDGE)
    return Projectile(1e-3, solid.radius, EDGE, "stl", length=solid.length, solid=solid)


def test_a_cube_on_its_edge_has_two_planes_of_symmetry(cube):
    assert cube.mirrored(0)
    assert cube.mirrored(1)


def test_a_cube_lies_in_the_frame_of_a_turned_ply_as_a_chisel_does(cube):
    assert_allclose(cube.seen_from(0.3).frame, NOSES["chisel"].seen_from(0.3).frame)
    assert not np.allclose(cube.seen_from(0.3).frame, cube.frame)


def test_the_distance_to_a_cube_has_its_rounded_edge(cube):
    """Along the diagonal of an edge a ball of the edge radius is touched, (sqrt(2) - 1) of it inside of the sharp
    edge."""
    corner = np.array([2.6e-3, 0, 0])
    out = np.array([1, 0, 1]) / 2**0.5
    assert cube.distance([0, 0, -1e-3])[0] == pytest.approx(-1e-3, abs=1e-6)
    assert cube.distance(corner)[0] == pytest.approx((2**0.5 - 1) * EDGE, abs=0.25 * EDGE)
    assert cube.distance(corner)[1] @ out > 0.99


def test_sharp_edges_are_rounded_and_round_ones_kept(tmp_path):
    """A sharp cylinder becomes the analytic one with the edge radius, but for a quarter of that at the edge."""
    path = tmp_path / "cylinder.stl"
    mesh = (
        pyvista.Cylinder(radius=2.7, height=5, direction=(0, 0, 1), resolution=96)
        .triangulate()
        .clean()
    )
    mesh.save(path)
    assert stl_file.surface(path, "mm").volume == pytest.approx(pi * 2.7e-3**2 * 5e-3, rel=2e-3)
    solid = stl_file.solid(path, "mm", 0.3e-3)
    body = Projectile(1e-3, solid.radius, 0.3e-3, "stl", length=solid.length, solid=solid)
    distance, _ = errors(replace(NOSES["flat"], length=5e-3), body, count=1500)
    assert abs(distance).max() < 0.25
    assert np.sqrt(np.mean(distance**2)) < 0.05
    round_ = stl_file.surface(
        write(tmp_path / "round.stl", *triangles(NOSES["flat"], 121, 97)), "mm"
    )
    assert not round_.sharp


def test_an_interrupted_run_goes_on_bit_for_bit_and_not_with_another_file(
    command, succeed, interrupted, tmp_path
):
    """The folder holds what is needed to repeat the run."""
    (tmp_path / "body.stl").write_bytes(CUBE.read_bytes())
    (tmp_path / "scene.toml").write_text(toml(merged(SHOT, {"projectile": {"yaw": "20 deg"}})))
    out = succeed("impact", "scene.toml", "--verbose", "--out", "whole")
    assert "projectile: a body from an STL file of 1.1 g and 7.354 mm" in out
    told = json.loads((tmp_path / "whole" / "summary.json").read_text())
    assert told["energy_error_max"] < 0.0025
    assert not told["mirror_x"]
    assert told["provenance"]["projectile_stl"].endswith(" mm 0.0004")
    assert (tmp_path / "whole" / "inputs" / "body.stl").read_bytes() == CUBE.read_bytes()
    with interrupted(0.5):
        assert command("impact", "scene.toml", "--out", "part")[0] == 130
    ascii_file(tmp_path / "body.stl", facets() * [1, 1, 1.01])
    code, _, err = command("impact", "scene.toml", "--out", "part", "--resume")
    assert code == 2
    assert "of other input or options" in err
    (tmp_path / "body.stl").write_bytes(CUBE.read_bytes())
    stl_file._solid.cache_clear()
    stl_file._surface.cache_clear()
    succeed("impact", "scene.toml", "--out", "part", "--resume")
    one, other = (datasets(tmp_path / name / "histories.h5") for name in ("whole", "part"))
    assert one == other
