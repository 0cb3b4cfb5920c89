"""Cases of the literature, each a folder: input, reference with its provenance, comparison, stated difference."""
