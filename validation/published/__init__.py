"""Cases of the literature, each a module or folder: input, reference with provenance, comparison, difference."""
