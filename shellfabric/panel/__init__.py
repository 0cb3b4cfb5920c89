"""One ply: its arrays, boundary conditions, time step, grading, motion and quality indicators."""
