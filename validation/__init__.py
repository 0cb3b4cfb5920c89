"""Published cases, each a folder: input, reference with its provenance, comparison, stated difference."""
