"""Packs of plies: the source's multi-ply outcomes, what contact has to do with failure, gap and stacking (issue 5)."""
