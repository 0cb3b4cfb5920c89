"""Cases of the literature that claims and studies share, and tables of measured shots with their provenance."""
