"""The assembled models: crossover, periodic cell, stack."""
