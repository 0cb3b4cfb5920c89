"""Woven yarns as solids with fibre bars under impact: an explicit solver of its own."""
