"""Explicit dynamics of a fabric panel under impact: numba kernels on a structured grid of crossovers."""
