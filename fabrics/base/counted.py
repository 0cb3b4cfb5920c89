"""A count with its noun: "1 shot", "12,000 more shots", "3 plies"."""

from __future__ import annotations

PLURALS = {"equilibrium": "equilibria", "hexahedron": "hexahedra"}
_HISSED = ("ch", "s", "sh", "x")


def counted(number: int, noun: str) -> str:
    """Say a count with its noun, which is given in the singular.

    Examples
    --------
    >>> counted(1, "search"), counted(12000, "more shot"), counted(0, "ply")
    ('1 search', '12,000 more shots', '0 plies')
    """
    if number == 1:
        return f"1 {noun}"
    return f"{number:,} {plural(noun)}"


def plural(noun: str) -> str:
    """Return the plural of a noun, of several words of the last one."""
    before, space, last = noun.rpartition(" ")
    if last in PLURALS:
        return before + space + PLURALS[last]
    if last.endswith("y") and last[-2] not in "aeiou":
        return f"{noun[:-1]}ies"
    if last.endswith(_HISSED):
        return f"{noun}es"
    return f"{noun}s"
