"""The computations that checks share and that are runs of other studies, as `runs` has them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from validation.published.pencilling.study import Case, bare, shoot

if TYPE_CHECKING:
    from validation.claims.registry import RunResult


def pencil(
    *, plies: int, modulus: float, mass: float, elements: int = 2, edge: str = "free", layer: Any = None
) -> RunResult:
    """One run of Table 6-2 before its block; without plies the block alone.

    Parameters
    ----------
    plies, modulus, mass : of `study.Case`
    elements, edge, layer : of `study.march`
    """
    found = bare() if plies == 0 else shoot(Case(plies, modulus, mass), elements=elements, edge=edge, layer=layer)
    return {
        "outcome": found.outcome,
        "depth": found.depth,
        "crater": found.crater,
        "steepness": found.steepness,
        "half_width": found.half_width,
        "balance": found.balance,
        "t": found.t,
        "z": found.z,
    }


# name: (function, rough cost, to begin with the longest)
RUNS = {"pencil": (pencil, 90)}
