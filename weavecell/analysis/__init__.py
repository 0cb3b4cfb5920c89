"""Analyses of the product: uncertainty of mesh and data, fits, fired tests, biaxial tests."""
