"""Four plies that stop the projectile: time and deflection of the stop, energy, peak tensions."""

from __future__ import annotations

from validation.verification.cost_accuracy import packs, ply_stopped, shots
from validation.verification.cost_accuracy.core import Scene


def scene(quick: bool = False) -> Scene:
    """The scene; `quick` takes coarser references."""
    shot = shots.read("four-ply-pack")
    meshes, finer = packs.references(shot, (0.5, 1, 2) if quick else (1, 2, 3, 4))
    text = (
        f"Four plies of {shot.fabric}, aligned, with the fabric's own gap, clamped over {1e3 * shot.opening:g} "
        f"mm, are struck at {shot.velocities[0]:g} m/s and stop the projectile. Quantities: those of one ply, the "
        'tensions being the largest of any ply. Here "default" has one element per crossover; the default mesh of '
        'packs in `weavecell impact` is "graded from 1/2 crossover".'
    )
    return Scene(
        "four-ply-pack", f"Four plies: {shot.fabric} at {shot.velocities[0]:g} m/s", text, ply_stopped.QUANTITIES,
        packs.methods(shot), packs.run, packs.warm, meshes, finer,
    )  # fmt: skip
