"""Kernels of the woven membrane: element forces, bending, jamming, yarn failure, energies, boundary, smooth surface."""
