"""Outcomes of several shots."""

DEPENDS = "depends"  # of shots whose outcomes differ
