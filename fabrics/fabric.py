"""A fabric: its weave with everything known about it, each number with its source."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from fabrics.base.checks import positive, refuse
from fabrics.base.errors import InputError
from fabrics.base.frozen import explain_frozen
from fabrics.base.run_cache import ADDED_LATER
from fabrics.compression import CompressionLaw
from fabrics.families.strain_rate import RateLaw
from fabrics.solid import SolidLaw
from fabrics.trellis import TrellisShear
from fabrics.weave import Weave
from fabrics.yarn import WeavingDamage

if TYPE_CHECKING:
    from fabrics.ply_law import PlyLaw

SECTIONS = ("sine", "ellipse", "conforming")


@explain_frozen
@dataclass(frozen=True, repr=False)
class Fabric:
    """One fabric of the catalogue, or of a user's file.

    Parameters
    ----------
    name : str
    weave : Weave
    laws : (CompressionLaw, CompressionLaw) or None, published compression laws of warp and weft
    shear : TrellisShear or None
    solid_laws : (SolidLaw, SolidLaw) or None, of warp and weft in the 3D crossover
    section : of SECTIONS, the yarn section of the 3D crossover; None takes the first of them that
        fits
    areal_density_measured : [kg/m2] or None
    interlayer_gap : [m] what neighbouring plies of a pack close in a test besides their contact
        law, or None
    effective_linear_density : (warp, weft) [kg/m] that the runs of the thesis really used (erratum
        E-07), or None
    micrograph : {"warp": {...}, "weft": {...}} [SI] values read from section pictures
    sources : {dotted key: {"value", "source", "status"}} as written in the data file
    assumed : of "crimp", "weave", "failure_length", "shear", "solid", "strain_rate" and
        `data_sheet.OF_SHOTS` what the data file does not give (see `fabrics.assumed`)
    yarn_width : (warp, weft) [m] widths of the yarns in the fabric, each None if not known
    thickness : [m] of the data sheet, or None
    yarn_area : (warp, weft) [m2] areas of the yarns' sections, gaps between fibres included, each
        None if not known
    notes : lines about numbers of the data file that disagree
    ply_contact : PlyLaw of plies of this fabric on each other, or None (see
        `fabrics.ply_laws.default`)
    strain_rate : RateLaw of its yarns, or None
    failure_length : [m] half width, across the fibres, of the mean tension that is held against the
        strength
    gauge_length : [m] of the yarns that have the strength of `weave` on average (`length_factors`)
    weibull_shape : [-] of the distribution of their strengths
    ranges : {dotted key: (low, high) over the value} of numbers with a range of their own
    deviations : (dotted key, standard deviation over the value) of those whose distribution is normal
    guessed : dotted keys of numbers that are assumed without a range
    family : name of the fibre family whose values are assumed; None takes that which modulus and
        fibre density decide
    idealised : whether numbers beyond the plausible are meant (`fabrics.plausible`)
    """

    name: str
    weave: Weave
    laws: tuple[CompressionLaw, CompressionLaw] | None = None
    shear: TrellisShear | None = None
    solid_laws: tuple[SolidLaw, SolidLaw] | None = None
    section: str | None = None
    areal_density_measured: float | None = None
    interlayer_gap: float | None = None
    effective_linear_density: tuple[float, float] | None = None
    micrograph: Mapping = field(default_factory=dict)
    sources: Mapping = field(default_factory=dict)
    assumed: tuple[str, ...] = ()
    yarn_width: tuple[float | None, float | None] = (None, None)
    yarn_area: tuple[float | None, float | None] = (None, None)
    thickness: float | None = None
    notes: tuple[str, ...] = ()
    ply_contact: PlyLaw | None = None
    strain_rate: RateLaw | None = None
    failure_length: float = 0.75e-3
    ranges: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    guessed: tuple[str, ...] = ()
    family: str | None = None
    idealised: bool = False
    gauge_length: float = field(default=0.2, metadata=ADDED_LATER)
    weibull_shape: float = field(default=14.3, metadata=ADDED_LATER)
    deviations: tuple[tuple[str, float], ...] = field(default=(), metadata=ADDED_LATER)

    def __post_init__(self):
        positive(self, "failure_length", "gauge_length", "weibull_shape")
        if self.section is not None and self.section not in SECTIONS:
            refuse(
                self,
                "section",
                ", ".join(SECTIONS[:-1]) + f" or {SECTIONS[-1]}",
            )
        for family, width in zip(("warp", "weft"), self.yarn_width):
            if width is not None and not width > 0:
                raise InputError(key=f"{family}.width", value=width, allowed="a positive number")

    def __repr__(self) -> str:
        weave = self.weave
        warp, weft = weave.yarns
        known = "no compression law"
        if self.laws:
            known = "with compression law"
        known += f", assumed: {', '.join(self.assumed)}" if self.assumed else ""
        return (
            f"Fabric({self.name}: {1e3 * weave.areal_density:.0f} g/m², {weave.warp_count / 100:.3g} x "
            f"{weave.weft_count / 100:.3g} yarns per cm of {warp.strength:.0f}/{weft.strength:.0f} N, crimp "
            f"{100 * warp.crimp:.3g}/{100 * weft.crimp:.3g} %, {known})"
        )

    def length_factors(self, lengths: Iterable[float]) -> tuple[float, ...]:
        """Compute what the mean strength of yarns of these lengths [m] is over that of the gauge length
        [-].

        A yarn is as strong as its weakest place. Of yarns whose strengths T at the length L0 follow 1 -
        exp(-(T / T0)^m), those of the length L follow 1 - exp(-(L / L0) (T / T0)^m): all strengths are
        multiplied by (L0 / L)^(1 / m), and their scatter stays (W. Weibull, J. Appl. Mech. 18 (1951) 293).
        """
        return tuple((self.gauge_length / length) ** (1 / self.weibull_shape) for length in lengths)

    def with_yarns(self, **values: float | Iterable[float]) -> Fabric:
        """Return this fabric with other values of its yarns; further changes are in
        `fabrics.variants`.

        Parameters
        ----------
        values : fields of `Yarn`, each a number for both families or a pair (warp, weft)

        Raises
        ------
        InputError : a value that `Yarn` does not allow
        """
        pairs = {name: pair(value) for name, value in values.items()}
        warp, weft = (
            replace(yarn, **{name: two[k] for name, two in pairs.items()})
            for k, yarn in enumerate(self.weave.yarns)
        )
        return replace(self, weave=replace(self.weave, warp=warp, weft=weft))

    def with_effective_density(self) -> Fabric:
        """Return this fabric with the linear densities that the shell runs of the thesis used
        (erratum E-07).

        Raises
        ------
        InputError : the fabric's file gives none
        """
        if self.effective_linear_density is None:
            raise InputError(f"fabric {self.name} has no effective linear density")
        return self.with_yarns(linear_density=self.effective_linear_density)

    def at_high_rate(self) -> Fabric:
        """Return this fabric with the modulus that its yarns have at the highest rate of
        `strain_rate`; strengths stay.

        Raises
        ------
        InputError : a failure strain that is not below 1
        """
        ratio = 1.0
        if self.strain_rate is not None:
            ratio = self.strain_rate.dynamic_modulus
        if ratio == 1.0:
            return self
        pairs = [(ratio * yarn.E, yarn.failure_strain / ratio) for yarn in self.weave.yarns]
        moduli, strains = zip(*pairs)
        return self.with_yarns(E=moduli, failure_strain=strains)

    def with_weaving_damage(self, damage: WeavingDamage) -> Fabric:
        """Return this fabric with modulus and strength of its yarns after weaving; geometry, masses
        and laws stay.

        The shares go into `sources`, with their source and status.

        Raises
        ------
        InputError : a failure strain that is not below 1
        """
        warp, weft = (yarn.woven(damage) for yarn in self.weave.yarns)
        entry = {"source": damage.source, "status": damage.status}
        sources = {}
        for key, share in damage.shares.items():
            sources[f"weaving_damage.{key}"] = {"value": share, **entry}
        return replace(
            self,
            weave=replace(self.weave, warp=warp, weft=weft),
            sources={**self.sources, **sources},
        )


def pair(value: float | Iterable[float]) -> tuple[float, float]:
    """Return (warp, weft) of a number for both families, or of a pair."""
    if isinstance(value, Iterable):
        warp, weft = value
    else:
        warp = value
        weft = value
    return warp, weft
