"""What is recorded of a run: hooks, histories, snapshots, wave fronts, checkpoints."""
