"""Scene files: schema, supported keys, and the set-up that a scene describes."""
