"""What is assumed of a fabric whose file does not give it: trellis shear, the yarn as a solid, crimp, failure length.

The laws are the defaults of the yarns' fibre family (`fabrics.families`); the angles and moduli of the trellis follow
from the weave. Crimp follows from the thickness (`fabrics.data_sheet`), with a thickness and a share of the warp that
have a range. The failure length is one for all families (`data_sheet.toml`). A fabric says what has been assumed:
`Fabric.assumed` names it, its `sources` hold the values with the status "assumed" or "derived", and `lines` is what a
command prints and records. `shear_ends`, `solid_ends`, `crimp_ends` and `failure_length_ends` are the fabric with
either end of the assumed ranges.
"""

from __future__ import annotations

from dataclasses import replace

from fabrics.data_sheet import FAMILIES, FROM_THICKNESS, crimps, entries
from fabrics.errors import InputError
from fabrics.fabric import Fabric
from fabrics.fabric_tables import FIBRES
from fabrics.families import Family, list_families

TABLES = {
    "shear": "G1, G2, gamma1 and gamma2",
    "solid": "E_a, E_c, K_r, K_G, V_c and Vf0 of warp and weft",
    "strain_rate": "rates and strength",
}


def with_shear(fabric: Fabric) -> Fabric:
    """The fabric with a trellis law, that of its fibre family where its file gives none.

    Raises
    ------
    InputError : it has none, and its yarns belong to no family, or neither of them is crimped
    """
    return _completed(fabric, "shear", lambda family: family.shear(fabric.weave, fabric.yarn_width))


def with_solid_laws(fabric: Fabric) -> Fabric:
    """The fabric with solid laws of its yarns, those of its fibre family where its file gives none.

    Raises
    ------
    InputError : it has none, and its yarns belong to no family
    """
    return _completed(fabric, "solid", lambda family: _solid_laws(fabric, family))


def with_strain_rate(fabric: Fabric) -> Fabric:
    """The fabric with ratios of strength and modulus against the strain rate, those of its fibre family where its file
    gives none.

    Raises
    ------
    InputError : it has none, and its yarns belong to no family of which numbers are known
    """

    def known(family):
        if family.strain_rate is None:
            raise _missing(fabric, "strain_rate", f"of {family.name} yarns no numbers are at hand")
        return family.strain_rate

    return _completed(fabric, "strain_rate", known)


def shear_ends(fabric: Fabric) -> dict[str, Fabric]:
    """{"soft", "stiff": the fabric with this end of its assumed trellis law}; empty where that is not assumed."""
    if "shear" not in fabric.assumed:
        return {}
    family = _family(fabric, "shear")
    return {end: replace(fabric, shear=family.shear(fabric.weave, fabric.yarn_width, end)) for end in ("soft", "stiff")}


def solid_ends(fabric: Fabric) -> dict[str, Fabric]:
    """{"soft", "stiff": the fabric with this end of its assumed solid laws}; empty where these are not assumed."""
    if "solid" not in fabric.assumed:
        return {}
    family = _family(fabric, "solid")
    return {end: replace(fabric, solid_laws=_solid_laws(fabric, family, end)) for end in ("soft", "stiff")}


def of_thickness(fabric: Fabric, factor: float = 1.0, share: float | None = None) -> Fabric:
    """A fabric whose crimp was computed from its thickness, with `factor` times that thickness.

    An assumed trellis law follows the crimp.

    Parameters
    ----------
    share : height of the warp over that of both yarns; None takes that of `fabrics.data_sheet`

    Raises
    ------
    InputError : a yarn whose crimp is given is alone higher than half of the thickness
    """
    computed = [fabric.sources[f"{family}.crimp"]["source"] == FROM_THICKNESS for family in FAMILIES]
    first, second = (None if made else yarn.crimp for made, yarn in zip(computed, fabric.weave.yarns))
    crimp = crimps(fabric.weave.w, factor * (fabric.thickness or 0.0), (first, second), share)
    other = fabric.with_yarns(crimp=crimp)
    return with_shear(replace(other, shear=None)) if "shear" in fabric.assumed else other


def crimp_ends(fabric: Fabric) -> dict[str, Fabric]:
    """{words: the fabric with one end of the thickness or of the warp's share that its crimp was computed from}.

    Empty where both crimps are given; the share is varied where neither is.
    """
    if "crimp" not in fabric.assumed:
        return {}
    factor, share = (entries()[name] for name in ("thickness", "warp_share"))
    ends: dict[str, tuple[float, float | None]] = {
        f"thickness times {x:g}": (x, None) for x in (factor.low, factor.high)
    }
    if all(fabric.sources[f"{family}.crimp"]["source"] == FROM_THICKNESS for family in FAMILIES):
        ends |= {f"warp share {x:g}": (1.0, x) for x in (share.low, share.high)}
    found = {}
    for name, end in ends.items():
        try:
            found[name] = of_thickness(fabric, *end)
        except InputError:  # thinner than the yarn whose crimp is given
            continue
    return found


def failure_length_ends(fabric: Fabric) -> dict[str, Fabric]:
    """{words: the fabric with one end of its assumed failure length}; empty where that is given."""
    if "failure_length" not in fabric.assumed:
        return {}
    one = entries()["failure_length"]
    return {f"failure length {1e3 * end:g} mm": replace(fabric, failure_length=end) for end in (one.low, one.high)}


