"""Constraints, periodic images, sparsity patterns and linear solver; the differences between versions of dolfinx."""
