"""The scene that tests of the command line share, 3 g at a small panel of S-720, and what a file of results holds."""

import h5py

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


def impact_scene(
    velocity="155 m/s", opening="50 mm", end_time="60 us", *, fabric="S-720", edge_radius="0.3 mm", head="", panel="",
    run="", extra="",
):  # fmt: skip
    """Text of a scene; `head`, `panel` and `run` are further lines of the file and of these tables, `extra` follows."""
    return SCENE.format(
        velocity=velocity, opening=opening, end_time=end_time, fabric=fabric, edge_radius=edge_radius, head=head,
        panel=panel, run=run,
    ) + extra  # fmt: skip


def every(snapshots, checkpoints):
    """Lines of [run] with the intervals of snapshots and of checkpoints, as texts with a unit."""
    return f'snapshot_interval = "{snapshots}"\ncheckpoint_interval = "{checkpoints}"\n'


def datasets(path):
    """Every dataset of an HDF5 file, as bytes."""
    found = {}
    with h5py.File(path) as file:
        file.visititems(
            lambda name, item: found.update({name: item[()].tobytes()}) if isinstance(item, h5py.Dataset) else None
        )
    return found
