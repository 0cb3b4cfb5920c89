"""The deformable block behind a panel: explicit hexahedra, contact with the cloth, coupling to its time steps."""
