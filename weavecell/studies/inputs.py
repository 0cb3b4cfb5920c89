"""Ranges and spreads of the input from inputs.toml, and a fabric changed by them.

Areal density changes mass alone, the stiffness of the yarns is kept, as in the thesis (thesis
section 6.3.3).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, fields, replace
from functools import cache
from math import inf
from pathlib import Path
from typing import Any

from fabrics import families, plausible, variants
from fabrics.base.checks import fraction, refuse
from fabrics.base.errors import InputError
from fabrics.base.files import read_data
from fabrics.fabric import Fabric
from shellfabric.impact.setup import ImpactSetup

_PATH = Path(__file__).with_suffix(".toml")


@dataclass(frozen=True)
class Scatter:
    """Scatter of yarns and panels.

    Parameters
    ----------
    shape : [-] Weibull modulus of the yarns' strength; infinite for yarns that are all alike, None
        for that of each fabric
    modulus, crimp : [-] standard deviation over mean from panel to panel
    """

    shape: float | None = inf
    modulus: float = 0.0
    crimp: float = 0.0

    def __post_init__(self):
        if self.shape is not None and not self.shape > 0:
            refuse(self, "shape", "above 0")
        fraction(self, "modulus", "crimp")
        plausible.judge(self.numbers())

    def numbers(self) -> Iterator[plausible.Number]:
        """Return the numbers that are compared with plausible ranges."""
        # yarns that are all alike have no scatter
        if self.shape is not None and self.shape < inf:
            yield plausible.Number("weibull_shape", "weibull_shape", self.shape)
        yield plausible.Number("modulus_cov", "cov", self.modulus)
        yield plausible.Number("crimp_cov", "cov", self.crimp)


@cache
def table(section: str) -> dict[str, families.Entry]:
    """Read the entries of a section, by name."""
    return families.entries(read_data(_PATH)[section])


def read_scatter() -> Scatter:
    """Read the scatter of inputs.toml; strengths scatter as the fabric's yarns do."""
    return Scatter(None, **{name: entry.value for name, entry in table("spread").items()})


def scale_fabric(fabric: Fabric, **factors: float) -> Fabric:
    """Multiply some numbers of a fabric by factors, by the names of [range] in inputs.toml.

    Raises
    ------
    InputError : an unknown name
    """
    factor = dict.fromkeys(table("range"), 1.0)
    unknown = set(factors) - set(factor)
    if unknown:
        raise InputError(key=min(unknown), allowed=f"one of {', '.join(factor)}")
    factor |= factors
    crimp = factor["crimp_warp"], factor["crimp_weft"]
    fabric = variants.scale_yarns(
        fabric, E=factor["modulus"], failure_strain=factor["failure_strain"], crimp=crimp
    )
    fabric = variants.scale_areal_density(fabric, factor["areal_density"])
    fabric = variants.scale_laws(fabric, factor["compression_a"], factor["compression_b"])
    fabric = variants.with_failure_length(fabric, factor["failure_length"] * fabric.failure_length)
    return variants.scale_shear(fabric, factor["trellis_stiffness"], factor["trellis_angles"])


def without_end(setup: ImpactSetup) -> ImpactSetup:
    """Return the set-up without the choices that a study of many shots passes over: each shot ends with its
    outcome, and takes no snapshots."""
    usual: dict[str, Any] = {one.name: one.default for one in fields(setup)}
    passed_over = {name: usual[name] for name in ("end_time", "snapshot_interval")}
    if setup.backing is not None:
        passed_over["backing"] = replace(setup.backing, after_stop=0.0)
    return replace(setup, **passed_over)


def use_one_thread(setup: ImpactSetup, **others: Any) -> ImpactSetup:
    """Return the set-up on one thread, since others run beside it, that records nothing beside its
    samples; others change."""
    numerics = replace(setup.numerics, threads=1)
    return replace(
        setup, **{"numerics": numerics, "history": None, "snapshot_interval": None} | others
    )


def scale_setup(setup: ImpactSetup, **factors: float) -> ImpactSetup:
    """Return a set-up whose plies are of a fabric changed by `scale_fabric`, with the laws that it
    names changed alike.

    Raises
    ------
    InputError : an unknown name
    """

    laws_factors = (factors.get("compression_a", 1.0), factors.get("compression_b", 1.0))

    def scale_ply(ply):
        laws = (
            ply.laws and variants.scale_laws(replace(ply.fabric, laws=ply.laws), *laws_factors).laws
        )
        return replace(ply, fabric=scale_fabric(ply.fabric, **factors), laws=laws)

    return scale_ply(replace(setup, lay_up=tuple(map(scale_ply, setup.lay_up))))
