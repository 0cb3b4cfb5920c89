"""Tests on coupons: what is measured after each load step, or sample of a pull-out, and their files
in HDF5.

Layout of histories.h5 of a quasi-static test: attributes of the root for scalars and texts;
/histories with one value a load step; /coupon with the fabric at rest; /states with nodes and shear
angles after every step; /final with the tensions of the yarns at the end; /relaxation with the
out-of-balance force of every iteration. That of a pull-out has /histories alone. Every dataset has
the attribute "unit".
"""

from __future__ import annotations

from math import pi
from typing import TYPE_CHECKING, Any

import numpy as np

from fabrics.base.checks import FilePath
from fabrics.base.files import write_hdf5
from fabrics.base.record import Record
from fabrics.fabric_tables import FAMILIES
from weavecell.results.hdf5_file import put
from weavecell.results.keys import COUPON_MEASURES

if TYPE_CHECKING:
    from shellfabric.coupon.pull_out import PullOutCurve
    from shellfabric.coupon.solver import Result
    from shellfabric.membrane.indicator import Indicator

FORMAT = "weavecell coupon 2"
PULL_OUT_FORMAT = "weavecell pull-out 2"
# stretches along each side of the cell's table, as many as in impacts
TABLE_SIZE = 201
# by each test
PRESCRIBED = {
    "bias_extension": "elongation",
    "picture_frame": "shear angle",
    "uniaxial": "strain of the strip",
    "biaxial": "strain of the cross",
}
# column that is 1 in steps of slack yarns
UNLOADED = "unloaded"


def record(inputs: Any, solved: Result, **facts: Any) -> Record:
    """Make the record of a test, a row a load step: first what is prescribed, then what is
    measured.

    Parameters
    ----------
    inputs : table of the test in the input file
    solved : `shellfabric.coupon.solver.Result`
    facts : further ones that come first, the name of the test among them
    """
    from shellfabric.coupon.quasistatic import softened_work

    test = facts["test"]
    measure = {
        "bias_extension": _bias,
        "picture_frame": _frame,
        "uniaxial": _uniaxial,
        "biaxial": _biaxial,
    }[test]
    prescribed = PRESCRIBED[test]
    measures = {prescribed: solved.prescribed} | measure(inputs, solved)
    measures[UNLOADED] = solved.unloaded.astype(int)
    facts |= {
        "prescribed_name": prescribed,
        "prescribed_unit": COUPON_MEASURES[prescribed].si_unit,
        "outcome": solved.outcome,
        "elements": len(solved.coupon.quads),
        "yarn_stiffness_share": solved.coupon.yarn_share,
        "softened_work_share": softened_work(solved.coupon, solved.states[-1]),
        "steps": len(solved.prescribed),
        "iterations": sum(state.iterations for state in solved.states),
        "residual_max": _residual_max(solved),
    }
    return _record_of(measures, facts)


def _record_of(measures, facts):
    """Return the Record of {name: values} and facts; keys.toml has units and meanings."""
    meanings = {}
    for name in measures:
        key = COUPON_MEASURES[name]
        meanings[name] = f"[{key.si_unit}] {key.meaning}"
    return Record(measures, meanings, facts)


def _residual_max(solved):
    return max(state.residual for state in solved.states)


def _bias(inputs, solved):
    from shellfabric.coupon import quasistatic

    size = quasistatic.bias_size(solved)
    shear = np.array([solved.shear(step) for step in range(len(solved.states))])
    zones = quasistatic.zones(solved.coupon, *size)
    measures = {"load": np.abs(solved.force(1, 1))}
    angles = []
    for number, zone in enumerate(quasistatic.ZONES):
        angle = 0.5 * pi - shear[:, zones == number].mean(axis=1)
        angles.append(angle)
        measures[f"angle in zone {zone}"] = angle
    a, b, c = angles
    rigid = [quasistatic.inextensible_shear(*size, end) for end in solved.prescribed]
    concentration = [quasistatic.concentration(gamma, zones == 2) for gamma in shear]
    return measures | {
        "B less the mean of A and C": b - 0.5 * (a + c),
        "zone C, yarns that do not stretch": 0.5 * pi - np.array(rigid),
        "shear concentration": np.array(concentration),
    }


def _frame(inputs, solved):
    from shellfabric.coupon import quasistatic

    measures = {"shear stress": quasistatic.frame_stress(solved)}
    law = solved.coupon.table.model.fabric.shear
    if law is not None:
        measures["trellis law"] = law.stress(solved.prescribed)
    return measures


def _uniaxial(inputs, solved):
    from shellfabric.coupon import quasistatic

    weave = solved.coupon.weave
    along = 1
    if inputs.direction == "warp":
        along = 0
    size = np.ptp(solved.coupon.points, axis=0)
    yarns = round(float(size[1]) / (2 * weave.w[1 - along]))
    strain = quasistatic.middle_strain(solved, 0.2 * (size if along == 0 else size[::-1]))
    load = solved.force(1, 0)
    return {
        "load": load,
        "load of a yarn": load / yarns,
        "strain in the middle, along": strain[:, along],
        "strain in the middle, across": strain[:, 1 - along],
    }


