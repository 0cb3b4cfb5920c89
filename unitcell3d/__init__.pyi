# Public names and their modules: `fabrics.lazy.public` loads each when it is first used.
from unitcell3d.cases.biaxial_and_platens import biaxial, plate_compression
from unitcell3d.identify.assumed_range import with_assumed_range
from unitcell3d.identify.calibrate import calibrate, calibrate_all
from unitcell3d.identify.calibration import Calibration
from unitcell3d.identify.response_surface import sample
from unitcell3d.identify.shear_fit import ShearFit
from unitcell3d.identify.solid_fit import fit_solid
from unitcell3d.identify.solid_record import SolidFit
from unitcell3d.model.crossover import CrossoverModel, Load, Numerics
from unitcell3d.solver.history import History

__all__ = [
    "Calibration",
    "CrossoverModel",
    "History",
    "Load",
    "Numerics",
    "ShearFit",
    "SolidFit",
    "biaxial",
    "calibrate",
    "calibrate_all",
    "fit_solid",
    "plate_compression",
    "sample",
    "with_assumed_range",
]
