"""Friction in a fabric: the force at which a yarn slips through a crossover."""
