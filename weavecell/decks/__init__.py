"""A panel or pack as a deck for LS-DYNA or OpenRadioss, with the material law of that code and its
error."""
