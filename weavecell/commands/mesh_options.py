"""Options of a mesh: from the texts of the command line to the arguments of the mesher, in one place."""

from __future__ import annotations

import re
from typing import Any

from fabrics.errors import InputError
from fabrics.units import si

SIZES = ("coarse", "medium", "fine", "auto")
_LENGTHS = {"gap": "--yarn-gap", "end_shells": "--end-shells"}


def parse(*, size: str, crimp: str = "hand", width: str | None = None, **others: Any) -> dict[str, Any]:
    """Keywords of `meshing.crossover.build` and `meshing.patch.build`.

    Parameters
    ----------
    size, crimp, width : texts, as of `weavecell mesh`; width None where it is not given
    others : of `meshing.inputs.MeshOptions`; gap and end_shells as texts, the rest as it is

    Raises
    ------
    InputError : a text that is none of these, with the option of the command line
    """
    found = {"size": parse_size(size), **others}
    found |= {name: si(others[name], "m", key=key) for name, key in _LENGTHS.items() if others.get(name) is not None}
    found["crimp"] = crimp if crimp in ("hand", "micrograph") else pair(crimp, "", "--crimp")
    found["width"] = None if width is None else pair(width, "m", "--width")
    return found


def parse_size(text: str) -> Any:
    """A name, three numbers, or an edge length [m], as `meshing.inputs.size` takes it."""
    if re.fullmatch(r"\s*\d+\s*(,\s*\d+\s*)*", text):
        return tuple(map(int, text.split(",")))
    if text in SIZES:
        return text
    if re.fullmatch(r"\s*[\d.+-][^,]*", text):
        return si(text, "m", key="--mesh")
    raise InputError(key="--mesh", value=text, allowed=f"{', '.join(SIZES)}, nx,ny,nz or a length such as 60um")


def parse_count(text: str) -> Any:
    """(n, m) numbers of warp and weft yarns of a text such as "3x4"."""
    found = re.fullmatch(r"\s*(\d+)\s*[xX×]\s*(\d+)\s*", text)
    if found is None:
        raise InputError(key="--patch", value=text, allowed="numbers of warp and weft yarns, such as 3x4")
    return int(found[1]), int(found[2])


def pair(text: str, unit: str, key: str, what: str = "of warp and weft") -> tuple[float, float]:
    """Two values [SI] of a text with one, or with two separated by a comma; `unit` "" for plain numbers."""
    parts = [part.strip() for part in text.split(",")]
    if len(parts) > 2:
        raise InputError(key=key, value=text, allowed=f"one value, or two separated by a comma, {what}")
    values = [si(part, unit, key=key) for part in parts]
    return values[0], values[-1]
