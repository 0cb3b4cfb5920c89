"""How hypothesis samples: the same few examples in every `make test`, many new ones in `make fuzz`."""

import os

from hypothesis import HealthCheck, settings

# a table of a cell or a projectile takes longer than the checks of health expect of an example
COMMON = {
    "deadline": None,
    "suppress_health_check": [HealthCheck.too_slow],
    "database": None,
    "print_blob": True,
}
settings.register_profile("test", max_examples=60, derandomize=True, **COMMON)
settings.register_profile("fuzz", max_examples=1000, derandomize=False, **COMMON)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "test"))
