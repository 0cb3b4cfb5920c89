"""The patch of solid yarns: one-point hexahedra, yarn-yarn contact, explicit time integration."""
