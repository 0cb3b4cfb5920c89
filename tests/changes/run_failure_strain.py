"""Yarns that fail at a strain below that of their strength fail earlier, pinned or resolved; a strain
that they do not reach changes nothing."""

import numpy as np

import weavecell as wc

SCENE = {"opening": "40 mm", "end_time": "15 us", "symmetry": "whole"}


def velocity(**options):
    """The history of the velocity [m/s]."""
    return wc.impact("S-726", "300 m/s", **SCENE | options).velocity


for model in ({}, {"crossovers": "yarns", "zone": "8 mm"}):
    usual = velocity(**model)
    early = velocity(failure_strain=0.015, **model)
    late = velocity(failure_strain=0.5, **model)
    assert early[-1] > usual[-1] > 0, model
    assert np.array_equal(late, usual), model
