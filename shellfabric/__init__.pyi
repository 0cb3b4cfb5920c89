# Public names and their modules: `fabrics.lazy.public` loads each when it is first used.
from shellfabric.backing.block import Backing
from shellfabric.cell.model import CellModel, CellTable
from shellfabric.impact.ballistic_limit import Limit, Shot, critical_velocity, shoot
from shellfabric.impact.lambert_jonas import LambertJonas
from shellfabric.impact.limit_scan import ScanRange, scan
from shellfabric.impact.simulation import ImpactResult, ImpactSetup, run
from shellfabric.output.histories import HistoryRequest
from shellfabric.panel.boundary import Grip, PullIn
from shellfabric.panel.model import Numerics, Panel
from shellfabric.plies.model import Pack, PlyContact
from shellfabric.projectile.projectile import Projectile

__all__ = [
    "Backing",
    "CellModel",
    "CellTable",
    "Grip",
    "HistoryRequest",
    "ImpactResult",
    "ImpactSetup",
    "LambertJonas",
    "Limit",
    "Numerics",
    "Pack",
    "Panel",
    "PlyContact",
    "Projectile",
    "PullIn",
    "ScanRange",
    "Shot",
    "critical_velocity",
    "run",
    "scan",
    "shoot",
]
