"""The mesh that is made for a request: crimp, closed sections, element numbers; the same for
crossover and patch."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from fabrics import assumed
from fabrics.base.errors import InputError
from fabrics.data_sheet import entries
from fabrics.fabric import Fabric
from fabrics.weave import Weave
from meshing import inputs
from meshing.inputs import TIP_THICKNESS_RATIO, Size
from meshing.section_fit import SectionFit, fit_sections, least_that_fits, leaves_room


@dataclass(frozen=True)
class Plan:
    """What both kinds of mesh are built from.

    Parameters
    ----------
    fabric : str
    weave : Weave, with the crimp requested
    section_fit : SectionFit
    size : (nx, ny, nz) hexahedra along, across and through a quarter of each yarn
    end_shells : [m] or None
    """

    fabric: str
    weave: Weave
    section_fit: SectionFit
    size: tuple[int, int, int]
    end_shells: float | None

    @classmethod
    def of(
        cls,
        fabric: Fabric,
        *,
        size: Size,
        shift: bool,
        section: str | None = None,
        gap: float = 0.0,
        width: Sequence[float] | None = None,
        tip_thickness_ratio: float = TIP_THICKNESS_RATIO,
        overlap: str = "solve",
        crimp: str | Sequence[float] = "hand",
        end_shells: float | None = None,
    ) -> Plan:
        """Check and resolve a request, with the options of `meshing.inputs.MeshOptions`.

        Parameters
        ----------
        size : as in `meshing.inputs.size`
        shift : whether a rigid shift can remove an overlap

        Raises
        ------
        InputError : a value is not allowed, a weave that is not plain, or the sections overlap and
            this is refused or cannot be solved
        """
        if shift:  # a patch may float
            fabric.weave.require_plain("solid yarns and the 3D crossover")
        inputs.one_of("overlap", overlap, ("solve", "refuse"))
        inputs.thickness("end_shells", end_shells)
        fabric = inputs.crimped(fabric, crimp)
        weave = fabric.weave
        section_fit = fit_sections(
            fabric.section if section is None else section,
            inputs.widths(fabric, gap, width),
            inputs.fractions(fabric),
            weave,
            tip_thickness_ratio,
            prescribed=width is not None,
            overlap=overlap,
            shift=shift,
        )
        elements = inputs.size(size, weave, section_fit.sections)
        return cls(fabric.name, weave, section_fit, elements, end_shells)

    def fields(self) -> dict:
        """Return those fields of a `YarnMesh` that do not depend on its extent."""
        weave = self.weave
        return {
            "fabric": self.fabric,
            "w": weave.w,
            "h0": weave.h0,
            "S0": weave.S0,
            "fibre_area": tuple(yarn.A_s for yarn in weave.yarns),
            "section_fit": self.section_fit,
            "end_shells": self.end_shells,
        }


def with_room(fabric: Fabric) -> Fabric:
    """Thicken the fabric within the range of its thickness if the crimp computed from that leaves
    too little room.

    As it is where its sections fit, its crimp is given, or no thickness of the range suffices.
    """

    def fits(factor):
        try:
            made = assumed.of_thickness(fabric, factor)
            made.weave.require_plain("solid yarns and the 3D crossover")
            widths = inputs.widths(made, 0.0, None)
            fractions = inputs.fractions(made)
        except InputError:
            return False
        return leaves_room(made.section, widths, fractions, made.weave, TIP_THICKNESS_RATIO)

    low = 1.0
    high = entries()["thickness"].high
    if "crimp" not in fabric.assumed or fits(low) or not fits(high):
        return fabric
    found = assumed.of_thickness(fabric, least_that_fits(fits, low, high))
    thickness = fabric.thickness or 0.0
    crimp = " / ".join(f"{100 * yarn.crimp:.2f}" for yarn in found.weave.yarns)
    note = (
        f"note: the thickness {1e3 * thickness:g} mm leaves too little room for the yarns; the 3D crossover has the "
        f"least thickness that fits, {1e3 * found.weave.thickness:.4g} mm, and a crimp of {crimp} %"
    )
    return replace(found, notes=(*fabric.notes, note))
