"""Explicit time integration: the loop, samples, energy audit and guards that all models share."""
