"""One ply: its arrays, boundary conditions, time step, grading, explicit time integration and quality indicators."""
