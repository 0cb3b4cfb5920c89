"""The law of a contact point, one for nose, resolved yarns, plies and block: normal force, damping,
friction."""
