"""The explicit solver of plies and projectile: time steps, energies of a ply, compilation ahead of
a run."""
