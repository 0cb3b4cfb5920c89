"""The two meshes of tests/meshing, whose input files are read back here."""

from tests.meshing.conftest import mesh

__all__ = ["mesh"]
