"""The surface of a ply that nose, other plies, block and resolved yarns touch: grid with ghosts,
spline, torn edges, nodal forces."""
