"""The yarn crossover of a plain weave in hexahedra: sections, closing of the overlap, mesh, quality, files, pictures."""
