"""Convergence of shots with the mesh, of plies and packs: critical velocity, and means over a window of velocities.

Nothing here is compared with a measurement; the reference is the same shot on a finer mesh.
"""
