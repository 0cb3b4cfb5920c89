"""The pin-jointed cable net: yarns as bars, with its own kernels and time integration, and Smith's closed form."""