def _biaxial(inputs, solved):
    from shellfabric.coupon import quasistatic

    strains = quasistatic.middle_strain(
        solved, [0.6 * inputs.centre * w for w in solved.coupon.weave.w]
    )
    cell = solved.coupon.table.model.solve(*(1 + strains.T))
    loads = solved.force(1, 0), solved.force(3, 1)
    measures = {}
    for family, load, strain in zip(FAMILIES, loads, strains.T):
        measures[f"load of a {family} yarn"] = load / inputs.centre
        measures[f"strain in the middle, {family}"] = strain
    for family, name in zip(FAMILIES, ("N1", "N2")):
        measures[f"cell at these strains, {family}"] = cell[name]
    return measures


def indicators(solved: Result, tolerance: float) -> tuple[Indicator, ...]:
    """Compute the quality indicators of a test; the load step in which a yarn fails may go beyond
    its strength."""
    from shellfabric.membrane import quality

    coupon = solved.coupon
    peaks = [float(tension.max()) for tension in coupon.tensions(solved.states[-1].x)]
    if solved.outcome == "yarn at its strength":
        peaks = [min(peak, yarn.strength) for peak, yarn in zip(peaks, coupon.weave.yarns)]
    return quality.of_coupon(coupon.table, peaks, _residual_max(solved), tolerance)


def indicate_locking(solved: Result) -> tuple[Indicator, ...]:
    """Indicate how far a picture frame is sheared beyond the angle at which its yarns lock."""
    from shellfabric.membrane import quality

    law = solved.coupon.table.model.fabric.shear
    if law is None or not len(solved.prescribed):
        return ()
    angle = float(np.max(np.abs(solved.prescribed)))
    return (quality.indicator("shear beyond locking", angle / law.gamma2),)


def pull_out_record(curve: PullOutCurve, **facts: Any) -> Record:
    """Make the record of a curve, a row a sample; `facts` come first."""
    coupon = curve.coupon
    measures = {
        "displacement of the crosshead": curve.displacement,
        "load": curve.load,
        "crossovers in slip": curve.sliding,
        "crossovers left": curve.left,
        "work of friction": curve.friction_work,
    }
    facts |= {
        "crossings": coupon.crossings,
        "pre_tension_N": coupon.pre_tension,
        "crossover_friction": float(coupon.friction),
        "crossover_cohesion_N": coupon.cohesion,
        "yarn_bending_N_m2": coupon.bending[0],
        "displacement_m": float(curve.displacement[-1]),
        "peak_load_N": curve.peak,
        "plateau_load_N": curve.plateau,
        "slip_length_m": curve.slip_length,
        "crossovers_left": int(curve.left[-1]),
        "crossover_friction_work_J": float(curve.friction_work[-1]),
    }
    return _record_of(measures, facts)


def pull_out_indicators(curve: PullOutCurve) -> tuple[Indicator, ...]:
    """Compute the quality indicators of a pull-out."""
    from shellfabric.membrane import quality

    return quality.of_cell(curve.coupon.table, (curve.peak, curve.coupon.pre_tension))


def write(path: FilePath, record: Record, solved: Result | None = None) -> None:
    """Write histories.h5, whole or not at all; `solved` is what the solver returned, None of a
    pull-out."""
    kind = PULL_OUT_FORMAT
    arrays = {}
    if solved is not None:
        kind = FORMAT
        arrays = _arrays(solved)
    with write_hdf5(path, kind) as file:
        for name, value in record.facts.items():
            if value is not None:
                file.attrs[name] = value
        for name, values in record.columns.items():
            put(file, f"histories/{name}", values, record.unit(name))
        for name, (values, unit) in arrays.items():
            put(file, name, values, unit)


def _arrays(solved):
    """{dataset: (array, unit)} of a quasi-static test beside its record."""
    coupon = solved.coupon
    states = solved.states
    x = np.array([state.x for state in states])
    yarns, trellis = np.transpose([state.energies for state in states])
    warp, weft = coupon.tensions(x[-1])
    return {
        "histories/energy of the yarns": (yarns, "J"),
        "histories/energy of the trellis": (trellis, "J"),
        "histories/residual": ([state.residual for state in states], "1"),
        "histories/iterations": ([state.iterations for state in states], "1"),
        "coupon/points": (coupon.points, "m"),
        "coupon/quads": (coupon.quads, "1"),
        "coupon/warp": (coupon.edges[0], "1"),
        "coupon/weft": (coupon.edges[1], "1"),
        "coupon/grips": (solved.grips, "1"),
        "states/x": (x, "m"),
        "states/shear": ([coupon.shear_angles(nodes) for nodes in x], "rad"),
        "final/tension_warp": (warp, "N"),
        "final/tension_weft": (weft, "N"),
        "relaxation": (np.concatenate([state.history for state in states]), "N"),
    }
