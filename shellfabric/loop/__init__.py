"""Explicit time integration: the time loop, what plies and projectile do in a step, audit and guards,
histories, snapshots, checkpoints."""
