"""One ply that stops the projectile: time and deflection of the stop, energy, peak tensions."""

from __future__ import annotations

from validation.verification.cost_accuracy import shots
from validation.verification.cost_accuracy.core import Quantity, Scene

QUANTITIES = (
    Quantity("stop time", "s", "motion"),
    Quantity("deflection", "m", "motion"),
    Quantity("energy absorbed early", "J", "motion"),
    Quantity("warp tension", "N", "peak tension"),
    Quantity("weft tension", "N", "peak tension"),
)


def scene(quick: bool = False) -> Scene:
    """The scene; `quick` takes coarser references."""
    shot = shots.read("ply-stopped")
    meshes, finer = shots.references(shot, (1, 2, 3) if quick else (2, 3, 4, 5))
    text = (
        f"{shot.fabric}, one ply clamped over {1e3 * shot.opening:g} mm, is struck at {shot.velocities[0]:g} m/s by "
        f"the thesis's projectile and stops it. Quantities: when, how deep, the energy taken up after "
        f"{1e6 * shot.early:g} µs, and the largest tension of warp and weft."
    )
    return Scene(
        "ply-stopped", f"One ply stopped: {shot.fabric} at {shot.velocities[0]:g} m/s", text, QUANTITIES,
        shots.methods(shot), shots.run, shots.warm, meshes, finer,
    )  # fmt: skip
