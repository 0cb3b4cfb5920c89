"""What a woven fabric is: yarn, weave, compression law, response surface, catalogue, units and errors.

The public names are loaded when they are first used.
"""

from __future__ import annotations

from fabrics import lazy

__version__ = "0.2.0"

__getattr__, __dir__ = lazy.public(__name__, __file__)
