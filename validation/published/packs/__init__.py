"""Packs of plies: the thesis's multi-ply outcomes, what contact has to do with failure, gap and stacking (issue 5)."""
