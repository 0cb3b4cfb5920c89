"""Memory that is free, and the refusal of a run that needs more, before it takes any."""

from __future__ import annotations

import os
from math import inf

from fabrics.base.errors import InputError


def free() -> float:
    """Return the memory [bytes] that this process can still take: what the system has available,
    and its own limit of addresses (`ulimit -v`) less those in use; infinite if the system does not
    state it."""
    try:
        import resource

        with open("/proc/meminfo", encoding="ascii") as file:
            available = 1024.0 * next(
                int(line.split()[1]) for line in file if line.startswith("MemAvailable")
            )
        with open("/proc/self/statm", encoding="ascii") as file:
            used = int(file.read().split()[0]) * os.sysconf("SC_PAGE_SIZE")
    except (ImportError, OSError, StopIteration):  # not Linux
        return inf
    limit = resource.getrlimit(resource.RLIMIT_AS)[0]
    if limit == resource.RLIM_INFINITY:
        return available
    return max(0.0, min(available, limit - used))


def check(
    needed: float,
    content: str,
    key: str,
    value: object = None,
    way: str = "smaller, or the elements larger",
) -> None:
    """Refuse what needs more memory than is free.

    Parameters
    ----------
    needed : [bytes]
    content : what needs it, in words, such as "953,000,000 elements"
    key, value : of the input that is to be changed
    way : what it has to be

    Raises
    ------
    InputError
    """
    there = free()
    if needed > there:
        allowed = f"{way}: {content} need about {1e-9 * needed:,.1f} GB of memory, and "
        raise InputError(key=key, value=value, allowed=f"{allowed}{1e-9 * there:,.1f} GB are free")
