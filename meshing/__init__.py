"""The yarn crossover of a plain weave in hexahedra: sections that close, mesh, quality, files."""
