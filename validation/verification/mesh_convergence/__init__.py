"""Convergence of the shell with its mesh: critical velocity and peak tension of the six Kevlar fabrics.

With 1, 2, 3 elements a crossover along each side, by which the cloth is resolved ever finer under one and the same
crossover model, projectile and contact law. Nothing here is compared with a measurement; the reference is the limit
that the meshes themselves extrapolate to (`richardson`).
"""
