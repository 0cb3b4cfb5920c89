"""Sliding crossovers in packs of plies."""
