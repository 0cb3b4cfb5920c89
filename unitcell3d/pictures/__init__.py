"""Pictures of calibrations and of the deformed crossover."""
