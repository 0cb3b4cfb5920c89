"""The assembled models: crossover, periodic cell, crossover with a pulled yarn."""
