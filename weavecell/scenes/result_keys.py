"""Results that become keys of fabric files: each is read by the reader of its key before it
is kept, and what that refuses is said of the curve that it comes from."""

from __future__ import annotations

from fabrics import plausible
from fabrics.base.checks import FilePath
from fabrics.base.errors import InputError
from fabrics.compression import check_room
from fabrics.fabric import Fabric
from fabrics.fabric_tables import OF_FABRIC, OF_YARN, LawTable

QUANTITIES = OF_YARN | OF_FABRIC
QUANTITIES |= {f"compression.{key}": of for key, of in LawTable.quantities().items()}


def checked(key: str, text: str, curve: FilePath, of: str) -> str:
    """Return the text of a result as the reader of its key takes it.

    Parameters
    ----------
    key : of a fabric file, such as "interlayer_gap" and "compression.a"
    text : as it is written, such as "0.1 mm"
    curve : file that it comes from, named in the error
    of : what it comes from in words, with what may be wrong with it

    Raises
    ------
    InputError : the reader of the key refuses it
    """
    try:
        if QUANTITIES[key].read(text)[0] < 0:
            raise InputError(key=key, allowed="of at least 0")
    except InputError as problem:
        message = f"gives {key} = {text}, of {of}"
        raise InputError(message, file=curve, allowed=problem.allowed) from None
    return text


def entry(key: str, value: str, origin: str, curve: FilePath, of: str) -> str:
    """Write the line of a fabric file that a result is, after the reader of the key has taken it; see
    `checked`."""
    text = checked(key, value, curve, of)
    name = key.rpartition(".")[2]
    return f'{name} = {{ value = "{text}", source = "{origin}", status = "fitted" }}'


def check_fabric(changed: Fabric, given: Fabric, curve: FilePath) -> None:
    """Refuse results that make a fabric of a given one that no fabric file could hold.

    Parameters
    ----------
    changed : the fabric with the results, of which what is as in the `given` one is not looked at
    curve : that they are fitted to, named in the error

    Raises
    ------
    InputError : yarns that close more than they are high, or a number far from plausible
    """
    if changed.laws is not None and changed.laws != given.laws:
        check_room(
            changed.laws, changed.weave, file=curve, key="compression.a, fitted to this curve"
        )
    before = plausible.of_fabric(given)
    numbers = [number for number in plausible.of_fabric(changed) if number not in before]
    plausible.judge(numbers, curve=curve)
