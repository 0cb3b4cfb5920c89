"""The page of the site that shows the tables of `shellfabric.state`: what kernels take, array by array."""

import inspect

from shellfabric import state
from shellfabric.block import state as backing
from shellfabric.cell import state as cell
from shellfabric.coupon import state as coupon
from shellfabric.jit.table import Row
from shellfabric.plies import state as plies
from shellfabric.projectile import state as projectile
from shellfabric.yarns import state as yarns

HEAD = """# Arrays of the kernels

From `shellfabric/state.py`. SI units throughout.

## Terms

"""
TERMS = {
    "node, slot": (
        "Node (i, j) of a ply is at slot k = i row_stride + j of flat arrays; so are the "
        "warp edge to (i+1, j), the weft edge to (i, j+1) and the element beside both. "
        "`slots` in the shapes below: (ni + 2)(nj + 1) + 16, padded for 8-wide access."
    ),
    "warp, weft": (
        "Yarn family 0 along x (grid lines j = const) and family 1 along y (i = const). "
        "In shapes, `2 x` is one array for each family, `3 x` one for each component x, "
        "y, z."
    ),
    "edge": (
        "Yarn segment between two neighbouring nodes of one grid line. Its stretch is its "
        "length over its length at rest."
    ),
    "element": (
        "The quadrilateral between four nodes; it carries the trellis (shear) and the "
        "contact points."
    ),
    "crossover": (
        "Cell of the weave: one warp and one weft yarn. An element covers one crossover "
        "or a part of it."
    ),
    "block": (
        "Consecutive element rows that one thread handles together, small enough for the "
        "cache. Results do not depend on blocks or threads."
    ),
    "total, tally": (
        "A number, or an integer, that kernels set by its name, as in `state.failures += 1`. So does Python."
    ),
    "active rows": (
        "Element rows that motion can have reached; the rest is exactly at rest and is skipped."
    ),
    "contact window": (
        "Rows and columns (i0, i1, j0, j1) of elements that the contact with the "
        "projectile looks at."
    ),
    "contact point": (
        "Point of an element's surface at which the penalty contact is evaluated, "
        "points_per_side along each side."
    ),
    "penalty, implicit penalty": (
        "Contact spring and damper at a point; the implicit one takes the force of the "
        "end of the step, so that it is stable at any stiffness."
    ),
    "closest point": (
        "Projection of a contact point onto the other surface (closest-point projection), "
        "followed from step to step."
    ),
    "element flag": (
        "Bits of an element: 1 a warp yarn failed, 2 a weft yarn failed, 4 eroded (no "
        "longer in contact), 8 torn and drawn out to "
        "twice its size."
    ),
    "equilibrium form, variational form": (
        "Forces of the crossover cell: tensions from its force balance, or the gradient "
        "of its strain energy."
    ),
    "trellis": (
        "Shear stiffness of the weave against rotation of warp against weft, one "
        "integration point an element."
    ),
    "history row": (
        "Position of the nose, velocity and force after one step; see "
        "shellfabric.loop.stack_kernels.record_step."
    ),
    "barrier": "Point of a step that all threads reach before any goes on.",
    "Float64x8, mask": (
        "Eight doubles, or eight booleans, in vector registers: the SIMD type of "
        "shellfabric.jit.simd."
    ),
}


def tables():
    """List the tables, in the order of their file."""
    files = (state, plies, projectile, backing, yarns, cell, coupon)
    classes = [kind for file in files for kind in vars(file).values() if inspect.isclass(kind)]
    return [kind for kind in classes if issubclass(kind, Row) and kind.fields]


def page():
    """Write the text of the page."""
    parts = [HEAD]
    for term, meaning in TERMS.items():
        parts.append(f"- **{term}**: {meaning}\n")
    for table in tables():
        parts.append(f"\n## {table.__name__}\n\n{table.__doc__}\n")
        parts.append(
            "\n| field | shape | unit | in a checkpoint | meaning |\n|---|---|---|---|---|\n"
        )
        for name, field in table.fields.items():
            kept = "yes" if field.kept else ""
            cells = f"`{name}`", field.shape, field.unit, kept, field.meaning
            parts.append(f"| {' | '.join(cells)} |\n")
    return "".join(parts)
