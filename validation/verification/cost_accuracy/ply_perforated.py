"""One ply that the projectile perforates: what velocity is left, what energy was absorbed."""

from __future__ import annotations

from validation.verification.cost_accuracy import shots
from validation.verification.cost_accuracy.core import Quantity, Scene


def scene(quick: bool = False) -> Scene:
    """The scene; `quick` takes coarser references."""
    shot = shots.read("ply-perforated")
    meshes, finer = shots.references(shot, (1, 2, 3) if quick else (2, 3, 4, 5))
    quantities = [Quantity(f"residual velocity at {v:g} m/s", "m/s", "residual velocity") for v in shot.velocities]
    quantities += [Quantity(f"energy at {v:g} m/s", "J", "absorbed energy") for v in shot.velocities]
    speeds = ", ".join(f"{v:g}" for v in shot.velocities[:-1]) + f" and {shot.velocities[-1]:g} m/s"
    text = (
        f"{shot.fabric}, one ply clamped over {1e3 * shot.opening:g} mm, is struck at {speeds} and perforated; the "
        "cost is that of all these shots. The peak tension is the strength of the yarns that fail."
    )
    return Scene(
        "ply-perforated", f"One ply perforated: {shot.fabric} at {speeds}", text, tuple(quantities),
        shots.methods(shot), shots.run, shots.warm, meshes, finer,
    )  # fmt: skip
