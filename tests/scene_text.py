"""The scene that tests of the command line share, 3 g at a small panel of S-720, and what a file of results holds."""

import copy
import json

import h5py

from fabrics.base.units import NUMBER
from weavecell.results import file_list

# a picture frame that is solved in a second
FRAME = '[fabric]\nname = "S-720"\n[picture_frame]\nshear_angle = "5 deg"\ncrossovers = 2\n[run]\nsteps = 2\n'

SCENE = """
{head}
[fabric]
name = "{fabric}"

[projectile]
mass = "3 g"
diameter = "5.5 mm"
edge_radius = "{edge_radius}"
strike_velocity = "{velocity}"

[panel]
opening = "{opening}"
{panel}

[run]
end_time = "{end_time}"
{run}
"""

SPHERE = """
[fabric]
name = "S-728"
[projectile]
shape = "sphere"
mass = "0.69 g"
diameter = "5.5 mm"
strike_velocity = "120 m/s"
[panel]
opening = "{opening}"
{panel}
[run]
end_time = "{end_time}"
"""


def sphere_scene(opening, end_time, panel):
    """Text of a scene of a sphere at S-728; `panel` are further lines of its table."""
    return SPHERE.format(opening=opening, end_time=end_time, panel=panel)


def impact_scene(
    velocity="155 m/s",
    opening="50 mm",
    end_time="60 us",
    *,
    fabric="S-720",
    edge_radius="0.3 mm",
    head="",
    panel="",
    run="",
    extra="",
):
    """Text of a scene; `head`, `panel` and `run` are further lines of the file and of these tables, `extra` follows."""
    return (
        SCENE.format(
            velocity=velocity,
            opening=opening,
            end_time=end_time,
            fabric=fabric,
            edge_radius=edge_radius,
            head=head,
            panel=panel,
            run=run,
        )
        + extra
    )


def merged(table, changes):
    """A table with the values of `changes` in place of its own, through the tables in it; None removes a key."""
    found = copy.deepcopy(table)
    for key, value in changes.items():
        both = isinstance(value, dict) and isinstance(found.get(key), dict)
        found[key] = merged(found[key], value) if both else copy.deepcopy(value)
    return {key: value for key, value in found.items() if value is not None}


def table_of(key, value):
    """{"panel": {"boundary": {"warp": value}}} of "panel.boundary.warp"."""
    for part in reversed(key.split(".")):
        value = {part: value}
    return value


def inline(value):
    """TOML of a value, tables in one line."""
    if isinstance(value, dict):
        return (
            "{ "
            + ", ".join(f"{json.dumps(key)} = {inline(part)}" for key, part in value.items())
            + " }"
        )
    if isinstance(value, list):
        return "[" + ", ".join(inline(part) for part in value) + "]"
    return json.dumps(value).replace("Infinity", "inf")


def toml(table):
    """The text of an input file that holds a table."""
    return "".join(f"{key} = {inline(value)}\n" for key, value in table.items())


def every(snapshots, checkpoints):
    """Lines of [run] with the intervals of snapshots and of checkpoints, as texts with a unit."""
    return f'snapshot_interval = "{snapshots}"\ncheckpoint_interval = "{checkpoints}"\n'


def scale_quantity(text, factor):
    """Multiply the number of a quantity as text by a factor; None of a text that begins with no number."""
    number = NUMBER.match(text)
    if number is None:
        return None
    return f"{float(number[0]) * factor:.12g}{text[number.end() :]}"


def is_whole(out):
    """Tell whether a folder of results says that it is whole, and is."""
    listed = file_list.FileList.read(out)
    return listed.whole is not None and not listed.damaged(out, ["*", "*/*"])


def datasets(path):
    """Every dataset of an HDF5 file, as bytes."""
    found = {}
    with h5py.File(path) as file:
        file.visititems(
            lambda name, item: (
                found.update({name: item[()].tobytes()}) if isinstance(item, h5py.Dataset) else None
            )
        )
    return found
