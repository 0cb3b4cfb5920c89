"""Kernels of the woven membrane: element forces, bending, packing, yarn failure, energies,
boundary, smooth surface."""
