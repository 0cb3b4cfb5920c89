"""Packs of plies: contact between plies, non-penetration of torn plies."""
