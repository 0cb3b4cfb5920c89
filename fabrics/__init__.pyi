# Public names and their modules: `fabrics.lazy.public` loads each when it is first used.
from fabrics.catalogue import list_names, load
from fabrics.compression import CompressionLaw
from fabrics.errors import DoubtfulError, InputError, UndecidedError, UnstableError, WeavecellError
from fabrics.fabric import Fabric
from fabrics.plate_curve import PlateCurve
from fabrics.solid import SolidLaw
from fabrics.surface import ResponseSurface
from fabrics.trellis import TrellisShear
from fabrics.weave import Weave
from fabrics.yarn import WeavingDamage, Yarn

__version__: str

__all__ = [
    "CompressionLaw",
    "DoubtfulError",
    "Fabric",
    "InputError",
    "PlateCurve",
    "ResponseSurface",
    "SolidLaw",
    "TrellisShear",
    "UndecidedError",
    "UnstableError",
    "Weave",
    "WeavecellError",
    "WeavingDamage",
    "Yarn",
    "list_names",
    "load",
]
