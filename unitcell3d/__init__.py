"""The quasi-static crossover of two yarns in three dimensions (dolfinx, PETSc), and the compression law it yields."""
