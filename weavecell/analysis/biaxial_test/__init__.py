"""A measured biaxial test: reading, curves of the cell, inverse fit of the compression law."""
