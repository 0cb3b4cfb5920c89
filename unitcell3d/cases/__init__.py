"""Load cases of the crossover: biaxial paths, platens, single yarn, stack, periodic cell."""
