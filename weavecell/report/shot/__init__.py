"""The report of an impact, on one ply or on a pack."""
