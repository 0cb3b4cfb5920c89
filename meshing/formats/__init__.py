"""Mesh files: the formats of solvers and of ParaView."""
