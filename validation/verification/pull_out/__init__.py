"""The slip threshold of the 3D crossover: its law, and what its numbers depend on."""
