"""The cable net beside the ladder: what it costs and gets wrong on the standard scenes, so that nobody need wonder.

Its yarns do not couple, which is no matter where they are nearly straight (S-731); it is never the cheapest.
"""

from __future__ import annotations

import time
from collections.abc import Iterable
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np

from validation.models.cable import solver as cable_solver
from validation.models.cable.model import CableNet
from validation.verification.fidelity import fit_error_database, scenes
from weavecell.analysis.fidelity import quantities
from weavecell.analysis.fidelity.ladder import FULL

NAME = "cable net"


def row(name: str, number: int) -> dict[str, Any]:
    """What the net answers to a standard scene, and its process time [s]."""
    setup = scenes.standard(name)[number]
    setup = replace(setup, numerics=replace(setup.numerics, threads=1))
    began = time.process_time()
    found = cable_solver.run(CableNet.of(setup), setup.strike_velocity, setup.end_time, audit_interval=20e-6)
    seconds = time.process_time() - began
    result = SimpleNamespace(
        setup=setup, outcome=found.outcome, residual_velocity=found.residual_velocity, step_history=found.step_history,
        ply_tensions=[found.peak_tension],
    )  # fmt: skip
    return {NAME: {"values": quantities.of(result), "seconds": seconds}}


def errors(rows: Iterable[dict[str, Any]]) -> dict[str, Any]:
    """{"cost", "expected": {quantity: [-]}} as of a model of the ladder; rows joined to those of the survey."""
    expected = {}
    for name in quantities.NAMES:
        alike = [row for row in rows if quantities.is_defined(name, quantities.regime(row[FULL]["values"]))]
        off = np.array([fit_error_database.error(row[NAME]["values"], row[FULL]["values"], name) for row in alike])
        expected[name] = float(np.quantile(off[np.isfinite(off)], fit_error_database.OFTEN))
    cost = float(np.median([row[NAME]["seconds"] / row[FULL]["seconds"] for row in rows]))
    return {"cost": cost, "expected": expected}