def given(fabric: Fabric, table: str) -> Fabric:
    """The fabric of whose `assumed` one is no longer assumed, such as "solid" after a fit; its value stays."""
    return replace(fabric, assumed=tuple(name for name in fabric.assumed if name != table))


def family_of(fabric: Fabric) -> Family | None:
    """The family that the file names, with wider ranges where the yarns do not belong to it; else the one that both
    yarns belong to, by modulus and fibre density; None where there is none."""
    yarns = fabric.weave.yarns
    if fabric.family is None:
        return next((family for family in list_families() if all(map(family.holds, yarns))), None)
    named = next(family for family in list_families() if family.name == fabric.family)
    return named if all(map(named.holds, yarns)) else named.for_other_yarns()


def lines(fabric: Fabric) -> list[str]:
    """One line for each table that was assumed, for crimp computed from the thickness, and for the failure length."""
    family = family_of(fabric)
    name = family.name if family is not None else "unknown"
    wider = ", with wider ranges for another fibre" if family is not None and family.of_others else ""
    more = {"shear": ", its angles from width and spacing of the yarns"}
    words = {table: f"[{table}] of {name} yarns{more.get(table, '')}{wider}" for table in TABLES}
    words["failure_length"] = f"failure length {entries()['failure_length'].written}"
    return [
        _crimp_line(fabric) if key == "crimp" else f"assumed: {words[key]}, because {fabric.name} gives none"
        for key in fabric.assumed
    ]


def _crimp_line(fabric):
    factor, share = (entries()[name] for name in ("thickness", "warp_share"))
    ends = [[yarn.crimp for yarn in each.weave.yarns] for each in crimp_ends(fabric).values()]
    now = [yarn.crimp for yarn in fabric.weave.yarns]
    crimp, low, high = (
        " / ".join(f"{100 * value:.2f}" for value in values)
        for values in (now, [min(pair) for pair in zip(now, *ends)], [max(pair) for pair in zip(now, *ends)])
    )
    made = [fabric.sources[f"{family}.crimp"]["source"] == FROM_THICKNESS for family in FAMILIES]
    more = f" and a warp share of the yarn heights of {share.written}" if all(made) else ""
    return (
        f"assumed: crimp {crimp} % of warp / weft ({low} .. {high} %), from the thickness "
        f"{1e3 * (fabric.thickness or 0):g} mm (times {factor.low:g} .. {factor.high:g}){more}"
    )


def _family(fabric, table):
    family = family_of(fabric)
    if family is not None:
        return family
    raise _missing(fabric, table, of_no_family())


def of_no_family() -> str:
    """What to do about yarns of no family, in words."""
    known = ", ".join(
        f"{each.name} ({_range(each.limits['modulus'], 1e-9)} GPa, {_range(each.limits['fibre_density'], 1)} kg/m^3)"
        for each in list_families()
    )
    names = " or ".join(f'"{name}"' for name in FIBRES)
    return (
        f"the yarns are none of {known}; or give family = {names} above [warp], whose values are then assumed with "
        "wider ranges"
    )


def _missing(fabric, table, why):
    what, given = (f"[{table}] table", f"given, with {TABLES[table]}") if table in TABLES else (table, "given")
    return InputError(f"fabric {fabric.name} has no {what}", allowed=f"{given}: {why}")


def _range(pair, factor):
    return f"{factor * pair[0]:g} to {factor * pair[1]:g}"


def _solid_laws(fabric, family, end="nominal"):
    """Solid laws of a family; the fibre volume fraction is that of a yarn's section where its area is known."""
    return tuple(
        law if area is None else replace(law, Vf0=yarn.A_s / area)
        for law, yarn, area in zip(family.solid_laws(end), fabric.weave.yarns, fabric.yarn_area)
    )


def _completed(fabric, table, law_of):
    """The fabric with law_of(its family) where its file gives none, and where that comes from."""
    field = "solid_laws" if table == "solid" else table
    if getattr(fabric, field) is not None:
        return fabric
    family = _family(fabric, table)
    law = law_of(family)
    sources = {**fabric.sources, **family.sources(table)}
    if table == "solid":
        sources |= {
            f"solid.Vf0.{name}": {"value": f"{made.Vf0:.4f}", "source": "section_area", "status": "derived"}
            for name, made, area in zip(FAMILIES, law, fabric.yarn_area)
            if area is not None
        }
    if table == "shear":
        sources |= _derived(law, family)
    if table == "strain_rate":
        sources |= law.sources()
    names = (*(name for name in fabric.assumed if name != table), table)
    return replace(fabric, **{field: law}, sources=sources, assumed=names)


def _derived(shear, family):
    """Entries of the moduli and angles that follow from the weave."""
    texts = {
        "G1": (f"{1e-6 * shear.G1:.4g} MPa", "shear.G1_over_G2 times G2"),
        "G2": (f"{1e-9 * shear.G2:.4g} GPa", "thesis eq. 4-49 with shear.locking_share"),
        "gamma1": (f"{shear.gamma1:.3f}", "thesis eq. 4-32, from the yarns' width, or shear.gap, and spacing"),
        "gamma2": (f"{shear.gamma2:.3f}", "thesis eqs. 4-33 and 4-34 as corrected in E-08, with shear.K_s"),
    }
    return {
        f"shear.{key}": {"value": value, "source": f"{source} ({family.name})", "status": "assumed"}
        for key, (value, source) in texts.items()
    }
