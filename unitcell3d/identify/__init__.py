"""Parameter identification: compression law, solid constants, response surfaces."""
