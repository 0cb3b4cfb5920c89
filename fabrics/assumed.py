"""What is assumed of a fabric whose file does not give it: trellis shear, the yarn as a solid, crimp,
failure length.

Laws are those of the yarns' fibre family (`fabrics.families`), crimp follows from areal density or
thickness (`fabrics.data_sheet`), the failure length is one for all (`data_sheet.toml`).
`Fabric.assumed` names what was assumed, `sources` have it with the status "assumed" or "derived",
and `lines` is what a command prints.

A number with `low` and `high` in the file has that range, measured or not. A guess without them
(status "assumed", or in [shear] and [solid] no source) has the range of its family about it.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace

import numpy as np

from fabrics import plausible
from fabrics.base.errors import InputError
from fabrics.base.units import si
from fabrics.data_sheet import (
    FAMILIES,
    FRICTION_BETWEEN_PLIES,
    FRICTION_BETWEEN_YARNS,
    FROM_MASS,
    FROM_THICKNESS,
    OF_SHOTS,
    crimps,
    crimps_of_mass,
    entries,
    failure_length,
    ranges_of_fibre,
)
from fabrics.fabric import Fabric
from fabrics.fabric_tables import FIBRES
from fabrics.families import Entry, Family, list_families
from fabrics.families.trellis import LARGEST

_SOFT_AT_HIGH = ("gamma1", "gamma2")
TABLES = {
    "shear": "G1, G2, gamma1 and gamma2",
    "solid": "E_a, E_c, K_r, K_G, V_c and Vf0 of warp and weft",
    "strain_rate": "rates and strength",
}


def with_shear(fabric: Fabric) -> Fabric:
    """Return the fabric with a trellis law: its own, or that of its fibre family if its file gives
    none.

    Raises
    ------
    InputError : it has none, and its yarns belong to no family, or neither of them is crimped
    """
    return _completed(fabric, "shear", lambda family: family.shear(fabric.weave, fabric.yarn_width))


def with_solid_laws(fabric: Fabric) -> Fabric:
    """Return the fabric with solid laws of its yarns: its own, or those of its fibre family if its
    file gives none.

    Raises
    ------
    InputError : it has none, and its yarns belong to no family
    """
    return _completed(fabric, "solid", lambda family: _solid_laws(fabric, family))


def transverse_moduli(fabric: Fabric) -> tuple[float, float]:
    """Return the transverse moduli (warp, weft) [Pa] of packed yarn; yarns of no known family have
    the lowest of all families."""
    if fabric.solid_laws is None and family_of(fabric) is None:
        known = [law.E_c for family in list_families() for law in family.solid_laws("nominal")]
        return min(known), min(known)
    laws = with_solid_laws(fabric).solid_laws
    assert laws is not None
    return laws[0].E_c, laws[1].E_c


def with_strain_rate(fabric: Fabric) -> Fabric:
    """Return the fabric with ratios of strength and modulus against the strain rate: its own, or
    those of its fibre family if its file gives none.

    Raises
    ------
    InputError : it has none, and its yarns belong to no family of which numbers are known
    """

    return _completed(fabric, "strain_rate", lambda family: family.strain_rate)


def has_range(fabric: Fabric, table: str) -> bool:
    """Tell whether a number of a table, "shear" or "solid", has a range."""
    return any(key.startswith(f"{table}.") for key in fabric.ranges)


def shear_at(fabric: Fabric, share: float) -> Fabric:
    """Return the fabric with its trellis law at a place in its range: 0 is the soft end, 0.5 the law as it
    is, 1 the stiff end."""
    law = fabric.shear
    assert law is not None
    numbers = {}
    for name, value in vars(law).items():
        low, high = fabric.ranges.get(f"shear.{name}", (1.0, 1.0))
        ends = (high, 1.0, low) if name in _SOFT_AT_HIGH else (low, 1.0, high)
        numbers[name] = value * float(np.interp(share, (0.0, 0.5, 1.0), ends))
    numbers["gamma2"] = min(numbers["gamma2"], LARGEST)
    numbers["gamma1"] = min(numbers["gamma1"], 0.99 * numbers["gamma2"])
    return replace(fabric, shear=replace(law, **numbers))


def _usual_ranges(fabric, table):
    """{number of [shear] or [solid]: (low, high) over the value}, of the fibre family; empty if
    there is none."""
    family = family_of(fabric)
    if family is None or table not in ("shear", "solid"):
        return {}
    laws = {}
    for end in ("soft", "nominal", "stiff"):
        if table == "shear":
            law = family.shear(fabric.weave, fabric.yarn_width, end)
        else:
            law = family.solid_laws(end)[0]
        laws[end] = vars(law)
    ranges = {}
    for name, usual in laws["nominal"].items():
        ratios = laws["soft"][name] / usual, laws["stiff"][name] / usual
        ranges[name] = tuple(sorted(ratios))
    return ranges


def with_ranges_of_guesses(fabric: Fabric) -> Fabric:
    """Give the guessed numbers of [shear] and [solid] of a fabric the ranges of its fibre
    family."""
    ranges = dict(fabric.ranges)
    for key in fabric.guessed:
        table, _, _ = key.partition(".")
        name = key.rpartition(".")[2]
        usual = _usual_ranges(fabric, table)
        if name in usual:
            ranges[key] = usual[name]
    return replace(fabric, ranges=ranges)


def of_thickness(
    fabric: Fabric,
    factor: float = 1.0,
    share: float | None = None,
    mass: float = 1.0,
    straight_floats: float | None = None,
) -> Fabric:
    """Return a fabric whose crimp was computed from its sheet with `factor` times the thickness that
    follows, or that the sheet has.

    An assumed trellis law follows the crimp.

    Parameters
    ----------
    share : height of the warp over that of both yarns; None takes that of `fabrics.data_sheet`
    mass : factor on the areal density, if the crimp was computed from that
    straight_floats : as of `fabrics.data_sheet.crimps`

    Raises
    ------
    InputError : a yarn whose crimp is given is alone higher than half of the thickness, or an areal
        density that these yarns do not have
    """
    known: list[float | None] = [yarn.crimp for yarn in fabric.weave.yarns]
    for number, computed in enumerate(is_crimp_computed(fabric)):
        if computed:
            known[number] = None
    warp, weft = known
    weave = fabric.weave
    thickness = fabric.thickness or 0.0
    other = fabric
    if _is_of_mass(fabric):
        counts = weave.warp_count, weave.weft_count
        straight = [n * yarn.linear_density for n, yarn in zip(counts, weave.yarns)]
        stated = mass * si(fabric.sources["areal_density"]["value"], "kg/m^2")
        crimp = crimps_of_mass(weave.w, straight, stated, (warp, weft), share, weave.pattern)
        other = fabric.with_yarns(crimp=crimp)
        thickness = other.weave.thickness
    if factor != 1.0 or not _is_of_mass(fabric):
        of_height = crimps(
            weave.w, factor * thickness, (warp, weft), share, weave.pattern, straight_floats
        )
        other = fabric.with_yarns(crimp=of_height)
    if "shear" in fabric.assumed:
        return with_shear(replace(other, shear=None))
    return other


def is_crimp_computed(fabric: Fabric) -> list[bool]:
    """Tell whether the crimp of warp and of weft was computed from areal density or thickness."""
    origins = [fabric.sources[f"{family}.crimp"]["source"] for family in FAMILIES]
    return [origin in (FROM_MASS, FROM_THICKNESS) for origin in origins]


def _is_of_mass(fabric):
    """Whether crimp was computed from the areal density."""
    return any(fabric.sources[f"{family}.crimp"]["source"] == FROM_MASS for family in FAMILIES)


def entries_of_crimp(fabric: Fabric) -> list[str]:
    """List the numbers of `data_sheet.toml` that a computed crimp follows from."""
    if _is_of_mass(fabric):
        return ["areal_density", "warp_share"]
    names = ["thickness", "warp_share"]
    if not fabric.weave.pattern.is_plain:
        names.append("straight_floats")
    return names


def crimp_ends(fabric: Fabric) -> dict[str, Fabric]:
    """Return the fabric with each end of what its crimp was computed from, areal density or thickness,
    the warp's share, and how long a change of sides takes: {words: Fabric}.

    Empty if both crimps are given; the share is varied if neither is.
    """
    if "crimp" not in fabric.assumed:
        return {}
    first, *others = entries_of_crimp(fabric)
    known = entries()
    share = known["warp_share"]
    ends = {}
    for factor in (known[first].low, known[first].high):
        if first == "areal_density":
            ends[f"areal density times {factor:g}"] = {"mass": factor}
        else:
            ends[f"thickness times {factor:g}"] = {"factor": factor}
    if "straight_floats" in others:
        low = known["straight_floats"].low
        ends["changes of sides as long as floats"] = {"straight_floats": low}
    if all(is_crimp_computed(fabric)):
        for value in (share.low, share.high):
            ends[f"warp share {value:g}"] = {"share": value}
    changed = {}
    for words, end in ends.items():
        # the low end may be thinner than a yarn whose crimp is given
        with suppress(InputError):
            changed[words] = of_thickness(fabric, **end)
    return changed


def range_of_failure_length(fabric: Fabric) -> tuple[float, float] | None:
    """Return (low, high) of the failure length over its value; None of one that is given without."""
    length = entries()["failure_length"]
    usual = None
    if "failure_length" in fabric.assumed:
        usual = (length.low / length.value, length.high / length.value)
    return fabric.ranges.get("failure_length", usual)


def scale_ranged(fabric: Fabric, name: str, ratios: tuple[float, float]) -> Fabric:
    """Multiply a number of `fabric_tables.OF_YARNS` of (warp, weft) by ratios; the strength stays if
    the modulus changes."""
    field = {"modulus": "E", "crimp": "crimp"}.get(name, "failure_strain")
    pairs = list(zip(fabric.weave.yarns, ratios))
    values = {field: [getattr(yarn, field) * ratio for yarn, ratio in pairs]}
    if field == "E":
        values["failure_strain"] = [yarn.failure_strain / ratio for yarn, ratio in pairs]
    return fabric.with_yarns(**values)


def given(fabric: Fabric, *names: str) -> Fabric:
    """Mark tables of a fabric, such as "solid" after a fit, as no longer assumed; their values
    stay."""
    ranges = {}
    for key, ratios in fabric.ranges.items():
        if key.partition(".")[0] not in names:
            ranges[key] = ratios
    kept = [name for name in fabric.assumed if name not in names]
    return replace(fabric, assumed=tuple(kept), ranges=ranges)


def family_of(fabric: Fabric) -> Family | None:
    """Find the fibre family of a fabric: the one that the file names, with wider ranges if the
    yarns do not belong to it; else the one that both yarns belong to, by modulus and fibre density;
    None if there is none."""
    # weaving takes of the modulus, and fibres are told by that which they had before
    share = fabric.sources.get("weaving_damage.modulus", {}).get("value", 1.0)
    fibres = [(yarn.E / share, yarn.fibre_density) for yarn in fabric.weave.yarns]

    def holds_both(family):
        return all(family.holds_fibre(*fibre) for fibre in fibres)

    if fabric.family is None:
        return next(filter(holds_both, list_families()), None)
    named = next(family for family in list_families() if family.name == fabric.family)
    if holds_both(named):
        return named
    return named.for_other_yarns()


def shot_entries(*fabrics: Fabric) -> dict[str, Entry]:
    """Return what shots take for the numbers that no data sheet gives, by the names of
    `data_sheet.OF_SHOTS`: of the fibre family, or of `data_sheet.toml`.

    Of several fabrics it is the value of the first, in the range of all.
    """
    found: dict[str, Entry] = {}
    families = list(map(family_of, fabrics)) or [None]
    for name in OF_SHOTS:
        usual = entries()[name]
        of_each = [usual if of is None else of.shots.get(name, usual) for of in families]
        first = of_each[0]
        low = min(each.low for each in of_each)
        high = max(each.high for each in of_each)
        if (low, high) != (first.low, first.high):
            written = f"{first.value:g} ({low:g} .. {high:g})"
            first = replace(first, low=low, high=high, written=written)
        found[name] = first
    return found


def friction_between_yarns(*fabrics: Fabric) -> Entry:
    """Return Coulomb's coefficient of yarn on yarn at a crossover: that of plies, which are of the same
    yarns, if the fibre family has one of its own; else that of `data_sheet.toml`.

    Of several fabrics it is the value of the first, in the range of all.
    """
    usual = entries()[FRICTION_BETWEEN_YARNS]
    of_each = []
    for family in map(family_of, fabrics):
        own = {} if family is None else family.shots
        of_each.append(own.get(FRICTION_BETWEEN_PLIES, usual))
    if not of_each:
        return usual
    low = min(each.low for each in of_each)
    high = max(each.high for each in of_each)
    return replace(of_each[0], low=low, high=high)


def laws(fabric: Fabric) -> list[str]:
    """Select from `lines` those that a quasi-static result follows from."""
    return lines(given(fabric, "failure_length", *OF_SHOTS))


def lines(fabric: Fabric) -> list[str]:
    """Write one line for what an idealised fabric has beyond the plausible, for each table that was
    assumed, for crimp computed from the thickness, for the failure length and for what no data sheet
    gives."""
    family = family_of(fabric)
    name = "unknown"
    if family is not None:
        name = family.name
    wider = ""
    if family is not None and family.of_others:
        wider = ", with wider ranges for another fibre"
    more = {"shear": ", its angles from width and spacing of the yarns"}
    if not fabric.weave.pattern.is_plain:
        more["shear"] += ", its moduli those of a plain weave"
    words = {table: f"[{table}] of {name} yarns{more.get(table, '')}{wider}" for table in TABLES}
    for key, entry in shot_entries(fabric).items():
        words[key] = f"{key} {entry.written}"
    words["failure_length"] = f"failure length {failure_length(fabric.weave).written}"
    lines = []
    if fabric.idealised:
        lines.append(f"assumed: {fabric.name} is idealised: {describe_idealised(fabric)}")
    # what is of a shot comes last
    for key in sorted(fabric.assumed, key=OF_SHOTS.__contains__):
        line = f"assumed: {words.get(key)}, because {fabric.name} gives none"
        if key == "crimp":
            line = _crimp_line(fabric)
        elif key == "weave":
            line = f"assumed: plain weave, because {fabric.name} states none"
        lines.append(line)
    return lines + _own_lines(fabric)


def describe_idealised(fabric: Fabric) -> str:
    """Write which numbers of an idealised fabric are beyond the plausible, as they are meant to be."""
    beyond = list(plausible.judge(plausible.of_fabric(fabric)))
    for family, yarn in zip(FAMILIES, fabric.weave.yarns):
        if ranges := ranges_of_fibre(yarn):
            beyond.append(f"{family} outside of {ranges}")
    return "; ".join(beyond) or "none of its numbers is beyond the plausible"


def ranges_of_measured(fabric: Fabric) -> list[str]:
    """Write one line for each measured number that has a range, with its source; warp and weft share
    a line where they are alike."""
    keys: dict[tuple[str, str, str], list[str]] = {}
    for key in sorted(_measured_keys(fabric)):
        entry = fabric.sources[key]
        family, _, name = key.rpartition(".")
        keys.setdefault((name, entry["value"], entry["source"]), []).append(family)
    lines = []
    for (name, value, source), families in keys.items():
        of = " and ".join(filter(None, families))
        if of:
            name += f" of {of}"
        lines.append(f"{name}, measured, {value}: {source}")
    return lines


def _measured_keys(fabric):
    """Keys of the measured numbers with a range that is wider than the number."""
    keys = set()
    for key, (low, high) in fabric.ranges.items():
        if low < high and fabric.sources.get(key, {}).get("status") == "measured":
            keys.add(key)
    return keys


def _own_lines(fabric):
    """Lines about the numbers with a range of their own, but for measured ones, and about guesses
    without one."""
    measured = _measured_keys(fabric)
    ranged = []
    for key, (low, high) in fabric.ranges.items():
        if low < high and key.partition(".")[0] not in fabric.assumed and key not in measured:
            value = fabric.sources[key]["value"].partition(" (")[0]
            ranged.append(f"{key} {value} (times {low:.3g} .. {high:.3g})")
    guessed = ", ".join(key for key in fabric.guessed if key not in fabric.ranges)
    lines = []
    if ranged:
        lines.append(f"assumed: {', '.join(ranged)}")
    if guessed:
        lines.append(f"guessed, without a range: {guessed}; give low and high")
    return lines


def _crimp_line(fabric):
    first, *others = entries_of_crimp(fabric)
    entry = entries()[first]
    if first == "areal_density":
        origin = f"the areal density {fabric.sources[first]['value']}"
    else:
        origin = f"the thickness {1e3 * (fabric.thickness or 0):g} mm"
    fabrics = fabric, *crimp_ends(fabric).values()
    warp, weft = zip(*([yarn.crimp for yarn in each.weave.yarns] for each in fabrics))
    crimp = _percent(warp[0], weft[0])
    low = _percent(min(warp), min(weft))
    high = _percent(max(warp), max(weft))
    more = ""
    if all(is_crimp_computed(fabric)):
        share = entries()["warp_share"].written
        more = f" and a warp share of the yarn heights of {share}"
    if "straight_floats" in others:
        more += " and changes of sides over one spacing (.. a float)"
    return (
        f"assumed: crimp {crimp} % of warp / weft ({low} .. {high} %), from {origin} "
        f"(times {entry.low:g} .. {entry.high:g}){more}"
    )


def _percent(warp, weft):
    return f"{100 * warp:.2f} / {100 * weft:.2f}"


def _family(fabric, table):
    family = family_of(fabric)
    if family is not None:
        return family
    known = ", ".join(
        f"{each.name} ({_range(each.limits['modulus'], 1e-9)} GPa, {_range(each.limits['fibre_density'], 1)} kg/m^3)"
        for each in list_families()
    )
    names = " or ".join(f'"{name}"' for name in FIBRES)
    named = f"give family = {names} above [warp] (--family of `fabrics new`)"
    why = f"the yarns are none of {known}; or {named}, whose values are then assumed with wider ranges"
    raise _missing(fabric, table, why)


def _missing(fabric, table, why):
    if table in ("shear", "solid"):
        lacking = {"shear": fabric.shear, "solid": fabric.solid_laws}
    else:
        lacking = {table: None}
    tables = " and ".join(
        f"[{name}] ({TABLES[name]})" for name, laws in lacking.items() if laws is None
    )
    return InputError(
        f"fabric {fabric.name} has no {tables}", allowed=f"given, since no data sheet has it: {why}"
    )


def _range(pair, factor):
    return f"{factor * pair[0]:g} to {factor * pair[1]:g}"


def _solid_laws(fabric, family):
    """Solid laws of a family; the fibre volume fraction is that of a yarn's section if its area is
    known."""
    laws = []
    for law, yarn, area in zip(family.solid_laws("nominal"), fabric.weave.yarns, fabric.yarn_area):
        if area is not None:
            law = replace(law, Vf0=yarn.A_s / area)
        laws.append(law)
    return tuple(laws)


def _completed(fabric, table, law_of):
    """The fabric with law_of(its family) if its file gives none, and where that comes from."""
    field = table
    if table == "solid":
        field = "solid_laws"
    if getattr(fabric, field) is not None:
        return fabric
    family = _family(fabric, table)
    law = law_of(family)
    if law is None:
        raise _missing(fabric, table, f"no numbers of {family.name} yarns are known")
    sources = {**fabric.sources, **family.sources(table)}
    if table == "solid":
        for name, made, area in zip(FAMILIES, law, fabric.yarn_area):
            if area is not None:
                entry = {"value": f"{made.Vf0:.4f}", "source": "section_area", "status": "derived"}
                sources[f"solid.Vf0.{name}"] = entry
    if table == "shear":
        sources |= _derived(law, family)
    if table == "strain_rate":
        sources |= law.sources()
    ranges = dict(fabric.ranges)
    for name, pair in _usual_ranges(fabric, table).items():
        ranges[f"{table}.{name}"] = pair
    names = [name for name in fabric.assumed if name != table]
    return replace(fabric, **{field: law}, sources=sources, assumed=(*names, table), ranges=ranges)


def _derived(shear, family):
    """Entries of the moduli and angles that follow from the weave."""
    texts = {
        "G1": (f"{1e-6 * shear.G1:.4g} MPa", "shear.G1_over_G2 times G2"),
        "G2": (f"{1e-9 * shear.G2:.4g} GPa", "thesis eq. 4-49 with shear.locking_share"),
        "gamma1": (
            f"{shear.gamma1:.3f}",
            "thesis eq. 4-32, from the yarns' width, or shear.gap, and spacing",
        ),
        "gamma2": (
            f"{shear.gamma2:.3f}",
            "thesis eqs. 4-33 and 4-34 as corrected in E-08, with shear.K_s",
        ),
    }
    sources = {}
    for key, (value, source) in texts.items():
        origin = f"{source} ({family.name})"
        sources[f"shear.{key}"] = {"value": value, "source": origin, "status": "assumed"}
    return sources
