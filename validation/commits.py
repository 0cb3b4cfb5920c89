"""When and at which commits a report was computed, without what writes pages: no kept result depends on that."""

from __future__ import annotations

import re
from collections.abc import Mapping

_STAMP = re.compile(r"commit (?P<commit>\w+(?: \+ changes)?), (?P<date>[\d-]{10}[ \d:]*)")


def computed(command: str, *stamps: str | Mapping[str, str]) -> str:
    """The line of a report that says at which commits, when and by which command it was computed.

    Parameters
    ----------
    command : that made the page
    stamps : of `provenance.stamp`, or texts with "commit COMMIT, DATE"
    """
    texts = [one if isinstance(one, str) else f"commit {one['commit']}, {one['date']}" for one in stamps]
    found = filter(None, map(_STAMP.search, texts))
    runs = sorted({(match["date"], match["commit"]) for match in found})
    if not runs:
        return f"Computed by `{command}`."
    (begin, first), (end, last) = runs[0], runs[-1]
    if first == last:
        return f"Computed at commit {first} on {begin[:10]} by `{command}`."
    return f"Computed at commits {first} ({begin[:10]}) to {last} ({end[:10]}) by `{command}`."
