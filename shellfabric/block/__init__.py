"""The deformable block behind a panel: explicit hexahedra, contact with the fabric, coupling to its
time steps."""
