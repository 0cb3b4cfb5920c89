"""What a test on a coupon leaves, in HDF5: its record (histories.h5), and the states to go on from (checkpoint.h5).

Layout of the record: attributes of the root for scalars and texts; /histories with one value a load step; /coupon with
the fabric at rest; /states with nodes and shear angles after every step; /final with the tensions of the yarns at the
end; /relaxation with the out-of-balance force of every iteration. Every dataset has the attribute "unit".
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from fabrics import run_cache
from fabrics.checks import FilePath
from fabrics.files import read_hdf5, write_hdf5
from weavecell.results import keys
from weavecell.results.hdf5_file import put

if TYPE_CHECKING:
    from shellfabric.coupon.dynamic_relaxation import State
    from shellfabric.coupon.solver import Result

FORMAT = "weavecell coupon 2"
_CHECKPOINT = "weavecell coupon checkpoint 3"
# attribute of the record: attribute of the file, and key of summary.json
_SCALARS = {
    "title": "title",
    "fabric": "fabric",
    "law_name": "law_name",
    "test": "test",
    "prescribed_name": "prescribed_name",
    "prescribed_unit": "prescribed_unit",
    "outcome": "outcome",
    "failure_message": "failure_message",
    "elements": "elements",
    "wall_time": "wall_time_s",
}
_STATE = {"load": "1", "x": "m", "reaction": "N", "history": "N", "residual": "1", "energies": "J"}


@dataclass(frozen=True)
class CouponRecord:
    """One test on one coupon.

    Parameters
    ----------
    title, fabric, law_name : for the reader
    test : of scenes.coupon.TESTS
    prescribed_name, prescribed_unit : what was prescribed
    outcome : "complete", "yarn at its strength" or "unstable"
    failure_message : why an unstable run was ended; "" for others
    elements : woven quadrilaterals
    floor : [N] reaction below which the coupon counts as unloaded
    wall_time : [s]
    prescribed : (k,) its value at each step
    measures : {name: (unit, (k,))} of `coupon_measures`
    energies : {"yarns", "trellis": (k,)} [J]
    residual, iterations : (k,) out-of-balance force over the reaction [-], and what it took
    points, quads, warp, weft, grips : of the coupon at rest
    x : (k, n, 2) [m] nodes
    shear : (k, q) [rad]
    tension : ((e1,), (e2,)) [N] at the end
    relaxation : (iterations of all steps, 2) [N] out-of-balance force and reaction
    checks : tuple of shellfabric.panel.quality.Indicator; kept in summary.json alone
    """

    title: str
    fabric: str
    law_name: str
    test: str
    prescribed_name: str
    prescribed_unit: str
    outcome: str
    failure_message: str
    elements: int
    floor: float
    wall_time: float
    prescribed: np.ndarray
    measures: dict
    energies: dict
    residual: np.ndarray
    iterations: np.ndarray
    points: np.ndarray
    quads: np.ndarray
    warp: np.ndarray
    weft: np.ndarray
    grips: np.ndarray
    x: np.ndarray
    shear: np.ndarray
    tension: tuple
    relaxation: np.ndarray
    checks: tuple = ()

    @classmethod
    def of(
        cls, result: Result, measures: dict[str, tuple[str, np.ndarray]], prescribed: tuple[str, str], **scalars: Any
    ) -> CouponRecord:
        """The record of a `shellfabric.coupon.solver.Result`; `prescribed` is (name, unit)."""
        coupon, states = result.coupon, result.states
        x = np.array([state.x for state in states])
        return cls(
            **scalars, prescribed_name=prescribed[0], prescribed_unit=prescribed[1],
            outcome=result.outcome, elements=len(coupon.quads),
            floor=result.force_floor,
            prescribed=result.prescribed, measures=measures,
            energies=dict(zip(("yarns", "trellis"), np.array([state.energies for state in states]).T)),
            residual=np.array([state.residual for state in states]),
            iterations=np.array([state.iterations for state in states]),
            points=coupon.points, quads=coupon.quads, warp=coupon.edges[0], weft=coupon.edges[1], grips=result.grips,
            x=x, shear=np.array([coupon.shear_angles(nodes) for nodes in x]), tension=coupon.tensions(x[-1]),
            relaxation=np.concatenate([state.history for state in states]),
        )  # fmt: skip

    def summary(self) -> dict[str, Any]:
        """The scalars of the record, and the last of what was measured, as a dict."""
        return {key: getattr(self, name) for name, key in _SCALARS.items()} | {
            "steps": len(self.prescribed),
            "iterations": int(self.iterations.sum()),
            "residual_max": float(self.residual.max()),
            "at_end": {self.prescribed_name: {"value": float(self.prescribed[-1]), "unit": self.prescribed_unit}}
            | {name: {"value": float(values[-1]), "unit": unit} for name, (unit, values) in self.measures.items()},
        }

    def write(self, path: FilePath) -> None:
        """Write the record, whole or not at all."""
        with write_hdf5(path, FORMAT) as file:
            for name, key in _SCALARS.items():
                file.attrs[key] = getattr(self, name)
            put(file, f"histories/{self.prescribed_name}", self.prescribed, self.prescribed_unit)
            for name, (unit, values) in self.measures.items():
                put(file, f"histories/{name}", values, unit)
            for name, values in self.energies.items():
                put(file, f"histories/energy of the {name}", values, "J")
            put(file, "histories/residual", self.residual, "1")
            put(file, "histories/iterations", self.iterations, "1")
            for name, unit in keys.units(keys.COUPON_MESH).items():
                put(file, f"coupon/{name}", getattr(self, name), unit)
            put(file, "states/x", self.x, "m", compression="gzip", shuffle=True)
            put(file, "states/shear", self.shear, "rad", compression="gzip", shuffle=True)
            for name, values in zip(("warp", "weft"), self.tension):
                put(file, f"final/tension_{name}", values, "N")
            put(file, "relaxation", self.relaxation, "N")


def write_states(path: FilePath, stamp: Mapping[str, str], states: Sequence[State]) -> None:
    """Keep the states of a run under way; `stamp` (`fabrics.run_cache`) is that of its scene and of the code."""
    with write_hdf5(path, _CHECKPOINT, **stamp) as file:
        for number, state in enumerate(states):
            for name, unit in _STATE.items():
                put(file, f"{number:05d}/{name}", getattr(state, name), unit)


def read_states(path: FilePath, stamp: Mapping[str, str]) -> tuple[State, ...]:
    """The states that `write_states` wrote; InputError if there are none, or those of another scene or other code."""
    from shellfabric.coupon.dynamic_relaxation import State

    with read_hdf5(path, _CHECKPOINT) as file:
        run_cache.check_stamp(file.attrs, stamp, path, of="scene")
        found = [{name: group[name][()] for name in _STATE} for _, group in sorted(file.items())]
    return tuple(
        State(
            load=float(values.pop("load")), residual=float(values.pop("residual")), settled=True,
            energies=tuple(values.pop("energies")), **values,
        )
        for values in found
    )  # fmt: skip
